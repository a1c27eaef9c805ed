"""The slow, obvious twin of refraction: rays of light followed step by step through bending air.

In the plane of a ray the planet's centre is the origin. A ray at x with direction t (a unit vector)
obeys dx/ds = t, dt/ds = (∇n - (∇n·t) t)/n: Runge-Kutta's fourth order, no invariant of the sphere.
From every point of a line of sight sun rays are shot at several apparent zenith angles until one
leaves the air in the sun's direction; its neighbour tells how far the beam has been spread. The
first order of scattering in NumPy, without a ground. `tests/test_refraction.py` holds it to the
refraction of stars.
"""

from dataclasses import dataclass

import numpy as np
from plain_air import Air


ALONG, LONGEST = 60.0, 2500.0  # m of altitude, and of path, to a step
NEIGHBOUR = 1e-5  # rad between two rays of one beam
SHELLS = (100.0, 200.0, 500.0, *(1e3 * k for k in range(1, 34)), 36e3, 40e3, 45e3, 50e3, 55e3)
FAR = tuple(d * k for d in (1e3, 1e4, 1e5) for k in (1.0, 2.0, 3.0, 5.0, 7.0))


@dataclass(frozen=True)
class Bending:
    """A refracting atmosphere: n = 1 + refractivity × relative density."""

    air: Air
    refractivity: float
    density: object  # relative density at altitudes [m], NumPy

    def index(self, altitude):
        """Index of refraction; 1 above the top."""
        inside = altitude <= self.air.top
        return 1 + self.refractivity * np.where(inside, self.density(altitude), 0.0)

    def slope(self, altitude):
        """Its slope [1/m]."""
        rise = self.density(altitude + 5.0) - self.density(altitude - 5.0)
        return self.refractivity * np.where(altitude <= self.air.top, rise / 10.0, 0.0)


def altitude_of(bending, place):
    """Altitudes of places [ray, 2] in the plane of the ray."""
    return np.hypot(place[:, 0], place[:, 1]) - bending.air.radius


def step(bending, place, way, column, ds):
    """One step of Runge and Kutta along rays; places and ways are [ray, 2]."""

    def slopes(x, t):
        h = altitude_of(bending, x)
        up = x / np.hypot(x[:, 0], x[:, 1])[:, None]
        gradient = bending.slope(h)[:, None] * up
        along = np.sum(gradient * t, axis=1, keepdims=True)
        return t, (gradient - along * t) / bending.index(h)[:, None], bending.air.density(h)

    d = ds[:, None]
    x1, t1, c1 = slopes(place, way)
    x2, t2, c2 = slopes(place + d / 2 * x1, way + d / 2 * t1)
    x3, t3, c3 = slopes(place + d / 2 * x2, way + d / 2 * t2)
    x4, t4, c4 = slopes(place + d * x3, way + d * t3)
    place = place + d / 6 * (x1 + 2 * x2 + 2 * x3 + x4)
    way = way + d / 6 * (t1 + 2 * t2 + 2 * t3 + t4)
    column = column + d / 6 * (c1 + 2 * c2 + 2 * c3 + c4)
    return place, way / np.hypot(way[:, 0], way[:, 1])[:, None], column


def start(bending, altitude, zenith):
    """Rays above the planet's pole."""
    altitude, zenith = np.broadcast_arrays(np.atleast_1d(altitude), np.atleast_1d(zenith))
    place = np.stack([0 * altitude, bending.air.radius + altitude], axis=1)
    way = np.stack([np.sin(zenith), np.cos(zenith)], axis=1)
    return place, way, np.zeros((len(place), len(bending.air.densities)))


def length_of_step(bending, place, way):
    """Shorter where the altitude changes fast."""
    h = np.maximum(altitude_of(bending, place), 0.0)
    steep = np.abs(np.sum(place * way, axis=1)) / np.hypot(place[:, 0], place[:, 1])
    # On a grazing ray the altitude rises by LONGEST²/2R, a metre, in the longest step.
    return np.minimum(ALONG * (1 + h / 15e3) / np.maximum(steep, 1e-9), LONGEST)


def shoot(bending, altitude, zenith):
    """Rays from altitudes to space.

    Returns:
        Zenith angle of their last direction, by the vertical where they began; columns [ray,
        species]; the lowest altitude on the way.
    """
    place, way, column = start(bending, altitude, zenith)
    lowest = altitude_of(bending, place)
    out = np.zeros(len(place))
    columns = np.zeros_like(column)
    going = np.arange(len(place))
    while going.size:
        h = altitude_of(bending, place)
        up = np.sum(place * way, axis=1) > 0
        done = (up & (h >= bending.air.top)) | (h < -2e3)
        out[going[done]] = np.arctan2(way[done, 0], way[done, 1])
        columns[going[done]] = column[done]
        place, way, column, going = place[~done], way[~done], column[~done], going[~done]
        if going.size:
            ds = length_of_step(bending, place, way)
            place, way, column = step(bending, place, way, column, ds)
            lowest[going] = np.minimum(lowest[going], altitude_of(bending, place))
    return out, columns, lowest


def grazing(bending, altitude):
    """Apparent zenith angle of the horizon seen from altitudes: n r sin θ is that at the ground.

    `tests/test_refraction.py` follows such rays.
    """
    air = bending.air
    here = bending.index(altitude) * (air.radius + altitude)
    return np.pi - np.arcsin(np.minimum(bending.index(0.0) * air.radius / here, 1.0))


def find_sun(bending, altitude, zenith):
    """Sun rays at points, by the zenith angle that the sun would have there without air [rad].

    Returns:
        Apparent zenith angle; columns; irradiance of the beam on a plane normal to it, over that
        above the air and without extinction: 0 where no ray arrives.
    """
    highest = grazing(bending, altitude)
    horizon = shoot(bending, altitude, highest)[0]
    lit = zenith < horizon
    count = lit.sum()
    h, want = altitude[lit], zenith[lit]
    # Light from higher up is bent less: the ray lies between these, and Newton's steps stay there.
    low, high = want - (horizon - highest)[lit], np.minimum(want, highest[lit])
    seen = high
    for _ in range(25):
        both = shoot(bending, np.tile(h, 2), np.concatenate([seen, seen - NEIGHBOUR]))
        out, columns = both[0], both[1][:count]
        rate = (out[:count] - out[count:]) / NEIGHBOUR
        miss = out[:count] - want
        if np.all(np.abs(miss) < 1e-9):
            break
        low, high = np.where(miss < 0, seen, low), np.where(miss < 0, high, seen)
        seen = seen - miss / rate
        seen = np.where((seen >= low) & (seen <= high), seen, 0.5 * (low + high))
    assert np.all(np.abs(miss) < 1e-7), np.abs(miss).max()
    found = np.zeros_like(zenith), np.zeros((len(zenith), columns.shape[1])), np.zeros_like(zenith)
    # A ring of rays about the sun's axis: what enters it above the air is what passes below.
    spread = bending.index(h) ** 2 * np.sin(seen) / np.sin(want) / rate
    for whole, part in zip(found, (seen, columns, spread), strict=True):
        whole[lit] = part
    return found


def follow(bending, altitude, zenith, distances):
    """Places, ways and columns of one ray at increasing distances from the eye [m]."""
    place, way, column = start(bending, altitude, zenith)
    at, kept = 0.0, []
    for distance in distances:
        while at < distance:
            ds = min(length_of_step(bending, place, way)[0], distance - at)
            place, way, column = step(bending, place, way, column, np.array([ds]))
            at += ds
        kept.append((place[0], way[0], column[0]))
    return tuple(np.array(part) for part in zip(*kept, strict=True))


def first(bending, sun_zenith, view_zenith, relative_azimuths, altitude=0.0, nodes=4):
    """First-order radiance along a line of sight that ends in space, [azimuth, wavelength]."""
    air = bending.air
    # How the ray runs: where it crosses shells, and where it leaves the air.
    distances = np.concatenate([np.arange(0.0, 2e3, 50.0), np.arange(2e3, 2e6, 500.0)])
    path = follow(bending, altitude, view_zenith, distances)
    h = altitude_of(bending, path[0])
    assert h.min() > -1.0, "the ray meets the ground"
    inside = np.argmax(h > air.top) + 1
    distances, h, path = distances[:inside], h[:inside], [part[:inside] for part in path]
    turn = np.arctan2(path[0][:, 0], path[0][:, 1])
    dark = shoot(bending, h, grazing(bending, h))[0]
    crossed = []
    for level in (*SHELLS, air.top):
        change = np.nonzero(np.diff(h > level))[0]
        crossed += [np.interp(0, *_pair(h - level, distances, k)) for k in change]
    end = crossed[-1]
    radiance = []
    for azimuth in relative_azimuths:
        lit = dark - _true_zenith(sun_zenith, azimuth, turn)
        edges = [np.interp(0, *_pair(lit, distances, k)) for k in np.nonzero(np.diff(lit > 0))[0]]
        cuts = np.array(sorted({0.0, end, *crossed, *edges, *(d for d in FAR if d < end)}))
        cuts = cuts[cuts <= end]
        x, w = np.polynomial.legendre.leggauss(nodes)
        at = (cuts[:-1, None] + np.diff(cuts)[:, None] * (x + 1) / 2).ravel()
        weight = (np.diff(cuts)[:, None] * w / 2).ravel()
        radiance.append(_sum(bending, sun_zenith, view_zenith, azimuth, altitude, at, weight))
    return np.array(radiance)


def _sum(bending, sun_zenith, view_zenith, azimuth, altitude, at, weight):
    """Light from points of a ray, each with its weight."""
    air = bending.air
    place, way, to_eye = follow(bending, altitude, view_zenith, at)
    h = altitude_of(bending, place)
    turn = np.arctan2(place[:, 0], place[:, 1])
    # Upright frames that turn with the ray: its plane is x, z; the sun above the air is fixed.
    sun = np.array([np.sin(sun_zenith) * np.cos(azimuth), np.sin(sun_zenith) * np.sin(azimuth),
                    np.cos(sun_zenith)])  # fmt: skip
    up = np.stack([np.sin(turn), 0 * turn, np.cos(turn)], axis=1)
    level = sun - (up @ sun)[:, None] * up
    level = level / np.maximum(np.linalg.norm(level, axis=1, keepdims=True), 1e-12)
    seen, to_sun, spread = find_sun(bending, h, _true_zenith(sun_zenith, azimuth, turn))
    arriving = np.cos(seen)[:, None] * up + np.sin(seen)[:, None] * level
    look = np.stack([way[:, 0], 0 * turn, way[:, 1]], axis=1)
    cos_angle = np.sum(arriving * look, axis=1)
    source = spread[:, None] * air.scattered(air.density(h), cos_angle)
    light = source * np.exp(-(to_eye + to_sun) @ air.extinction)
    # Radiance over n² stays the same along a ray.
    basic = (weight / bending.index(h) ** 2) @ light
    return air.sun * basic * bending.index(np.array(altitude)) ** 2


def _true_zenith(sun_zenith, azimuth, turn):
    """Zenith angle of the airless sun where the vertical has turned along a line of sight."""
    up, ahead = np.cos(sun_zenith), np.sin(sun_zenith) * np.cos(azimuth)
    aside = np.sin(sun_zenith) * np.sin(azimuth)
    here, there = np.cos(turn) * up + np.sin(turn) * ahead, np.cos(turn) * ahead - np.sin(turn) * up
    return np.arctan2(np.hypot(there, aside), here)


def _pair(values, distances, k):
    """Two neighbours, increasing, for `np.interp`."""
    order = [k, k + 1] if values[k] < values[k + 1] else [k + 1, k]
    return values[order], distances[order]
