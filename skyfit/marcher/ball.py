"""Points and rays near a sphere, in coordinates that keep their digits in float32.

The origin lies on the ground under the camera, z up: a point's distance from the planet's centre is
never formed, only its height above the ground.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import Scalar
from ..transfer.quadrature import safe_sqrt


def height(radius: Scalar, point: Float[Array, "*batch 3"]) -> Float[Array, "*batch"]:
    """Height above the ground [m]: √(x² + y² + (R + z)²) - R without cancelling."""
    excess = jnp.sum(point**2, axis=-1) + 2 * radius * point[..., 2]
    return excess / (safe_sqrt(radius**2 + excess) + radius)


def up_cosine(
    radius: Scalar, point: Float[Array, "*batch 3"], direction: Float[Array, " 3"]
) -> Float[Array, "*batch"]:
    """Cosine between a direction and the vertical of a point."""
    along = point @ direction + radius * direction[2]
    return along / (height(radius, point) + radius)


def crossings(
    radius: Scalar,
    altitude: Scalar,
    point: Float[Array, " 3"],
    direction: Float[Array, " 3"],
) -> tuple[Scalar, Scalar]:
    """Distances at which a ray crosses the sphere of an altitude, the nearer first [m].

    Both are infinite where it does not; negative behind the point.
    """
    towards = jnp.sum(point * direction) + radius * direction[2]
    outside = jnp.sum(point**2) + 2 * radius * point[2] - altitude * (2 * radius + altitude)
    discriminant = towards**2 - outside
    root = safe_sqrt(discriminant)
    # The larger root in size first; the other from the product of both, which does not cancel.
    large = -towards - jnp.where(towards > 0, root, -root)
    small = outside / jnp.where(large == 0, 1.0, large)
    near, far = jnp.minimum(small, large), jnp.maximum(small, large)
    meets = discriminant > 0
    return jnp.where(meets, near, jnp.inf), jnp.where(meets, far, jnp.inf)
