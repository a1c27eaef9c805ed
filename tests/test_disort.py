"""All orders over a plane against discrete ordinates, run here and now by another program."""

import numpy as np
import pytest
from peers import peer

import skyfit
from skyfit import Atmosphere, Constituent, phase, profile


pydisort = peer("PythonicDISORT.pydisort").pydisort

TOP = 60e3  # m
AIR, HAZE = (1.2e-5, 8e3), (1.0e-4, 1.2e3)  # scattering [1/m] and scale height [m]
HAZE_ABSORPTION, ASYMMETRY = 1e-5, 0.76
STREAMS, LAYERS = 48, 80


def depth(coefficient, scale, altitude):
    return coefficient * scale * (np.exp(-altitude / scale) - np.exp(-TOP / scale))


def discrete_ordinates(cos_sun, albedo, hazier=1.0):
    """Zenith cosines of the streams, and the radiance at the ground as a function of azimuth."""
    haze_extinction = hazier * (HAZE[0] + HAZE_ABSORPTION)
    bottoms = np.linspace(1, 0, LAYERS + 1)[1:] ** 3 * TOP  # thin layers near the ground
    tops = np.concatenate([[TOP], bottoms[:-1]])
    layer = {
        "air": depth(*AIR, bottoms) - depth(*AIR, tops),
        "haze": depth(haze_extinction, HAZE[1], bottoms) - depth(haze_extinction, HAZE[1], tops),
    }
    scattered = layer["air"], layer["haze"] * hazier * HAZE[0] / haze_extinction
    total = layer["air"] + layer["haze"]
    order = np.arange(STREAMS)
    rayleigh = np.where(order == 2, 0.1, np.where(order == 0, 1.0, 0.0))
    mixed = scattered[0][:, None] * rayleigh + scattered[1][:, None] * ASYMMETRY**order
    moments = mixed / sum(scattered)[:, None]
    below = np.cumsum(total)
    albedos = np.minimum(sum(scattered) / total, 1 - 2e-6)  # it warns nearer to 1
    mu, _, _, _, radiance = pydisort(
        below, albedos, STREAMS, moments, cos_sun, 1.0, 0.0,
        BDRF_Fourier_modes=[albedo],
    )  # fmt: skip
    return mu, lambda azimuth: radiance(below[-1], azimuth)


@pytest.mark.slow
@pytest.mark.parametrize(("sun_deg", "albedo"), [(30.0, 0.0), (75.0, 0.3)])
def test_all_orders_over_a_plane_are_those_of_discrete_ordinates(sun_deg, albedo):
    sun = np.radians(sun_deg)
    mu, radiance = discrete_ordinates(np.cos(sun), albedo)
    downward = mu < -np.cos(np.radians(85))
    azimuth = np.radians([10.0, 90.0, 170.0])
    want = np.stack([radiance(a)[downward] for a in azimuth], axis=1)
    air = Constituent(profile.Exponential(AIR[1]), AIR[0], phase=phase.Rayleigh())
    haze = Constituent(
        profile.Exponential(HAZE[1]), HAZE[0], HAZE_ABSORPTION,
        phase=phase.HenyeyGreenstein(ASYMMETRY),
    )  # fmt: skip
    atmosphere = Atmosphere([550.0], 1.0, (air, haze), albedo)
    view = np.arccos(-mu[downward])[:, None]
    sky = skyfit.simulate(atmosphere, sun, view, azimuth, orders=None, geometry="flat")
    # Default quality keeps 8e-4 here; it promises 0.5 %.
    np.testing.assert_allclose(sky.radiance[..., 0], want, rtol=5e-4)


@pytest.mark.slow
def test_wavelengths_of_other_depths_share_their_levels():
    """Haze of depth 0.13, 1.3 and 5.9 at three wavelengths, for all of which levels are laid."""
    sun, hazier = np.radians(60.0), np.array([1.0, 10.0, 45.0])
    azimuth = np.radians([10.0, 90.0, 170.0])
    air = Constituent(profile.Exponential(AIR[1]), AIR[0], phase=phase.Rayleigh())
    haze = Constituent(
        profile.Exponential(HAZE[1]), hazier * HAZE[0], hazier * HAZE_ABSORPTION,
        phase=phase.HenyeyGreenstein(ASYMMETRY),
    )  # fmt: skip
    atmosphere = Atmosphere([450.0, 500.0, 550.0], 1.0, (air, haze), 0.3)
    by_depth = [discrete_ordinates(np.cos(sun), 0.3, factor) for factor in hazier]
    mu = by_depth[0][0]
    downward = mu < -np.cos(np.radians(85))
    view = np.arccos(-mu[downward])[:, None]
    sky = skyfit.simulate(atmosphere, sun, view, azimuth, orders=None, geometry="flat")
    # Measured: 0.02, 0.31 and 1.41 %.
    for number, rtol in enumerate([5e-4, 4e-3, 1.6e-2]):
        radiance = by_depth[number][1]
        want = np.stack([radiance(a)[downward] for a in azimuth], axis=1)
        np.testing.assert_allclose(sky.radiance[..., number], want, rtol=rtol)
