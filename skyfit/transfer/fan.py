"""All rays that end at one level of the field, taken leg by leg.

Rising rays have one leg, falling ones one, grazing ones (limb) two. Laid side by side the legs go
through one compiled program, whatever their kind.
"""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import Scalar
from .geometry import Flat, Ray
from .medium import Medium
from .paths import Leg, column_along, ground_leg, limb_legs, rising_leg
from .quadrature import safe_sqrt
from .quality import Directions


class Fan(eqx.Module):
    """Legs of the rays of a level: rising ones first, then falling; limb rays have one of each.

    Attributes:
        ray: The ray each leg belongs to.
        leg: The legs.
        start: Where they begin to matter, from their lowest point [m].
        offset: Column between the eye and the leg's nearer end [m].
        to_ground: Column between the eye and the ground, for each falling ray [m].
        up: Number of rising rays.
        limb: Number of limb rays.
    """

    ray: Ray
    leg: Leg
    start: Float[Array, " leg"]
    offset: Float[Array, "leg species"]
    to_ground: Float[Array, "down species"]
    up: int = eqx.field(static=True)
    limb: int = eqx.field(static=True)

    def collect(
        self, light: Float[Array, "leg *batch"], ground: Float[Array, "down *batch"]
    ) -> Float[Array, "ray *batch"]:
        """Add up what comes along the legs of each ray, and from the ground at its end."""
        above, below = light[: self.up + self.limb], light[self.up + self.limb :]
        grazing = above[self.up :] + below[: self.limb]
        return jnp.concatenate([above[: self.up], grazing, below[self.limb :] + ground])

    def falling(self) -> tuple[Ray, Leg]:
        """The rays that strike the ground, and their legs."""
        return jax.tree.map(lambda a: a[self.up + 2 * self.limb :], (self.ray, self.leg))


def make_fan(
    medium: Medium,
    altitude: Scalar,
    mu: Float[Array, " ray"],
    directions: Directions,
) -> Fan:
    """Cut the rays of a level; `mu` are their zenith cosines in the order rising, limb, falling."""
    farthest = medium.sight()
    up = directions.up
    limb = 0 if isinstance(medium.planet, Flat) else directions.limb

    rising = jax.vmap(lambda m: rising_leg(medium.planet, altitude, m, farthest))(mu[:up])
    falling = jax.vmap(lambda m: ground_leg(medium.planet, altitude, m))(mu[up + limb :])
    join = partial(jax.tree.map, lambda *parts: jnp.concatenate(parts))
    if limb:
        down, out = jax.vmap(lambda m: limb_legs(medium.planet, altitude, m, farthest))(
            mu[up : up + limb]
        )
        rising, falling = join(rising, out), join(down, falling)
    start = jnp.maximum(falling.length - farthest, 0.0)
    column = jax.vmap(partial(column_along, medium))(falling, start, falling.length)
    leg = join(rising, falling)
    # Only the far leg of a limb ray is seen through another.
    none = jnp.zeros((up, column.shape[1]), column.dtype)
    offset = jnp.concatenate([none, column[:limb], jnp.zeros_like(column)])
    wide = jnp.concatenate([mu[: up + limb], mu[up:]])
    ray = Ray(jnp.broadcast_to(altitude, wide.shape), wide, safe_sqrt(1 - wide**2))
    starts = jnp.concatenate([jnp.zeros(up + limb, start.dtype), start])
    return Fan(ray, leg, starts, offset, column[limb:], up, limb)
