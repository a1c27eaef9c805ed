"""Bands of water vapour and oxygen, against the formulas and the table of Bird & Riordan."""

import numpy as np
import pytest
from peers import peer

from skyfit.campaign.description.bands import mixed_gas_bands, water_vapour_bands


pytestmark = pytest.mark.any_precision


PUBLISHED = peer("pvlib.spectrum.spectrl2")._SPECTRL2_COEFFS
VISIBLE = PUBLISHED[(PUBLISHED["wavelength"] >= 570) & (PUBLISHED["wavelength"] <= 800)]
AIRMASS = np.array([1.0, 2.0, 5.0, 10.0, 38.0])


def water(x):
    """Bird & Riordan (1986), equation 8."""
    return np.exp(-0.2385 * x / (1 + 20.07 * x) ** 0.45)


def mixed(x):
    """Bird & Riordan (1986), equation 11."""
    return np.exp(-1.41 * x / (1 + 118.93 * x) ** 0.45)


@pytest.mark.slow
def test_water_vapour_is_absorbed_as_in_the_published_formula_at_every_length():
    # x = 1 in a column of 1 m: k is 2.5 per cm at 724.4 nm, and 0.4 cm of water.
    bands = water_vapour_bands(np.array([724.4]), 0.004, 1.0)
    x = np.r_[0, np.geomspace(1e-6, 500, 2000)]
    found = [bands.transmittance(column)[0] for column in x]
    np.testing.assert_allclose(found, water(x), atol=1e-3)


@pytest.mark.slow
def test_mixed_gases_absorb_as_in_the_published_formula_at_every_length():
    bands = mixed_gas_bands(np.array([762.5]), 4.0)  # k is 4
    x = np.r_[0, np.geomspace(1e-6, 500, 2000)]
    found = [bands.transmittance(column)[0] for column in x]
    np.testing.assert_allclose(found, mixed(x), atol=1e-3)


def test_two_centimetres_of_water_take_a_seventh_at_724_nm_and_half_at_the_horizon():
    # By hand: x = 5 m; (1 + 100.35)^0.45 = 7.99, T = exp(-1.1925/7.99) = 0.861; at m = 12, x = 60,
    # (1 + 1204.2)^0.45 = 24.35, T = exp(-14.31/24.35) = 0.556.
    bands = water_vapour_bands(np.array([724.4]), 0.02, 2000.0)
    np.testing.assert_allclose(bands.transmittance(2000.0), 0.861, atol=1.5e-3)
    np.testing.assert_allclose(bands.transmittance(24000.0), 0.556, atol=1.5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("airmass", AIRMASS)
def test_the_table_is_that_of_the_published_program(airmass):
    lam = np.ascontiguousarray(VISIBLE["wavelength"])
    vapour = water_vapour_bands(lam, 0.0142, 1.0).transmittance(airmass)
    want = water(1.42 * airmass * VISIBLE["water_vapor_absorption"])
    np.testing.assert_allclose(vapour, want, atol=1.1e-3)
    gases = mixed_gas_bands(lam, 8e3, 0.9).transmittance(8e3 * airmass)
    np.testing.assert_allclose(
        gases, mixed(0.9 * airmass * VISIBLE["mixed_absorption"]), atol=1.1e-3
    )


def test_there_is_no_absorption_beside_the_bands():
    beside = np.array([450.0, 560.0, 580.0, 615.0, 640.0])
    assert (water_vapour_bands(beside, 0.05, 2e3).absorption == 0).all()
    assert (mixed_gas_bands([550.0, 680.0, 745.0, 780.0], 8e3).absorption == 0).all()


@pytest.mark.float64
def test_classes_of_lines_share_the_spectrum():
    vapour, gases = water_vapour_bands([720.0], 0.02, 2e3), mixed_gas_bands([760.0], 8e3)
    np.testing.assert_allclose(vapour.weights.sum(), 1, rtol=1e-12)
    np.testing.assert_array_equal(vapour.weights, gases.weights)
    assert (vapour.weights > 0).all()
    assert vapour.absorption.shape == (6, 1)
    assert (np.diff(vapour.absorption[:, 0]) > 0).all()
