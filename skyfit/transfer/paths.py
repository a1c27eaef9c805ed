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
import numpy as np
from jaxtyping import Array, Bool, Float

from .._typing import Scalar
from ..atmosphere import Atmosphere
from .geometry import AbstractPlanet, Spherical
from .quadrature import gauss, legendre_moments, polynomial_fit


Kind = Literal["rising", "falling", "limb", "any"]
"""Which legs a ray has: only rising; only falling, to the ground; both; known at run time."""


class Leg(eqx.Module):
    """Part of a ray on one side of its lowest point.

    Attributes:
        altitude: Of the lowest point [m].
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


class Path(eqx.Module):
    """Nodes on a stretch of a leg.

    Attributes:
        distance: From the eye [m].
        altitude: [m].
        weight: Σ weight × f(node) is ∫ρ f ds, for f smooth [m].
        column: From the stretch's low end to the node [m].
        total: From one end to the other [m].
    """

    distance: Float[Array, " node"]
    altitude: Float[Array, " node"]
    weight: Float[Array, "node species"]
    column: Float[Array, "node species"]
    total: Float[Array, " species"]

    def to_eye(self, leg: Leg, offset: Float[Array, " species"]) -> Float[Array, "node species"]:
        """Columns between nodes and eye, given that from the eye to the stretch's nearer end."""
        nearer = jnp.where(leg.sign > 0, self.column, self.total[None, :] - self.column)
        return offset[None, :] + nearer


def sight(extinction: Float[Array, "species wavelength"]) -> tuple[Scalar, Scalar]:
    """How far and how closely rays must be looked at, by what dims them.

    Returns:
        Distance past which nothing is seen: 2000 optical depths at ground density [m]; only a
        flat planet's grazing rays are that long. Where spectra differ more than a hundredfold the
        densest wavelength counts.
        Distance over which the densest wavelength fades at ground density [m].
    """
    total = jnp.sum(extinction, axis=0)
    densest = jnp.maximum(jnp.max(total), 1e-12)
    slowest = jnp.maximum(jnp.min(total), 0.01 * densest)
    return 2000 / slowest, 1 / densest


def legs(
    planet: AbstractPlanet, altitude: Scalar, mu: Scalar, farthest: Scalar, kind: Kind
) -> tuple[Leg | None, Leg | None, Bool[Array, ""]]:
    """Cut a ray at its lowest point.

    Args:
        planet: Its shape.
        altitude: Of the eye, inside the atmosphere [m].
        mu: Cosine of the ray's zenith angle at the eye.
        farthest: No rising leg is longer [m]; see `sight`.
        kind: Which legs there are.

    Returns:
        The falling leg, the rising leg (None where `kind` has none), and whether the ray ends at
        the ground.
    """
    none = jnp.zeros_like(altitude)
    if kind == "rising":
        length = jnp.minimum(planet.to_top(altitude, mu), farthest)
        return None, Leg(altitude, mu, length, none, none + 1), jnp.asarray(False)
    falls = jnp.asarray(kind in ("falling", "limb")) | (mu < 0)
    strikes = jnp.asarray(kind == "falling") | (mu < planet.horizon(altitude))
    strikes = strikes & jnp.asarray(kind != "limb")
    safe = jnp.where(falls, mu, -1.0)
    if kind == "falling":
        low_distance, low = planet.to_ground(altitude, mu), none
    else:
        to_ground = planet.to_ground(altitude, jnp.where(strikes, mu, -1.0))
        to_lowest, lowest = planet.lowest(altitude, jnp.where(strikes, -1e-6, safe))
        low_distance = jnp.where(strikes, to_ground, jnp.where(falls, to_lowest, 0.0))
        low = jnp.where(strikes, 0.0, jnp.where(falls, lowest, altitude))
    ground_mu = planet.mu_at_level(altitude, mu, none)
    low_mu = jnp.where(strikes, ground_mu, jnp.where(falls, 0.0, mu))
    falling = Leg(low, low_mu, low_distance, low_distance, none - 1)
    if kind == "falling":
        return falling, None, strikes
    to_top = jnp.minimum(planet.to_top(low, jnp.where(strikes, 1.0, low_mu)), farthest)
    rising = Leg(low, low_mu, jnp.where(strikes, 0.0, to_top), low_distance, none + 1)
    return falling, rising, strikes


def sample(
    atmosphere: Atmosphere,
    planet: AbstractPlanet,
    leg: Leg,
    start: Scalar,
    end: Scalar,
    nodes: int,
) -> Path:
    """Put nodes on a stretch of a leg, between two distances from its lowest point [m].

    Nodes thin out exponentially away from the lowest point, and on a falling leg from the eye too:
    from the distance over which light fades to the whole stretch. Between them, and cut where the
    density has a kink, three Gauss nodes a piece look at the density alone: it is rough but cheap,
    what it multiplies is smooth but has a spectrum. The weights integrate the polynomial through
    the nodes times the density.
    """
    span = end - start
    safe_span = jnp.where(span > 0, span, 1.0)
    steepness = jnp.log1p(jnp.maximum(50.0, span / sight(atmosphere.extinction)[1]))
    far, half = jnp.expm1(steepness), jnp.tanh(0.5 * steepness)
    rises = leg.sign > 0

    def place(x):
        """Distance outwards and its slope at x in [0, 1]."""
        bend = jnp.tanh(steepness * (x - 0.5))
        share = jnp.where(rises, jnp.expm1(steepness * x) / far, 0.5 * (1 + bend / half))
        slope = jnp.where(rises, jnp.exp(steepness * x) / far, 0.5 * (1 - bend**2) / half)
        return start + span * share, span * steepness * slope

    def undo(outwards):
        share = jnp.clip((outwards - start) / safe_span, 0.0, 1.0)
        rising = jnp.log1p(share * far) / steepness
        falling = 0.5 + jnp.arctanh((2 * share - 1) * half) / steepness
        return jnp.where(rises, rising, falling)

    x = jnp.asarray(gauss(nodes)[0], span.dtype)
    kinks = undo(planet.to_level(leg.altitude, leg.mu, atmosphere.knots()))
    ends = jnp.asarray([0.0, 1.0], x.dtype)
    edges = jnp.sort(jnp.concatenate([ends, x, kinks]))
    fine, piece = _in_panels(edges, 3)
    at, slope = place(fine.ravel())
    altitude = planet.advance(leg.altitude, leg.mu, at)[0]
    density = atmosphere.density(altitude) * (slope * piece.ravel())[:, None]
    moments = legendre_moments(nodes, fine.ravel(), density)
    weight = jnp.asarray(polynomial_fit(nodes), density.dtype) @ moments
    panels = jnp.sum(density.reshape(*fine.shape, -1), axis=1)
    running = jnp.cumsum(panels, axis=0)
    # Below node j lie the end at 0, the nodes before it and the kinks before it.
    before = jnp.arange(nodes) + jnp.sum(kinks[None, :] < x[:, None], axis=1)
    outwards, _ = place(x)
    low = planet.advance(leg.altitude, leg.mu, outwards)[0]
    return Path(leg.from_eye(outwards), low, weight, running[before], running[-1])


def column_along(
    atmosphere: Atmosphere, planet: AbstractPlanet, leg: Leg, start: Scalar, end: Scalar
) -> Float[Array, " species"]:
    """Column between two distances from a leg's lowest point [m]."""
    crossings = planet.to_level(leg.altitude, leg.mu, _shells(atmosphere))
    edges = jnp.concatenate([start[None], jnp.clip(crossings, start, end), end[None]])
    at, piece = _in_panels(edges, 3)
    altitude = planet.advance(leg.altitude, leg.mu, at.ravel())[0]
    return piece.ravel() @ atmosphere.density(altitude)


def _shells(atmosphere: Atmosphere) -> Float[Array, " shell"]:
    """Altitudes between which densities are smooth and change by no more than a few times [m]."""
    share = np.expm1(6 * np.linspace(0, 1, 20)) / np.expm1(6)
    base = atmosphere.top_altitude * jnp.asarray(share, atmosphere.top_altitude.dtype)
    return jnp.sort(jnp.concatenate([base, atmosphere.knots()]))


def _in_panels(edges: Float[Array, " edge"], count: int):
    """Gauss nodes and weights between neighbouring edges; [panel, node] each."""
    x, w = (jnp.asarray(a, edges.dtype)[None, :] for a in gauss(count))
    width = jnp.diff(edges)[:, None]
    return edges[:-1, None] + width * x, width * w


class SunColumns(eqx.Module):
    """Columns from any point to the top of the atmosphere, towards the sun.

    A table over altitude and the sun's zenith cosine, read with bicubic interpolation. Its
    coordinates stretch the ground and the horizon (after Bruneton & Neyret 2008, section 4).

    Attributes:
        planet: Its shape.
        table: Columns; a flat planet's has one angle, the vertical.
    """

    planet: AbstractPlanet
    table: Float[Array, "altitude angle species"]

    def __call__(
        self, altitude: Float[Array, "*b"], mu: Float[Array, "*b"]
    ) -> tuple[Float[Array, "*b species"], Bool[Array, "*b"]]:
        """Columns [m] at altitudes, towards zenith cosines; and whether the sun is above the horizon.

        Where it is not, the column is that to the zenith.
        """
        horizon = self.planet.horizon(altitude)
        lit = mu > horizon
        up = jnp.where(lit, mu, 1.0)
        row = _stretch(altitude / self.planet.top) * (self.table.shape[0] - 1)
        if self.table.shape[1] == 1:
            vertical = _interpolate(self.table[:, 0], row)
            return vertical / up[..., None], lit
        column = _stretch((up - horizon) / (1 - horizon)) * (self.table.shape[1] - 1)
        return _interpolate2(self.table, row, column), lit


def sun_columns(
    atmosphere: Atmosphere, planet: AbstractPlanet, altitudes: int, angles: int
) -> SunColumns:
    """Tabulate the columns towards the sun."""
    share = _unstretch(jnp.linspace(0.0, 1.0, altitudes, dtype=planet.top.dtype))
    altitude = planet.top * share

    def one(h, mu):
        none = jnp.zeros_like(h)
        falling, rising, _ = legs(planet, h, mu, none + jnp.inf, "limb")
        assert falling is not None
        assert rising is not None
        # A ray that does not fall has its lowest point here.
        up = Leg(h, mu, planet.to_top(h, jnp.maximum(mu, 0.0)), none, none + 1)
        falls = mu < 0
        leg = jax.tree.map(partial(jnp.where, falls), rising, up)
        dip = jnp.where(falls, falling.length, 0.0)
        out = column_along(atmosphere, planet, leg, none, leg.length)
        return out + column_along(atmosphere, planet, leg, none, dip)

    over_angles = jax.vmap(one, in_axes=(None, 0))
    if isinstance(planet, Spherical):
        w = _unstretch(jnp.linspace(0.0, 1.0, angles, dtype=altitude.dtype))
        horizon = planet.horizon(altitude)[:, None]
        mu = horizon + (1 - horizon) * w[None, :]
        return SunColumns(planet, jax.vmap(over_angles)(altitude, mu))
    up = jnp.ones((altitudes, 1), altitude.dtype)
    return SunColumns(planet, jax.vmap(over_angles)(altitude, up))


_OFFSET = 1e-3  # of the square-root coordinates; it keeps their slope at 0 finite


def _stretch(share):
    """Square root of a share in [0, 1], offset and rescaled to [0, 1]."""
    share = jnp.maximum(share, 0.0)
    return jnp.sqrt(share * (1 + 2 * _OFFSET) + _OFFSET**2) - _OFFSET


def _unstretch(x):
    return ((x + _OFFSET) ** 2 - _OFFSET**2) / (1 + 2 * _OFFSET)


def _cubic(position, count):
    """First of four neighbours on a uniform grid, and their Lagrange weights."""
    first = jnp.clip(jnp.floor(position).astype(int) - 1, 0, count - 4)
    t = position - first.astype(position.dtype)
    a, b, c, d = t, t - 1, t - 2, t - 3
    weights = (-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6)
    return first, weights


def _interpolate(table, position):
    first, weights = _cubic(position, table.shape[0])
    return sum(w[..., None] * table[first + k] for k, w in enumerate(weights))


def _interpolate2(table, row, column):
    rows, columns, _ = table.shape
    flat = table.reshape(rows * columns, -1)
    first_row, row_weights = _cubic(row, rows)
    first_column, column_weights = _cubic(column, columns)
    total = 0.0
    for i, wi in enumerate(row_weights):
        start = (first_row + i) * columns + first_column
        for j, wj in enumerate(column_weights):
            total = total + (wi * wj)[..., None] * flat[start + j]
    return total
