"""Directions drawn in proportion to a sky's brightness, for renderers."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

from .._typing import ArrayLike, as_float, check
from ..errors import InputError
from .dome import Dome


class SkySampler(eqx.Module):
    """A density over the upper hemisphere, constant in each cell of a dome's grid.

    The sun's disc is no part of it: a source so small is sampled by itself.

    Attributes:
        probability: Probability of each cell; 1 in sum.
        edges: Cosines of the zenith angles between rings, from 1 down to 0.
    """

    probability: Float[Array, "zenith azimuth"]
    edges: Float[Array, " edge"]

    def density(self, direction: ArrayLike) -> Float[Array, "*batch"]:
        """Density in directions [sr⁻¹]; 0 below the horizon.

        Args:
            direction: Directions as unit vectors; x towards the sun, z up.
        """
        vectors = as_float(direction)
        x, y, z = jnp.moveaxis(vectors, -1, 0)
        rings, spokes = self.probability.shape
        ring = jnp.clip(jnp.searchsorted(-self.edges, -z, side="right") - 1, 0, rings - 1)
        turn = jnp.arctan2(y, x) / (2 * math.pi) % 1.0
        spoke = jnp.clip((turn * spokes).astype(int), 0, spokes - 1)
        solid_angle = (self.edges[ring] - self.edges[ring + 1]) * (2 * math.pi / spokes)
        return jnp.where(z > 0, self.probability[ring, spoke] / solid_angle, 0.0)

    def sample(
        self, key: PRNGKeyArray, shape: tuple[int, ...] = ()
    ) -> tuple[Float[Array, "*batch 3"], Float[Array, "*batch"]]:
        """Draw directions.

        Args:
            key: Key of `jax.random`.
            shape: Shape of the samples.

        Returns:
            Unit vectors, x towards the sun and z up, and their density [sr⁻¹].
        """
        dtype = self.probability.dtype
        u, across, around = jax.random.uniform(key, (3, *shape), dtype)
        spokes = self.probability.shape[1]
        cumulative = jnp.cumsum(self.probability.ravel())
        cell = jnp.searchsorted(cumulative, u * cumulative[-1], side="right")
        ring, spoke = jnp.divmod(jnp.minimum(cell, cumulative.size - 1), spokes)
        high, low = self.edges[ring], self.edges[ring + 1]
        cosine = low + across * (high - low)
        sine = jnp.sqrt(jnp.maximum(1 - cosine**2, 0.0))
        azimuth = (spoke.astype(dtype) + around) * (2 * math.pi / spokes)
        vectors = jnp.stack([sine * jnp.cos(azimuth), sine * jnp.sin(azimuth), cosine], axis=-1)
        solid_angle = (high - low) * (2 * math.pi / spokes)
        return vectors, self.probability[ring, spoke] / solid_angle


def sky_sampler(
    dome: Dome, *, channel: int = 1, cosine: bool = False, floor: float = 1e-3
) -> SkySampler:
    """A density that follows a channel of a sky.

    Args:
        dome: The sky.
        channel: Channel that is followed; 1 is the luminance of a dome in CIE XYZ.
        cosine: Follow the light times the cosine of the zenith angle, for horizontal surfaces.
        floor: Share that is spread evenly over the hemisphere, so that no direction is left out.

    Raises:
        InputError: A channel that the dome has not; a floor outside 0 to 1; a sky without light.
    """
    channels = dome.light.shape[-1]
    if not -channels <= channel < channels:
        raise InputError(f"sky_sampler(channel=...): expected one of {channels}; got {channel}")
    if not 0 <= floor <= 1:
        raise InputError(f"sky_sampler(floor=...) must lie in 0 to 1; got {floor}")
    light = dome.light[..., channel]
    if cosine:
        light = light * dome.directions[..., 2]
    power = jnp.maximum(light, 0.0) * dome.solid_angle[:, None]
    total = check(power.sum(), lambda v: ~(v > 0), "sky_sampler(dome=...) must hold some light")
    even = dome.solid_angle[:, None] / (2 * math.pi)
    # A ring's cells lie between the cosines that share out the hemisphere by its solid angles.
    rings = np.asarray(dome._grid()[2]) * light.shape[1] / (2 * math.pi)
    edges = np.concatenate([[1.0], 1.0 - np.cumsum(rings)])
    edges[-1] = 0.0
    return SkySampler((1 - floor) * power / total + floor * even, jnp.asarray(edges, light.dtype))
