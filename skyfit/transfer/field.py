"""The light field between the levels of an atmosphere, and its first order.

The field of one order is kept as spherical-harmonic moments at a few altitudes (levels) under a
few zenith angles of the sun: along a line of sight the vertical turns, and with it the sun.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .columns import SunColumns
from .fan import make_fan
from .geometry import Flat, SunDirection
from .harmonics import cosines, legendre
from .medium import Medium
from .quadrature import gauss, safe_sqrt
from .quality import Directions, Quality
from .single import along_leg, from_ground


_LEVEL_GROWTH = 5.0  # levels at (e^{5x} - 1)/(e⁵ - 1) of the top: 160 m to 12 km apart under 60 km


class Grid(eqx.Module):
    """Where the field is kept, and the directions over which it is summed.

    Attributes:
        altitude: Of the levels [m].
        sun_zenith: Of the suns, increasing [rad].
        mu: Zenith cosines of directions at each level: rising first, then limb, then falling.
        weight: Of each direction; over a level and 2π of azimuth they sum to 4π.
        cos_azimuth: Azimuths in half a turn, equally weighted.
    """

    altitude: Float[Array, " level"]
    sun_zenith: Float[Array, " sun"]
    mu: Float[Array, "level ray"]
    weight: Float[Array, "level ray"]
    cos_azimuth: Float[Array, " azimuth"]

    def sun_from(self) -> SunDirection:
        """Directions of the suns in the frame of each azimuth; [azimuth, sun]."""
        zenith, cosine = jnp.broadcast_arrays(self.sun_zenith[None, :], self.cos_azimuth[:, None])
        return SunDirection.from_angles(zenith, cosine)


class Field(eqx.Module):
    """Light of one order, per unit of solar irradiance [sr⁻¹].

    Attributes:
        moments: ∫ P̄_lm(μ) cos(mφ) L dω at each level and sun.
        irradiance: Downwards, on the ground, under each sun [1].
    """

    moments: Float[Array, "level m l sun wavelength"]
    irradiance: Float[Array, "sun wavelength"]

    def up_to(self, directions: Directions) -> "Field":
        """The same without the harmonics beyond what some directions resolve."""
        modes, degree = directions.modes, directions.degree
        return Field(self.moments[:, : modes + 1, : degree + 1], self.irradiance)


def make_grid(
    medium: Medium, sun_zenith: Float[Array, " sun"], levels: int, directions: Directions
) -> Grid:
    """Lay out levels and directions for a planet and the suns' zenith angles [rad]."""
    x = np.linspace(0, 1, levels)
    share = np.expm1(_LEVEL_GROWTH * x) / np.expm1(_LEVEL_GROWTH)
    altitude = medium.planet.top * jnp.asarray(share, medium.planet.top.dtype)
    horizon = medium.planet.horizon(altitude)[:, None]
    horizon = jnp.where(altitude[:, None] > 0, horizon, 0.0)

    def panel(count, start, end):
        nodes, weights = (jnp.asarray(a, altitude.dtype)[None, :] for a in gauss(count))
        return start + (end - start) * nodes, (end - start) * weights

    panels = [panel(directions.up, 0 * horizon, 1.0 + 0 * horizon)]
    if not isinstance(medium.planet, Flat):
        panels.append(panel(directions.limb, horizon, 0 * horizon))
    # Just below the horizon the air in front of the ground thins out: nodes crowd there.
    x, w = (jnp.asarray(a, altitude.dtype)[None, :] for a in gauss(directions.down))
    depth = 1 + horizon
    panels.append((horizon - depth * x**2, depth * 2 * x * w))
    mu, weight = (jnp.concatenate(parts, axis=1) for parts in zip(*panels, strict=True))
    azimuth = np.pi * (np.arange(directions.azimuths) + 0.5) / directions.azimuths
    cos_azimuth = jnp.asarray(np.cos(azimuth), altitude.dtype)
    return Grid(altitude, sun_zenith, mu, 2 * np.pi * weight, cos_azimuth)


def project(
    grid: Grid,
    mu: Float[Array, " ray"],
    weight: Float[Array, " ray"],
    light: Float[Array, "ray azimuth sun wavelength"],
    directions: Directions,
) -> tuple[Float[Array, "m l sun wavelength"], Float[Array, "sun wavelength"]]:
    """Moments of the light at one level, and its downward irradiance."""
    count = grid.cos_azimuth.shape[0]
    degree, order = directions.degree, directions.modes
    modes = cosines(order, grid.cos_azimuth) / count
    by_mode = jnp.einsum("ma,rasw->mrsw", modes, light)
    polynomials = legendre(degree, order, mu, safe_sqrt(1 - mu**2)) * weight[None, None, :]
    moments = jnp.einsum("mlr,mrsw->mlsw", polynomials, by_mode)
    downward = weight * jnp.maximum(mu, 0.0)
    return moments, jnp.einsum("r,rsw->sw", downward, by_mode[0])


def first_field(
    medium: Medium,
    columns: SunColumns,
    grid: Grid,
    quality: Quality,
) -> Field:
    """The first order at every level: sunlight scattered once, and lit ground."""
    nodes, spread = _azimuth_rule(quality, isinstance(medium.planet, Flat))
    cos_nodes = jnp.asarray(nodes, grid.mu.dtype)
    spread = jnp.asarray(spread, grid.mu.dtype)
    zenith, cosine = jnp.broadcast_arrays(grid.sun_zenith[None, :], cos_nodes[:, None])
    node_suns = SunDirection.from_angles(zenith, cosine)
    suns = grid.sun_from()

    def at_level(level):
        altitude, mu, weight = level
        fan = make_fan(medium, altitude, mu, quality.first)

        def along(ray, leg, start, offset):
            def under(sun):
                return along_leg(
                    medium, columns, ray, leg, (start, leg.length), offset, sun,
                    quality.field_nodes,
                )  # fmt: skip

            return jax.vmap(jax.vmap(under))(node_suns)

        def ground_along(ray, leg, to_ground):
            def under(sun):
                return from_ground(medium, columns, ray, leg.low_distance, to_ground, sun)

            return jax.vmap(jax.vmap(under))(node_suns)

        strength = jax.vmap(along)(fan.ray, fan.leg, fan.start, fan.offset)
        lit_ground = jax.vmap(ground_along)(*fan.falling(), fan.to_ground)
        # [ray, node, sun, species, wavelength]
        strength = fan.collect(strength, jnp.zeros_like(strength[: lit_ground.shape[0]]))
        rays = jnp.zeros((fan.up + fan.limb, *lit_ground.shape[1:]), lit_ground.dtype)
        ground = jnp.concatenate([rays, lit_ground])
        sine = safe_sqrt(1 - mu**2)[:, None, None]
        cos_gamma = mu[:, None, None] * suns.up[None] + sine * suns.ahead[None]
        light = jnp.einsum("an,rnsw->rasw", spread, ground)
        for number, one in enumerate(medium.atmosphere.constituents):
            here = jnp.einsum("an,rnsw->rasw", spread, strength[..., number, :])
            light = light + one.phase.spectral(cos_gamma) * here
        return project(grid, mu, weight, light, quality.first)

    levels = grid.altitude, grid.mu, grid.weight
    moments, irradiance = jax.lax.map(jax.checkpoint(at_level), levels)
    return Field(moments, irradiance[0])


def _azimuth_rule(quality: Quality, flat: bool) -> tuple[np.ndarray, np.ndarray]:
    """Cosines of azimuth at which to integrate, and their weights for all azimuths.

    Along a ray over a flat planet sunlight does not depend on azimuth; over a sphere only through
    the turning vertical, so that a polynomial in cos φ through a few nodes follows it.
    """
    azimuths = quality.first.azimuths
    azimuth = np.pi * (np.arange(azimuths) + 0.5) / azimuths
    if flat:
        return np.ones(1), np.ones((azimuths, 1))
    count = quality.sun_azimuths
    nodes = np.cos(np.pi * np.arange(count) / (count - 1))
    powers = np.polynomial.chebyshev.chebvander(nodes, count - 1)
    wanted = np.polynomial.chebyshev.chebvander(np.cos(azimuth), count - 1)
    return nodes, wanted @ np.linalg.inv(powers)
