"""Turbidity from visibility, haze and the zenith, and back."""

import inspect

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit import preetham_atmosphere, preetham_sky, turbidity
from skyfit.plots.visibility import VISIBILITY_CODE, meteorological_range_chart


GREEN = 550.0
TURBIDITIES = np.array([1.0, 1.5, 2.0, 4.0, 10.0, 60.0])


@pytest.mark.parametrize("meaning", ["optical thickness", "coefficients"])
def test_targets_fade_where_the_simulated_atmosphere_makes_them(meaning):
    for value in (1.0, 2.0, 6.0):
        atm = preetham_atmosphere(value, wavelengths=GREEN, turbidity_means=meaning)
        # By Koschmieder, exp(-extinction distance) is the contrast.
        distance = turbidity.meteorological_range(value, turbidity_means=meaning)
        contrast = np.exp(-float(distance) * atm.scattering.sum())
        np.testing.assert_allclose(contrast, 0.02, rtol=1e-9)


def test_the_papers_coefficients_see_42_kilometres_at_turbidity_two():
    # 3.912 / (7.9e-5 + 1.4e-5 m^-1)
    got = turbidity.meteorological_range(2.0, turbidity_means="coefficients")
    np.testing.assert_allclose(got, 42e3, rtol=0.005)


def test_pure_air_is_seen_through_for_three_hundred_kilometres():
    # McCartney (1976): 3.912 over Rayleigh's 1.162e-5 m^-1 is 337 km; the paper's air scatters
    # 1.36e-5 m^-1, which is 288 km.
    np.testing.assert_allclose(turbidity.meteorological_range(1.0), 3.912 / 1.356e-5, rtol=2e-3)


def test_weather_stations_visibility_is_shorter_than_the_meteorological_range():
    ratio = turbidity.meteorological_range(3.0, contrast=0.05) / turbidity.meteorological_range(3.0)
    np.testing.assert_allclose(ratio, 2.9957 / 3.9120, rtol=1e-4)


@pytest.mark.parametrize("meaning", ["optical thickness", "coefficients"])
@pytest.mark.parametrize("contrast", [0.02, 0.05])
def test_turbidity_comes_back_from_the_range(meaning, contrast):
    how = {"turbidity_means": meaning, "contrast": contrast}
    distance = turbidity.meteorological_range(TURBIDITIES, **how)
    back = turbidity.from_meteorological_range(distance, **how)
    np.testing.assert_allclose(back, TURBIDITIES, rtol=1e-10)


def test_optical_depth_is_that_of_the_simulated_haze():
    atm = preetham_atmosphere(3.0, wavelengths=GREEN)
    haze = atm.constituents[1]
    depth = haze.density.column(60e3) * atm.scattering[1, 0]
    np.testing.assert_allclose(turbidity.aerosol_optical_depth(3.0), depth, rtol=1e-9)


def test_a_sun_photometers_reading_becomes_turbidity_by_hand():
    # 0.1 at 500 nm is 0.1 (550/500)^-1.3 = 0.08835 at 550 nm; the air's is 1.356e-5 m^-1 times
    # 8.45 km = 0.1146.
    got = turbidity.from_aerosol_optical_depth(0.1, 500.0)
    np.testing.assert_allclose(got, 1 + 0.08835 / 0.1146, atol=1e-3)
    back = turbidity.aerosol_optical_depth(got, 500.0)
    np.testing.assert_allclose(back, 0.1, rtol=1e-12)
    grey = turbidity.from_aerosol_optical_depth(0.1, 500.0, angstrom_exponent=0.0)
    np.testing.assert_allclose(grey, 1 + 0.1 / 0.1146, atol=1e-3)


def test_turbidity_comes_back_from_the_zeniths_luminance():
    suns = np.radians([0.0, 30.0, 60.0, 80.0])[:, None]
    values = np.array([1.9, 2.0, 3.7, 6.0, 9.9, 10.0])
    luminance = preetham_sky(values).xyY(suns, 0.0, 0.0)[..., 2]
    back = turbidity.from_zenith_luminance(luminance, suns)
    np.testing.assert_allclose(back, np.broadcast_to(values, back.shape), rtol=1e-9)


def test_a_zenith_beyond_the_models_is_given_the_nearest_turbidity():
    got = turbidity.from_zenith_luminance([1.0, 1e6], 1.0)
    np.testing.assert_array_equal(got, [1.9, 10.0])


@pytest.mark.slow
def test_derivatives_are_those_of_the_inverse_functions():
    def zenith(value, sun):
        return preetham_sky(value).xyY(sun, 0.0, 0.0)[2]

    value, sun = 3.0, 0.9
    forward = jax.grad(zenith, argnums=(0, 1))(value, sun)
    inverse = jax.grad(turbidity.from_zenith_luminance, argnums=(0, 1))(zenith(value, sun), sun)
    np.testing.assert_allclose(inverse[0], 1 / forward[0], rtol=1e-8)
    np.testing.assert_allclose(inverse[1], -forward[1] / forward[0], rtol=1e-8)
    seen = jax.grad(turbidity.meteorological_range)(value)
    distance = turbidity.meteorological_range(value)
    back = jax.grad(turbidity.from_meteorological_range)(distance)
    np.testing.assert_allclose(seen * back, 1.0, rtol=1e-10)
    assert np.isfinite(jax.grad(turbidity.aerosol_optical_depth)(1.0))


def test_everything_maps_and_compiles():
    each = jax.jit(jax.vmap(lambda t: turbidity.from_zenith_luminance(4000.0 * t, 0.8)))
    assert each(jnp.array([1.0, 2.0, 3.0])).shape == (3,)
    np.testing.assert_allclose(
        jax.jit(turbidity.meteorological_range)(2.0), turbidity.meteorological_range(2.0)
    )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (("meteorological_range", (0.5,), {}), r"turbidity=...\) must be 1 or more; got 0.5"),
        (("meteorological_range", (2.0,), {"contrast": 2.0}), r"contrast=...\) must lie between"),
        (
            ("meteorological_range", (2.0,), {"turbidity_means": "x"}),
            "expected 'optical thickness'",
        ),
        (("from_meteorological_range", (0.0,), {}), r"distance=...\) must be above 0 m; got 0"),
        (("aerosol_optical_depth", (np.nan,), {}), "must be 1 or more; got nan"),
        (("from_aerosol_optical_depth", (-0.1,), {}), r"optical_depth=...\) must be 0 or more"),
        (("from_zenith_luminance", (3e3, 1.5), {}), r"sun_zenith=...\) must lie in 0 to 80"),
    ],
)
def test_mistakes_are_named(call, message):
    name, arguments, options = call
    with pytest.raises(ValueError, match=message):
        inspect.unwrap(getattr(skyfit.turbidity, name))(*arguments, **options)


def test_the_chart_has_units_a_legend_and_the_visibility_code():
    figure = meteorological_range_chart()
    (axes,) = figure.axes
    assert "[km]" in axes.get_ylabel()
    assert len(axes.get_legend().get_texts()) == 2
    assert {text.get_text() for text in axes.texts} == set(VISIBILITY_CODE)
    # Both curves fall from pure air through "very clear" at turbidity 2.
    for line in axes.get_lines():
        assert 20 < np.interp(2.0, *line.get_data()) < 50
