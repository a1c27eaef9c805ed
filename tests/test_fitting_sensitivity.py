"""Derivatives of coefficients through simulation and fit, against central differences."""

import jax.numpy as jnp
import numpy as np
import pytest

import skyfit.retrieval.sensitivity
from skyfit import constants
from skyfit.atmosphere import Atmosphere, Constituent
from skyfit.campaign import half_dome
from skyfit.phase import HenyeyGreenstein, Rayleigh
from skyfit.preetham_air import rayleigh_scattering, solar_irradiance
from skyfit.profile import Exponential
from skyfit.retrieval import coefficient_sensitivity


LAM = np.array([450.0, 550.0, 650.0])
SUNS = np.radians([20.0, 60.0])
VIEW, AZIMUTH = half_dome(np.radians([30.0, 60.0, 80.0]), np.radians([0.0, 40.0, 100.0, 180.0]))
HERE = {
    "optical_depth": 0.15,
    "scale_height": 1200.0,
    "asymmetry": 0.7,
    "ozone": 1.0,
    "ground_albedo": 0.2,
}


def hazy(optical_depth, scale_height, asymmetry, ozone, ground_albedo, *, light=1.0):
    """Air, haze, and what stands for ozone, each with an exponential profile."""
    low = Exponential(scale_height)
    haze = optical_depth / low.column(constants.TOP_OF_ATMOSPHERE) * jnp.asarray(550 / LAM)
    absorption = ozone * jnp.array([1e-8, 4e-7, 3e-7])
    return Atmosphere(
        LAM,
        light * solar_irradiance(LAM),
        (
            Constituent(Exponential(8000.0), rayleigh_scattering(LAM), phase=Rayleigh()),
            Constituent(low, 0.9 * haze, 0.1 * haze, phase=HenyeyGreenstein(asymmetry)),
            Constituent(Exponential(20e3), 0.0, absorption, phase=Rayleigh()),
        ),
        ground_albedo,
    )


def sensitivity(at, atmosphere=hazy, **changed):
    """Every call here runs the same compiled programs."""
    views = {"sun_zenith": SUNS, "view_zenith": VIEW, "relative_azimuth": AZIMUTH} | changed
    return coefficient_sensitivity(atmosphere, at, quality="draft", **views)


@pytest.mark.slow
def test_derivatives_are_those_of_central_differences():
    found = sensitivity(HERE)
    assert list(found.at) == list(HERE)
    assert found.converged == {"x": True, "y": True, "Y": True}
    for k, (name, value) in enumerate(HERE.items()):
        # These steps err by up to 1e-6, in the asymmetry, and round by 1e-5; 1e-4 is promised.
        # Of the scale height steps of up to 7e-5 agree to 1e-6, longer ones cross a kink of the
        # simulation's sampling and agree to 5e-5.
        step = (3e-5 if name == "scale_height" else 1e-4) * value
        high, low = (sensitivity(HERE | {name: value + s}).coefficients for s in (step, -step))
        for channel, table in found.derivatives.items():
            slope = (high[channel] - low[channel]) / (2 * step)
            np.testing.assert_allclose(table[:, k], slope, rtol=5e-5)
            log_slope = np.log(high[channel] / low[channel]) / np.log(
                (value + step) / (value - step)
            )
            np.testing.assert_allclose(found.relative()[channel][:, k], log_slope, rtol=5e-5)


def test_a_black_sky_is_refused():
    with pytest.raises(ValueError, match="expected light from every direction; 26 of 26 are dark"):
        sensitivity(HERE, lambda **at: hazy(**at, light=0.0))


@pytest.mark.parametrize(
    ("at", "changed", "message"),
    [
        ({}, {}, r"\(at=...\): expected one quantity or more; got none"),
        ({"ozone": [1.0, 2.0]}, {}, r"\(at=...\): ozone: expected one value; got shape \(2,\)"),
        (HERE, {"view_zenith": None}, "got only one of them"),
        (HERE, {"view_zenith": VIEW[1:]}, r"got shapes \(2,\), \(12,\) and \(13,\)"),
        (HERE, {"sun_zenith": [0.3, 1.7]}, r"\(sun_zenith=...\) must lie in .*; got 1.7"),
    ],
)
def test_what_cannot_be_varied_is_refused(at, changed, message):
    with pytest.raises(ValueError, match="^coefficient_sensitivity.*" + message):
        sensitivity(at, **changed)


@pytest.mark.slow
def test_the_coefficients_are_those_of_the_fit(monkeypatch):
    fits = []
    fit_groups = skyfit.retrieval.sensitivity.fit_groups
    monkeypatch.setattr(
        skyfit.retrieval.sensitivity,
        "fit_groups",
        lambda *given: fits.append(fit_groups(*given)) or fits[0],
    )
    found = np.stack(list(sensitivity(HERE).coefficients.values()))
    # The solver stops where the loss cannot fall by 1e-13 of itself: 1e-6 off where it is flat.
    np.testing.assert_allclose(found, fits[0].numbers[:, 0, 0], rtol=1e-4)
