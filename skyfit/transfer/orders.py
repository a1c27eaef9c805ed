"""The second and higher orders: the field scatters, and is gathered along rays.

For a ray, wavelength-free geometry (which levels it crosses, at what angle, under which sun) and
spectral weights (transmittance, density) are separate factors; a gather is matrix products of the
two with the moments of the field.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .columns import SunColumns
from .fan import make_fan
from .field import Field, Grid, project
from .geometry import Ray, SunDirection
from .harmonics import cosines, legendre
from .medium import Medium
from .nodes import Path, sample
from .optics import Optics
from .paths import Leg
from .quadrature import safe_sqrt
from .quality import Quality
from .refraction import apparent
from .sight import Sight


class Source(eqx.Module):
    """What a field sends on, per unit of density: by constituent, and from the ground.

    Attributes:
        scattered: Of each constituent, harmonics of ∫ β p L dω [m⁻¹ sr⁻¹], up to its degree.
        ground: Radiance of the ground under each sun [sr⁻¹].
    """

    scattered: tuple[Float[Array, "level _m _l sun wavelength"], ...]
    ground: Float[Array, "sun wavelength"]

    def plus(self, other: "Source") -> "Source":
        """Both together; of one shape."""
        return jax.tree.map(jnp.add, self, other)


def scatter(optics: Optics, field: Field) -> Source:
    """Let a field be scattered once more, and reflected by the ground."""
    highest = field.moments.shape[2] - 1
    sources = []
    for harmonics in optics.harmonics:
        top = min(highest, harmonics.shape[0] - 1)
        norm = (2 * np.arange(top + 1)[:, None] + 1) / (4 * np.pi)
        strength = harmonics[: top + 1] * jnp.asarray(norm, field.moments.dtype)
        strength = strength[None, None, :, None, :]
        sources.append(strength * field.moments[:, : top + 1, : top + 1])
    ground = optics.ground_albedo[None, :] / np.pi * field.irradiance
    return Source(tuple(sources), ground)


def straight_beam(columns: SunColumns, grid: Grid, field: Field, times: int) -> Field:
    """Sunlight that went straight on, by forward peaks, so many times; shaped as another field."""
    optics = columns.medium.optics
    up, sine = jnp.cos(grid.sun_zenith), jnp.sin(grid.sun_zenith)
    high, ahead = grid.altitude[:, None], SunDirection(up[None], sine[None], 0 * sine[None])
    seen, spread = apparent(columns.medium.planet, ahead, high)
    column, lit = columns(high, seen.up)
    depth = column @ optics.straight
    share = jnp.exp(-column @ optics.extinction)
    for count in range(1, times + 1):
        share = share * depth / count
    share = jnp.where(lit[..., None], share, 0.0)
    share = share if spread is None else share * spread[..., None]
    modes, degrees = field.moments.shape[1:3]
    shape = legendre(degrees - 1, modes - 1, up, sine)
    ground = jnp.maximum(seen.up[0], 0.0)[:, None] * share[0]
    return Field(jnp.einsum("mls,ksw->kmlsw", shape, share), ground)


def send(
    medium: Medium,
    grid: Grid,
    source: Source,
    ray: Ray,
    leg: Leg,
    path: Path,
    offset: Float[Array, " species"],
    to_ground: Float[Array, " species"],
    strikes: Bool[Array, ""],
    sun: SunDirection,
) -> Float[Array, "*out wavelength"]:
    """Light that a source sends along one leg of a ray, under one or many suns.

    Args:
        medium: What the light crosses.
        grid: Where the source is known.
        source: See `scatter`.
        ray: The line of sight, from inside the atmosphere.
        leg: One of its legs.
        path: Nodes on it.
        offset: Column between the eye and the leg's nearer end [m].
        to_ground: Column between the eye and the ground [m].
        strikes: Whether the leg ends at the ground, which then shines through.
        sun: As seen from the eye, in the frame of the ray; any shape.

    Returns:
        Per unit of solar irradiance [sr⁻¹], in the shape of `sun`.
    """
    extinction = medium.optics.extinction
    order, degree = (max(part.shape[k] for part in source.scattered) - 1 for k in (1, 2))
    arriving = path.arriving(leg, offset, extinction)
    level = medium.level_at(path.altitude)
    crossing = leg.sign * medium.planet.mu_at_level(leg.altitude, leg.mu, grid.altitude)
    sine = medium.planet.sine_at_level(ray, grid.altitude)
    harmonics = legendre(degree, order, crossing, sine)
    levels, suns, wavelengths = crossing.size, *source.ground.shape
    sent = jnp.zeros((levels, order + 1, suns, wavelengths), arriving.dtype)
    weights = grid.between_levels(level, path.weight[:, :, None] * arriving[:, None])
    for number, part in enumerate(source.scattered):
        modes, degrees = part.shape[1:3]
        here = jnp.einsum("mlk,kmlsw->kmsw", harmonics[:modes, :degrees], part)
        sent = sent.at[:, :modes].add(weights[:, number, None, None, :] * here)
    through = jnp.where(strikes, jnp.exp(-to_ground @ extinction), 0.0)
    sent = sent.at[0, 0].add(through[None, :] * source.ground)
    turn = medium.planet.turn_sun
    for _ in sun.up.shape:
        turn = jax.vmap(turn, in_axes=(0, None, None))
    distance = leg.from_eye(medium.planet.to_level(leg.altitude, leg.mu, grid.altitude))
    there = turn(sun, ray, distance)
    modes = cosines(order, there.cos_azimuth())
    between = grid.between_suns(there.zenith())
    return jnp.einsum("m...k,...ks,kmsw->...w", modes, between, sent, optimize="optimal")


def gather(
    medium: Medium, grid: Grid, source: Source, ray: Ray, sun: SunDirection, sight: Sight
) -> Float[Array, "*out wavelength"]:
    """Light that a source sends along one line of sight; arguments as for `send`."""

    def along(leg, path, offset, to_ground, strikes):
        return send(medium, grid, source, ray, leg, path, offset, to_ground, strikes, sun)

    legs = sight.leg, sight.path, sight.offset, sight.to_ground, sight.strikes
    return jnp.sum(jax.vmap(along)(*legs), axis=0)


def next_field(medium: Medium, grid: Grid, source: Source, quality: Quality) -> Field:
    """The field that a source makes, at every level and sun."""
    suns = grid.sun_from()
    modes = cosines(quality.higher.modes, grid.cos_azimuth) / grid.cos_azimuth.size

    def at_level(level):
        altitude, mu, weight = level
        fan = make_fan(medium, altitude, mu, quality.higher)
        falls = fan.to_ground.shape[0]
        others = fan.offset.shape[0] - falls
        to_ground = jnp.concatenate([jnp.zeros_like(fan.offset[:others]), fan.to_ground])
        strikes = jnp.arange(others + falls) >= others

        def along(ray, leg, start, offset, column, strikes):
            path = sample(medium, leg, start, leg.length, quality.field_panels, quality.field_kinks)
            return send(medium, grid, source, ray, leg, path, offset, column, strikes, suns)

        light = jax.vmap(along)(fan.ray, fan.leg, fan.start, fan.offset, to_ground, strikes)
        light = fan.collect(light, jnp.zeros_like(light[:falls]))
        by_mode = jnp.einsum("ma,rasw->mrsw", modes, light)
        seen = legendre(quality.higher.degree, quality.higher.modes, mu, safe_sqrt(1 - mu**2))
        return project(mu, weight, by_mode, seen)

    levels = grid.altitude, grid.mu, grid.weight
    moments, irradiance = jax.lax.map(jax.checkpoint(at_level), levels)
    return Field(moments, irradiance[0])
