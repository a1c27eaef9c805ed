"""The sky and the air of Hoffman & Preetham (2002)."""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit.colour import rgb_to_xyz
from skyfit.models import hoffman


pytestmark = pytest.mark.any_precision


ZENITH, LEVEL = 0.0, np.pi / 2
SUN = np.radians(60.0)


@pytest.fixture(scope="module")
def model():
    return skyfit.hoffman_preetham_sky(haze="light haze", haze_absorption=1e-5)


def kasten(degrees):
    """Equation 5 without its length."""
    return 1 / (np.cos(np.radians(degrees)) + 0.15 * (93.885 - degrees) ** -1.253)


def two_shells(model, view_degrees, gamma, steps=4000):
    """The sky by marching through both shells, a midpoint rule in place of the closed form."""
    air, haze, lost = (np.asarray(c) for c in (model.air, model.haze, model.haze_absorption))
    g = float(model.haze_phase.g[0])
    rayleigh = 3 / (16 * np.pi) * (1 + np.cos(gamma) ** 2) * air
    forward = (1 - g**2) / (4 * np.pi * (1 + g**2 - 2 * g * np.cos(gamma)) ** 1.5) * haze
    long, short = 8400 * kasten(view_degrees), 1250 * kasten(view_degrees)
    ds = long / steps
    s = (np.arange(steps) + 0.5)[:, None] * ds
    inside = s < short
    depth = air * s + (haze + lost) * np.minimum(s, short)
    return np.sum((rayleigh + np.where(inside, forward, 0)) * np.exp(-depth) * ds, axis=0)


@pytest.mark.parametrize("view_degrees", [0.0, 40.0, 85.0, 90.0])
def test_the_sky_is_what_marching_through_both_shells_gives(model, view_degrees):
    view = np.radians(view_degrees)
    sky = model.rgb(SUN, view, 0.7)
    gamma = float(skyfit.angles.view_sun_angle(*map(jnp.asarray, (view, SUN, 0.7))))
    marched = two_shells(model, view_degrees, gamma) * np.asarray(model.sunlight(SUN))
    np.testing.assert_allclose(sky, marched, rtol=1e-3)  # the shells' edge is within half a step


@pytest.mark.slow
@pytest.mark.parametrize("g", [-1.0, -3.0, -10.0, -30.0])
def test_the_g_of_table_1_is_none_of_a_phase_function(g):
    # With these g the mended function integrates to sign(1 - |g|) or vanishes, and is largest
    # backwards; haze scatters forward.
    mu, weight = np.polynomial.legendre.leggauss(400)
    values = (1 - g**2) / (4 * np.pi * (1 + g**2 - 2 * g * mu) ** 1.5)
    assert 2 * np.pi * weight @ values < 0.5
    with pytest.raises(ValueError, match="must lie in"):
        skyfit.hoffman_preetham_sky(haze="light haze", g=g)


def test_the_air_is_as_printed():
    np.testing.assert_allclose(
        skyfit.hoffman_preetham_sky(1.0).air, [6.95e-6, 1.18e-5, 2.44e-5], rtol=0.005
    )


def test_sunlight_is_dimmed_over_the_optical_lengths(model):
    # At 60° Kasten's air mass is 1.993; of blue, 2.44e-5 · 8400 and 5e-5 · 1250 m lie overhead.
    beyond = np.asarray(hoffman.sun_colour())
    depth = 1.993 * (2.44e-5 * 8400 + (4e-5 + 1e-5) * 1250)
    np.testing.assert_allclose(model.sunlight(SUN)[2] / beyond[2], np.exp(-depth), rtol=2e-3)


def test_the_sun_above_the_air_has_the_solar_illuminance():
    # 128 to 135 klx in the literature; Darula, Kittler & Gueymard (2005) give 133.3 klx.
    lux = rgb_to_xyz(hoffman.sun_colour())[1]
    np.testing.assert_allclose(lux, 133.3e3, rtol=0.04)


def test_turbidity_is_the_ratio_of_optical_depths():
    model = skyfit.hoffman_preetham_sky(4.0)
    green_air = 13.6e-6 * 8400  # 550 nm
    haze = np.interp(550.0, [475.0, 570.0], np.asarray(model.haze)[[2, 1]]) * 1250
    np.testing.assert_allclose((green_air + haze) / green_air, 4.0, rtol=0.02)
    assert (skyfit.hoffman_preetham_sky(1.0).haze == 0).all()


def test_the_sky_is_blue_by_day_and_red_round_a_low_sun():
    clear = skyfit.hoffman_preetham_sky(1.5)
    red, green, blue = clear.rgb(SUN, ZENITH, 0.0)
    assert blue > green > red
    red, green, blue = clear.rgb(np.radians(89.0), np.radians(88.0), 0.0)
    assert red > green > blue


@pytest.mark.float64
def test_air_before_an_object_follows_equation_4(model):
    air = skyfit.hoffman_preetham_aerial(model, SUN)
    view, azimuth, s = np.radians(80.0), 0.5, 5e3
    gamma = np.arccos(np.cos(view) * np.cos(SUN) + np.sin(view) * np.sin(SUN) * np.cos(azimuth))
    rayleigh = 3 / (16 * np.pi) * (1 + np.cos(gamma) ** 2) * np.asarray(model.air)
    spread = 1 + 0.76**2 - 2 * 0.76 * np.cos(gamma)
    haze = (1 - 0.76**2) / (4 * np.pi * spread**1.5) * np.array([2e-5, 3e-5, 4e-5])
    beta = np.asarray(model.air) + np.array([3e-5, 4e-5, 5e-5])
    seen = np.exp(-beta * s)
    light = np.asarray(model.sunlight(SUN)) * (rayleigh + haze) / beta * (1 - seen)
    np.testing.assert_allclose(air.transmittance(s), seen, rtol=1e-9)
    np.testing.assert_allclose(air.inscatter(s, view, azimuth), light, rtol=1e-9)
    np.testing.assert_allclose(air.apply([1.0, 2.0, 3.0], s, view, azimuth),
                               light + seen * [1, 2, 3], rtol=1e-9)  # fmt: skip


@pytest.mark.float64
def test_the_sky_at_the_end_of_the_haze_is_the_air_before_an_object(model):
    # Within the inner shell sky and aerial perspective are one formula.
    shallow = skyfit.hoffman_preetham_sky(haze="light haze", haze_absorption=1e-5)
    object.__setattr__(shallow, "air_length", shallow.haze_length)
    light = skyfit.hoffman_preetham_aerial(shallow, SUN).inscatter(1250 * kasten(70.0),
                                                                   np.radians(70), 1.0)  # fmt: skip
    np.testing.assert_allclose(shallow.rgb(SUN, np.radians(70), 1.0), light, rtol=1e-9)


@pytest.mark.slow
def test_vectors_and_angles_agree(model):
    view, azimuth = np.radians([0.0, 30.0, 89.0, 100.0]), np.array([0.0, 1.0, 2.0, -3.0])
    direction = skyfit.angles.unit_vector(jnp.array(view), jnp.array(azimuth))
    sun = np.array([np.sin(SUN), 0.0, np.cos(SUN)])
    by_angles = rgb_to_xyz(model.rgb(SUN, view, azimuth))
    np.testing.assert_allclose(model.xyz(direction, sun), by_angles, rtol=1e-6)
    np.testing.assert_allclose(model.xyY(SUN, view, azimuth)[:, 2], by_angles[:, 1], rtol=1e-12)


def test_values_and_gradients_are_finite_by_day_and_night(model):
    rays = np.meshgrid([0.0, 1.0, LEVEL, 1.6, np.pi], [0.0, 1.0, LEVEL, 2.5, np.pi], [0.0, np.pi])
    rays = [jnp.asarray(a.ravel()) for a in rays]

    def total(*angles):
        return model.rgb(*angles).sum()

    value, slopes = jax.jit(jax.vmap(jax.value_and_grad(total, argnums=(0, 1, 2))))(*rays)
    assert np.isfinite([value, *slopes]).all()
    assert (value >= 0).all()
    np.testing.assert_allclose(
        model.rgb(LEVEL + np.radians(2.5), 0.5, 0.0) / model.rgb(LEVEL, 0.5, 0.0), 0.1, rtol=0.1
    )


@pytest.mark.slow
def test_without_haze_nothing_is_lost_to_it_in_single_precision(float32):
    clear = skyfit.hoffman_preetham_sky(1.0)
    light = clear.rgb(1.0, jnp.linspace(0.0, 1.6, 5), 0.3)
    assert light.dtype == jnp.float32
    assert np.isfinite(light).all()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "expected turbidity or haze, one of the two"),
        ({"turbidity": 2.0, "haze": "light haze"}, "one of the two"),
        ({"turbidity": 0.5}, "turbidity=...) must be 1 or more; got 0.5"),
        ({"haze": "smog"}, "expected one of 'light haze', 'heavy haze'"),
        ({"haze": [1e-5, 2e-5]}, "haze=...): expected one value or three; got shape (2,)"),
        ({"haze": -1e-5}, "haze=...) must be 0 or more, in 1/m; got -1e-05"),
        ({"turbidity": 2.0, "g": -3.0}, "g=...) must lie in (-1, 1); got -3"),
    ],
)
def test_mistakes_are_answered_with_one_line(given, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        skyfit.hoffman_preetham_sky(**given)
