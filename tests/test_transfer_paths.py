"""Columns along rays and towards the sun."""

import jax.numpy as jnp
import numpy as np
import pytest

from skyfit import Atmosphere, Constituent, phase, profile
from skyfit.transfer.columns import sun_columns
from skyfit.transfer.geometry import Flat, Spherical
from skyfit.transfer.medium import make_medium
from skyfit.transfer.nodes import sample
from skyfit.transfer.paths import column_along, ground_leg, limb_legs, rising_leg


KINKED = profile.Tabulated([0, 1e3, 2e3, 9e3, 12e3], [1.0, 0.4, 0.3, 0.3, 0.0])
AIR = Atmosphere(
    [500.0],
    1.0,
    (
        Constituent(profile.Exponential(8e3), 1e-5, phase=phase.Rayleigh()),
        Constituent(KINKED, 1e-4, phase=phase.Rayleigh()),
    ),
)
SPHERE = make_medium(AIR, Spherical(AIR.planet_radius, AIR.top_altitude))
PLANE = make_medium(AIR, Flat(AIR.top_altitude))
FAR = jnp.asarray(jnp.inf)


def brute(altitude, mu, length, count=400_001):
    """Trapezoid sums in three dimensions; its error falls as the square of 2 m steps."""
    t = np.linspace(0, 1, count) ** 2 * length
    p = np.stack([t * np.sqrt(1 - mu**2), 6.36e6 + altitude + t * mu])
    h = np.linalg.norm(p, axis=0) - 6.36e6
    rho = [np.exp(-h / 8e3), np.interp(h, KINKED.altitude, KINKED.relative_density, right=0)]
    return np.array([np.trapezoid(r, t) for r in rho])


@pytest.mark.slow
@pytest.mark.parametrize("zenith_deg", [0.0, 50.0, 85.0, 89.5, 90.0])
def test_column_of_a_rising_ray_is_the_integral_of_density(zenith_deg):
    mu = np.cos(np.radians(zenith_deg))
    leg = rising_leg(SPHERE.planet, jnp.asarray(300.0), jnp.asarray(mu), FAR)
    got = column_along(SPHERE, leg, jnp.asarray(0.0), leg.length)
    # The cubics on shells are worth 1e-6.
    np.testing.assert_allclose(got, brute(300.0, mu, float(leg.length)), rtol=3e-6)
    path = sample(SPHERE, leg, jnp.asarray(0.0), leg.length, 12, 6)
    np.testing.assert_allclose(path.total, got, rtol=1e-5)
    np.testing.assert_allclose(path.weight.sum(0), got, rtol=1e-5)


@pytest.mark.slow
def test_columns_at_nodes_are_those_of_the_stretch_below():
    leg = rising_leg(SPHERE.planet, jnp.asarray(0.0), jnp.asarray(0.05), FAR)
    path = sample(SPHERE, leg, jnp.asarray(0.0), leg.length, 7, 6)
    for k in (0, 7, 15, 38):
        want = column_along(SPHERE, leg, jnp.asarray(0.0), path.distance[k])
        np.testing.assert_allclose(path.column[k], want, rtol=2e-5)


def test_flat_columns_follow_the_secant():
    leg = rising_leg(PLANE.planet, jnp.asarray(0.0), jnp.asarray(0.1), FAR)
    got = column_along(PLANE, leg, jnp.asarray(0.0), leg.length)
    # 8 km (1 - e^{-60/8}) and the area of the polygon, over μ = 0.1.
    area = 700.0 + 350.0 + 2100.0 + 450.0
    np.testing.assert_allclose(got, [10 * 8e3 * (1 - np.exp(-7.5)), 10 * area], rtol=2e-6)


def test_a_limb_ray_sees_twice_the_column_above_its_lowest_point():
    down, out = limb_legs(SPHERE.planet, jnp.asarray(2e4), jnp.asarray(-0.06), FAR)
    here = column_along(SPHERE, down, jnp.asarray(0.0), down.length)
    there = column_along(SPHERE, out, jnp.asarray(0.0), down.length)
    np.testing.assert_allclose(here, there, rtol=1e-12)
    assert 0 < float(down.altitude) < 2e4


def test_a_ray_to_the_ground_and_back_is_one_path():
    h, mu = jnp.asarray(5e3), jnp.asarray(-0.3)
    down = ground_leg(SPHERE.planet, h, mu)
    column = column_along(SPHERE, down, jnp.asarray(0.0), down.length)
    up = rising_leg(SPHERE.planet, down.altitude, down.mu, FAR)
    np.testing.assert_allclose(
        column, column_along(SPHERE, up, jnp.asarray(0.0), down.length), rtol=1e-12
    )


@pytest.mark.slow
def test_sun_columns_agree_with_direct_integration():
    columns = sun_columns(SPHERE, 96)
    rng = np.random.default_rng(0)
    for _ in range(40):
        h = float(60e3 * rng.uniform(0, 0.9) ** 2)
        horizon = float(SPHERE.planet.horizon(jnp.asarray(h)))
        mu = horizon + (1 - horizon) * rng.uniform(0.02, 1) ** 3
        got, lit = columns(jnp.asarray(h), jnp.asarray(mu))
        length = float(SPHERE.planet.to_top(jnp.asarray(h), jnp.asarray(mu)))
        assert bool(lit)
        want = brute(h, mu, length)
        # Bicubic on this grid is worth 2e-4 for a smooth density. A ray whose lowest point lies
        # on a kink (this profile's are twice as sharp as Elterman's) costs up to 1 %.
        np.testing.assert_allclose(got[0], want[0], rtol=3e-4)
        np.testing.assert_allclose(got[1], want[1], rtol=1e-2, atol=0.1)


@pytest.mark.slow
def test_the_sun_below_the_horizon_does_not_shine():
    columns = sun_columns(SPHERE, 48)
    h = jnp.asarray([0.0, 1e4, 1e4])
    mu = jnp.asarray([-1e-3, -0.06, -0.05])
    assert columns(h, mu)[1].tolist() == [False, False, True]


@pytest.mark.slow
@pytest.mark.parametrize("thicker", [1e-3, 1.0, 100.0])
@pytest.mark.parametrize("geometry", [SPHERE, PLANE])
def test_air_that_glows_evenly_is_seen_with_its_own_brightness(geometry, thicker):
    """∫ β e^{-τ} ds is what transmittance falls by, in few panels and through any depth."""
    leg = rising_leg(geometry.planet, jnp.asarray(0.0), jnp.asarray(0.2), FAR)
    path = sample(geometry, leg, jnp.asarray(0.0), leg.length, 3, 4)
    extinction = thicker * geometry.optics.extinction
    before = jnp.asarray([2e3, 0.0])
    seen = jnp.sum((path.weight @ extinction) * path.arriving(leg, before, extinction), axis=0)
    through = np.exp(-before @ extinction), np.exp(-(before + path.total) @ extinction)
    # Of panels thinner than 0.01 three nodes see all but 1e-7; others are scaled to it.
    np.testing.assert_allclose(seen, through[0] - through[1], rtol=1e-6)
