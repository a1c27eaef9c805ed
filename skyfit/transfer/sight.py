"""Lines of sight, laid out once for all orders of scattering."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .geometry import Ray
from .medium import Medium
from .nodes import Dimming, Path, sample
from .paths import Kind, Leg, both_legs, rising_leg


class Sight(eqx.Module):
    """A line of sight: its legs side by side, a rising ray's one or any ray's two, and their nodes.

    Attributes:
        leg: The legs.
        start: Where each begins to matter, from its lowest point [m].
        offset: Column between the eye and its nearer end [m].
        to_ground: Column between the eye and the ground, where a leg ends there [m].
        strikes: Whether it does.
        path: Nodes on each.
    """

    leg: Leg
    start: Float[Array, " leg"]
    offset: Float[Array, "leg species"]
    to_ground: Float[Array, "leg species"]
    strikes: Bool[Array, " leg"]
    path: Path


def look_along(
    medium: Medium, ray: Ray, kind: Kind, panels: int, kinks: int, dimming: Dimming | None
) -> Sight:
    """Cut one line of sight into legs and put nodes on them.

    Args:
        medium: What the ray crosses.
        ray: From inside the atmosphere.
        kind: "rising" saves the legs of falling rays.
        panels: Number of panels of nodes on each leg.
        kinks: So many are ends of panels besides.
        dimming: See `sample`.
    """
    farthest = medium.sight()
    none = jnp.zeros_like(medium.optics.extinction[:, 0])
    if kind == "rising":
        one = rising_leg(medium.planet, ray.altitude, ray.mu, farthest)
        leg = jax.tree.map(lambda a: a[None], one)
        start, offset, column = jnp.zeros_like(leg.length), none[None], none[None]
        strikes = jnp.zeros(1, bool)
    else:
        leg, start, before, ends = both_legs(medium, ray, farthest)
        offset, column = jnp.stack([none, before]), jnp.stack([before, none])
        strikes = jnp.stack([ends, jnp.zeros_like(ends)])

    def nodes(leg, start):
        return sample(medium, leg, start, leg.length, panels, kinks, dimming)

    return Sight(leg, start, offset, column, strikes, jax.vmap(nodes)(leg, start))
