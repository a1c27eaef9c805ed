"""Sunlight at the ground: by hand, against ASTM G173-03, through the horizon."""

import inspect

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from peers import peer

import skyfit
from skyfit import sun_irradiance, sun_xyY, sunlight
from skyfit.colour import spectrum_to_xyY
from skyfit.constants import SUN_ANGULAR_RADIUS, SUN_SOLID_ANGLE
from skyfit.preetham_air import table2
from skyfit.spectrum import PAPER_WAVELENGTHS
from skyfit.sun import light
from skyfit.tables import read_table


pytestmark = pytest.mark.any_precision


HORIZON = np.pi / 2
# ASTM G173-03: aerosol optical depth 0.084 at 500 nm, 0.34 cm of ozone, 1.42 cm of water, air mass
# 1.5. Ångström's β = 0.084 · 0.5^1.3 is turbidity (β + 0.04586) / 0.04608 = 1.736.
G173 = {"ozone": 0.0034, "water_vapour": 0.0142}
G173_TURBIDITY = (0.084 * 0.5**1.3 + 0.04586) / 0.04608
G173_SUN = np.radians(48.236)


def as_printed(turbidity, zenith, row):
    """Appendix A.1 at one wavelength of table 2, written out, blanks being 0."""
    table = read_table("preetham1999_table2_spectra")
    at = {name: np.nan_to_num(column[row]) for name, column in table.items()}
    m = 1 / (np.cos(zenith) + 0.15 * (93.885 - np.degrees(zenith)) ** -1.253)
    micron = at["wavelength_nm"] / 1000
    rayleigh = np.exp(-0.008735 * micron ** (-4.08 * 1) * m)
    haze = np.exp(-(0.04608 * turbidity - 0.04586) * micron**-1.3 * m)
    ozone = np.exp(-at["k_ozone_m-1"] * 0.0035 * m)
    gas = np.exp(-1.41 * at["k_gas_m-1"] * m / (1 + 118.93 * at["k_gas_m-1"] * m) ** 0.45)
    k = at["k_water_m-1"] * 0.02 * m
    water = np.exp(-0.2385 * k / (1 + 20.07 * k) ** 0.45)
    return at["sun_W_m-2_nm-1_sr-1"] * rayleigh * haze * ozone * gas * water


@pytest.mark.float64
@pytest.mark.parametrize(("turbidity", "zenith"), [(1.0, 0.0), (2.0, 0.7), (6.0, 1.4)])
def test_radiance_is_the_papers_product_of_transmittances(turbidity, zenith):
    rows = [2, 17, 30, 34, 36]  # 400, 550, 680, 720 and 740 nm
    got = sunlight(turbidity, zenith, PAPER_WAVELENGTHS)[np.array(rows)]
    want = [as_printed(turbidity, zenith, row) for row in rows]
    np.testing.assert_allclose(got, want, rtol=1e-12)


def test_a_sun_overhead_at_turbidity_two_by_hand():
    # 550 nm, m = 0.9995: molecules 0.008735 · 0.55^-4.08 = 0.10013, haze 0.0463 · 0.55^-1.3 =
    # 0.10072, ozone 8.5 · 0.0035 = 0.02975; 25503.8 exp(-0.2305)
    np.testing.assert_allclose(sunlight(2.0, 0.0, 550.0), [20253.0], rtol=1e-3)


def test_mixed_gases_take_a_quarter_of_760_nanometres():
    # k m = 3 at m = 1: exp(-1.41 · 3 / 357.8^0.45) = exp(-0.3001)
    zenith = np.radians(1.8)  # where m = 1
    depths = light.optical_depths(*jnp.asarray([2.0, 1.0, 0.0, 0.0]), jnp.asarray([760.0]))
    np.testing.assert_allclose(np.exp(-depths["mixed gases"]), [0.7407], atol=1e-4)
    np.testing.assert_allclose(light.air_mass(jnp.asarray(zenith)), 1.0, atol=1e-4)


def standard_spectra():
    """G173-03's direct spectrum at 1 nm, and its mean and the extraterrestrial's around table 2's
    wavelengths; ±5 nm. [W m^-2 nm^-1]"""
    table = peer("pvlib").spectrum.get_reference_spectra()
    fine = np.arange(380.0, 781.0)
    bands = [
        [table[name].loc[lam - 5 : lam + 5].mean() for lam in PAPER_WAVELENGTHS]
        for name in ("direct", "extraterrestrial")
    ]
    return fine, table.direct.reindex(fine).interpolate().to_numpy(), *np.array(bands)


def test_the_standards_direct_sun_comes_out_within_three_percent():
    fine, direct, band, above = standard_spectra()
    got = sun_irradiance(G173_TURBIDITY, G173_SUN, PAPER_WAVELENGTHS, **G173)
    inner = (PAPER_WAVELENGTHS >= 400) & (PAPER_WAVELENGTHS <= 750)
    error = np.asarray(got / band - 1)[inner]
    # What the docstring of sunlight says.
    np.testing.assert_allclose(np.sqrt(np.mean(error**2)), 0.031, atol=0.002)
    assert PAPER_WAVELENGTHS[inner][np.argmax(np.abs(error))] == 690
    np.testing.assert_allclose(np.abs(error).max(), 0.083, atol=0.003)
    x, y, luminous = spectrum_to_xyY(got, PAPER_WAVELENGTHS) - spectrum_to_xyY(direct, fine)
    assert max(abs(x), abs(y)) < 0.0042
    np.testing.assert_allclose(luminous / spectrum_to_xyY(direct, fine)[2], -0.027, atol=0.002)
    # The transmittance by itself, without the older solar spectrum of table 2.
    sun = SUN_SOLID_ANGLE * table2("sun_W_m-2_nm-1_sr-1", PAPER_WAVELENGTHS)
    ratio = np.asarray(got / sun / (band / above))
    assert np.abs(ratio - 1)[PAPER_WAVELENGTHS <= 580].max() < 0.025


def test_the_lower_the_sun_the_redder_and_dimmer():
    x, y, luminance = sun_xyY(2.0, np.radians([0.0, 40.0, 60.0, 75.0, 85.0, 89.0])).T
    assert (np.diff(x) > 0).all()
    assert (np.diff(luminance) < 0).all()
    # The familiar 1.5e9 cd/m² and 100 klx of a high sun in clear air.
    np.testing.assert_allclose(luminance[0], 1.5e9, rtol=0.02)
    np.testing.assert_allclose(luminance[0] * SUN_SOLID_ANGLE, 1.0e5, rtol=0.03)
    assert x[0] - 0.3320 < 0.005 > abs(y[0] - 0.344)


@pytest.mark.parametrize("turbidity", [1.0, 2.0, 6.0, 20.0])
def test_the_sun_sets_smoothly_and_stays_dark(turbidity):
    zenith = np.concatenate([np.linspace(HORIZON - 0.01, HORIZON + 0.01, 401), [1.7, 2.5, np.pi]])
    values = np.asarray(sunlight(turbidity, zenith, [400.0, 550.0, 700.0]))
    assert np.isfinite(values).all()
    assert (values >= 0).all()
    assert (values[zenith > HORIZON + SUN_ANGULAR_RADIUS] == 0).all()
    # A step of 5e-5 rad hides at most 0.7 % of the disc, and the light is what the air lets by.
    high = sunlight(turbidity, HORIZON - 0.05, [400.0, 550.0, 700.0]).max()
    assert np.abs(np.diff(values[:401], axis=0)).max() < 0.007 * high


@pytest.mark.parametrize("darkened", [False, True])
def test_gradients_are_finite_with_the_sun_anywhere(darkened):
    edges = [HORIZON - SUN_ANGULAR_RADIUS, HORIZON, HORIZON + SUN_ANGULAR_RADIUS]
    zenith = jnp.asarray([0.0, 1.0, *edges, 1.7, np.pi])

    def total(turbidity, sun, radius):
        where = {"distance_from_centre": radius} if darkened else {}
        return jnp.sum(sunlight(turbidity, sun, [450.0, 650.0], **where))

    gradient = jax.jit(jax.vmap(jax.grad(total, argnums=(0, 1, 2)), (None, 0, None)))
    for distance in (0.0, 0.5, 1.0):
        assert np.isfinite(gradient(2.0, zenith, distance)).all()


@pytest.mark.float64
def test_half_of_the_disc_is_above_the_horizon_when_its_centre_is_on_it():
    radius = SUN_ANGULAR_RADIUS
    zenith = jnp.asarray([HORIZON - radius / 2, HORIZON, HORIZON + radius / 2])
    # A chord at half the radius cuts off (2π/3 - √3/2) / 2π = 0.19550 of a disc.
    want = [1 - 0.195501, 0.5, 0.195501]
    np.testing.assert_allclose(light.visible_fraction(zenith), want, atol=1e-6)
    np.testing.assert_allclose(np.degrees(radius), 959.63 / 3600, rtol=1e-3)


def test_the_mean_over_a_darkened_disc_is_the_disc():
    rings = (np.arange(2000) + 0.5) / 2000
    darkened = sunlight(2.0, 0.5, [430.0, 550.0, 700.0], distance_from_centre=rings)
    mean = 2 * (rings / 2000) @ darkened
    # Midpoints miss what the last of 2000 rings holds of the root at the limb.
    np.testing.assert_allclose(mean, sunlight(2.0, 0.5, [430.0, 550.0, 700.0]), rtol=2e-4)


def test_the_limb_is_as_dark_as_the_classical_law_says():
    # Cox (ed.), "Allen's Astrophysical Quantities": 1 - u - v + u µ + v µ² at 550 nm with u = 0.93
    # and v = -0.23; the power law leaves it by 3 % at most above µ = 0.3.
    mu = np.array([1.0, 0.8, 0.5, 0.3])
    law = light.limb_darkening(jnp.asarray(np.sqrt(1 - mu**2)), jnp.asarray([550.0]))[:, 0]
    np.testing.assert_allclose(law / law[0], 0.3 + 0.93 * mu - 0.23 * mu**2, rtol=0.03)


def test_arguments_broadcast_with_the_wavelength_last():
    turbidity, zenith = np.array([[2.0], [4.0]]), np.array([0.1, 0.9, 1.5])
    got = sunlight(turbidity, zenith, [450.0, 550.0])
    assert got.shape == (2, 3, 2)
    np.testing.assert_allclose(got[1, 2], sunlight(4.0, 1.5, [450.0, 550.0]), rtol=1e-12)
    mapped = jax.jit(jax.vmap(lambda z: sunlight(4.0, z, [450.0, 550.0])))(zenith)
    np.testing.assert_allclose(mapped, got[1], rtol=1e-12)


def test_float32_is_within_a_hundred_thousandth(float32):
    got = sunlight(2.0, np.float32(1.2), [450.0, 550.0])
    assert got.dtype == jnp.float32
    want = [as_printed(2.0, 1.2, 7), as_printed(2.0, 1.2, 17)]
    np.testing.assert_allclose(got, want, rtol=1e-5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.5, 0.3, [500.0]), r"sunlight\(turbidity=...\) must be 1 or more; got 0.5"),
        ((np.nan, 0.3, [500.0]), "must be 1 or more; got nan"),
        ((2.0, 0.3, [500.0, 400.0]), r"sunlight\(wavelengths=...\) must increase"),
    ],
)
def test_mistakes_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        inspect.unwrap(skyfit.sunlight)(*arguments)


def test_a_point_beyond_the_limb_is_refused():
    with pytest.raises(ValueError, match=r"distance_from_centre=...\) must lie in 0 to 1; got 1.5"):
        sunlight(2.0, 0.3, [500.0], distance_from_centre=1.5)
