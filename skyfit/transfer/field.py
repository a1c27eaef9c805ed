"""The light field between the levels of an atmosphere, and its first order.

The field of one order is kept as spherical-harmonic moments at a few altitudes (levels) under a
few zenith angles of the sun: along a line of sight the vertical turns, and with it the sun.
"""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .._typing import Scalar
from .columns import SunColumns
from .fan import make_fan
from .geometry import Flat, SunDirection
from .harmonics import legendre
from .levels import place_levels, stencils
from .medium import Medium
from .nodes import sample
from .quadrature import gauss, lagrange_weights, safe_sqrt
from .quality import Directions, Quality
from .refraction import apparent
from .single import along_path, dimming, from_ground


_SWING = 2.2  # sum of sizes of cubic weights between levels, at most; 1.6 where they are even
# Optical depths between levels: through more than these light falls by more than a cubic follows,
# and there it is interpolated ever less by one and more by a straight line.
_THIN, _THICK = 1.0, 2.0
# The logarithm of light falls by this at most while the sun sinks [rad⁻¹]: light of higher orders
# holds on. Through a steeper fall suns far down would tell those above them more than they know,
# and each order would outgrow the one before it: measured with 97, not with 80.
_STEEPEST = 60.0


class Grid(eqx.Module):
    """Where the field is kept, and the directions over which it is summed.

    Attributes:
        altitude: Altitudes of the levels [m].
        level: Their coordinate, almost evenly from 0 to 1; see `Medium`.
        stencils: Levels between which light is interpolated, between each level and the next.
        thick: Share of the two neighbours alone in this interpolation, from 0 to 1.
        sun_zenith: Zenith angles of the suns, increasing [rad].
        dusk: Radius of the planet over the mean altitude of what scatters highest; 0 for a plane.
        mu: Zenith cosines of directions at each level: rising first, then limb, then falling.
        weight: Weight of each direction; over a level and 2π of azimuth they sum to 4π.
        cos_azimuth: Azimuths in half a turn, equally weighted.
    """

    altitude: Float[Array, " level"]
    level: Float[Array, " level"]
    stencils: Bool[Array, "interval level"]
    thick: Float[Array, "interval channel"]
    sun_zenith: Float[Array, " sun"]
    dusk: Scalar
    mu: Float[Array, "level ray"]
    weight: Float[Array, "level ray"]
    cos_azimuth: Float[Array, " azimuth"]

    def between_levels(
        self, level: Float[Array, " point"], light: Float[Array, "point species channel"]
    ) -> Float[Array, "level species channel"]:
        """Share of light from each level, of light from points given by their coordinate."""
        x = jnp.clip(level, self.level[0], self.level[-1])[:, None]
        count = self.level.size
        interval = jnp.clip(jnp.sum(x >= self.level[None], axis=1) - 1, 0, count - 2)
        smooth = _lagrange(self.level, x, self.stencils[interval])
        places = jnp.arange(count)[None] - interval[:, None]
        straight = _lagrange(self.level, x, (places == 0) | (places == 1))
        by_line = light * self.thick[interval][:, None]
        return jnp.tensordot(smooth.T, light - by_line, 1) + jnp.tensordot(straight.T, by_line, 1)

    def between_suns(self, zenith: Float[Array, "*b"]) -> Float[Array, "*b sun"]:
        """Weights of the suns for a sun at other zenith angles [rad].

        Interpolated is light over its usual fall after sunset, over which it changes by decades.
        """
        weights = lagrange_weights(self.sun_zenith, zenith)
        suns = self._fall(self.sun_zenith).reshape((1,) * zenith.ndim + (-1,))
        return weights * jnp.exp(suns - self._fall(zenith)[..., None])

    def _fall(self, zenith):
        """Logarithm of how much darker it is than by day: the shadow's height over `dusk` [m]."""
        down = jnp.maximum(jnp.minimum(zenith, np.pi) - np.pi / 2, 0.0)
        turn = jnp.minimum(np.radians(7.0), _STEEPEST / jnp.maximum(self.dusk, 1.0))
        return self.dusk * jnp.where(down < turn, down**2 / 2, turn * (down - turn / 2))

    def sun_from(self) -> SunDirection:
        """Directions of the suns in the frame of each azimuth; [azimuth, sun]."""
        zenith, cosine = jnp.broadcast_arrays(self.sun_zenith[None, :], self.cos_azimuth[:, None])
        return SunDirection.from_angles(zenith, cosine)


def _lagrange(
    nodes: Float[Array, " node"], x: Float[Array, "point 1"], used: Bool[Array, "point node"]
) -> Float[Array, "point node"]:
    """Weights of the nodes that are used in the polynomial through them."""
    itself = jnp.eye(nodes.size, dtype=bool)
    gaps = jnp.where(itself, 1.0, nodes[:, None] - nodes[None, :])
    factors = (x - nodes[None])[:, None, :] / gaps[None]
    others = used[:, None, :] & ~itself[None]
    return jnp.where(used, jnp.prod(jnp.where(others, factors, 1.0), axis=-1), 0.0)


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

    def plus(self, more: "Field", start: int) -> "Field":
        """The same and a smoother field, whose channels begin at one of these."""
        modes, degrees = more.moments.shape[1:3]
        moments = self.moments.at[:, :modes, :degrees, :, start:].add(more.moments)
        return Field(moments, self.irradiance.at[:, start:].add(more.irradiance))


def make_grid(
    medium: Medium, sun_zenith: Float[Array, " sun"], levels: int, directions: Directions
) -> Grid:
    """Lay out levels and directions for a planet and the suns' zenith angles [rad]."""
    altitude, kinked = place_levels(medium, levels)
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
    level, used = medium.level_at(altitude), stencils(kinked)
    # Uneven levels make a cubic swing: there the two neighbours do.
    middle = 0.5 * (level[1:] + level[:-1])
    swings = jnp.sum(jnp.abs(_lagrange(level, middle[:, None], used)), axis=1) > _SWING
    neighbours = np.eye(levels - 1, levels, dtype=bool) | np.eye(levels - 1, levels, 1, dtype=bool)
    used = jnp.where(swings[:, None], neighbours, used)
    depth = -jnp.diff(medium.above_altitude(altitude) @ medium.optics.extinction, axis=0)
    thick = jnp.clip((depth - _THIN) / (_THICK - _THIN), 0.0, 1.0)
    return Grid(
        altitude, level, used, thick, sun_zenith, medium.dusk(), mu, 2 * np.pi * weight,
        cos_azimuth,
    )  # fmt: skip


def project(
    mu: Float[Array, " ray"],
    weight: Float[Array, " ray"],
    by_mode: Float[Array, "mode ray sun channel"],
    harmonics: Float[Array, "mode l ray"],
) -> tuple[Float[Array, "mode l sun channel"], Float[Array, "sun channel"]]:
    """Moments of the light at one level, and its downward irradiance.

    Args:
        mu: Zenith cosines of directions.
        weight: Weight of each direction.
        by_mode: Mean over azimuth of cos(mφ) L.
        harmonics: Harmonics in these directions; see `legendre`.
    """
    moments = jnp.einsum("mlr,mrsw->mlsw", harmonics * weight[None, None, :], by_mode)
    downward = weight * jnp.maximum(mu, 0.0)
    return moments, jnp.einsum("r,rsw->sw", downward, by_mode[0])


def first_field(columns: SunColumns, grid: Grid, quality: Quality) -> Field:
    """The first order at every level: sunlight scattered once, and lit ground.

    Light is kept by azimuthal mode throughout. What phase functions multiply is a polynomial in
    the cosine of the azimuth, through a few nodes: over a sphere it depends on azimuth only
    through the turning vertical, over a plane not at all.
    """
    medium, directions = columns.medium, quality.first
    order, optics = directions.modes, medium.optics
    nodes = 1 if isinstance(medium.planet, Flat) else quality.sun_azimuths
    cos_nodes = np.cos(np.pi * np.arange(nodes) / max(nodes - 1, 1))
    to_modes = np.linalg.inv(np.polynomial.chebyshev.chebvander(cos_nodes, nodes - 1))
    to_modes = jnp.asarray(to_modes, grid.mu.dtype)
    zenith, cosine = jnp.broadcast_arrays(
        grid.sun_zenith[None, :], jnp.asarray(cos_nodes, grid.mu.dtype)[:, None]
    )
    suns = SunDirection.from_angles(zenith, cosine)
    # Nodes on a ray serve all suns: where light changes under any of these.
    count = grid.sun_zenith.size
    telling = [count // 2] if count < 9 else range(1, count, 3)
    around = [0.0] if count < 9 else [1.0, -1.0]
    shades = SunDirection.from_angles(
        jnp.repeat(grid.sun_zenith[np.array(telling)], len(around)),
        jnp.tile(jnp.asarray(around, grid.mu.dtype), len(telling)),
    )
    ahead = SunDirection.from_angles(grid.sun_zenith, jnp.ones_like(grid.sun_zenith))

    def at_level(level):
        altitude, mu, weight = level
        fan = make_fan(medium, altitude, mu, directions)
        beam, _ = apparent(medium.planet, ahead, altitude + 0 * ahead.up)

        def along(ray, leg, start, offset):
            shade = dimming(columns, ray, shades)
            path = sample(
                medium, leg, start, leg.length, quality.field_panels, quality.field_kinks, shade
            )
            return along_path(columns, ray, leg, path, offset, suns, orders=1, follow=False)[0]

        def ground_along(ray, leg, to_ground):
            under = partial(from_ground, columns, ray, leg.low_distance, to_ground)
            return jax.vmap(jax.vmap(lambda sun: under(sun)[0]))(suns)

        strength = jax.vmap(along)(fan.ray, fan.leg, fan.start, fan.offset)
        lit_ground = jax.vmap(ground_along)(*fan.falling(), fan.to_ground)
        # [ray, species, node, sun, channel]
        strength = fan.collect(strength, jnp.zeros_like(strength[: lit_ground.shape[0]]))
        strength = jnp.einsum("kn,rinsw->kirsw", to_modes, strength)
        rays = jnp.zeros((fan.up + fan.limb, *lit_ground.shape[1:]), lit_ground.dtype)
        ground = jnp.concatenate([rays, lit_ground])
        ground = jnp.einsum("kn,rnsw->krsw", to_modes, ground)
        light = jnp.zeros((order + 1, *ground.shape[1:]), ground.dtype).at[:nodes].add(ground)
        # Towards rays and suns at once: less to compile.
        seen, lit = jnp.split(
            legendre(
                directions.degree,
                order,
                jnp.concatenate([mu, beam.up]),
                jnp.concatenate([safe_sqrt(1 - mu**2), beam.ahead]),
            ),
            [mu.size],
            axis=-1,
        )
        phases = []
        for harmonics in optics.harmonics:
            degree = harmonics.shape[0] - 1
            modes = min(order, degree)
            norm = (2 * np.arange(degree + 1) + 1) / (4 * np.pi)
            scaled = harmonics * jnp.asarray(norm, mu.dtype)[:, None]
            there = slice(modes + 1), slice(degree + 1)
            source = jnp.einsum("mls,lw->mlsw", lit[there], scaled)
            phases.append(jnp.einsum("mlr,mlsw->mrsw", seen[there], source))
        modes = max(phase.shape[0] for phase in phases)
        for k in range(nodes):
            sent = jnp.zeros((modes, *ground.shape[1:]), ground.dtype)
            for number, phase in enumerate(phases):
                sent = sent.at[: phase.shape[0]].add(phase * strength[k, number][None])
            light = light + _times_cosine(sent, k, order)
        halves = np.where(np.arange(order + 1) > 0, 0.5, 1.0)
        by_mode = light * jnp.asarray(halves, mu.dtype)[:, None, None, None]
        return project(mu, weight, by_mode, seen)

    levels = grid.altitude, grid.mu, grid.weight
    moments, irradiance = jax.lax.map(jax.checkpoint(at_level), levels)
    return Field(moments, irradiance[0])


def _times_cosine(
    series: Float[Array, "mode *batch"], k: int, order: int
) -> Float[Array, "{order}+1 *batch"]:
    """A cosine series times cos(kφ), up to an order: by half cos(m + k) + cos(m - k) for each."""
    pad = [(0, 0)] * (series.ndim - 1)
    up = jnp.pad(series, [(k, order), *pad])[: order + 1]
    if k == 0:
        return up
    down = jnp.pad(series, [(0, order + k), *pad])[k : k + order + 1]
    both = up + down
    # Modes below k come back: cos(m - k) is cos(k - m).
    for m in range(max(k - order, 0), min(k, series.shape[0])):
        both = both.at[k - m].add(series[m])
    return 0.5 * both
