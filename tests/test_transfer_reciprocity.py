"""Reciprocity: light takes the same share of itself from the sun to the eye as it would back.

The reflection I / (E cos θₛ) of a plane-parallel atmosphere does not change when the sun and the
eye above it trade places (Chandrasekhar 1960, section 52); nor does that of each single order.
"""

import numpy as np
import pytest

import skyfit


@pytest.fixture(scope="module")
def reflection():
    """[order, sun, view, wavelength]; suns and views at the same zenith angles."""
    angles = np.radians([10.0, 35.0, 60.0])
    atmosphere = skyfit.preetham_atmosphere(
        3.0, wavelengths=[400.0, 550.0, 700.0], ground_albedo=0.4
    )
    sky = skyfit.simulate(
        atmosphere, angles[:, None], np.pi - angles, np.radians(50.0), orders=4,
        geometry="flat", observer_altitude=70e3,
    )  # fmt: skip
    sunlight = np.asarray(atmosphere.solar_irradiance) * np.cos(angles)[:, None, None]
    return np.asarray(sky.by_order) / sunlight


@pytest.mark.slow
def test_every_order_of_a_flat_atmosphere_is_reciprocal(reflection):
    # The orders are sums over different directions from the one side and the other: default
    # quality promises 0.5 %.
    traded = np.swapaxes(reflection, 1, 2)
    np.testing.assert_allclose(reflection, traded, rtol=5e-3)


@pytest.mark.slow
def test_the_radiance_itself_is_not_symmetric(reflection):
    suns = np.cos(np.radians([10.0, 35.0, 60.0]))[None, :, None, None]
    radiance = reflection * suns
    assert np.abs(radiance / np.swapaxes(radiance, 1, 2) - 1).max() > 0.5
