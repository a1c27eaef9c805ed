"""A simulator that costs nothing, for tests of what is done with skies."""

import jax.numpy as jnp

from skyfit.angles import view_sun_angle
from skyfit.transfer.simulate_sky import Sky


def stand_in(atmosphere, sun_zenith, view_zenith, relative_azimuth, orders=2, **_):
    """Brighter towards the sun, by the haze; each order a tenth of the one before."""
    angles = jnp.broadcast_arrays(view_zenith, sun_zenith, relative_azimuth)
    glow = jnp.exp(-view_sun_angle(*angles))[..., None]
    light = glow * atmosphere.scattering.sum(0).reshape((1,) * (glow.ndim - 1) + (-1,)) * 1e3
    by_order = jnp.stack([light * 0.1**n for n in range(orders)])
    return Sky(by_order, jnp.zeros_like(light))
