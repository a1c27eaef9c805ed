"""Mountains that cast shadows into the air."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .._typing import ArrayLike, Scalar, as_parameter, as_scalar, check
from ..errors import InputError


class HeightField(eqx.Module):
    """Altitudes on a square grid, linear in between; 0 outside it.

    Args:
        altitude: Altitudes [y, x], two or more each way [m].
        spacing: Distance between grid points [m].
        corner: x and y of the first of them; the grid lies around the origin if not given [m].
    """

    altitude: Float[Array, "y x"]
    spacing: Scalar
    corner: Float[Array, " 2"]

    def __init__(self, altitude: ArrayLike, spacing: ArrayLike, corner: ArrayLike | None = None):
        grid = as_parameter(altitude)
        if grid.ndim != 2 or min(grid.shape) < 2:
            raise InputError(f"HeightField(altitude=...): expected [y, x]; got shape {grid.shape}")
        self.altitude = grid
        step = as_scalar(spacing, "HeightField(spacing=...)")
        message = "HeightField(spacing=...) must be above 0 m"
        self.spacing = check(step, lambda v: ~(v > 0), message)
        middle = -0.5 * step * as_parameter([grid.shape[1] - 1, grid.shape[0] - 1])
        self.corner = middle if corner is None else as_parameter(corner)

    def __call__(
        self, x: Float[Array, "*batch"], y: Float[Array, "*batch"]
    ) -> Float[Array, "*batch"]:
        """Altitude of the ground at horizontal coordinates [m]."""
        column = (x - self.corner[0].astype(x.dtype)) / self.spacing.astype(x.dtype)
        row = (y - self.corner[1].astype(x.dtype)) / self.spacing.astype(x.dtype)
        rows, columns = self.altitude.shape
        inside = (column >= 0) & (column <= columns - 1) & (row >= 0) & (row <= rows - 1)
        column, row = jnp.where(inside, column, 0.0), jnp.where(inside, row, 0.0)
        left = jnp.minimum(column.astype(int), columns - 2)
        low = jnp.minimum(row.astype(int), rows - 2)
        across, along = column - left.astype(x.dtype), row - low.astype(x.dtype)
        grid = self.altitude.astype(x.dtype)
        near = grid[low, left] * (1 - across) + grid[low, left + 1] * across
        far = grid[low + 1, left] * (1 - across) + grid[low + 1, left + 1] * across
        return jnp.where(inside, near * (1 - along) + far * along, 0.0)


def in_shadow(
    terrain,
    altitude: Float[Array, "*batch"],
    point: Float[Array, "*batch 3"],
    toward: Float[Array, " 3"],
    reach: float,
    steps: int,
) -> Bool[Array, "*batch"]:
    """Whether ground rises above a point's way to the sun within a reach [m].

    Args:
        terrain: Altitude of the ground from x and y.
        altitude: Altitude of the points; the ground between is taken as flat [m].
        point: Points at which shadow is asked for.
        toward: Direction to the sun.
        reach: Distance to which is looked.
        steps: Number of places looked at, closer near the point.
    """
    share = (jnp.arange(steps, dtype=point.dtype) + 0.5) / steps

    def look(hidden, s):
        x, y = point[..., 0] + s * toward[0], point[..., 1] + s * toward[1]
        return hidden | (altitude + s * toward[2] < terrain(x, y)), None

    start = altitude < terrain(point[..., 0], point[..., 1])
    return jax.lax.scan(look, start, reach * share**2)[0]
