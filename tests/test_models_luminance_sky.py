"""What every sky of one colour answers: the CIE's, Perez's all-weather sky, the blend."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.angles import unit_vector
from skyfit.colour import xyY_to_xyz
from skyfit.models import (
    cie_clear_sky,
    cie_general_sky,
    cie_intermediate_sky,
    cie_overcast_sky,
    overcast_blend_sky,
    perez_all_weather_sky,
    perez_clear_sky,
)


pytestmark = pytest.mark.any_precision


HORIZON = np.pi / 2
SKIES = {
    "clear": lambda: cie_clear_sky(3.0),
    "overcast": cie_overcast_sky,
    "intermediate": lambda: cie_intermediate_sky(3.0),
    "general": lambda: cie_general_sky(13, diffuse_illuminance=12e3),
    "all-weather": lambda: perez_all_weather_sky(400.0, 200.0),
    "blend": lambda: overcast_blend_sky(8.0),
}
each_sky = pytest.mark.parametrize("make", SKIES.values(), ids=SKIES)

# Sun, view and azimuth: zenith, horizon, below it, at the sun, opposite it, at sunset and at night.
CORNERS = np.array(
    [
        [0.6, 0.0, 0.3],
        [0.0, 0.0, 0.0],
        [0.0, HORIZON, 0.0],
        [0.6, HORIZON, 1.0],
        [0.6, 2.0, 1.0],
        [0.6, np.pi, 1.0],
        [0.6, 0.6, 0.0],
        [1.1, HORIZON - 1.1, np.pi],
        [0.6, np.pi - 0.6, np.pi],
        [HORIZON, HORIZON, 0.0],
        [HORIZON, 1.0, np.pi],
        [1.7, 0.8, 0.5],
        [2.5, HORIZON, 0.0],
    ]
)


@pytest.mark.slow
@each_sky
def test_light_is_never_negative_and_its_gradient_is_finite(make):
    sky = make()
    colours = np.asarray(sky.xyY(*CORNERS.T))
    assert np.isfinite(colours).all()
    assert (colours >= 0).all()

    gradient = jax.jit(jax.vmap(jax.grad(lambda angles: sky.xyY(*angles).sum())))
    assert np.isfinite(gradient(CORNERS)).all()


def test_gradients_by_unit_vectors_are_finite():
    sky = cie_intermediate_sky(3.0)  # which asks for the angle of the view as well as its cosine

    def total(angles):
        sun, view, azimuth = angles
        return sky.xyz(unit_vector(view, azimuth), unit_vector(sun, jnp.zeros_like(sun))).sum()

    assert np.isfinite(jax.jit(jax.vmap(jax.grad(total)))(CORNERS)).all()


@pytest.mark.slow
@each_sky
def test_unit_vectors_and_angles_give_the_same_light(make):
    sky, rng = make(), np.random.default_rng(3)
    sun, view, azimuth = jnp.asarray(rng.uniform(0.0, [1.5, 1.9, 2 * np.pi], (20, 3))).T
    got = sky.xyz(unit_vector(view, azimuth), unit_vector(sun, 0 * sun))
    # The cosine of a view near the horizon comes by two roads: 1e-16 in it is 1e-12 in e^{b/cos}.
    np.testing.assert_allclose(got, xyY_to_xyz(sky.xyY(sun, view, azimuth)), rtol=1e-9)


@pytest.mark.slow
@each_sky
def test_derivatives_by_sun_and_view_are_those_of_differences(make):
    sky = make()
    at, step = np.array([0.9, 0.5, 0.7]), 1e-5
    slope = jax.jit(jax.jacfwd(lambda angles: sky.xyY(*angles)))(at)
    stencil = at[:, None] + step * np.concatenate([np.eye(3), -np.eye(3)], axis=1)
    ahead, behind = np.split(np.asarray(sky.xyY(*stencil)), 2)
    np.testing.assert_allclose(slope.T, (ahead - behind) / (2 * step), rtol=1e-5, atol=1e-6)


@pytest.mark.slow
@each_sky
def test_dusk_falls_without_a_step(make):
    suns = np.linspace(HORIZON - 2e-3, HORIZON + 2e-3, 9)
    luminance = np.asarray(make().xyY(suns, 0.7, 2.0)[:, 2])
    # Dimming by a decade in 2.5° is 2.7 % in a step of 5e-4 rad; by day the sun matters less.
    assert np.abs(np.diff(luminance)).max() <= 0.04 * luminance.max()
    night = make().xyY(np.radians([93.0, 95.5, 98.0]), 0.7, 2.0)[:, 2]
    assert (np.diff(night) < 0).all()


@pytest.mark.slow
@pytest.mark.parametrize("make", [SKIES["general"], SKIES["all-weather"]])
def test_float32_is_within_a_ten_thousandth(make):
    angles = np.random.default_rng(4).uniform(0.05, [1.4, 1.5, 3.0], (10, 3)).T
    want = make().xyY(*angles)
    with jax.enable_x64(False):
        got = make().xyY(*angles.astype(np.float32))
        assert got.dtype == jnp.float32
    np.testing.assert_allclose(got, want, rtol=1e-4)


@pytest.mark.float64
@pytest.mark.parametrize("make", [SKIES["clear"], SKIES["intermediate"]])
def test_many_directions_are_one_program(make):
    sky = make()
    view, azimuth = np.linspace(0.0, 1.5, 100)[:, None], np.linspace(0.0, 6.0, 100)
    got = jax.jit(sky.xyY)(0.8, view, azimuth)
    assert got.shape == (100, 100, 3)
    np.testing.assert_allclose(got[50, 30], sky.xyY(0.8, view[50, 0], azimuth[30]), rtol=1e-9)
    assert "sun_zenith" in sky.valid_range


def test_spectra_and_rgb_have_the_luminance():
    sky = cie_clear_sky(3.0)
    luminance = sky.xyY(0.7, 0.4, 1.0)[2]
    rgb = sky.rgb(0.7, 0.4, 1.0)
    np.testing.assert_allclose(rgb @ np.array([0.2126, 0.7152, 0.0722]), luminance, rtol=1e-3)
    assert (sky.radiance(0.7, 0.4, 1.0, [450.0, 550.0, 650.0]) > 0).all()


@pytest.mark.slow
def test_parameters_broadcast_against_the_angles():
    turbidity = np.array([2.0, 4.0, 6.0])
    views = np.array([0.1, 0.8])[:, None]
    got = cie_clear_sky(turbidity).xyY(0.9, views, 0.3)
    assert got.shape == (2, 3, 3)
    np.testing.assert_allclose(got[1, 2], cie_clear_sky(6.0).xyY(0.9, 0.8, 0.3), rtol=1e-12)
    weather = perez_all_weather_sky(np.array([0.0, 300.0, 800.0]), 150.0).xyY(0.9, views, 0.3)
    np.testing.assert_allclose(
        weather[0, 1], perez_all_weather_sky(300.0, 150.0).xyY(0.9, 0.1, 0.3), rtol=1e-12
    )
    blend = overcast_blend_sky(np.array([3.0, 7.0, 10.0])).xyY(0.9, views, 0.3)
    np.testing.assert_allclose(blend[1, 1], overcast_blend_sky(7.0).xyY(0.9, 0.8, 0.3), rtol=1e-12)


@pytest.mark.parametrize("make", [cie_clear_sky, perez_clear_sky, cie_intermediate_sky])
def test_turbidity_out_of_range_is_held_with_a_warning(make):
    with pytest.warns(UserWarning, match=r"turbidity=...\) is valid from 1.9 to 10 and held"):
        got = make(15.0).xyY(0.9, 0.5, 0.3)
    np.testing.assert_allclose(got, make(10.0).xyY(0.9, 0.5, 0.3), rtol=1e-12)
