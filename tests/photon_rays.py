"""Straight rays through shells of air: where they go and how deep, for `photon_paths.py`.

Positions and directions are Cartesian, from the centre of the planet [m]. A ray is a chain of
pieces, one a shell. Distances along it are counted from its point nearest to the centre, negative
before; b2 is the square of the least distance to the centre.
"""

from typing import NamedTuple

import numpy as np
from numba import njit


class Tables(NamedTuple):
    """An atmosphere in shells; coefficients are linear between their edges.

    Attributes:
        shells: Radii of the edges, the ground's first [m].
        extinction: At each edge [m⁻¹].
        scattering: Of each constituent that scatters, at each edge [m⁻¹].
        phase: Of each such constituent, at NUM_ANGLES + 1 angles [sr⁻¹].
        chance: Probability of an angle up to each of those.
        aim: Density of the angles from the sun that are tried beside [sr⁻¹].
        aim_chance: Probability of such an angle up to each.
        albedo: Of the ground.
    """

    shells: np.ndarray
    extinction: np.ndarray
    scattering: np.ndarray
    phase: np.ndarray
    chance: np.ndarray
    aim: np.ndarray
    aim_chance: np.ndarray
    albedo: float


class Ray(NamedTuple):
    """A ray cut into pieces.

    Attributes:
        b2: Square of the least distance to the centre [m²].
        ends: Where piece k starts, and at k + 1 where it ends [m].
        depths: Optical depths from the start of the ray to each of these.
        where: Shell of each piece.
        pieces: How many there are; the arrays are longer.
        hit: Whether it ends on the ground.
    """

    b2: float
    ends: np.ndarray
    depths: np.ndarray
    where: np.ndarray
    pieces: int
    hit: bool


@njit(cache=True)
def dot(a, b):
    """Product of two vectors in space."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def below(edges, value, last):
    """Index of the last edge not above a value, less than `last`."""
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if edges[middle] <= value:
            low = middle
        else:
            high = middle
    return low


@njit(cache=True)
def enter(shells, p, d):
    """Move a point above the atmosphere to where its ray enters; NaN if it misses."""
    r = np.sqrt(dot(p, p))
    if r <= shells[-1]:
        return p
    x = dot(p, d)
    root = shells[-1] ** 2 - (r * r - x * x)
    if x > 0 or root <= 0:
        return p * np.nan
    return p + (-x - np.sqrt(root)) * d


@njit(cache=True, fastmath=True)
def coefficient(shells, values, b2, i, x):
    """A coefficient at a distance along a ray, in shell i."""
    slope = (values[i + 1] - values[i]) / (shells[i + 1] - shells[i])
    return values[i] + slope * (np.sqrt(x * x + b2) - shells[i])


@njit(cache=True, fastmath=True)
def partial(shells, extinction, b2, i, start, end, t):
    """Optical depth of the first part t of a piece: of the parabola through three points."""
    one = coefficient(shells, extinction, b2, i, start)
    two = coefficient(shells, extinction, b2, i, 0.5 * (start + end))
    three = coefficient(shells, extinction, b2, i, end)
    bend = 2 * one - 4 * two + 2 * three
    tilt = 4 * two - 3 * one - three
    return (end - start) * t * (one + t * (0.5 * tilt + t * bend / 3))


@njit(cache=True, fastmath=True)
def depth_to_top(shells, extinction, r, mu):
    """Optical depth from a radius up to the top, -1 if the ground is in the way."""
    x = r * mu
    b2 = r * r - x * x
    if mu < 0 and b2 < shells[0] ** 2:
        return -1.0
    i = below(shells, r, len(shells) - 1)
    depth = 0.0
    if mu < 0:
        while i > 0 and shells[i] ** 2 > b2:
            end = -np.sqrt(shells[i] ** 2 - b2)
            depth += partial(shells, extinction, b2, i, x, end, 1.0)
            x = end
            i -= 1
    here = coefficient(shells, extinction, b2, i, x)
    while i < len(shells) - 1:
        end = np.sqrt(max(shells[i + 1] ** 2 - b2, 0.0))
        middle = coefficient(shells, extinction, b2, i, 0.5 * (x + end))
        depth += (end - x) / 6 * (here + 4 * middle + extinction[i + 1])
        x, here = end, extinction[i + 1]
        i += 1
    return depth


@njit(cache=True)
def trace(air, p, d, ends, depths, where):
    """Cut a ray into pieces and sum its optical depth, in the arrays given."""
    shells, extinction = air.shells, air.extinction
    size = np.sqrt(dot(p, p))
    r = min(max(size, shells[0]), shells[-1])
    mu = dot(p, d) / size
    x = r * mu
    b2 = r * r - x * x
    hit = mu < 0 and b2 < shells[0] ** 2
    i = below(shells, r, len(shells) - 1)
    ends[0], depths[0] = x, 0.0
    n = 0
    if mu < 0:
        while i >= 0 and shells[i] ** 2 > b2:
            end = max(-np.sqrt(shells[i] ** 2 - b2), x)
            where[n], ends[n + 1] = i, end
            depths[n + 1] = depths[n] + partial(shells, extinction, b2, i, x, end, 1.0)
            x = end
            n += 1
            i -= 1
        if hit or i < 0:
            return Ray(b2, ends, depths, where, n, True)
    while i < len(shells) - 1:
        end = max(np.sqrt(max(shells[i + 1] ** 2 - b2, 0.0)), x)
        where[n], ends[n + 1] = i, end
        depths[n + 1] = depths[n] + partial(shells, extinction, b2, i, x, end, 1.0)
        x = end
        n += 1
        i += 1
    return Ray(b2, ends, depths, where, n, False)


@njit(cache=True)
def depth_at(air, ray, x):
    """Optical depth from the start of a ray to a distance on it."""
    if x <= ray.ends[0]:
        return 0.0
    if x >= ray.ends[ray.pieces]:
        return ray.depths[ray.pieces]
    k = below(ray.ends, x, ray.pieces)
    start, end = ray.ends[k], ray.ends[k + 1]
    t = (x - start) / max(end - start, 1e-9)
    return ray.depths[k] + partial(air.shells, air.extinction, ray.b2, ray.where[k], start, end, t)


@njit(cache=True)
def place_at(air, ray, depth):
    """Distance at which a ray reaches an optical depth, and the shell."""
    k = below(ray.depths, depth, ray.pieces)
    start, end, i = ray.ends[k], ray.ends[k + 1], ray.where[k]
    piece, wanted = ray.depths[k + 1] - ray.depths[k], depth - ray.depths[k]
    low, high = 0.0, 1.0
    t = wanted / piece if piece > 0 else 0.5
    for _ in range(8):  # Newton, held by bisection
        t = min(max(t, low), high)
        excess = partial(air.shells, air.extinction, ray.b2, i, start, end, t) - wanted
        if excess > 0:
            high = t
        else:
            low = t
        here = coefficient(air.shells, air.extinction, ray.b2, i, start + t * (end - start))
        rise = (end - start) * here
        if abs(excess) < 1e-10 * piece or rise <= 0:
            break
        t -= excess / rise
        if t <= low or t >= high:
            t = 0.5 * (low + high)
    return start + t * (end - start), i


@njit(cache=True)
def shadow(ground, p, d, to_sun, length):
    """Distances from p at which a ray enters and leaves the planet's shadow; equal if it misses."""
    along, rate = dot(p, to_sun), dot(d, to_sun)
    a = 1 - rate * rate
    b = dot(p, d) - along * rate
    c = dot(p, p) - along * along - ground**2
    start, end = 0.0, length
    if a > 1e-12:
        root = b * b - a * c
        if root <= 0:
            return 0.0, 0.0
        root = np.sqrt(root)
        start, end = max(start, (-b - root) / a), min(end, (-b + root) / a)
    elif c >= 0:
        return 0.0, 0.0
    # Behind the plane through the centre.
    if rate > 0:
        end = min(end, -along / rate)
    elif rate < 0:
        start = max(start, -along / rate)
    elif along >= 0:
        return 0.0, 0.0
    return (start, end) if end > start else (0.0, 0.0)
