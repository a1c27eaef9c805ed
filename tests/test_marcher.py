"""The 16 × 8 ray marcher against plain loops, and against the simulator it converges to."""

import math
import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit import marcher
from skyfit.angles import unit_vector
from skyfit.colour import rgb_to_xyz
from skyfit.marcher.ball import crossings, height


SUN = np.radians(60.0)
TOWARD = np.array([np.sin(SUN), 0.0, np.cos(SUN)])
EYE = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def air():
    return marcher.scs_air()


def rays(degrees, azimuth=1.0):
    views = jnp.radians(jnp.asarray(degrees, float))
    return unit_vector(views, jnp.full_like(views, azimuth))


def looped(eye, ray, sun, far=math.inf):
    """The tutorial's algorithm, one step after the other, about the planet's centre."""
    earth, top, heights = 6360e3, 6420e3, np.array([7994.0, 1200.0])
    beta = np.array([[3.8e-6, 13.5e-6, 33.1e-6], [21e-6] * 3])
    extinction = beta * np.array([[1.0], [1.1]])

    def meets(start, way, radius):
        b = start @ way
        root = b**2 - start @ start + radius**2
        return (math.inf, -math.inf) if root < 0 else (-b - root**0.5, -b + root**0.5)

    start = eye + np.array([0.0, 0.0, earth])
    enters, leaves = meets(start, ray, top)
    if leaves <= 0:
        return np.zeros(3)
    ground, behind = meets(start, ray, earth)
    begin = max(enters, 0.0)
    end = min(leaves, far, ground if behind > 0 and ground > 0 else math.inf)
    step = (end - begin) / 16
    mu, g = ray @ sun, 0.76
    spread = (1 + g * g - 2 * g * mu) ** 1.5
    phases = np.array([
        3 / (16 * np.pi) * (1 + mu**2),
        3 / (8 * np.pi) * (1 - g * g) * (1 + mu**2) / ((2 + g * g) * spread),
    ])  # fmt: skip
    passed, total = np.zeros(2), np.zeros((2, 3))
    for i in range(16):
        here = start + (begin + (i + 0.5) * step) * ray
        amount = step * np.exp(-(np.linalg.norm(here) - earth) / heights)
        passed = passed + amount
        _, out = meets(here, sun, top)
        ahead = np.zeros(2)
        for j in range(8):
            above = np.linalg.norm(here + (j + 0.5) * out / 8 * sun) - earth
            if above < 0:
                break
            ahead = ahead + out / 8 * np.exp(-above / heights)
        else:
            total += np.outer(amount, np.exp(-(passed + ahead) @ extinction))
    return 20 * np.sum(beta * phases[:, None] * total, axis=0)


@pytest.mark.parametrize("sun_degrees", [0.0, 60.0, 89.0, 95.0])
@pytest.mark.parametrize("altitude", [1.0, 10e3, 400e3])
def test_light_is_that_of_the_loops(air, sun_degrees, altitude):
    sun = np.asarray(rays([sun_degrees], 0.0))[0]
    eye, views = np.array([0.0, 0.0, altitude]), rays([0.0, 45.0, 85.0, 92.0, 110.0, 170.0])
    light, _ = marcher.march(air, eye, views, sun)
    expected = [looped(eye, np.asarray(view), sun) for view in views]
    # The loops lose digits where they subtract the planet's radius.
    np.testing.assert_allclose(light, expected, rtol=1e-5, atol=1e-12)


@pytest.mark.slow
def test_sixteen_by_eight_steps_are_a_tenth_dark_and_more_near_the_horizon(air):
    views = jnp.radians(jnp.array([0.0, 30.0, 60.0, 80.0]))
    exact = skyfit.simulate(skyfit.scs_atmosphere(), SUN, views, 1.0, orders=1).radiance[:, ::-1]
    few = skyfit.scs_sky(sun=20.0).rgb(SUN, views, 1.0)
    assert (few < exact).all()
    np.testing.assert_allclose(few, exact, rtol=0.16)
    many = skyfit.scs_sky(sun=20.0, view_steps=300, light_steps=100).rgb(SUN, views, 1.0)
    np.testing.assert_allclose(many, exact, rtol=0.015)


@pytest.mark.slow
def test_from_space_it_converges_to_the_simulator(air):
    altitude = 300e3
    views = jnp.radians(jnp.array([60.0, 100.0, 150.0, 180.0]))
    exact = skyfit.simulate(
        air.atmosphere(), SUN, views, 1.0, orders=1, observer_altitude=altitude
    ).radiance[:, ::-1]
    light, _ = marcher.march(
        air, np.array([0.0, 0.0, altitude]), unit_vector(views, jnp.ones(4)), TOWARD,
        view_steps=600, light_steps=100,
    )  # fmt: skip
    np.testing.assert_allclose(light, exact, rtol=0.015, atol=1e-9)


@pytest.mark.slow
def test_the_table_replaces_the_steps_towards_the_sun(air):
    views = rays([0.0, 60.0, 85.0])
    by_steps, _ = marcher.march(air, EYE, views, TOWARD, light_steps=400)
    table = marcher.optical_depth_table(air)
    by_table, _ = marcher.march(air, EYE, views, TOWARD, table=table)
    np.testing.assert_allclose(by_table, by_steps, rtol=2e-3)
    # Overhead at the ground: the columns are the scale heights, less what lies above 60 km.
    column, lit = table(jnp.array(0.1), jnp.array(1.0))
    np.testing.assert_allclose(column, [7994 * (1 - np.exp(-60e3 / 7994)), 1200], rtol=1e-3)
    assert lit
    assert not table(jnp.array(0.1), jnp.array(-0.1))[1]


def test_an_object_is_seen_through_the_transmittance(air):
    level = np.array([1.0, 0.0, 0.0])
    near = marcher.march(air, EYE, level, TOWARD, 1.0)
    far = marcher.march(air, EYE, level, TOWARD, 50e3)
    np.testing.assert_allclose(near[1], 1.0, atol=1e-4)
    np.testing.assert_allclose(near[0], 0.0, atol=1e-3)
    beta = np.array([3.8e-6, 13.5e-6, 33.1e-6])
    # Over 50 km the ground curves away by 200 m, a sixth of the haze's scale height at the end.
    np.testing.assert_allclose(far[1], np.exp(-50e3 * (beta + 0.95 * 23.1e-6)), rtol=0.03)
    assert (near[0] < far[0]).all()


@pytest.mark.slow
def test_mountains_cast_shafts_of_shadow(air):
    sun = np.asarray(rays([80.0], 0.0))[0]
    ridge = np.zeros((61, 61))
    ridge[:, 40:] = 3000.0  # from 10 km on towards the sun
    field = marcher.HeightField(ridge, 1e3)
    view = np.array([0.0, 1.0, 0.0])
    given = {"view_steps": 64, "distance": 20e3, "shadow_steps": 800}
    shaded, seen = marcher.march(air, EYE, view, sun, terrain=field, **given)
    lit, same = marcher.march(air, EYE, view, sun, **given)
    assert (lit > 0.01).all()
    # The ridge's shadow reaches 3000 m · tan 80° = 17 km, so over all of the path by the ground.
    np.testing.assert_allclose(shaded, 0.0)
    np.testing.assert_allclose(seen, same)
    # Looking up, the path leaves the shadow at (3000 - 10 km / tan 80°) = 1.24 km.
    up = np.array([0.0, 0.0, 1.0])
    fine = {"view_steps": 500, "shadow_steps": 800}
    above, _ = marcher.march(air, EYE, up, sun, 5e3, terrain=field, **fine)
    start = np.array([0.0, 0.0, 3000 - 10e3 / np.tan(np.radians(80.0))])
    beyond, _ = marcher.march(air, start, up, sun, 5e3 - start[2], view_steps=500)
    below = marcher.march(air, EYE, up, sun, start[2], view_steps=500)[1]
    np.testing.assert_allclose(above, beyond * below, rtol=0.02)
    as_function, _ = marcher.march(air, EYE, up, sun, 5e3, terrain=lambda x, y: field(x, y), **fine)
    np.testing.assert_allclose(as_function, above)


def test_a_height_field_is_linear_between_its_points():
    field = marcher.HeightField([[0.0, 100.0], [200.0, 300.0]], 10.0, corner=[0.0, 0.0])
    x, y = jnp.array([0.0, 5.0, 10.0, 2.5, 20.0]), jnp.array([0.0, 0.0, 10.0, 5.0, 0.0])
    np.testing.assert_allclose(field(x, y), [0.0, 50.0, 300.0, 125.0, 0.0])


def test_alien_skies_take_other_numbers(air):
    # Air that scatters red as Earth's scatters blue has a red sky; without haze, a darker one.
    red = skyfit.scs_sky(rayleigh=(33.1e-6, 13.5e-6, 3.8e-6), mie=0.0)
    light = red.rgb(SUN, 0.3, 1.0)
    blue = skyfit.scs_sky(mie=0.0).rgb(SUN, 0.3, 1.0)
    suns = np.asarray(red.air.sun)
    np.testing.assert_allclose(light / suns, (blue / suns)[::-1], rtol=1e-9)
    no_air = marcher.scs_air(rayleigh=0.0, mie=0.0)
    assert (marcher.march(no_air, EYE, TOWARD, TOWARD)[0] == 0).all()


def test_a_day_runs_from_noon_to_below_the_horizon(air):
    frames = list(marcher.day_frames(air, size=9, frames=4))
    np.testing.assert_allclose(
        [angle for angle, _ in frames], [0, 0.2 * np.pi, 0.4 * np.pi, 0.6 * np.pi]
    )
    bright = [float(light.sum()) for _, light in frames]
    assert min(bright[:3]) > 100 * bright[3] >= 0
    assert (frames[0][1][0, 0] == 0).all()  # the corner is no sky
    middle, _ = marcher.march(air, EYE, [0.0, 0.0, 1.0], [0.0, 0.0, 1.0])
    np.testing.assert_allclose(frames[0][1][4, 4], middle, rtol=1e-9)


def test_the_tone_curve_by_hand():
    # (0.38317 · 1)^(1/2.2) = 0.6466, and 1 - e^-2 = 0.8647
    np.testing.assert_allclose(marcher.tone_map([0.0, 1.0, 2.0]), [0.0, 0.6466, 0.8647], atol=1e-4)


def test_a_camera_looks_where_it_is_told():
    picture = marcher.camera_rays(3, 3, np.radians(90.0), pitch=0.2, heading=0.5)
    axis = [np.cos(0.2) * np.cos(0.5), np.cos(0.2) * np.sin(0.5), np.sin(0.2)]
    np.testing.assert_allclose(picture[1, 1], axis, atol=1e-12)
    assert picture[0, 1, 2] > picture[1, 1, 2] > picture[2, 1, 2]
    np.testing.assert_allclose(np.linalg.norm(picture, axis=-1), 1.0)


@pytest.mark.slow
def test_heights_keep_their_digits_in_single_precision(float32):
    radius = jnp.asarray(6.36e6)
    point = jnp.asarray([300.0, 400.0, 0.25])
    # 0.25 m and the 500²/2R by which the ground falls away
    np.testing.assert_allclose(height(radius, point), 0.25 + 0.019654, rtol=1e-4)
    near, far = crossings(radius, jnp.asarray(60e3), point, jnp.asarray([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(far, 60e3 - 0.25, rtol=1e-5)
    assert near < 0
    light = skyfit.scs_sky().rgb(1.0, jnp.array([0.0, 1.5]), 0.5)
    assert light.dtype == jnp.float32


@pytest.mark.slow
def test_light_in_single_precision_is_that_in_double(air):
    views = rays([0.0, 60.0, 89.0])
    exact, _ = marcher.march(air, EYE, views, TOWARD)
    rough, _ = marcher.march(air, EYE.astype(np.float32), views.astype(jnp.float32), TOWARD)
    assert rough.dtype == jnp.float32
    np.testing.assert_allclose(rough, exact, rtol=2e-4)


@pytest.mark.slow
def test_gradients_are_finite_by_day_and_night():
    sky = skyfit.scs_sky()
    grid = np.meshgrid(
        [0.0, 1.0, np.pi / 2, 1.7, np.pi], [0.0, 1.0, np.pi / 2, 2.5, np.pi], [0.0, 3.0]
    )
    angles = [jnp.asarray(a.ravel()) for a in grid]
    value, slopes = jax.value_and_grad(lambda *a: sky.rgb(*a).sum(), argnums=(0, 1, 2))(*angles)
    assert all(np.isfinite(a).all() for a in (value, *slopes))


def test_vectors_and_angles_agree():
    sky = skyfit.scs_sky()
    direction = rays([0.0, 30.0, 80.0], 2.0)
    by_angles = rgb_to_xyz(sky.rgb(SUN, np.radians([0.0, 30.0, 80.0]), 2.0))
    np.testing.assert_allclose(sky.xyz(direction, TOWARD), by_angles, rtol=1e-9)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"mie": -1e-6}, "mie=...) must be 0 or more; got -1e-06"),
        ({"rayleigh": [1e-6, 2e-6]}, "rayleigh=...): expected one value or three; got (2,)"),
        ({"g": 1.0}, "g=...) must lie in (-1, 1); got 1"),
        ({"mie_extinction_ratio": 0.5}, "mie_extinction_ratio=...) must be 1 or more; got 0.5"),
    ],
)
def test_mistakes_are_answered_with_one_line(given, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        marcher.scs_air(**given)
