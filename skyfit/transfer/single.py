"""The first order: sunlight scattered once into the line of sight, or by the ground.

L₁ = E Σ_i p_i(γ) β_i ∫ ρ_i(s) exp(-τ_eye(s) - τ_sun(s)) ds + ground; the phase functions stay
outside since the angle γ to the sun is the same all along a straight ray.
"""

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import Scalar
from .columns import SunColumns
from .geometry import Ray, SunDirection
from .medium import Medium
from .paths import Kind, Leg, both_legs, column_along, rising_leg, sample


def sunlight_at(
    extinction: Float[Array, "species wavelength"],
    columns: SunColumns,
    altitude: Float[Array, "*b"],
    mu: Float[Array, "*b"],
    eye_column: Float[Array, "*b species"],
) -> Float[Array, "*b wavelength"]:
    """Transmittance from the sun to a point, times that from the point to the eye."""
    sun_column, lit = columns(altitude, mu)
    light = jnp.exp(-(sun_column + eye_column) @ extinction)
    return jnp.where(lit[..., None], light, 0.0)


def along_leg(
    medium: Medium,
    columns: SunColumns,
    ray: Ray,
    leg: Leg,
    stretch: tuple[Scalar, Scalar],
    offset: Float[Array, " species"],
    sun: SunDirection,
    nodes: int,
) -> Float[Array, "species wavelength"]:
    """First-order light from a stretch of one leg of a ray, under one sun.

    Args:
        medium: What the light crosses.
        columns: Towards the sun.
        ray: The line of sight, from inside the atmosphere.
        leg: One of its legs.
        stretch: Distances of its ends from the leg's lowest point [m].
        offset: Column between the eye and the stretch's nearer end [m].
        sun: As seen from the eye, in the frame of the ray.
        nodes: On the stretch.

    Returns:
        What the phase functions multiply, scattering coefficient included; per unit irradiance.
    """
    path = sample(medium, leg, *stretch, nodes)
    here = medium.planet.turn_sun(sun, ray, path.distance)
    to_eye = path.to_eye(leg, offset)
    light = sunlight_at(medium.atmosphere.extinction, columns, path.altitude, here.up, to_eye)
    return (path.weight.T @ light) * medium.atmosphere.scattering


def from_ground(
    medium: Medium,
    columns: SunColumns,
    ray: Ray,
    distance: Scalar,
    to_ground: Float[Array, " species"],
    sun: SunDirection,
) -> Float[Array, " wavelength"]:
    """Radiance of the sunlit ground as it arrives, per unit of solar irradiance [sr⁻¹]."""
    below = medium.planet.turn_sun(sun, ray, distance)
    altitude = jnp.zeros_like(ray.mu)
    light = sunlight_at(medium.atmosphere.extinction, columns, altitude, below.up, to_ground)
    return medium.atmosphere.ground_albedo / jnp.pi * jnp.maximum(below.up, 0.0) * light


def first_order(
    medium: Medium,
    columns: SunColumns,
    ray: Ray,
    sun: SunDirection,
    *,
    kind: Kind,
    nodes: int,
    split: bool,
) -> tuple[Float[Array, "species wavelength"], Float[Array, " wavelength"]]:
    """First-order light along one line of sight under one sun, per unit of solar irradiance.

    Args:
        medium: What the light crosses.
        columns: Towards the sun.
        ray: The line of sight, from inside the atmosphere.
        sun: As seen from the eye, in the frame of the ray.
        kind: "rising" saves the legs of falling rays.
        nodes: On each stretch.
        split: Cut the ray where it enters and leaves the planet's shadow. Without, nodes in the
            shadow are dark, and its edge is found only to their distance.

    Returns:
        What the phase functions multiply, scattering coefficient included [species, wavelength];
        radiance of the ground as it arrives [sr⁻¹].
    """
    farthest, _ = medium.sight()

    def light_of(leg: Leg, start, offset):
        def light_from(low, high, column):
            return along_leg(medium, columns, ray, leg, (low, high), column, sun, nodes)

        if not split:
            return light_from(start, leg.length, offset)
        a, b = (
            jnp.clip(leg.sign * (t - leg.low_distance), start, leg.length)
            for t in medium.planet.shadow(sun, ray)
        )
        low, high = jnp.minimum(a, b), jnp.maximum(a, b)
        # The far stretch of a rising leg is seen through all below it; of a falling one, directly.
        starts, ends = jnp.stack([start, low]), jnp.stack([high, leg.length])
        inner, outer = jax.vmap(partial(column_along, medium, leg))(starts, ends)
        rises = leg.sign > 0
        near = offset + jnp.where(rises, 0.0, outer)
        far = offset + jnp.where(rises, inner, 0.0)
        # Both stretches go through one compiled program.
        starts, ends = jnp.stack([start, high]), jnp.stack([low, leg.length])
        return jnp.sum(jax.vmap(light_from)(starts, ends, jnp.stack([near, far])), axis=0)

    none = jnp.zeros_like(medium.atmosphere.extinction[:, 0])
    if kind == "rising":
        leg = rising_leg(medium.planet, ray.altitude, ray.mu, farthest)
        scattered = light_of(leg, jnp.zeros_like(leg.length), none)
        return scattered, jnp.zeros_like(scattered[0])
    both, start, before, strikes = both_legs(medium, ray, farthest)
    offset = jnp.stack([none, before])
    scattered = jnp.sum(jax.vmap(light_of)(both, start, offset), axis=0)
    ground = from_ground(medium, columns, ray, both.low_distance[0], before, sun)
    return scattered, jnp.where(strikes, ground, 0.0)
