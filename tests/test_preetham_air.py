import inspect

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit import phase, preetham_air, profile
from skyfit.preetham_air import preetham_atmosphere
from skyfit.spectrum import PAPER_WAVELENGTHS


TURBIDITIES = (1.0, 2.0, 3.7, 6.0)


@pytest.mark.parametrize(
    ("wavelength", "coefficient"),
    [(650.0, 6.95e-6), (570.0, 1.18e-5), (475.0, 2.44e-5)],
)
def test_air_scatters_as_hoffman_and_preetham_print(wavelength, coefficient):
    got = preetham_air.rayleigh_scattering(wavelength)
    # Three digits are printed: half of the last is 0.0045 of the smallest.
    np.testing.assert_allclose(got, coefficient, rtol=0.0045)


@pytest.mark.parametrize(
    ("wavelength", "coefficient"),
    [(440.0, 33.1e-6), (550.0, 13.5e-6), (680.0, 5.8e-6)],
)
def test_air_scatters_as_ray_marchers_take_it(wavelength, coefficient):
    # The usual triple has 13.5 where the formula gives 13.56.
    got = preetham_air.rayleigh_scattering(wavelength)
    np.testing.assert_allclose(got, coefficient, rtol=0.005)


def test_air_scatters_by_the_formula_worked_out_by_hand():
    # n² - 1 = 6.0009e-4, King's factor 6.105 / 5.755, λ = 550 nm.
    want = 8 * np.pi**3 * 6.0009e-4**2 / (3 * 2.545e25 * 550e-9**4) * 6.105 / 5.755
    np.testing.assert_allclose(preetham_air.rayleigh_scattering(550.0), want, rtol=1e-12)


def test_air_scatters_with_the_fourth_power_of_frequency():
    blue, red = preetham_air.rayleigh_scattering([350.0, 700.0])
    np.testing.assert_allclose(blue / red, 16, rtol=1e-14)


def test_haze_scatters_by_the_formula_worked_out_by_hand():
    # K(550 nm) = 0.678, c = (1.3088 - 0.6510)e-18 at T = 2.
    want = 0.434 * 0.6578e-18 * np.pi * (2 * np.pi / 550e-9) ** 2 * 0.678
    np.testing.assert_allclose(preetham_air.haze_scattering(2.0, 550.0), want, rtol=1e-12)


def test_haze_scatters_nearly_with_the_square_of_frequency():
    blue, red = preetham_air.haze_scattering(3.0, [400.0, 780.0])
    np.testing.assert_allclose(blue / red, (780 / 400) ** 2 * 0.656 / 0.689, rtol=1e-12)


@pytest.mark.parametrize("wavelength", [400.0, 450.0, 550.0, 650.0])
def test_eta_integrates_to_pi_k_within_one_percent(wavelength):
    """Table 1 over the sphere against table 2, wherever both are tabulated (η/2 stands for p)."""
    table = preetham_air.read_table("preetham1999_table1_mie_eta")
    angle, eta = np.radians(table["scattering_angle_deg"]), table[f"eta_{wavelength:.0f}nm"]
    theta = (np.arange(20000) + 0.5) * np.pi / 20000
    interpolated = np.exp(np.interp(theta, angle, np.log(eta)))
    integral = 2 * np.pi * np.sum(interpolated / 2 * np.sin(theta)) * np.pi / 20000
    # The tables differ by half a percent everywhere, K being printed to three digits.
    np.testing.assert_allclose(integral, np.pi * preetham_air.table2("K", wavelength), rtol=0.01)


@pytest.mark.slow
def test_the_haze_phase_function_is_eta_normalised():
    p = preetham_air.haze_phase([450.0, 550.0])
    at = np.cos(np.radians([4.0, 30.0, 150.0, 180.0]))
    # η of table 1 at 450 and 550 nm, relative to 90°.
    want = np.array([[3.319, 3.329], [1.129, 1.138], [0.1024, 0.1095], [0.1368, 0.1447]])
    ratio = np.asarray(p(at)) / np.asarray(p(np.cos(np.pi / 2)))
    np.testing.assert_allclose(ratio, want / [[0.1275, 0.1320]], rtol=1e-12)


def test_the_haze_phase_function_is_linear_between_wavelengths_and_constant_outside():
    p = preetham_air.haze_phase([380.0, 400.0, 500.0])
    ratio = np.asarray(p(np.cos(np.radians(60.0)))) / np.asarray(p(np.cos(np.radians(120.0))))
    between = (0.3373 + 0.3433) / (0.08652 + 0.09179)
    np.testing.assert_allclose(ratio, [0.3324 / 0.08242, 0.3324 / 0.08242, between], rtol=1e-12)


@pytest.mark.slow
def test_haze_scatters_mostly_forward():
    # Between Rayleigh's 0 and the 0.76 often taken: Bullrich's function has no strong peak.
    mean = preetham_air.haze_phase(550.0).mean_cosine
    np.testing.assert_allclose(mean, 0.5431, atol=1e-4)


def test_the_sun_is_table_2_times_its_solid_angle():
    # 25503.8 W m⁻² nm⁻¹ sr⁻¹ make the familiar 1.73 W m⁻² nm⁻¹ at 550 nm.
    np.testing.assert_allclose(preetham_air.solar_irradiance(550.0), 25503.8 * 6.80e-5, rtol=1e-14)


def test_the_suns_solid_angle_is_that_of_959_63_arc_seconds():
    radius = np.radians(959.63 / 3600)
    np.testing.assert_allclose(preetham_air.constants.SUN_SOLID_ANGLE, np.pi * radius**2, rtol=1e-4)


def test_the_sun_beyond_750_nm_has_the_shape_of_the_standard_spectrum():
    got = preetham_air.solar_irradiance([750.0, 760.0, 770.0, 780.0])
    standard = np.array([1.27855, 1.25688, 1.21485, 1.19681])  # ASTM G173-03, means of ±5 nm
    np.testing.assert_allclose(got / got[0], standard / standard[0], rtol=1e-12)
    np.testing.assert_allclose(got[0], 18259.2 * 6.80e-5, rtol=1e-14)


def test_the_sun_has_no_gap_and_no_step_where_it_is_continued():
    sun = preetham_air.solar_irradiance(np.arange(740.0, 781.0))
    # The steepest stretch loses 4 % in 10 nm.
    assert np.all(np.isfinite(sun))
    assert np.max(np.abs(np.diff(np.log(sun)))) < 0.005


def test_a_standard_sun_gives_the_solar_constants_share_of_light():
    # About half of 1361 W m⁻² lies between 380 and 780 nm.
    sun = preetham_air.solar_irradiance(PAPER_WAVELENGTHS)
    assert 0.47 < np.trapezoid(sun, PAPER_WAVELENGTHS) / 1361 < 0.52


@pytest.mark.slow
@pytest.mark.parametrize("turbidity", TURBIDITIES)
def test_turbidity_is_the_optical_thickness_over_that_of_clean_air(turbidity):
    air, haze = preetham_atmosphere(turbidity, wavelengths=550.0).optical_depth()[:, 0]
    # The definition, exact but for rounding: (t_m + t_h) / t_m at 550 nm.
    np.testing.assert_allclose((air + haze) / air, turbidity, rtol=1e-13)


@pytest.mark.parametrize(
    ("turbidity", "means"),
    [(2.0, 2.095), (3.0, 3.184), (4.0, 4.274), (5.0, 5.363), (6.0, 6.452)],
)
def test_appendix_a3_as_it_stands_means_a_higher_turbidity(turbidity, means):
    atm = preetham_atmosphere(turbidity, wavelengths=550.0, turbidity_means="coefficients")
    air, haze = atm.optical_depth()[:, 0]
    # By hand: 1 + β_p · 1581.69 m / (β_m · 8452.15 m).
    np.testing.assert_allclose((air + haze) / air, means, atol=5e-4)


def test_any_haze_profile_keeps_the_definition():
    atm = preetham_atmosphere(3.0, wavelengths=550.0, haze_density=profile.Exponential(1250.0))
    air, haze = atm.optical_depth()[:, 0]
    np.testing.assert_allclose((air + haze) / air, 3, rtol=1e-12)


def test_clean_air_has_the_optical_thickness_of_the_standard_atmosphere():
    # 1.356e-5 m⁻¹ × 8452 m. Careful values are near 0.097: n = 1.0003 is coarse.
    air = preetham_atmosphere(1.0, wavelengths=550.0).optical_depth()[:, 0]
    np.testing.assert_allclose(air, [0.11464, 0], atol=5e-6)


def test_turbidity_changes_the_amount_of_haze_and_not_its_colour():
    two, five = (preetham_atmosphere(t).scattering[1] for t in (2.0, 5.0))
    np.testing.assert_allclose(five / two, 4, rtol=1e-12)


def test_the_papers_spectra_run_from_380_to_780_nm_by_10():
    atm = preetham_atmosphere(2.5)
    np.testing.assert_array_equal(atm.wavelengths, np.arange(380, 781, 10))
    assert len(atm.constituents) == 2
    assert not np.any(atm.constituents[1].absorption)


def test_the_ground_is_black_unless_told_otherwise():
    assert not np.any(preetham_atmosphere(2.5).ground_albedo)
    bright = preetham_atmosphere(2.5, wavelengths=[500.0, 600.0], ground_albedo=[0.1, 0.2])
    np.testing.assert_array_equal(bright.ground_albedo, [0.1, 0.2])


def test_ozone_absorbs_what_three_and_a_half_millimetres_absorb():
    atm = preetham_atmosphere(2.5, wavelengths=[380.0, 440.0, 550.0, 600.0, 780.0], ozone=True)
    # k of table 2 times 0.0035 m; nothing where the table is blank.
    want = [0, 0, 8.5 * 0.0035, 12.5 * 0.0035, 0]
    np.testing.assert_allclose(atm.optical_depth()[2], want, atol=1e-15)
    assert not np.any(atm.constituents[2].scattering)


def test_ozone_lies_between_10_and_40_km_and_is_thickest_at_25():
    layer = preetham_air.ozone_layer()
    got = layer(jnp.array([0.0, 10e3, 17.5e3, 25e3, 32.5e3, 40e3, 50e3]))
    np.testing.assert_allclose(got, [0, 0, 0.5, 1, 0.5, 0, 0], atol=1e-15)
    np.testing.assert_allclose(layer.column(60e3), 15e3, rtol=1e-12)


def test_table_2_is_linear_between_its_wavelengths():
    got = preetham_air.table2("S0", [380.0, 555.0, 780.0])
    np.testing.assert_allclose(got, [63.4, 102.2, 65.0], rtol=1e-14)


def test_blank_absorption_in_table_2_is_none():
    got = preetham_air.table2("k_gas_m-1", [550.0, 750.0, 760.0])
    np.testing.assert_array_equal(got, [0, 0, 3])


def test_molecules_scatter_by_rayleighs_law_and_haze_by_its_table():
    kinds = [type(one.phase) for one in preetham_atmosphere(2.5).constituents]
    assert kinds == [phase.Rayleigh, phase.Tabulated]


def test_haze_thickens_with_turbidity_as_the_derivative_says():
    def depth(turbidity):
        return preetham_atmosphere(turbidity, wavelengths=550.0).optical_depth()[1, 0]

    # By definition the haze's share is (T - 1) times that of the air, whatever T; T = 1 included.
    air = preetham_atmosphere(1.0, wavelengths=550.0).optical_depth()[0, 0]
    slopes = jax.jit(jax.vmap(jax.grad(depth)))(jnp.array([1.0, 2.5, 6.0]))
    np.testing.assert_allclose(slopes, air, rtol=1e-10)


@pytest.mark.slow
def test_float32_is_within_rounding_of_float64():
    want = preetham_atmosphere(3.0, ozone=True)
    with jax.enable_x64(False):
        got = preetham_atmosphere(3.0, ozone=True)
        depth = got.optical_depth()
    assert depth.dtype == got.constituents[1].phase.log_value.dtype == jnp.float32
    np.testing.assert_allclose(depth, want.optical_depth(), rtol=1e-5)
    np.testing.assert_allclose(got.solar_irradiance, want.solar_irradiance, rtol=1e-6)


@pytest.mark.parametrize(
    ("turbidity", "message"),
    [
        (0.99, "must be 1 or more; got 0.99"),
        (-3, "must be 1 or more; got -3"),
        (np.nan, "must be 1 or more; got nan"),
        (np.inf, "must be 1 or more; got inf"),
        ([2.0, 3.0], r"expected one value; got shape \(2,\)"),
    ],
)
def test_turbidity_below_one_is_refused(turbidity, message):
    with pytest.raises(ValueError, match=rf"^preetham_atmosphere\(turbidity=\.\.\.\):? {message}$"):
        preetham_atmosphere(turbidity)


@pytest.mark.slow
def test_turbidity_below_one_is_refused_under_jit():
    with pytest.raises(RuntimeError, match=r"preetham_atmosphere\(turbidity=\.\.\.\) must be 1 or"):
        eqx.filter_jit(lambda t: preetham_atmosphere(t).optical_depth())(jnp.array(0.5))


def test_unsorted_wavelengths_are_refused_by_the_papers_atmosphere():
    with pytest.raises(ValueError, match=r"^preetham_atmosphere\(wavelengths=\.\.\.\) must.* 400$"):
        preetham_atmosphere(2.0, wavelengths=[500.0, 400.0])


def test_an_unknown_meaning_of_turbidity_lists_the_known_ones():
    # Without the suite's type checks: a user may pass anything.
    make = inspect.unwrap(preetham_atmosphere)
    with pytest.raises(
        ValueError, match=r"expected 'optical thickness' or 'coefficients'; got 'x'"
    ):
        make(2.0, turbidity_means="x")
