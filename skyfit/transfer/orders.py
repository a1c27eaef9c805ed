"""The second and higher orders: the field scatters, and is gathered along rays.

For a ray, wavelength-free geometry (which levels it crosses, at what angle, under which sun) and
spectral weights (transmittance, density) are separate factors; a gather is matrix products of the
two with the moments of the field.
"""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..atmosphere import Atmosphere
from .field import Field, Grid, panels, project
from .geometry import AbstractPlanet, Ray, SunDirection
from .harmonics import cosines, legendre
from .paths import Kind, Leg, legs, sample, sight
from .quadrature import lagrange_weights, safe_sqrt
from .quality import Quality


class Source(eqx.Module):
    """What a field sends on, per unit of density: by constituent, and from the ground.

    Attributes:
        scattered: For each constituent, harmonics of ∫ β p L dω [m⁻¹ sr⁻¹], up to its degree.
        ground: Radiance of the ground under each sun [sr⁻¹].
    """

    scattered: tuple[Float[Array, "level m l sun wavelength"], ...]
    ground: Float[Array, "sun wavelength"]


def scatter(atmosphere: Atmosphere, field: Field) -> Source:
    """Let a field be scattered once more, and reflected by the ground."""
    degree = field.moments.shape[2] - 1
    sources = []
    for one in atmosphere.constituents:
        highest = one.phase.max_degree
        top = degree if highest is None else min(degree, highest)
        l = np.arange(top + 1)[:, None]
        chi = one.phase.legendre(top) * jnp.asarray((2 * l + 1) / (4 * np.pi), field.moments.dtype)
        strength = (chi * one.scattering[None, :])[None, None, :, None, :]
        sources.append(strength * field.moments[:, : top + 1, : top + 1])
    ground = atmosphere.ground_albedo[None, :] / np.pi * field.irradiance
    return Source(tuple(sources), ground)


def gather(
    atmosphere: Atmosphere,
    planet: AbstractPlanet,
    grid: Grid,
    source: Source,
    ray: Ray,
    sun: SunDirection,
    *,
    kind: Kind,
    quality: Quality,
) -> Float[Array, "*out wavelength"]:
    """Light that a source sends along one ray, under one or many suns.

    Args:
        atmosphere: What attenuates on the way.
        planet: Its shape.
        grid: Where the source is known.
        source: See `scatter`.
        ray: The line of sight, from inside the atmosphere.
        sun: As seen from the eye, in the frame of the ray; any shape.
        kind: Which legs the ray has.
        quality: Sizes.

    Returns:
        Per unit of solar irradiance [sr⁻¹], in the shape of `sun`.
    """
    extinction = atmosphere.extinction
    farthest, _ = sight(extinction)
    falling, rising, strikes = legs(planet, ray.altitude, ray.mu, farthest, kind)
    order = max(part.shape[1] for part in source.scattered) - 1

    turn = planet.turn_sun
    for _ in sun.up.shape:
        turn = jax.vmap(turn, in_axes=(0, None, None))

    def from_leg(leg: Leg, start, offset, ground):
        path = sample(
            atmosphere, planet, leg, start, leg.length, quality.field_nodes, quality.density_nodes
        )
        to_eye = path.to_eye(leg, offset)
        arriving = jnp.exp(-to_eye @ extinction)
        near = lagrange_weights(grid.altitude, path.altitude)
        sign = 1.0 if leg.rising else -1.0
        crossing = sign * planet.mu_at_level(leg.altitude, leg.mu, grid.altitude)
        distance = leg.from_eye(planet.to_level(leg.altitude, leg.mu, grid.altitude))
        harmonics = legendre(order, order, crossing, planet.sine_at_level(ray, grid.altitude))
        sent = jnp.zeros((*harmonics.shape[::2], *source.ground.shape), arriving.dtype)
        sent = jnp.moveaxis(sent, 1, 0)  # [level, m, sun, wavelength]
        for number, part in enumerate(source.scattered):
            weight = jnp.einsum("n,nw,nk->kw", path.weight[:, number], arriving, near)
            top = part.shape[1]
            here = jnp.einsum("mlk,kmlsw->kmsw", harmonics[:top, :top], part)
            sent = sent.at[:, :top].add(weight[:, None, None, :] * here)
        if ground is not None:
            sent = sent.at[0, 0].add(ground[None, :] * source.ground)
        there = turn(sun, ray, distance)
        modes = cosines(order, there.cos_azimuth())
        between = lagrange_weights(grid.sun_zenith, there.zenith())
        return jnp.einsum("m...k,...ks,kmsw->...w", modes, between, sent, optimize="optimal")

    light = 0.0
    before = jnp.zeros_like(extinction[:, 0])
    if falling is not None:
        start = jnp.maximum(falling.length - farthest, 0.0)
        whole = sample(
            atmosphere, planet, falling, start, falling.length, 2, quality.density_nodes
        ).total
        ground = jnp.where(strikes, jnp.exp(-whole @ extinction), 0.0)
        light = from_leg(falling, start, before, ground)
        before = whole
    if rising is not None:
        light = light + from_leg(rising, jnp.zeros_like(rising.length), before, None)
    return light


def next_field(
    atmosphere: Atmosphere, planet: AbstractPlanet, grid: Grid, field: Field, quality: Quality
) -> Field:
    """The field of the next order, at every level and sun."""
    source = scatter(atmosphere, field)
    suns = grid.sun_from()

    def at_level(level):
        altitude, mu, weight = level

        def along(kind, ray_mu):
            ray = Ray(altitude, ray_mu, safe_sqrt(1 - ray_mu**2))
            return gather(atmosphere, planet, grid, source, ray, suns, kind=kind, quality=quality)

        light = [
            jax.vmap(partial(along, kind))(mu[part]) for kind, part in panels(planet, quality)
        ]
        return project(grid, mu, weight, jnp.concatenate(light), quality.degree)

    moments, irradiance = jax.lax.map(at_level, (grid.altitude, grid.mu, grid.weight))
    return Field(moments, irradiance[0])

