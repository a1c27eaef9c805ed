"""Columns between air and sun.

A ray to the sun is followed to the next shell edge, where columns are tabulated by the zenith
angle at that edge: no table is read between altitudes, so kinks and thin layers are exact. Above
an edge the column is the vertical one times an air mass, whose inverse is smooth in the cosine of
the zenith angle. A sun below the horizontal is seen through the lowest point of its ray: twice the
column from there less the column to a sun as far above the horizontal.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .geometry import Spherical
from .medium import Medium
from .paths import column_along, rising_leg
from .quadrature import even_stencil, gauss


_GROWTH = 5.0  # of zenith cosines at an edge, from the horizontal on
# Of the interpolation between them, and nodes in a shell: where a point moves from shell to shell
# the column then jumps by 1e-9 of itself, which a difference of two simulations does not notice.
_WIDTH, _NODES = 6, 3


class SunColumns(eqx.Module):
    """Columns from any point to the top of the atmosphere, towards the sun.

    Attributes:
        medium: The atmosphere on its planet.
        inverse_airmass: Above each edge, over zenith cosines there; none for a flat planet.
    """

    medium: Medium
    inverse_airmass: Float[Array, "edge angle species"] | None

    def __call__(
        self, altitude: Float[Array, "*#b"], mu: Float[Array, "*#b"]
    ) -> tuple[Float[Array, "*b species"], Bool[Array, "*b"]]:
        """Columns [m] at altitudes, towards zenith cosines; and whether that is above the horizon.

        Where it is not, the column is that to the zenith.
        """
        planet = self.medium.planet
        lit = mu > planet.horizon(altitude)
        towards = jnp.where(lit, mu, 1.0)
        shell = self.medium.shell(altitude)
        if self.inverse_airmass is None:
            return self._rising(shell, altitude, towards), lit
        below = towards < 0
        _, lowest = planet.lowest(altitude, jnp.where(below, towards, 0.0))
        # From the point and from the lowest one at once: less to compile.
        shells, altitudes, cosines = (
            jnp.stack(jnp.broadcast_arrays(*pair))
            for pair in (
                (shell, self.medium.shell(lowest)),
                (altitude, lowest),
                (jnp.abs(towards), jnp.zeros_like(lowest)),
            )
        )
        rising, horizontal = self._rising(shells, altitudes, cosines)
        through = jnp.maximum(2 * horizontal - rising, rising)
        return jnp.where(below[..., None], through, rising), lit

    def at_ground(
        self, mu: Float[Array, "*b"]
    ) -> tuple[Float[Array, "*b species"], Bool[Array, "*b"]]:
        """The same on the ground, which is an edge."""
        ground = jnp.zeros_like(mu)
        lit = mu > self.medium.planet.horizon(ground)
        towards = jnp.where(lit, mu, 1.0)
        above = self.medium.above[0]
        above = above.reshape((1,) * mu.ndim + above.shape)
        if self.inverse_airmass is None:
            return above / jnp.maximum(towards, 1e-9)[..., None], lit
        row = jnp.zeros(mu.shape, int)
        return above / self._inverse_airmass(row, jnp.maximum(towards, 0.0)), lit

    def _rising(self, shell, altitude, mu):
        """Columns towards zenith cosines of 0 or more, from altitudes in given shells."""
        medium, planet = self.medium, self.medium.planet
        low, edge, above, (c0, c1, c2, c3) = medium.look_up(shell)
        depth = jnp.where(edge > low, edge - low, 1.0)
        flat = self.inverse_airmass is None
        mu = jnp.maximum(mu, 1e-9) if flat else mu
        distance = jnp.maximum(planet.to_level(altitude, mu, edge), 0.0)
        inside = 0.0
        for x, w in zip(*gauss(_NODES), strict=True):
            here = planet.advance(altitude, mu, float(x) * distance)[0]
            share = jnp.clip((here - low) / depth, 0.0, 1.0)[..., None]
            inside = inside + float(w) * (c0 + share * (c1 + share * (c2 + share * c3)))
        inside = jnp.maximum(inside, 0.0) * distance[..., None]
        if self.inverse_airmass is None:
            return inside + above / mu[..., None]
        crossing = planet.mu_at_level(altitude, mu, edge)
        return inside + above / self._inverse_airmass(shell + 1, crossing)

    def _inverse_airmass(self, row, mu):
        assert self.inverse_airmass is not None
        edges, angles, species = self.inverse_airmass.shape
        position = jnp.log1p(mu * float(np.expm1(_GROWTH))) / _GROWTH * (angles - 1)
        first, weights = even_stencil(position, angles, _WIDTH)
        flat = self.inverse_airmass.reshape(edges * angles, species)
        near = [_at(flat, row * angles + first + k) for k in range(_WIDTH)]
        value = sum(weight[..., None] * one for weight, one in zip(weights, near, strict=True))
        # Monotonic in the cosine: no overshoot past the outer neighbours.
        return jnp.clip(value, near[0], near[-1])


def sun_columns(medium: Medium, angles: int) -> SunColumns:
    """Tabulate air masses above the edges of the shells."""
    planet = medium.planet
    if not isinstance(planet, Spherical):
        return SunColumns(medium, None)
    x = np.expm1(_GROWTH * np.linspace(0, 1, angles)) / np.expm1(_GROWTH)
    cosines = jnp.asarray(x, medium.edges.dtype)

    def one(h, mu):
        leg = rising_leg(planet, h, mu, jnp.zeros_like(h) + jnp.inf)
        return column_along(medium, leg, jnp.zeros_like(h), leg.length)

    # One altitude at a time stays in the cache; a gradient goes over each once more in place of a
    # gigabyte of notes.
    row = jax.checkpoint(jax.vmap(one, in_axes=(None, 0)))
    slant = jax.lax.map(lambda h: row(h, cosines), medium.edges)
    vertical = medium.above[:, None, :]
    some = (vertical > 0) & (slant > 0)
    inverse = jnp.where(some, vertical, 1.0) / jnp.where(some, slant, 1.0)
    return SunColumns(medium, jnp.where(some, inverse, 1.0))


def _at(table, index):
    """Rows of a table at indices known to lie in it."""
    return table.at[index].get(mode="promise_in_bounds", wrap_negative_indices=False)
