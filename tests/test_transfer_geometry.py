"""Rays over a planet, against positions in three dimensions."""

import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.transfer.geometry import Flat, Ray, Spherical, SunDirection


RADIUS, TOP = 6.36e6, 60e3
RNG = np.random.default_rng(1)
ALTITUDE = RNG.uniform(0, 50e3, 200)


def planet(dtype=jnp.float64):
    return Spherical(jnp.asarray(RADIUS, dtype), jnp.asarray(TOP, dtype))


def positions(altitude, mu, distance):
    """Distance from the planet's centre, and zenith cosine, after going straight on."""
    eye = np.stack([0 * altitude, RADIUS + altitude], axis=-1)
    step = np.stack([np.sqrt(1 - mu**2), mu], axis=-1)
    there = eye + distance[:, None] * step
    size = np.linalg.norm(there, axis=-1)
    return size, np.sum(there * step, axis=-1) / size


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_a_ray_reaches_the_top_where_it_says(dtype):
    mu = RNG.uniform(-0.05, 1, 200)
    got = planet(dtype).to_top(jnp.asarray(ALTITUDE, dtype), jnp.asarray(mu, dtype))
    size, _ = positions(ALTITUDE, mu, np.asarray(got, float))
    # A relative error ε in the distance moves the end by ε·distance; μ itself is rounded as well.
    slack = 8 * float(jnp.finfo(dtype).eps) * np.asarray(got, float) + 1e-7
    assert np.all(np.abs(size - RADIUS - TOP) <= slack)


def test_a_falling_ray_strikes_the_ground_where_it_says():
    horizon = np.asarray(planet().horizon(jnp.asarray(ALTITUDE)))
    mu = horizon + (-1 - horizon) * RNG.uniform(0.01, 1, 200)
    got = np.asarray(planet().to_ground(jnp.asarray(ALTITUDE), jnp.asarray(mu)))
    size, _ = positions(ALTITUDE, mu, got)
    # The radius is 6e6 m: positions are rounded to 1e-9 m, and grazing rays multiply that.
    np.testing.assert_allclose(size, RADIUS, atol=1e-6)


def test_the_horizon_is_where_rays_just_miss_the_ground():
    horizon = planet().horizon(jnp.asarray(ALTITUDE))
    distance, low = planet().lowest(jnp.asarray(ALTITUDE), horizon)
    size, cosine = positions(ALTITUDE, np.asarray(horizon), np.asarray(distance))
    # The horizon's ray passes (100 m)² / 2R = 0.8 mm too low, on purpose.
    np.testing.assert_allclose(size - RADIUS, 0, atol=1e-3)
    np.testing.assert_allclose(low, 0, atol=1e-3)
    np.testing.assert_allclose(cosine, 0, atol=1e-9)


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_going_straight_on_changes_altitude_and_zenith_angle(dtype):
    mu, distance = RNG.uniform(0, 1, 200), 10 ** RNG.uniform(1, 5.7, 200)
    args = (jnp.asarray(a, dtype) for a in (ALTITUDE, mu, distance))
    altitude, cosine = planet(dtype).advance(*args)
    size, want = positions(ALTITUDE, mu, distance)
    eps = float(jnp.finfo(dtype).eps)
    # No difference of radii: the altitude keeps its digits, in float32 a few cm of 500 km.
    np.testing.assert_allclose(altitude, size - RADIUS, rtol=8 * eps, atol=1e-7)
    np.testing.assert_allclose(cosine, want, atol=8 * eps)


def test_levels_are_crossed_at_the_distance_and_angle_of_the_ray():
    level = jnp.asarray([0.0, 1e3, 2e4, TOP])
    low, mu = jnp.asarray(500.0), jnp.asarray(0.02)
    distance = planet().to_level(low, mu, level)
    altitude, cosine = planet().advance(low, mu, distance)
    np.testing.assert_allclose(altitude[1:], level[1:], atol=1e-6)
    np.testing.assert_allclose(cosine[1:], planet().mu_at_level(low, mu, level)[1:], atol=1e-12)
    ray = Ray(low, mu, jnp.sqrt(1 - mu**2))
    sine = planet().sine_at_level(ray, level)
    np.testing.assert_allclose(sine[1:] ** 2 + cosine[1:] ** 2, 1, atol=1e-12)


def test_the_sun_stays_where_it_is_while_the_vertical_turns():
    rng = np.random.default_rng(2)
    for _ in range(20):
        zenith, azimuth, mu = rng.uniform(0, 3), rng.uniform(0, np.pi), rng.uniform(0, 1)
        altitude, distance = rng.uniform(0, 4e4), rng.uniform(0, 3e5)
        eye, up = np.array([0, 0, RADIUS + altitude]), np.array([0.0, 0, 1])
        ahead = np.array([1.0, 0, 0])
        view = np.sqrt(1 - mu**2) * ahead + mu * up
        sun = np.array(
            [np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth), np.cos(zenith)]
        )
        there = eye + distance * view
        new_up = there / np.linalg.norm(there)
        new_ahead = np.cross(np.array([0.0, 1, 0]), new_up)
        want = [sun @ new_up, sun @ new_ahead, abs(sun[1])]
        ray = Ray(*(jnp.asarray(a) for a in (altitude, mu, np.sqrt(1 - mu**2))))
        seen = SunDirection.from_angles(jnp.asarray(zenith), jnp.cos(azimuth))
        got = planet().turn_sun(seen, ray, jnp.asarray(distance))
        np.testing.assert_allclose([got.up, got.ahead, got.aside], want, atol=1e-12)
        np.testing.assert_allclose(got.zenith(), np.arccos(want[0]), atol=1e-7)


def test_the_shadow_begins_and_ends_where_the_planet_hides_the_sun():
    rng = np.random.default_rng(3)
    found = 0
    for _ in range(300):
        zenith, azimuth = rng.uniform(1.5, 1.9), rng.uniform(0, np.pi)
        mu, altitude = rng.uniform(-0.1, 0.5), rng.uniform(0, 3e4)
        sun = np.array(
            [np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth), np.cos(zenith)]
        )
        view = np.array([np.sqrt(1 - mu**2), 0, mu])
        ray = Ray(*(jnp.asarray(a) for a in (altitude, mu, np.sqrt(1 - mu**2))))
        seen = SunDirection.from_angles(jnp.asarray(zenith), jnp.cos(azimuth))
        enter, leave = (float(t) for t in planet().shadow(seen, ray))
        t = rng.uniform(0, 1e6, 200)
        p = np.array([0, 0, RADIUS + altitude]) + t[:, None] * view
        along = p @ sun
        dark = (along < 0) & (np.sum(p * p, axis=1) - along**2 < RADIUS**2)
        near_an_edge = (np.abs(t - enter) < 1) | (np.abs(t - leave) < 1)
        inside = (t > enter) & (t < leave)
        assert np.all((inside == dark) | near_an_edge)
        found += dark.any() and not dark.all()
    assert found > 30  # both lit and dark stretches were met


def test_a_ray_from_space_enters_where_the_atmosphere_begins():
    eye = Ray(jnp.asarray(4e5), jnp.asarray(-0.5), jnp.sqrt(0.75))
    sun = SunDirection.from_angles(jnp.asarray(1.0), jnp.asarray(0.3))
    entered, _, meets = planet().enter(eye, sun)
    # (R + h) sinθ is the same all along a straight line.
    assert bool(meets)
    np.testing.assert_allclose(entered.altitude, TOP)
    np.testing.assert_allclose(
        (RADIUS + entered.altitude) * entered.sine, (RADIUS + 4e5) * eye.sine, rtol=1e-12
    )
    np.testing.assert_allclose(entered.sine**2 + entered.mu**2, 1, rtol=1e-12)
    upward = Ray(jnp.asarray(4e5), jnp.asarray(0.1), jnp.sqrt(0.99))
    assert not bool(planet().enter(upward, sun)[2])


def test_over_a_plane_nothing_turns():
    flat = Flat(jnp.asarray(TOP))
    altitude, mu = flat.advance(jnp.asarray(1e3), jnp.asarray(0.5), jnp.asarray(2e4))
    assert (float(altitude), float(mu)) == (11e3, 0.5)
    assert float(flat.to_top(jnp.asarray(1e4), jnp.asarray(0.5))) == 1e5
    assert float(flat.to_ground(jnp.asarray(1e4), jnp.asarray(-0.5))) == 2e4
