"""Directions and the angles between them. Angles in radians.

Conventions, used everywhere in skyfit:

- `view_zenith`, `sun_zenith`: 0 straight up, π/2 at the horizon, beyond it below;
- `relative_azimuth`: view azimuth minus sun azimuth, 0 towards the sun, π away from it;
- `gamma`: angle between the view direction and the sun;
- unit vectors have z up.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float


def view_sun_angle(
    view_zenith: Float[Array, "*#batch"],
    sun_zenith: Float[Array, "*#batch"],
    relative_azimuth: Float[Array, "*#batch"],
) -> Float[Array, "*batch"]:
    """Angle γ between a view direction and the sun.

    The haversine form: `arccos` of the dot product loses every digit below 0.02° in float32 and
    has an infinite derivative at γ = 0.

    Args:
        view_zenith: Zenith angle of the view direction [rad].
        sun_zenith: Zenith angle of the sun [rad].
        relative_azimuth: View azimuth minus sun azimuth [rad].

    Returns:
        γ in [0, π] [rad]. Its derivative at γ = 0 and γ = π, the apexes of a cone, is taken as 0.
    """
    h = (
        jnp.sin((view_zenith - sun_zenith) / 2) ** 2
        + jnp.sin(view_zenith) * jnp.sin(sun_zenith) * jnp.sin(relative_azimuth / 2) ** 2
    )
    inside = (h > 0) & (h < 1)
    root = jnp.sqrt(jnp.where(inside, h, 0.5))
    gamma = 2 * jnp.arcsin(jnp.minimum(root, 1.0))
    return jnp.where(inside, gamma, jnp.where(h <= 0, 0.0, jnp.pi))


def cos_view_sun_angle(
    view_zenith: Float[Array, "*#batch"],
    sun_zenith: Float[Array, "*#batch"],
    relative_azimuth: Float[Array, "*#batch"],
) -> Float[Array, "*batch"]:
    """Cosine of the angle between view and sun, smooth everywhere; see `view_sun_angle`."""
    return jnp.cos(view_zenith) * jnp.cos(sun_zenith) + jnp.sin(view_zenith) * jnp.sin(
        sun_zenith
    ) * jnp.cos(relative_azimuth)


def unit_vector(
    zenith: Float[Array, "*#batch"], azimuth: Float[Array, "*#batch"]
) -> Float[Array, "*batch 3"]:
    """Unit vector of a direction: x at azimuth 0, y at azimuth π/2, z up."""
    zenith, azimuth = jnp.broadcast_arrays(zenith, azimuth)
    sine = jnp.sin(zenith)
    return jnp.stack([sine * jnp.cos(azimuth), sine * jnp.sin(azimuth), jnp.cos(zenith)], axis=-1)
