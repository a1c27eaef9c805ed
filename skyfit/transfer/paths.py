"""Density along rays, and the columns that attenuate light on the way.

A column is ∫ρ ds for each constituent [m at relative density 1]: it knows neither wavelength nor
amount, so one set serves every spectrum and turbidity.

A ray is cut at its lowest point into a falling leg, towards the eye's side, and a rising leg
beyond; distances on a leg are counted outwards from that point, where the air is densest and the
nodes lie closest.
"""

from functools import partial
from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .._typing import Scalar
from .geometry import AbstractPlanet, Ray
from .medium import Medium
from .quadrature import gauss


Kind = Literal["rising", "any"]
"""Lines of sight that all rise, or that go anywhere: known before compiling."""


class Leg(eqx.Module):
    """Part of a ray on one side of its lowest point.

    Attributes:
        altitude: Altitude of the lowest point [m].
        mu: Cosine of the zenith angle there, looking along the leg, 0 or more.
        length: From the lowest point to the end [m]; 0 if the ray has no such leg.
        low_distance: From the eye to the lowest point [m].
        sign: 1 if the leg leads away from the eye, -1 if towards it.
    """

    altitude: Scalar
    mu: Scalar
    length: Scalar
    low_distance: Scalar
    sign: Scalar

    def from_eye(self, outwards: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """Distance from the eye to points at distances from the lowest point [m]."""
        return self.low_distance + self.sign * outwards


def rising_leg(planet: AbstractPlanet, altitude: Scalar, mu: Scalar, farthest: Scalar) -> Leg:
    """The one leg of a ray that rises from the eye, no longer than `farthest` [m]."""
    none = jnp.zeros_like(altitude)
    length = jnp.minimum(planet.to_top(altitude, mu), farthest)
    return Leg(altitude, mu, length, none, none + 1)


def ground_leg(planet: AbstractPlanet, altitude: Scalar, mu: Scalar) -> Leg:
    """The one leg of a ray that falls from the eye to the ground."""
    none = jnp.zeros_like(altitude)
    distance = planet.to_ground(altitude, mu)
    return Leg(none, planet.mu_at_level(altitude, mu, none), distance, distance, none - 1)


def limb_legs(
    planet: AbstractPlanet, altitude: Scalar, mu: Scalar, farthest: Scalar
) -> tuple[Leg, Leg]:
    """The falling and the rising leg of a ray that misses the ground."""
    none = jnp.zeros_like(altitude)
    distance, low = planet.lowest(altitude, mu)
    falling = Leg(low, none, distance, distance, none - 1)
    length = jnp.minimum(planet.to_top(low, none), farthest)
    return falling, Leg(low, none, length, distance, none + 1)


def legs(
    planet: AbstractPlanet, altitude: Scalar, mu: Scalar, farthest: Scalar
) -> tuple[Leg, Leg, Bool[Array, ""]]:
    """Cut any ray at its lowest point.

    Args:
        planet: Shape of the planet.
        altitude: Altitude of the eye, inside the atmosphere [m].
        mu: Cosine of the ray's zenith angle at the eye.
        farthest: No rising leg is longer [m]; see `Medium.sight`.

    Returns:
        The falling leg, the rising leg (of length 0 where there is none), and whether the ray ends
        at the ground.
    """
    none = jnp.zeros_like(altitude)
    falls, strikes = mu < 0, mu < planet.horizon(altitude)
    # Each kind of ray is computed from a direction it can have, then chosen.
    straight = ground_leg(planet, altitude, jnp.where(strikes, mu, -1.0))
    grazing = jnp.where(strikes, planet.horizon(altitude), jnp.minimum(mu, 0.0))
    down, out = limb_legs(planet, altitude, grazing, farthest)
    up = rising_leg(planet, altitude, jnp.maximum(mu, 0.0), farthest)
    absent = Leg(altitude, none, none, none, none - 1)

    def choose(condition, yes, no):
        return jax.tree.map(partial(jnp.where, condition), yes, no)

    falling = choose(strikes, straight, choose(falls, down, absent))
    rising = choose(falls, out, up)
    return (
        falling,
        eqx.tree_at(lambda leg: leg.length, rising, jnp.where(strikes, 0.0, rising.length)),
        strikes,
    )


def column_along(medium: Medium, leg: Leg, start: Scalar, end: Scalar) -> Float[Array, " species"]:
    """Column between two distances from a leg's lowest point [m]."""
    at = jnp.clip(medium.planet.to_level(leg.altitude, leg.mu, medium.edges), start, end)
    return jnp.sum(columns_in_shells(medium, leg, at), axis=0)


def columns_in_shells(
    medium: Medium, leg: Leg, at: Float[Array, " edge"]
) -> Float[Array, "shell species"]:
    """Columns along a leg between where it crosses neighbouring edges [m]."""
    planet, edges = medium.planet, medium.edges
    depth = jnp.diff(edges)
    low, width = at[:-1], jnp.diff(at)
    x, weights = (jnp.asarray(a, edges.dtype)[:, None] for a in gauss(3))
    altitude = planet.advance(leg.altitude, leg.mu, low[None] + x * width[None])[0]
    share = (altitude - edges[None, :-1]) / jnp.where(depth > 0, depth, 1.0)[None]
    # Rounding may lead a little out of a shell. Shells last: long vectors.
    density = medium.density_in_shells(jnp.clip(share, 0.0, 1.0))
    total = jnp.sum(weights[None] * density, axis=1) * width[None]
    return jnp.maximum(total, 0.0).T


def both_legs(
    medium: Medium, ray: Ray, farthest: Scalar
) -> tuple[Leg, Float[Array, " 2"], Float[Array, " species"], Bool[Array, ""]]:
    """The legs of any ray side by side, to go through one compiled program.

    Args:
        medium: What the ray crosses.
        ray: From inside the atmosphere.
        farthest: No leg is looked at from farther [m]; see `Medium.sight`.

    Returns:
        The falling and the rising leg; where each begins to matter, from its lowest point [m]; the
        column along the falling one [m]; whether it ends at the ground.
    """
    falling, rising, strikes = legs(medium.planet, ray.altitude, ray.mu, farthest)
    start = jnp.maximum(falling.length - farthest, 0.0)
    column = column_along(medium, falling, start, falling.length)
    both = jax.tree.map(lambda *parts: jnp.stack(parts), falling, rising)
    return both, jnp.stack([start, jnp.zeros_like(start)]), column, strikes
