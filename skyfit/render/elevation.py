"""Elevation models: heights on a grid, read between its nodes."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import Scalar
from ..errors import InputError


class Elevation(eqx.Module):
    """Heights on a grid of equal steps, in float32.

    The grid is continued by its own mirror images, so that land reaches to the horizon.

    Attributes:
        height: Heights above sea level, from south to north and from west to east [m].
        north: Step between rows [m].
        east: Step between columns [m].
    """

    height: Float[Array, "row column"]
    north: Scalar
    east: Scalar

    def __init__(self, height: Float[np.ndarray, "row column"], north: float, east: float):
        heights = np.asarray(height, np.float32)
        if heights.ndim != 2 or min(heights.shape) < 3:
            raise InputError(
                f"Elevation(height=...): expected 3 x 3 heights or more; got shape {heights.shape}"
            )
        if not np.isfinite(heights).all():
            raise InputError("Elevation(height=...): expected finite heights; got NaN or infinity")
        for name, step in (("north", north), ("east", east)):
            if not 0 < step < np.inf:
                raise InputError(f"Elevation({name}=...): expected a step above 0 m; got {step}")
        self.height = jnp.asarray(heights)
        self.north, self.east = jnp.float32(north), jnp.float32(east)

    @property
    def size(self) -> tuple[float, float]:
        """From west to east and from south to north [m]."""
        rows, columns = self.height.shape
        return float(self.east) * (columns - 1), float(self.north) * (rows - 1)

    def at(self, east: Float[Array, "*b"], north: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """Height at places [m] from the south-western corner, linear between the nodes."""
        return self.read(self.height[..., None], east, north)[..., 0]

    def read(
        self,
        table: Float[Array, "row column channel"],
        east: Float[Array, "*b"],
        north: Float[Array, "*b"],
    ) -> Float[Array, "*b channel"]:
        """Values of a table with the grid's nodes, linear in between."""
        rows, columns, channels = table.shape
        x, _ = _mirror(east / self.east, columns)
        y, _ = _mirror(north / self.north, rows)
        column = jnp.clip(x.astype(jnp.int32), 0, columns - 2)
        row = jnp.clip(y.astype(jnp.int32), 0, rows - 2)
        u, v = (x - column.astype(x.dtype))[..., None], (y - row.astype(y.dtype))[..., None]
        flat, corner = table.reshape(rows * columns, channels), row * columns + column
        south = flat[corner] * (1 - u) + flat[corner + 1] * u
        north_side = flat[corner + columns] * (1 - u) + flat[corner + columns + 1] * u
        return south * (1 - v) + north_side * v

    def signs(
        self, east: Float[Array, "*b"], north: Float[Array, "*b"]
    ) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        """Whether a place lies in an image mirrored east to west, or north to south: -1, else 1."""
        rows, columns = self.height.shape
        return _mirror(east / self.east, columns)[1], _mirror(north / self.north, rows)[1]

    def slopes(self) -> Float[Array, "row column 2"]:
        """Rise per metre towards east and north, at the nodes."""
        padded = jnp.pad(self.height, 1, mode="reflect")
        east = (padded[1:-1, 2:] - padded[1:-1, :-2]) / (2 * self.east)
        north = (padded[2:, 1:-1] - padded[:-2, 1:-1]) / (2 * self.north)
        return jnp.stack([east, north], axis=-1)


def _mirror(place, count):
    """Place on the grid, in [0, count - 1], and the direction in which it runs there."""
    period = 2.0 * (count - 1)
    turned = place - period * jnp.floor(place / period)
    back = turned > count - 1
    return jnp.where(back, period - turned, turned), jnp.where(back, -1.0, 1.0)
