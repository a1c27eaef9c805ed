"""Where the levels of the light field lie, and between which of them light is interpolated."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from .medium import Medium
from .quadrature import interpolate


_KINKS = 4  # of the density that lie on levels
# Change of optical depth by a kink, over the distance of levels: more than these draws a level, and
# is not smooth.
_WEAK, _STRONG = 0.02, 0.1


def place_levels(
    medium: Medium, count: int
) -> tuple[Float[Array, " level"], Bool[Array, " level"]]:
    """Altitudes of levels [m], even in the medium's coordinate or on its strongest kinks.

    And which of them are kinks across which light is not smooth.
    """
    even = jnp.linspace(0, 1, count, dtype=medium.edges.dtype)
    altitude = interpolate(even, medium.coordinate, medium.edges)
    gap = interpolate(medium.edges, 0.5 * (altitude[1:] + altitude[:-1]), jnp.diff(altitude))
    inside = (medium.edges > 0) & (medium.edges < medium.planet.top)
    strength = jnp.where(inside, medium.kink * gap**2, 0.0)
    strength, which = jax.lax.top_k(strength, min(_KINKS, count - 2))
    places = jnp.arange(count)
    taken = (places == 0) | (places == count - 1)
    fixed, edge_of = even, jnp.where(places == 0, 0, medium.edges.size - 1)
    kinked = jnp.zeros_like(taken)

    def move(state, kink):
        fixed, edge_of, taken, kinked = state
        one, edge = kink
        place = medium.coordinate[edge]
        distance = jnp.where(taken, jnp.inf, jnp.abs(even - place))
        moved = (places == jnp.argmin(distance)) & (one > _WEAK)
        fixed, edge_of = jnp.where(moved, place, fixed), jnp.where(moved, edge, edge_of)
        return (fixed, edge_of, taken | moved, kinked | (moved & (one > _STRONG))), None

    state = fixed, edge_of, taken, kinked
    (fixed, edge_of, taken, kinked), _ = jax.lax.scan(move, state, (strength, which))
    # Those that were moved in the order of altitude, the others evenly between them.
    order = jnp.argsort(jnp.where(taken, fixed, jnp.inf))[jnp.cumsum(taken) - 1]
    fixed, edge_of, kinked = fixed[order], edge_of[order], kinked[order] & taken
    low, high = _around(taken)
    share = (places - low) / jnp.maximum(high - low, 1)
    level = fixed[low] + share.astype(fixed.dtype) * (fixed[high] - fixed[low])
    altitude = interpolate(level, medium.coordinate, medium.edges)
    altitude = jnp.where(taken, medium.edges[edge_of], altitude)
    return altitude, kinked


def _around(
    marked: Bool[Array, " level"],
) -> tuple[Int[Array, " level"], Int[Array, " level"]]:
    """The last marked level up to each and the first from each on; both ends are marked."""
    places = np.arange(marked.size)
    passed = jnp.asarray(places[None] <= places[:, None])
    low = jnp.max(jnp.where(marked[None] & passed, places[None], 0), axis=1)
    high = jnp.min(jnp.where(marked[None] & passed.T, places[None], marked.size - 1), axis=1)
    return low, high


def stencils(kinked: Bool[Array, " level"]) -> Bool[Array, "interval level"]:
    """Which levels interpolate between neighbours: the nearest four on this side of a kink."""
    places = jnp.arange(kinked.size)
    ends = kinked | (places == 0) | (places == kinked.size - 1)
    low, high = _around(ends)
    low, high = low[:-1], high[1:]
    first = jnp.clip(places[:-1] - 1, low, jnp.maximum(low, high - 3))
    last = jnp.minimum(first + 3, high)
    return (places[None] >= first[:, None]) & (places[None] <= last[:, None])
