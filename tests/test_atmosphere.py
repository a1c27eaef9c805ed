import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit import phase, profile
from skyfit.atmosphere import Atmosphere, Constituent


pytestmark = pytest.mark.any_precision


WAVELENGTHS = [450.0, 550.0, 650.0]
AIR = Constituent(profile.Exponential(8e3), [2.7e-5, 1.2e-5, 6.1e-6], phase=phase.Rayleigh())
HAZE = Constituent(
    profile.Tabulated([0.0, 1e3, 3e3], [1.0, 0.5, 0.0]),
    4e-5,
    [1e-5, 2e-5, 4e-5],
    phase=phase.HenyeyGreenstein(0.76),
)


def atmosphere(**changes):
    takes = {"wavelengths": WAVELENGTHS, "solar_irradiance": 1.5, "constituents": (AIR, HAZE)}
    return Atmosphere(**(takes | changes))


@pytest.mark.float64
def test_extinction_is_scattering_plus_absorption():
    want = [[2.7e-5, 1.2e-5, 6.1e-6], [5e-5, 6e-5, 8e-5]]
    np.testing.assert_allclose(atmosphere().extinction, want, rtol=1e-14)
    np.testing.assert_allclose(atmosphere().scattering[1], 4e-5, rtol=1e-14)


@pytest.mark.float64
def test_optical_depth_is_coefficient_times_column():
    air = 8e3 * (1 - np.exp(-60 / 8))
    haze = 1e3 * 0.75 + 2e3 * 0.25
    want = np.array([air, haze])[:, None] * np.asarray(atmosphere().extinction)
    # The table's knots fall on the quadrature's panels: rounding alone.
    np.testing.assert_allclose(atmosphere().optical_depth(), want, rtol=1e-12)


@pytest.mark.float64
def test_the_lower_the_top_the_thinner_the_air():
    column = atmosphere(top_altitude=10e3).vertical_column()
    np.testing.assert_allclose(column[0], 8e3 * (1 - np.exp(-10 / 8)), rtol=1e-12)


@pytest.mark.float64
def test_there_is_nothing_above_the_top():
    altitude = jnp.array([0.0, 2e3, 60e3, 60e3 + 1e-3])
    want = np.exp(-np.array([0, 2e3, 60e3, np.inf]) / 8e3)
    density = atmosphere().density(altitude)
    np.testing.assert_allclose(density[:, 0], want, rtol=1e-14)
    np.testing.assert_allclose(density[:, 1], [1, 0.25, 0, 0], atol=1e-15)


@pytest.mark.float64
def test_an_atmospheres_methods_can_be_jitted_as_they_are():
    got = jax.jit(atmosphere().density)(jnp.array(2e3))
    np.testing.assert_allclose(got, [np.exp(-0.25), 0.25], rtol=1e-14)


@pytest.mark.float64
def test_one_value_stands_for_all_wavelengths():
    air = atmosphere(ground_albedo=0.3)
    np.testing.assert_array_equal(air.ground_albedo, [0.3, 0.3, 0.3])
    np.testing.assert_array_equal(air.solar_irradiance, [1.5, 1.5, 1.5])


def test_the_planet_is_the_earth_unless_told_otherwise():
    assert (atmosphere().planet_radius, atmosphere().top_altitude) == (6.36e6, 60e3)
    mars = atmosphere(planet_radius=3389.5e3, top_altitude=100e3)
    assert (mars.planet_radius, mars.top_altitude) == (3389.5e3, 100e3)


def test_wavelengths_may_be_lists_arrays_or_one_number():
    one = Constituent(profile.Exponential(8e3), 1e-5, phase=phase.Rayleigh())
    assert Atmosphere(550, 1.0, [one]).wavelengths.shape == (1,)
    assert Atmosphere(np.array([500.0, 600.0]), 1.0, (one,)).wavelengths.shape == (2,)


@pytest.mark.slow
def test_an_atmosphere_is_made_and_differentiated_inside_a_program():
    def depth(factor):
        haze = Constituent(HAZE.density, factor * 4e-5, phase=HAZE.phase)
        return atmosphere(constituents=(AIR, haze)).optical_depth()[1, 0]

    value, slope = jax.jit(jax.value_and_grad(depth))(1.7)
    np.testing.assert_allclose(value, 1.7 * 4e-5 * 1250, rtol=1e-12)
    np.testing.assert_allclose(slope, 4e-5 * 1250, rtol=1e-12)
    many = jax.vmap(depth)(jnp.array([1.0, 2.0]))
    np.testing.assert_allclose(many, [0.05, 0.1], rtol=1e-12)


def test_optical_depth_in_float32_is_within_rounding(float32):
    one = Constituent(profile.Exponential(8e3), [1.2e-5], phase=phase.Rayleigh())
    got = Atmosphere([550.0], 1.0, (one,)).optical_depth()
    assert got.dtype == jnp.float32
    np.testing.assert_allclose(got, 1.2e-5 * 8e3 * (1 - np.exp(-60 / 8)), rtol=2e-6)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"wavelengths": [550.0, 450.0, 650.0]}, r"wavelengths=\.\.\.\) must increase .*got 450$"),
        ({"wavelengths": [450.0, np.nan, 650.0]}, r"wavelengths=\.\.\.\) must increase .*got nan$"),
        ({"wavelengths": [[450.0]]}, r"wavelengths=\.\.\.\): expected one axis .*\(1, 1\)$"),
        ({"solar_irradiance": -1.0}, r"solar_irradiance=\.\.\.\) must be 0 or more; got -1$"),
        ({"solar_irradiance": [1.0, np.nan, 1.0]}, r"solar_irradiance=.*got nan$"),
        ({"solar_irradiance": [1.0, 1.0]}, r"solar_irradiance=.*expected one value or 3.*\(2,\)$"),
        ({"ground_albedo": 1.5}, r"ground_albedo=\.\.\.\) must be 0 to 1; got 1\.5$"),
        ({"ground_albedo": [0.1, -0.1, 0.1]}, r"ground_albedo=.*must be 0 to 1; got -0\.1$"),
        ({"ground_albedo": np.nan}, r"ground_albedo=.*got nan$"),
        ({"planet_radius": 0.0}, r"planet_radius=\.\.\.\) must be above 0 m; got 0$"),
        ({"planet_radius": np.inf}, r"planet_radius=.*got inf$"),
        ({"top_altitude": -1.0}, r"top_altitude=\.\.\.\) must be above 0 m; got -1$"),
        ({"top_altitude": [6e4, 7e4]}, r"top_altitude=.*expected one value; got shape \(2,\)$"),
        ({"constituents": ()}, r"constituents=\.\.\.\): expected one or more; got none$"),
        (
            {"wavelengths": [450.0, 550.0]},
            r"constituents\[0\]\.scattering has 3 wavelengths, expected 1 or 2 as in wavelengths$",
        ),
    ],
)
def test_what_no_atmosphere_can_be_is_named(changes, message):
    with pytest.raises(ValueError, match="^Atmosphere.*" + message):
        atmosphere(**changes)


def test_a_phase_function_of_other_wavelengths_is_named():
    odd = Constituent(AIR.density, 1e-5, phase=phase.CornetteShanks([0.1, 0.2]))
    with pytest.raises(ValueError, match=r"constituents\[1\]\.phase has 2 wavelengths, expected 1"):
        atmosphere(constituents=(AIR, odd))


@pytest.mark.parametrize(
    ("scattering", "absorption", "message"),
    [
        (-1e-5, 0.0, r"Constituent\(scattering=\.\.\.\) must be 0 or more, in 1/m; got -1e-05$"),
        (np.nan, 0.0, r"Constituent\(scattering=.*got nan$"),
        (np.inf, 0.0, r"Constituent\(scattering=.*got inf$"),
        ([[1e-5]], 0.0, r"Constituent\(scattering=.*expected one axis; got shape \(1, 1\)$"),
        (1e-5, [1e-6, -1e-6], r"Constituent\(absorption=.*got -1e-06$"),
    ],
)
def test_coefficients_below_zero_are_refused(scattering, absorption, message):
    with pytest.raises(ValueError, match="^" + message):
        Constituent(AIR.density, scattering, absorption, phase=AIR.phase)


def test_coefficients_are_checked_under_jit():
    def make(beta):
        return Constituent(AIR.density, beta, phase=AIR.phase).extinction

    with pytest.raises(RuntimeError, match=r"Constituent\(scattering=\.\.\.\) must be 0 or more"):
        eqx.filter_jit(make)(jnp.array(-1e-5))
