"""Fits of an aerosol through the simulator: known numbers back, and derivatives."""

import dataclasses

import jax
import numpy as np
import pytest
import xarray as xr

import skyfit
from skyfit.retrieval import aerosol_fit
from skyfit.transfer.quality import QUALITIES, Directions


FILE = """
schema = "skyfit/campaign/1"
[sun]
spectrum = "astm_g173"
[ground]
albedo = 0.1
[[constituents]]
name = "air"
kind = "air"
[[constituents]]
name = "haze"
kind = "angstrom_aerosol"
angstrom_beta = 0.04
angstrom_exponent = 1.0
asymmetry = 0.6
single_scattering_albedo = 0.9
profile = { kind = "exponential", scale_height_m = 1500 }
"""
TRUTH = {
    "angstrom_beta": 0.06,
    "angstrom_exponent": 1.4,
    "asymmetry": 0.72,
    "single_scattering_albedo": 0.95,
    "ground_scale": 1.5,
}
LAM = np.array([400.0, 520.0, 680.0])
SMALL = Directions(up=4, limb=1, down=2, azimuths=6, degree=5, modes=5)
COARSE = QUALITIES["draft"]._replace(
    view_panels=4, levels=6, first=SMALL, higher=SMALL, sun_azimuths=2, sun_offsets_deg=(0.0,)
)
VIEW = np.radians([0.0, 25.0, 50.0, 75.0, 75.0])
AZIMUTH = np.radians([[0.0, 40.0, 90.0, 10.0, 180.0], [0.0, 0.0, 60.0, 120.0, 10.0]])
SUN = np.radians([30.0, 60.0])


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    file = tmp_path_factory.mktemp("aerosol") / "own.toml"
    file.write_text(FILE)
    return dataclasses.replace(skyfit.load_campaign(file), wavelengths=tuple(LAM.tolist()))


@pytest.fixture(scope="module")
def found(campaign):
    """The fit to skies simulated with the true numbers, in single scattering; one patch is gone."""
    known = aerosol_fit.AerosolFit(TRUTH, {}, 0.0, 0, True).campaign(campaign, "haze")
    light = skyfit.simulate(
        known.build_atmosphere(), SUN[:, None], VIEW[None], AZIMUTH, 1, quality=COARSE
    ).radiance
    light = np.array(light)
    light[1, 3] = np.nan
    skies = xr.Dataset(
        {"radiance": (("time", "direction", "wavelength"), light)},
        {
            "wavelength": LAM,
            "sun_zenith": ("time", SUN),
            "view_zenith": ("direction", VIEW),
            "relative_azimuth": (("time", "direction"), AZIMUTH),
        },
    )
    return skyfit.fit_aerosol(skies, campaign, "haze", wavelengths=LAM, orders=1, quality=COARSE)


@pytest.mark.slow
def test_the_numbers_of_a_simulated_aerosol_come_back(found):
    assert found.converged
    for name, value in (TRUTH | {"ground_scale": 1.0}).items():
        np.testing.assert_allclose(found.values[name], value, rtol=1e-3, err_msg=name)
    assert found.rmse < 1e-6
    assert all(0 <= error < 1e-3 for error in found.standard_errors.values())
    assert found.standard_errors["ground_scale"] == 0


@pytest.mark.slow
def test_fitted_numbers_take_their_places_in_the_campaign(found, campaign):
    fitted = found.campaign(campaign, "haze").build_atmosphere()
    depth = np.asarray(fitted.optical_depth()[1])
    expected = found.values["angstrom_beta"] * (LAM / 1000) ** -found.values["angstrom_exponent"]
    np.testing.assert_allclose(depth, expected, rtol=1e-9)
    np.testing.assert_allclose(fitted.ground_albedo, 0.1 * found.values["ground_scale"], rtol=1e-12)


@pytest.mark.slow
def test_derivatives_through_the_simulator_are_those_of_differences(campaign):
    start = aerosol_fit._free(TRUTH | {"asymmetry": 0.5})
    base = campaign.build_atmosphere()
    case = aerosol_fit._Case(
        base, base.vertical_column()[1], *map(jax.numpy.asarray, (SUN, VIEW[None] + 0 * AZIMUTH)),
        jax.numpy.asarray(AZIMUTH), jax.numpy.ones((2, 5, 3)),
        jax.numpy.ones((2, 5, 3), bool), 1, 2, COARSE,
    )  # fmt: skip

    @jax.jit
    def run(free, way):
        return jax.jvp(lambda free: aerosol_fit._residuals(free, case), (free,), (way,))

    for number in range(5):
        way = jax.numpy.asarray(np.eye(5)[number])
        step = 1e-4 * way
        difference = (run(start + step, way)[0] - run(start - step, way)[0]) / 2e-4
        exact = run(start, way)[1]
        np.testing.assert_allclose(exact, difference, atol=1e-6 * abs(difference).max())


def test_an_aerosol_that_is_not_there_is_named(campaign):
    with pytest.raises(ValueError, match="has air, haze, not fog"):
        skyfit.fit_aerosol(xr.Dataset(), campaign, "fog", wavelengths=LAM)
    with pytest.raises(ValueError, match="lists constituents and sweeps nothing"):
        skyfit.fit_aerosol(xr.Dataset(), skyfit.Campaign(), "haze", wavelengths=LAM)
    with pytest.raises(ValueError, match="expected a variable 'radiance'"):
        skyfit.fit_aerosol(xr.Dataset(), campaign, "haze", wavelengths=LAM)
