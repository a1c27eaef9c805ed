"""Columns between air and sun, tabulated over altitude and the sun's zenith angle."""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .geometry import AbstractPlanet, Spherical
from .medium import Medium
from .paths import column_along, limb_legs, rising_leg


class SunColumns(eqx.Module):
    """Columns from any point to the top of the atmosphere, towards the sun.

    A table over altitude and the sun's zenith cosine, read with bicubic interpolation. Its
    coordinates stretch the ground and the horizon (after Bruneton & Neyret 2008, section 4).

    Attributes:
        planet: Its shape.
        table: Columns; a flat planet's has one angle, the vertical.
    """

    planet: AbstractPlanet
    table: Float[Array, "altitude angle species"]

    def __call__(
        self, altitude: Float[Array, "*b"], mu: Float[Array, "*b"]
    ) -> tuple[Float[Array, "*b species"], Bool[Array, "*b"]]:
        """Columns [m] at altitudes, towards zenith cosines; and whether that is above the horizon.

        Where it is not, the column is that to the zenith.
        """
        horizon = self.planet.horizon(altitude)
        lit = mu > horizon
        up = jnp.where(lit, mu, 1.0)
        row = self.planet.stretch(altitude) * (self.table.shape[0] - 1)
        if self.table.shape[1] == 1:
            vertical = _interpolate(self.table[:, 0], row)
            return jnp.maximum(vertical, 0.0) / up[..., None], lit
        column = _stretch((up - horizon) / (1 - horizon)) * (self.table.shape[1] - 1)
        # A cubic may swing below zero where a constituent ends.
        return jnp.maximum(_interpolate2(self.table, row, column), 0.0), lit


def sun_columns(medium: Medium, altitudes: int, angles: int) -> SunColumns:
    """Tabulate the columns towards the sun."""
    planet = medium.planet
    altitude = planet.unstretch(jnp.linspace(0.0, 1.0, altitudes, dtype=planet.top.dtype))

    def one(h, mu):
        none = jnp.zeros_like(h)
        falling, rising = limb_legs(planet, h, jnp.minimum(mu, 0.0), none + jnp.inf)
        up = rising_leg(planet, h, jnp.maximum(mu, 0.0), none + jnp.inf)
        falls = mu < 0
        leg = jax.tree.map(partial(jnp.where, falls), rising, up)
        dip = jnp.where(falls, falling.length, 0.0)
        out = column_along(medium, leg, none, leg.length)
        return out + column_along(medium, leg, none, dip)

    over_angles = jax.vmap(one, in_axes=(None, 0))
    if isinstance(planet, Spherical):
        w = _unstretch(jnp.linspace(0.0, 1.0, angles, dtype=altitude.dtype))
        horizon = planet.horizon(altitude)[:, None]
        mu = horizon + (1 - horizon) * w[None, :]
        # One altitude at a time stays in the cache; a gradient goes over each once more in place of
        # a gigabyte of notes.
        row = jax.checkpoint(over_angles)
        table = jax.lax.map(lambda levels: row(*levels), (altitude, mu))
        return SunColumns(planet, table)
    up = jnp.ones((altitudes, 1), altitude.dtype)
    return SunColumns(planet, jax.vmap(over_angles)(altitude, up))


_OFFSET = 1e-3  # of the square-root coordinate; it keeps its slope at the horizon finite


def _stretch(share):
    """Square root of a share in [0, 1], offset and rescaled to [0, 1]."""
    share = jnp.maximum(share, 0.0)
    return jnp.sqrt(share * (1 + 2 * _OFFSET) + _OFFSET**2) - _OFFSET


def _unstretch(x):
    return ((x + _OFFSET) ** 2 - _OFFSET**2) / (1 + 2 * _OFFSET)


def _cubic(position, count):
    """First of four neighbours on a uniform grid, and their Lagrange weights."""
    first = jnp.clip(jnp.floor(position).astype(int) - 1, 0, count - 4)
    t = position - first.astype(position.dtype)
    a, b, c, d = t, t - 1, t - 2, t - 3
    weights = (-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6)
    return first, weights


def _interpolate(table, position):
    first, weights = _cubic(position, table.shape[0])
    total = jnp.zeros((*position.shape, table.shape[-1]), table.dtype)
    for k, weight in enumerate(weights):
        total = total + weight[..., None] * _rows(table, first + k)
    return total


def _interpolate2(table, row, column):
    rows, columns, _ = table.shape
    flat = table.reshape(rows * columns, -1)
    first_row, row_weights = _cubic(row, rows)
    first_column, column_weights = _cubic(column, columns)
    total = jnp.zeros((*row.shape, flat.shape[-1]), flat.dtype)
    for i, wi in enumerate(row_weights):
        start = (first_row + i) * columns + first_column
        for j, wj in enumerate(column_weights):
            total = total + (wi * wj)[..., None] * _rows(flat, start + j)
    return total


def _rows(table, index):
    """Rows of a table at indices known to lie in it."""
    return table.at[index].get(mode="promise_in_bounds", wrap_negative_indices=False)
