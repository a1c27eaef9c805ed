"""Colours: against the CIE's numbers, and there and back."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.colour import (
    daylight_radiance,
    luminance,
    rgb_to_xyz,
    spectrum_to_xyY,
    spectrum_to_xyz,
    srgb_matrix,
    xyY_to_xyz,
    xyz_to_rgb,
    xyz_to_xyY,
    xyz_weights,
)


pytestmark = pytest.mark.any_precision


FULL = np.arange(300.0, 831.0, 5.0)
# Colours of clear skies, a sunset and the D65 white
COLOURS = np.array([[0.24, 0.25, 3e3], [0.27, 0.28, 1e4], [0.45, 0.41, 50.0], [0.3127, 0.329, 1.0]])


@pytest.mark.float64
def test_one_watt_of_green_light_is_683_lumens():
    # A narrow line at 555 nm: K_m times a band of 1e-3 nm, where V(λ) is 1.
    line = [555 - 1e-3, 555.0, 555 + 1e-3]
    np.testing.assert_allclose(luminance([0.0, 1e3, 0.0], line), 683.002, rtol=1e-6)


def test_the_equal_energy_spectrum_is_white_in_the_middle():
    # The sums of the three tabulated functions agree to 2e-4.
    xyY = spectrum_to_xyY(np.ones(471), np.arange(360.0, 831.0))
    np.testing.assert_allclose(xyY[:2], 1 / 3, atol=5e-5)
    # and its luminance is 683.002 times the sum of V(λ), 106.857
    np.testing.assert_allclose(xyY[2], 683.002 * 106.8569, rtol=1e-6)


@pytest.mark.slow
def test_standard_illuminant_d65_has_its_tabulated_chromaticity():
    from colour.colorimetry import SDS_ILLUMINANTS

    d65 = SDS_ILLUMINANTS["D65"]
    for step, tolerance in ((1, 2e-5), (10, 2e-4), (20, 2e-3)):
        lam = np.arange(360.0, 781.0, step)
        got = spectrum_to_xyY(np.interp(lam, d65.wavelengths, d65.values), lam)
        # CIE 015:2018, table 3: 0.31272, 0.32903. A coarser grid loses the spectrum's own detail.
        np.testing.assert_allclose(got[:2], [0.31272, 0.32903], atol=tolerance)


def test_weights_do_not_depend_on_how_finely_a_smooth_spectrum_is_sampled():
    def smooth(lam):
        return np.exp(-(((lam - 500) / 150) ** 2))

    fine, coarse = np.arange(380.0, 780.5, 0.5), np.arange(380.0, 781.0, 10.0)
    # Linear interpolation errs by h²/8 · s'' = 100/8 · 2/150² = 1e-3 at most, less in the mean.
    np.testing.assert_allclose(
        spectrum_to_xyz(smooth(coarse), coarse), spectrum_to_xyz(smooth(fine), fine), rtol=1e-3
    )


@pytest.mark.float64
def test_d65_white_of_one_candela_is_one_one_one():
    np.testing.assert_allclose(xyz_to_rgb(xyY_to_xyz([0.3127, 0.3290, 1.0])), [1, 1, 1], atol=1e-14)


def test_srgb_matrix_is_the_standards_to_its_printed_digits():
    # IEC 61966-2-1 prints four decimals, from primaries rounded in between.
    printed = [
        [3.2406, -1.5372, -0.4986],
        [-0.9689, 1.8758, 0.0415],
        [0.0557, -0.2040, 1.0570],
    ]
    np.testing.assert_allclose(srgb_matrix(), printed, atol=4e-4)


def test_red_primary_of_srgb_has_its_chromaticity():
    np.testing.assert_allclose(
        xyz_to_xyY(rgb_to_xyz([1.0, 0.0, 0.0]))[:2], [0.64, 0.33], atol=1e-12
    )


@pytest.mark.float64
def test_colours_come_back_through_every_pair_of_conversions():
    xyz = xyY_to_xyz(COLOURS)
    np.testing.assert_allclose(xyz_to_xyY(xyz), COLOURS, rtol=1e-13)
    np.testing.assert_allclose(rgb_to_xyz(xyz_to_rgb(xyz)), xyz, rtol=1e-12)


@pytest.mark.float64
def test_black_is_black_and_has_finite_gradients():
    np.testing.assert_array_equal(xyz_to_xyY([0.0, 0.0, 0.0]), [0.3127, 0.329, 0.0])
    assert np.all(np.isfinite(jax.jacrev(xyz_to_xyY)(jnp.zeros(3))))
    assert np.all(np.isfinite(jax.jacrev(xyY_to_xyz)(jnp.zeros(3))))


@pytest.mark.slow
@pytest.mark.float64
@pytest.mark.parametrize("colour", COLOURS[:2])
def test_daylight_spectra_have_the_luminance_and_chromaticity_asked_for(colour):
    back = spectrum_to_xyY(daylight_radiance(colour, FULL), FULL)
    np.testing.assert_allclose(back[2], colour[2], rtol=1e-12)
    # As good as the published coefficients of M1 and M2 are near the daylight locus
    np.testing.assert_allclose(back[:2], colour[:2], atol=2e-4)


def test_daylight_of_6504_kelvin_is_illuminant_d65():
    from colour.colorimetry import SDS_ILLUMINANTS

    d65 = SDS_ILLUMINANTS["D65"]
    lam = np.arange(300.0, 781.0, 10.0)
    # The point of the daylight locus, which lies 1e-4 above the illuminant's own chromaticity
    got = np.asarray(daylight_radiance([0.312714, 0.329119, 1.0], lam))
    # The CIE rounds M1 and M2 to three decimals: 5e-4 of S1 = 42 against S = 55.
    np.testing.assert_allclose(got / got[lam == 560], d65[lam] / 100, atol=5e-4)


def test_reddest_skies_give_no_negative_light():
    spectrum = daylight_radiance([0.48, 0.43, 100.0], FULL)
    assert np.all(np.asarray(spectrum) >= 0)
    np.testing.assert_allclose(luminance(spectrum, FULL), 100, rtol=2e-3)


def test_daylight_is_differentiable_where_the_published_denominator_vanishes():
    # 0.0241 + 0.2562 x - 0.7341 y = 0
    y = 0.11
    x = (0.7341 * y - 0.0241) / 0.2562
    jacobian = jax.jacrev(lambda c: daylight_radiance(c, FULL))(jnp.array([x, y, 1.0]))
    assert np.all(np.isfinite(jacobian))


@pytest.mark.slow
@pytest.mark.usefixtures("float32")
def test_colour_works_in_float32():
    # Rounding to 6e-8 grows with the terms that cancel in 471 sums and in M1, M2.
    spectrum = daylight_radiance(COLOURS.astype(np.float32), FULL.astype(np.float32))
    assert spectrum.dtype == jnp.float32
    back = spectrum_to_xyY(spectrum, FULL.astype(np.float32))
    np.testing.assert_allclose(back[:2, 2], COLOURS[:2, 2], rtol=1e-4)


def test_conversions_work_under_jit_and_vmap():
    lam = jnp.asarray(FULL)
    together = jax.jit(daylight_radiance)(jnp.asarray(COLOURS), lam)
    one_by_one = jax.vmap(daylight_radiance, (0, None))(jnp.asarray(COLOURS), lam)
    np.testing.assert_allclose(together, one_by_one, rtol=1e-12, atol=1e-15)


def test_wrong_shapes_are_refused_by_name():
    with pytest.raises(ValueError, match=r"spectrum_to_xyz\(radiance=.*expected 3 wavelengths"):
        spectrum_to_xyz(np.ones(4), [400.0, 500.0, 600.0])
    with pytest.raises(ValueError, match=r"xyz_weights\(wavelengths=.*expected two or more"):
        xyz_weights([500.0])
    with pytest.raises(ValueError, match=r"xyz_weights\(wavelengths=.*must increase"):
        xyz_weights([500.0, 400.0])
