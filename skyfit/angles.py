"""Directions and the angles between them. Angles in radians.

Conventions, used everywhere in skyfit:

- `view_zenith`, `sun_zenith`: 0 straight up, π/2 at the horizon, beyond it below;
- `relative_azimuth`: view azimuth minus sun azimuth, 0 towards the sun, π away from it;
- `gamma`: angle between the view direction and the sun;
- unit vectors have z up.

Angles that are known and lie beyond any such angle, as degrees do, are refused; values that are
traced pass unseen, and NaN passes as what is missing.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._typing import ArrayLike, as_float, check, is_traced


# A difference of azimuths, one from -π to π and the other from 0 to 2π, is less than two turns.
_LARGEST_AZIMUTH = 4 * np.pi
_ROUNDING = 1e-6  # rad: π in float32 is beyond that in float64


def as_zenith(value: ArrayLike, argument: str) -> Float[Array, "..."]:
    """Convert a zenith angle, 0 to π [rad].

    Raises:
        InputError: A known value lies outside; the message starts with `argument`.
    """
    return _within(value, argument, 0.0, np.pi, "0 to π")


def as_view_zenith(value: ArrayLike, argument: str) -> Float[Array, "..."]:
    """Convert the zenith angle of a view, -π to π: below 0 it looks to the other side [rad].

    Raises:
        InputError: A known value lies outside; the message starts with `argument`.
    """
    return _within(value, argument, -np.pi, np.pi, "-π to π")


def as_azimuth(value: ArrayLike, argument: str) -> Float[Array, "..."]:
    """Convert an azimuth or a difference of two, of at most two turns [rad].

    Raises:
        InputError: A known value lies outside; the message starts with `argument`.
    """
    return _within(value, argument, -_LARGEST_AZIMUTH, _LARGEST_AZIMUTH, "-4π to 4π")


def as_sight(
    sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike, caller: str
) -> tuple[Float[Array, "..."], Float[Array, "..."], Float[Array, "..."]]:
    """Convert the three angles that a sky is asked for [rad].

    Raises:
        InputError: A known one lies outside its range; the message starts with `caller`.
    """
    return (
        as_zenith(sun_zenith, f"{caller}(sun_zenith=...)"),
        as_view_zenith(view_zenith, f"{caller}(view_zenith=...)"),
        as_azimuth(relative_azimuth, f"{caller}(relative_azimuth=...)"),
    )


def compass_azimuth(azimuth: ArrayLike) -> Float[Array, "..."]:
    """Compass azimuth, 0 north and π/2 east, of one counted from the south westward, in [0, 2π).

    Args:
        azimuth: As `skyfit.sun_position` and Preetham et al. (1999) count it [rad].
    """
    turned = jnp.mod(as_azimuth(azimuth, "compass_azimuth(azimuth=...)") + jnp.pi, 2 * jnp.pi)
    return jnp.where(turned < 2 * jnp.pi, turned, 0.0)  # a rounding error below 0 comes out as 2π


def azimuth_from_south(compass: ArrayLike) -> Float[Array, "..."]:
    """Azimuth from the south westward, in (-π, π]; the inverse of `compass_azimuth`.

    Args:
        compass: Azimuth of the compass, 0 north and π/2 east [rad].
    """
    angle = as_azimuth(compass, "azimuth_from_south(compass=...)")
    return jnp.pi - jnp.mod(-angle, 2 * jnp.pi)


def _within(value, argument, low, high, words):
    angle = as_float(value)
    if is_traced(angle):
        return angle
    message = f"{argument} must lie in {words} rad (not degrees)"
    return check(angle, lambda v: (v < low - _ROUNDING) | (v > high + _ROUNDING), message)


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
