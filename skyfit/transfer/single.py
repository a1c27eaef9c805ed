"""The first order: sunlight scattered once into the line of sight, or by the ground.

L₁ = E Σ_i p_i(γ) β_i ∫ ρ_i(s) exp(-τ_eye(s) - τ_sun(s)) ds + ground; the phase functions stay
outside since the angle γ to the sun is the same all along a straight ray.
"""

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .._typing import Scalar
from .columns import SunColumns
from .geometry import Ray, SunDirection
from .medium import Medium
from .nodes import Path, sample
from .optics import Optics
from .paths import Leg, column_along
from .refraction import apparent, cos_at_start, cos_to_sun
from .sight import Sight


_DARK = 700.0  # optical depth that stands for the planet's shadow
_BLACK_COLUMN, _LEAST = 1e30, 1e-25  # m and 1/m: their product is dark, the second alone nothing


def sunlight_at(
    columns: SunColumns,
    altitude: Float[Array, "*#b"],
    mu: Float[Array, "*#b"],
    eye_column: Float[Array, "*#b species"],
) -> tuple[Float[Array, "*b channel"], Float[Array, "*b species"]]:
    """Transmittance from the sun to a point times that from there to the eye; and the column."""
    return sunlight(columns.medium.optics, *columns(altitude, mu), eye_column)


def sunlight(
    optics: Optics,
    sun_column: Float[Array, "*#b species"],
    lit: Bool[Array, "*#b"],
    eye_column: Float[Array, "*#b species"],
) -> tuple[Float[Array, "*b channel"], Float[Array, "*b species"]]:
    """The same where the column towards the sun is known."""
    # The shadow is a column that no light passes, not even where nothing dims it; a mask after the
    # product with the spectrum would cost as much as the exponential.
    column = jnp.where(lit[..., None], sun_column + eye_column, _BLACK_COLUMN)
    return jnp.exp(-(column @ (optics.extinction + _LEAST))), column


def dimming(columns: SunColumns, ray: Ray, suns: SunDirection):
    """How deep in the shade of the air points of a ray lie, under each sun; see `sample`."""

    def depth(altitude, distance):
        def under(sun):
            here = columns.medium.planet.turn_sun(sun, ray, distance)
            seen, _ = apparent(columns.medium.planet, here, altitude)
            column, lit = columns(altitude, seen.up)
            return jnp.where(lit[:, None], column @ columns.medium.telling.T, _DARK)

        return jax.vmap(under, out_axes=1)(suns)

    return depth


def along_path(
    columns: SunColumns,
    ray: Ray,
    leg: Leg,
    path: Path,
    offset: Float[Array, " species"],
    sun: SunDirection,
    orders: int = 2,
    follow: bool = True,
) -> Float[Array, "{orders} species *sun channel"]:
    """Sunlight that nodes on one leg of a ray would send to the eye.

    Args:
        columns: Towards the sun.
        ray: The line of sight, from inside the atmosphere.
        leg: One of its legs.
        path: Nodes on a stretch of it.
        offset: Column between the eye and the stretch's nearer end [m].
        sun: As seen from the eye, in the frame of the ray; one or many, any shape.
        orders: 1 or 2.
        follow: Where light is bent, let phase functions change along the ray: they are relative to
            their value at its start.

    Returns:
        What phase functions times scattering coefficients multiply, per unit irradiance [m]: in
        the first order; and in the second, what went straight on once before or after.
    """
    optics = columns.medium.optics
    wide = (-1,) + (1,) * sun.up.ndim
    along = jax.tree.map(lambda a: a[None], sun)
    planet, altitude = columns.medium.planet, path.altitude.reshape(wide)
    here = planet.turn_sun(along, ray, path.distance.reshape(wide))
    seen, spread = apparent(planet, here, altitude)
    to_eye = path.to_eye(leg, offset).reshape(*path.distance.shape, *wide[1:], -1)
    light, column = sunlight_at(columns, altitude, seen.up, to_eye)
    light = light if spread is None else light * spread[..., None]
    # One product of matrices for all suns: [species, node] @ [node, sun · channel].
    kinds = (
        [light] if orders == 1 else [light, light * jnp.minimum(column @ optics.straight, _DARK)]
    )
    if spread is not None and follow:
        phases = _phases_along(columns.medium, ray, path.distance.reshape(wide), seen, sun)
        lit = [jnp.stack(kinds) * phase[None] for phase in phases]
        return jnp.stack(
            [
                jnp.einsum("n,kn...->k...", w, one)
                for w, one in zip(path.weight.T, lit, strict=True)
            ],
            axis=1,
        )
    flat = [path.weight.T @ kind.reshape(path.distance.size, -1) for kind in kinds]
    return jnp.stack([one.reshape(-1, *light.shape[1:]) for one in flat])


def _phases_along(medium: Medium, ray: Ray, distance, seen: SunDirection, sun: SunDirection):
    """Phase functions where a bent ray meets bent sunlight, relative to those at its start."""
    planet, channels = medium.planet, medium.optics.extinction.shape[1]
    altitude, mu = planet.advance(ray.altitude, ray.mu, distance)
    cosine = cos_to_sun(mu, planet.sine_at_level(ray, altitude), seen)
    first = cos_at_start(planet, ray, sun)
    for one in medium.atmosphere.constituents:
        here, there = one.phase.spectral(cosine), one.phase.spectral(first)[None]
        ratio = jnp.where(there > 0, here, 1.0) / jnp.where(there > 0, there, 1.0)
        # As many copies of the spectrum as there are channels to a wavelength.
        copies = channels // ratio.shape[-1] if ratio.shape[-1] > 1 else 1
        yield jnp.concatenate([ratio] * copies, axis=-1)


def from_ground(
    columns: SunColumns,
    ray: Ray,
    distance: Scalar,
    to_ground: Float[Array, " species"],
    sun: SunDirection,
) -> Float[Array, "order channel"]:
    """Radiance of the sunlit ground as it arrives, per unit of solar irradiance [sr⁻¹].

    As a first order; and as a second, what went straight on once before or after.
    """
    optics = columns.medium.optics
    planet, altitude = columns.medium.planet, jnp.zeros_like(ray.mu)
    below, spread = apparent(planet, planet.turn_sun(sun, ray, distance), altitude)
    light, column = sunlight(optics, *columns.at_ground(below.up), to_ground)
    light = light if spread is None else light * spread
    light = optics.ground_albedo / jnp.pi * jnp.maximum(below.up, 0.0) * light
    return jnp.stack([light, light * jnp.minimum(column @ optics.straight, _DARK)])


def first_order(
    medium: Medium,
    columns: SunColumns,
    ray: Ray,
    suns: SunDirection,
    sight: Sight,
    *,
    panels: int,
    kinks: int,
    split: bool,
) -> tuple[Float[Array, "sun order species channel"], Float[Array, "sun order channel"]]:
    """First-order light along one line of sight under several suns, per unit of solar irradiance.

    Args:
        medium: What the light crosses.
        columns: Towards the sun.
        ray: The line of sight, from inside the atmosphere.
        suns: As seen from the eye, in the frame of the ray.
        sight: Legs of the line of sight.
        panels: Number of panels of nodes on each stretch.
        kinks: So many are ends of panels besides.
        split: Cut the ray where it enters and leaves the planet's shadow of each sun. Without, all
            suns share the nodes of `sight`, and those in the shadow are dark.

    Returns:
        What phase functions times scattering coefficients multiply [m]; radiance of the ground as
        it arrives [sr⁻¹]. Of either the first order, and of the second what went straight on
        once.
    """

    def split_light(leg: Leg, start, offset, sun: SunDirection):
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

        alone = jax.tree.map(lambda a: a[None], sun)

        def light_from(low, high, column):
            path = sample(medium, leg, low, high, panels, kinks, dimming(columns, ray, alone))
            return along_path(columns, ray, leg, path, column, sun)

        # Both stretches go through one compiled program.
        starts, ends = jnp.stack([start, high]), jnp.stack([low, leg.length])
        return jnp.sum(jax.vmap(light_from)(starts, ends, jnp.stack([near, far])), axis=0)

    leg = sight.leg
    if split:

        def light_of(leg: Leg, start, offset):
            return jax.vmap(partial(split_light, leg, start, offset))(suns)

        light = jax.vmap(light_of)(leg, sight.start, sight.offset)
    else:

        def light_along(leg: Leg, path: Path, offset):
            return along_path(columns, ray, leg, path, offset, suns)

        light = jnp.moveaxis(jax.vmap(light_along)(leg, sight.path, sight.offset), 3, 1)
    scattered = jnp.sum(light, axis=0)
    if leg.length.size == 1:
        return scattered, jnp.zeros_like(scattered[:, :, 0])
    under = partial(from_ground, columns, ray, leg.low_distance[0], sight.to_ground[0])
    return scattered, jnp.where(sight.strikes[0], jax.vmap(under)(suns), 0.0)
