"""The first order: sunlight scattered once into the line of sight, or by the ground.

L₁ = E Σ_i p_i(γ) β_i ∫ ρ_i(s) exp(-τ_eye(s) - τ_sun(s)) ds + ground; the phase functions stay
outside since the angle γ to the sun is the same all along a straight ray.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..atmosphere import Atmosphere
from .geometry import AbstractPlanet, Ray, SunDirection
from .paths import Kind, Leg, SunColumns, column_along, legs, sample, sight


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


def first_order(
    atmosphere: Atmosphere,
    planet: AbstractPlanet,
    columns: SunColumns,
    ray: Ray,
    sun: SunDirection,
    *,
    kind: Kind,
    nodes: int,
    fine: int,
    split: bool,
) -> tuple[Float[Array, "species wavelength"], Float[Array, " wavelength"]]:
    """First-order light along one ray under one sun, per unit of solar irradiance.

    Args:
        atmosphere: What scatters and absorbs.
        planet: Its shape.
        columns: Towards the sun.
        ray: The line of sight, from inside the atmosphere.
        sun: As seen from the eye, in the frame of the ray.
        kind: Which legs the ray has.
        nodes: On each stretch, for light.
        fine: The same, for density.
        split: Cut the ray where it enters and leaves the planet's shadow. Without, nodes in the
            shadow are dark, and its edge is found only to their distance.

    Returns:
        What the phase functions multiply, scattering coefficient included [species, wavelength];
        radiance of the ground as it arrives [sr⁻¹].
    """
    extinction = atmosphere.extinction
    farthest, _ = sight(extinction)
    falling, rising, strikes = legs(planet, ray.altitude, ray.mu, farthest, kind)

    def light_from(leg: Leg, start, end, offset):
        """Light from one stretch; `offset` is the column from the eye to its nearer end."""
        path = sample(atmosphere, planet, leg, start, end, nodes, fine)
        to_eye = path.to_eye(leg, offset)
        here = planet.turn_sun(sun, ray, path.distance)
        light = sunlight_at(extinction, columns, path.altitude, here.up, to_eye)
        return jnp.einsum("ns,nw->sw", path.weight, light)

    def light_of(leg: Leg, start, offset):
        """Light from a whole leg, or from its lit stretches."""
        if not split:
            return light_from(leg, start, leg.length, offset)
        enter, leave = planet.shadow(sun, ray)
        sign = 1.0 if leg.rising else -1.0
        a, b = (jnp.clip(sign * (t - leg.low_distance), start, leg.length) for t in (enter, leave))
        low, high = jnp.minimum(a, b), jnp.maximum(a, b)
        if leg.rising:
            near = offset
            far = offset + column_along(atmosphere, planet, leg, start, high, fine)
        else:
            near = offset + column_along(atmosphere, planet, leg, low, leg.length, fine)
            far = offset
        return light_from(leg, start, low, near) + light_from(leg, high, leg.length, far)

    scattered = jnp.zeros_like(extinction)
    ground = jnp.zeros_like(extinction[0])
    before = jnp.zeros_like(extinction[:, 0])
    if falling is not None:
        start = jnp.maximum(falling.length - farthest, 0.0)
        scattered = scattered + light_of(falling, start, before)
        before = column_along(atmosphere, planet, falling, start, falling.length, fine)
        below = planet.turn_sun(sun, ray, falling.low_distance)
        light = sunlight_at(extinction, columns, jnp.zeros_like(ray.mu), below.up, before)
        reflected = atmosphere.ground_albedo / jnp.pi * jnp.maximum(below.up, 0.0) * light
        ground = jnp.where(strikes, reflected, 0.0)
    if rising is not None:
        scattered = scattered + light_of(rising, jnp.zeros_like(rising.length), before)
    return scattered * atmosphere.scattering, ground
