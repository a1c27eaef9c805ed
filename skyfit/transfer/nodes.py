"""Nodes on a stretch of a ray, where the light comes from.

A stretch is cut into panels of equal importance; kinks of the density are important by themselves.
"""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import Scalar
from .medium import Medium
from .paths import Leg, columns_in_shells
from .quadrature import count_passed, gauss, interpolate, running_sum


Dimming = Callable[[Float[Array, " edge"], Float[Array, " edge"]], Array]

NODES = 3  # Gauss nodes on each panel
_THIN = 0.01  # optical depth of a panel
_FADE = 0.4  # importance follows transmittance to this power, which also tells of dim parts
_BEND = 0.01  # change of optical depth by a kink, over a panel, that counts half
_NEAR_END = 1e-3  # of a stretch; a kink there is weaker
_THINNING = 50.0  # how much closer nodes lie at the lowest point than far from it, by themselves


class Path(eqx.Module):
    """Nodes on a stretch of a leg.

    Attributes:
        distance: From the eye [m].
        altitude: [m].
        weight: Σ weight × f(node) is ∫ρ f ds, for f smooth [m].
        column: From the stretch's low end to the node [m].
        ends: From there to the ends of panels [m].
        total: From one end to the other [m].
    """

    distance: Float[Array, " node"]
    altitude: Float[Array, " node"]
    weight: Float[Array, "node species"]
    column: Float[Array, "node species"]
    ends: Float[Array, "panel_end species"]
    total: Float[Array, " species"]

    def to_eye(self, leg: Leg, offset: Float[Array, " species"]) -> Float[Array, "node species"]:
        """Columns between nodes and eye, given that from the eye to the stretch's nearer end."""
        return self._to_eye(self.column, leg, offset)

    def arriving(
        self,
        leg: Leg,
        offset: Float[Array, " species"],
        extinction: Float[Array, "species channel"],
    ) -> Float[Array, "node channel"]:
        """Transmittance from nodes to the eye, scaled so that each panel is as opaque as it is.

        Σ weight × extinction × this, over a panel, is what its ends differ by in transmittance: air
        that glows evenly is seen with its own brightness, however thick, and no light is gained.

        Args:
            leg: Leg of the ray.
            offset: Column between the eye and the stretch's nearer end [m].
            extinction: Where densities are 1 [m⁻¹].
        """
        through = jnp.exp(-self.to_eye(leg, offset) @ extinction)
        dims = (self.weight @ extinction).reshape(-1, NODES, through.shape[1])
        seen = jnp.sum(dims * through.reshape(dims.shape), axis=1)
        ends = jnp.exp(-self._to_eye(self.ends, leg, offset) @ extinction)
        opaque = jnp.abs(jnp.diff(ends, axis=0))
        # In thin panels nodes are exact, and differences are not.
        thick = (jnp.sum(dims, axis=1) > _THIN) & (seen > 0)
        scale = jnp.where(thick, opaque, 1.0) / jnp.where(thick, seen, 1.0)
        return through * jnp.repeat(scale, NODES, axis=0)

    def _to_eye(self, column, leg, offset):
        nearer = jnp.where(leg.sign > 0, column, self.total[None, :] - column)
        return offset[None, :] + nearer


def crossings(
    medium: Medium, leg: Leg, start: Scalar, end: Scalar
) -> tuple[Float[Array, " edge"], Float[Array, "edge species"]]:
    """Where a leg crosses the edges of the shells, and the columns from its start to there [m]."""
    at = jnp.clip(medium.planet.to_level(leg.altitude, leg.mu, medium.edges), start, end)
    inside = columns_in_shells(medium, leg, at)
    return at, jnp.concatenate([jnp.zeros_like(inside[:1]), running_sum(inside)])


def sample(
    medium: Medium,
    leg: Leg,
    start: Scalar,
    end: Scalar,
    panels: int,
    kinks: int,
    dimming: Dimming | None = None,
) -> Path:
    """Put nodes on a stretch of a leg, between two distances from its lowest point [m].

    The stretch is cut into panels of equal importance, with `NODES` Gauss nodes each. Important
    is where light comes from: where transmittance to the eye and from the sun changes, at the
    clearest, a middling and the densest wavelength, and where the medium's own coordinate does; and
    some of it is spread evenly over a coordinate that thins out away from the lowest point.
    Between nodes, and cut where a density has a kink, three Gauss nodes a piece look at the density
    alone: it is rough but cheap, what it multiplies is smooth but has a spectrum. The weights
    integrate the polynomial through a panel's nodes times the density.

    Args:
        medium: What the ray crosses.
        leg: Leg of the ray.
        start: Nearer to the lowest point [m].
        end: Farther from it [m].
        panels: How many.
        kinks: Panels besides, of which one ends at each of the density's strongest.
        dimming: Optical depth [edge, sun, few] towards each of what shines, at the medium's telling
            wavelengths, given the altitudes [m] of points and their distances from the eye [m].
    """
    span = end - start
    safe_span = jnp.where(span > 0, span, 1.0)
    steepness = float(np.log1p(_THINNING))
    half = float(np.tanh(0.5 * steepness))
    rises = leg.sign > 0

    # An exponential on rising legs, on falling ones a tanh: written as one function of one
    # exponential, it is compiled once.
    def place(x):
        """Distance outwards and its slope at x in [0, 1]."""
        grown = jnp.expm1(steepness * jnp.where(rises, x, 2 * x - 1))
        per = 1 / jnp.where(rises, _THINNING, grown + 2)
        bend = grown * per
        share = jnp.where(rises, bend, 0.5 + 0.5 / half * bend)
        slope = (grown + 1) * per * jnp.where(rises, 1.0, 2 / half * per)
        return start + span * share, span * steepness * slope

    def undo(outwards):
        share = jnp.clip((outwards - start) / safe_span, 0.0, 1.0)
        bend = (2 * share - 1) * half
        grown = jnp.where(rises, share * _THINNING, 2 * bend / (1 - bend))
        long = jnp.log1p(grown) / steepness
        return jnp.where(rises, long, 0.5 + 0.5 * long)

    at, column = crossings(medium, leg, start, end)
    even = undo(at)
    importance, light = _importance(medium, leg, at, column, even, dimming)
    cuts = _cuts(medium, leg, at, even, light, importance, panels, kinks)
    gauss_nodes, gauss_weights = (jnp.asarray(g, even.dtype) for g in gauss(NODES))
    width = jnp.diff(cuts)[:, None]
    x = (cuts[:-1, None] + width * gauss_nodes[None]).ravel()
    points, slopes = place(jnp.concatenate([cuts, x]))
    outwards, slope = points[cuts.size :], slopes[cuts.size :]
    columns, densities = _inside(medium, leg, at, column, points)
    whole = jnp.maximum(jnp.diff(columns[: cuts.size], axis=0), 0.0)
    shares = (width * gauss_weights[None]).ravel() * slope
    weight = shares[:, None] * densities[cuts.size :]
    # What the nodes of a panel miss of its column is spread over them, what they see too much of it
    # is taken off in proportion: all of it counts, and none is negative.
    by_panel = weight.reshape(width.size, NODES, -1)
    seen = jnp.sum(by_panel, axis=1, keepdims=True)
    missed = jnp.maximum(whole[:, None] - seen, 0.0)
    excess = seen > whole[:, None]
    scale = jnp.where(excess, whole[:, None], 1.0) / jnp.where(excess, seen, 1.0)
    weight = by_panel * scale + gauss_weights[None, :, None] * missed
    weight = weight.reshape(x.size, -1)
    altitude = medium.planet.advance(leg.altitude, leg.mu, outwards)[0]
    to_ends, to_nodes = columns[: cuts.size], columns[cuts.size :]
    return Path(leg.from_eye(outwards), altitude, weight, to_nodes, to_ends, column[-1])


def _importance(medium, leg, at, column, even, dimming):
    """Share of what matters between the start of a stretch and each crossing, from 0 to 1."""
    altitude = medium.planet.advance(leg.altitude, leg.mu, at)[0]
    level = interpolate(altitude, medium.edges, medium.coordinate)
    depth = column @ medium.telling.T
    depth = jnp.where(leg.sign > 0, depth, depth[-1:] - depth)
    total = depth
    if dimming is not None:
        # Clearly above each edge: rounding may not choose the shell from which columns are taken.
        clear = float(jnp.finfo(altitude.dtype).eps) ** 0.75 * medium.planet.top
        total = depth[:, None] + dimming(altitude + clear, leg.from_eye(at))
        total = total.reshape(at.size, -1)
        total = total - jnp.min(total, axis=0, keepdims=True)
        depth = jnp.concatenate([depth, total], axis=1)
    few = medium.telling.shape[0]
    counts = np.repeat([few, total.shape[1]], [few, depth.shape[1] - few])
    changes = jnp.abs(jnp.diff(jnp.exp(-_FADE * depth), axis=0))
    size = changes @ jnp.asarray(1 / counts, depth.dtype)
    size = size + medium.filled * jnp.abs(jnp.diff(even)) + jnp.abs(jnp.diff(level))
    running = running_sum(size)
    running = jnp.concatenate([jnp.zeros_like(running[:1]), running])
    whole = jnp.where(running[-1] > 0, running[-1], 1.0)
    return running / whole, jnp.mean(jnp.exp(-total), axis=1)


def _cuts(medium, leg, at, even, light, importance, panels, kinks):
    """Ends of panels of equal importance, by the even coordinate.

    A kink of the density that is seen is as important as a whole panel: one ends there. Of more
    kinks than there is room for each counts in part, so that where they change nothing jumps.
    """
    count = panels + kinks
    slant = medium.planet.mu_at_level(leg.altitude, leg.mu, medium.edges)
    # How wide panels are about each edge, by the even coordinate.
    wider, more = (jnp.pad(a[2:] - a[:-2], 1, mode="edge") for a in (even, importance))
    width = jnp.minimum(wider / jnp.maximum(panels * more, 1e-9), 1.0)
    bend = medium.kink * slant * light * (width * (at[-1] - at[0])) ** 2
    strong = bend**2 / (bend**2 + _BEND**2)
    # Those beyond the ends were moved to them, but for rounding.
    strong = strong * jnp.clip(jnp.minimum(even, 1 - even) / _NEAR_END, 0.0, 1.0)
    passed = running_sum(strong)
    room = kinks / jnp.maximum(passed[-1], max(kinks, 1))
    strong, passed = strong * room, passed * room
    smooth = importance * (count - passed[-1])
    steps = jnp.stack([smooth + passed - strong, smooth + passed], axis=1).ravel()
    inner = jnp.arange(1, count, dtype=even.dtype)
    inner = interpolate(inner, steps, jnp.repeat(even, 2))
    return jnp.pad(inner, 1, constant_values=(0.0, 1.0))


def _inside(
    medium: Medium,
    leg: Leg,
    at: Float[Array, " edge"],
    column: Float[Array, "edge species"],
    points: Float[Array, " point"],
) -> tuple[Float[Array, "point species"], Float[Array, "point species"]]:
    """Columns from where a leg starts to points on it [m], and relative densities there.

    Args:
        medium: What the leg crosses.
        leg: Leg of a ray.
        at: Where it crosses the edges of shells [m].
        column: From its start to there [m].
        points: Distances outwards [m].
    """
    planet, edges = medium.planet, medium.edges
    shell = jnp.clip(count_passed(points, at) - 1, 0, edges.size - 2)
    below = jnp.concatenate([at[:, None], column], axis=1)[shell]
    low, below = below[:, 0], below[:, 1:]
    bottom, top, _, cubics = medium.look_up(shell)
    depth = top - bottom
    x, weights = gauss(3)
    # Between the edge below and the point; and the point itself.
    looks = jnp.asarray([*x, 1.0], edges.dtype)[:, None]
    distance = low[None] + looks * (points - low)[None]
    altitude = planet.advance(leg.altitude, leg.mu, distance)[0]
    y = (altitude - bottom[None]) / jnp.where(depth > 0, depth, 1.0)[None]
    y = jnp.clip(y, 0.0, 1.0)[None]
    c0, c1, c2, c3 = (c.T[:, None] for c in cubics)
    density = jnp.maximum(c0 + y * (c1 + y * (c2 + y * c3)), 0.0)  # [species, look, point]
    total = jnp.einsum("l,slp->ps", jnp.asarray(weights, edges.dtype), density[:, :-1])
    return below + total * (points - low)[:, None], density[:, -1].T
