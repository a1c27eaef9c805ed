"""Optical lengths towards the sun, tabulated over height and angle, as Nishita et al. propose."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .air import MarchedAir
from .ball import crossings, height


class OpticalDepthTable(eqx.Module):
    """Columns of air and haze from a height to space, over the sun's zenith cosine there.

    Attributes:
        planet_radius: Radius of the planet [m].
        top_altitude: Altitude at which the air ends [m].
        columns: Columns over height (closer near the ground) and angle (near the horizon) [m].
    """

    planet_radius: Float[Array, ""]
    top_altitude: Float[Array, ""]
    columns: Float[Array, "height angle 2"]

    def __call__(
        self, altitude: Float[Array, "*batch"], cosine: Float[Array, "*batch"]
    ) -> tuple[Float[Array, "*batch 2"], Bool[Array, "*batch"]]:
        """Columns [m], and whether the sun is above the horizon."""
        horizon = _horizon(self.planet_radius, altitude)
        lit = (cosine > horizon) & (altitude > 0)
        rows, angles, _ = self.columns.shape
        share = jnp.clip(altitude / self.top_altitude, 1e-12, 1.0)
        above = jnp.clip((cosine - horizon) / (1 - horizon), 1e-12, 1.0)
        row, column = jnp.sqrt(share) * (rows - 1), jnp.sqrt(above) * (angles - 1)
        i = jnp.clip(row.astype(int), 0, rows - 2)
        j = jnp.clip(column.astype(int), 0, angles - 2)
        u, v = (row - i.astype(row.dtype))[..., None], (column - j.astype(row.dtype))[..., None]
        table = self.columns.astype(altitude.dtype)
        low = table[i, j] * (1 - v) + table[i, j + 1] * v
        high = table[i + 1, j] * (1 - v) + table[i + 1, j + 1] * v
        return low * (1 - u) + high * u, lit


def optical_depth_table(
    air: MarchedAir, heights: int = 64, angles: int = 128, samples: int = 400
) -> OpticalDepthTable:
    """Tabulate the columns; `march(..., table=...)` then needs no steps towards the sun.

    Args:
        air: Air that is marched through.
        heights: Number of the table's rows.
        angles: Number of the table's columns.
        samples: Number of steps towards the sun for each entry.
    """
    radius, top = air.planet_radius, air.top_altitude
    at = jnp.linspace(0.0, 1.0, heights, dtype=top.dtype) ** 2 * top
    beside = jnp.asarray(np.linspace(0.0, 1.0, angles) ** 2, top.dtype)

    def one(altitude, share):
        horizon = _horizon(radius, altitude)
        cosine = horizon + (1 - horizon) * share
        direction = jnp.stack([jnp.sqrt(jnp.maximum(1 - cosine**2, 0.0)), 0 * cosine, cosine])
        start = jnp.stack([0 * altitude, 0 * altitude, altitude])
        _, end = crossings(radius, top, start, direction)
        end = jnp.where(jnp.isfinite(end), jnp.maximum(end, 0.0), 0.0)
        # Steps in the square root of the way from the eye: closer where the air is.
        x = (jnp.arange(samples, dtype=top.dtype) + 0.5) / samples
        h = height(radius, start[None] + (x**2 * end)[:, None] * direction[None])
        density = jnp.exp(-jnp.maximum(h, 0.0)[:, None] / air.scale_heights[None])
        return (2 * x * end / samples) @ density

    columns = jax.vmap(jax.vmap(one, (None, 0)), (0, None))(at, beside)
    return OpticalDepthTable(radius, top, columns)


def _horizon(radius, altitude):
    """Cosine of the zenith angle at which a ray grazes the ground."""
    altitude = jnp.maximum(altitude, 0.0)
    radius = radius.astype(altitude.dtype)
    dip = jnp.sqrt(altitude * (2 * radius + altitude) + 1e-6)
    return -dip / (radius + altitude)
