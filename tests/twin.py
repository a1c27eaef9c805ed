"""The slow, obvious twin of the simulator: NumPy, Cartesian positions, no tables, no JAX.

The planet's centre is the origin, the observer stands on the z axis, the sun lies in the plane
y = 0. A ray is cut where it crosses shells of given altitude, at given distances from its start
and where it enters or leaves the shadow of the planet; every piece is integrated by Gauss's rule.
From every point of a ray another ray runs to the sun: first order. From every point of a ray a
sphere of directions is looked at, each a first-order ray of its own: second order.

An order counts the interactions, a reflection by the ground being one. The first order is what the
sun lights directly: the air along the ray and, where the ray ends on it, the ground. The second is
what the first lights. `tests/test_twin.py` holds the twin to numbers of other programs.
"""

from dataclasses import dataclass

import numpy as np
from plain_air import Air


@dataclass(frozen=True)
class Steps:
    """How fine the sums are. All rays share one rule; `nodes` are Gauss nodes in each piece."""

    shells: tuple[float, ...]  # m above the ground
    distances: tuple[float, ...]  # m from the start of a ray
    nodes: int
    zeniths: int  # above the horizon of a point, and as many below
    azimuths: int  # on half a circle; the other half is its mirror image


SINGLE = Steps(
    shells=(100.0, 200.0, 500.0, *(1e3 * k for k in range(1, 33)), 36e3, 40e3, 45e3, 50e3),
    distances=tuple(d * k for d in (1e2, 1e3, 1e4, 1e5) for k in (2.0, 5.0, 10.0)),
    nodes=4,
    zeniths=0,
    azimuths=0,
)
# Seconds for one direction; within 0.2 % by day, not enough for twilight.
DOUBLE = Steps(
    shells=(1e3, 2e3, 3e3, 5e3, 9e3, 20e3, 32e3),
    distances=(2e3, 6e3, 2e4, 5e4, 1e5, 2e5, 4e5),
    nodes=3,
    zeniths=16,
    azimuths=24,
)
# Minutes for one direction: for numbers to keep.
DOUBLE_FINE = Steps(
    shells=(
        *(300.0, 600.0, 1e3, 1.5e3, 2e3, 3e3, 4e3, 5e3, 7e3, 9e3, 12e3, 15e3, 20e3, 25e3),
        *(32e3, 42e3),
    ),
    distances=(2e3, 5e3, 1e4, 2e4, 4e4, 8e4, 1.6e5, 3.2e5, 6.4e5),
    nodes=4,
    zeniths=20,
    azimuths=24,
)


def single(
    atm,
    sun_zenith: float,
    view_zenith: float,
    relative_azimuth: float,
    observer_altitude: float = 0.0,
    geometry: str = "spherical",
    steps: Steps = SINGLE,
) -> np.ndarray:
    """First-order spectral radiance of one direction, [wavelength]."""
    scene = _Scene(Air(atm), sun_zenith, geometry, steps)
    eye, ray = scene.view(view_zenith, relative_azimuth, observer_altitude)
    return scene.first(eye[None], ray[None])[0]


def double(
    atm,
    sun_zenith: float,
    view_zenith: float,
    relative_azimuth: float,
    observer_altitude: float = 0.0,
    geometry: str = "spherical",
    steps: Steps = DOUBLE,
) -> np.ndarray:
    """Second-order spectral radiance of one direction, [wavelength]."""
    scene = _Scene(Air(atm), sun_zenith, geometry, steps)
    eye, ray = scene.view(view_zenith, relative_azimuth, observer_altitude)
    return scene.second(eye, ray)


class _Scene:
    """One atmosphere under one sun. Positions and directions are [..., 3]."""

    def __init__(self, air: Air, sun_zenith: float, geometry: str, steps: Steps):
        self.air, self.steps, self.flat = air, steps, geometry == "flat"
        self.to_sun = np.array([np.sin(sun_zenith), 0.0, np.cos(sun_zenith)])
        # Positions are measured from the planet's centre; on a flat one from the ground.
        self.ground = 0.0 if self.flat else air.radius
        x, w = np.polynomial.legendre.leggauss(steps.nodes)
        self.node, self.weight = 0.5 * (x + 1), 0.5 * w  # on [0, 1]
        # partial[j] @ f is the integral from 0 to node j of the polynomial through f.
        vandermonde = np.vander(self.node, increasing=True)
        power = np.arange(1, steps.nodes + 1)
        self.partial = (self.node[:, None] ** power / power) @ np.linalg.inv(vandermonde)

    def view(self, zenith: float, azimuth: float, altitude: float):
        eye = np.array([0.0, 0.0, self.ground + altitude])
        sine = np.sin(zenith)
        return eye, np.array([sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(zenith)])

    # ---- geometry

    def altitude(self, p):
        return p[..., 2] if self.flat else np.linalg.norm(p, axis=-1) - self.ground

    def up(self, p):
        if self.flat:
            return np.broadcast_to([0.0, 0.0, 1.0], p.shape)
        return p / np.linalg.norm(p, axis=-1, keepdims=True)

    def lit(self, p):
        """Whether the sun, a point at infinity, is above the horizon of a point."""
        if self.flat:
            return np.full(p.shape[:-1], self.to_sun[2] > 0)
        along = p @ self.to_sun
        aside = np.sum(p * p, axis=-1) - along**2
        return (along > 0) | (aside > self.ground**2)

    def crossings(self, p, d, altitude):
        """Both distances at which rays cross a shell; NaN where they miss it."""
        if self.flat:
            with np.errstate(divide="ignore", invalid="ignore"):
                t = (altitude - p[:, 2]) / d[:, 2]
            return np.stack([t, t], axis=-1)
        b = np.sum(p * d, axis=-1)
        # |p|² - r² as a product: the difference of two squares of 6e6 m loses digits.
        size = np.linalg.norm(p, axis=-1)
        shell = self.ground + altitude
        c = (size - shell) * (size + shell)
        with np.errstate(invalid="ignore"):
            root = np.sqrt(b * b - c)
        return np.stack([-b - root, -b + root], axis=-1)

    def span(self, p, d):
        """Where rays enter and leave the atmosphere, and whether they end on the ground."""
        first, last = np.nan_to_num(self.crossings(p, d, self.air.top), nan=0.0).T
        hit = self.crossings(p, d, 0.0)[:, 0]
        down = np.sum(self.up(p) * d, axis=-1) < 0
        if self.flat:
            leave = np.where(down, hit, last)
            # A level ray never leaves: it is followed until nothing comes through.
            thin = np.min(self.air.density(self.altitude(p)) @ self.air.extinction, axis=-1)
            leave = np.where(np.abs(d[:, 2]) < 1e-6, 60 / np.maximum(thin, 1e-9), leave)
            inside = self.altitude(p) <= self.air.top
            return np.where(inside, 0.0, first), leave, down & (leave == hit)
        ends = down & np.isfinite(hit)
        enter = np.maximum(first, 0.0)
        return enter, np.maximum(np.where(ends, np.maximum(hit, 0.0), last), enter), ends

    def pieces(self, p, d):
        """Cut rays into smooth pieces: ray of each piece, its start and its width."""
        enter, leave, ends = self.span(p, d)
        cuts = [enter[:, None], leave[:, None]]
        cuts += [self.crossings(p, d, h) for h in self.steps.shells if h < self.air.top]
        cuts.append(enter[:, None] + np.array(self.steps.distances))
        if not self.flat:
            cuts.append(-np.sum(p * d, axis=-1, keepdims=True))  # nearest to the ground
            cuts.append(self.shadow_edges(p, d))
        cuts = np.nan_to_num(np.concatenate(cuts, axis=-1), nan=0.0, posinf=0.0, neginf=0.0)
        cuts = np.sort(np.clip(cuts, enter[:, None], leave[:, None]), axis=-1)
        width = np.diff(cuts, axis=-1)
        ray, piece = np.nonzero(width > 1e-6)
        return ray, cuts[ray, piece], width[ray, piece], leave, ends

    def shadow_edges(self, p, d):
        """Distances at which rays cross the cylinder of shadow behind the planet."""
        p_along, d_along = p @ self.to_sun, d @ self.to_sun
        a = np.sum(d * d, axis=-1) - d_along**2
        b = np.sum(p * d, axis=-1) - p_along * d_along
        c = np.sum(p * p, axis=-1) - p_along**2 - self.ground**2
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt(b * b - a * c)
            t = np.stack([(-b - root) / a, (-b + root) / a, -p_along / d_along], axis=-1)
        return t

    # ---- light

    def columns(self, p, d):
        """Densities integrated along whole rays, [ray, species]."""
        ray, start, width, _, _ = self.pieces(p, d)
        t = start[:, None] + width[:, None] * self.node
        density = self.air.density(self.altitude(p[ray][:, None] + t[..., None] * d[ray][:, None]))
        total = np.zeros((len(p), density.shape[-1]))
        np.add.at(total, ray, width[:, None] * np.einsum("j,njs->ns", self.weight, density))
        return total

    def sunlight(self, p):
        """Irradiance of the direct beam on a plane normal to it, [point, wavelength]."""
        arriving = np.zeros((len(p), len(self.air.sun)))
        lit = np.nonzero(self.lit(p))[0]
        for some in np.array_split(lit, len(lit) // 20000 + 1):
            d = np.broadcast_to(self.to_sun, p[some].shape)
            depth = self.columns(p[some], d) @ self.air.extinction
            arriving[some] = self.air.sun * np.exp(-depth)
        return arriving

    def path(self, p, d):
        """Sample rays: ray of each piece, points and weights, density, column to the start."""
        ray, start, width, leave, ends = self.pieces(p, d)
        t = start[:, None] + width[:, None] * self.node
        points = p[ray][:, None] + t[..., None] * d[ray][:, None]
        density = self.air.density(self.altitude(points))
        whole = width[:, None] * np.einsum("j,njs->ns", self.weight, density)
        before = np.cumsum(whole, axis=0) - whole
        first = np.searchsorted(ray, ray)  # pieces come ray by ray
        column = (before - before[first])[:, None] + width[:, None, None] * np.einsum(
            "jk,nks->njs", self.partial, density
        )
        total = np.zeros((len(p), density.shape[-1]))
        np.add.at(total, ray, whole)
        return ray, points, width[:, None] * self.weight, density, column, total, leave, ends

    def first(self, p, d):
        """First-order radiance of rays, [ray, wavelength]."""
        parts = np.array_split(np.arange(len(p)), len(p) // 1000 + 1)
        return np.concatenate([self._first(p[some], d[some]) for some in parts])

    def _first(self, p, d):
        air = self.air
        ray, points, weight, density, column, total, leave, ends = self.path(p, d)
        sun = self.sunlight(points.reshape(-1, 3)).reshape(*points.shape[:2], len(air.sun))
        into_view = air.scattered(density, (d[ray] @ self.to_sun)[:, None])
        arriving = sun * into_view * np.exp(-column @ air.extinction)
        radiance = np.zeros((len(p), len(air.sun)))
        np.add.at(radiance, ray, np.einsum("nj,njw->nw", weight, arriving))
        if np.any(ends) and np.any(air.albedo > 0):
            spot = self.on_ground(p[ends] + leave[ends, None] * d[ends])
            cos_sun = np.maximum(self.up(spot) @ self.to_sun, 0.0)
            light = self.sunlight(spot) * cos_sun[:, None]
            radiance[ends] += air.albedo / np.pi * light * np.exp(-total[ends] @ air.extinction)
        return radiance

    def second(self, p, d):
        """Second-order radiance of one ray, [wavelength]."""
        air = self.air
        _, points, weight, density, column, total, leave, ends = self.path(p[None], d[None])
        radiance = np.zeros(len(air.sun))
        through = np.exp(-column @ air.extinction)
        for point, w, rho, t in zip(
            points.reshape(-1, 3),
            weight.ravel(),
            density.reshape(-1, density.shape[-1]),
            through.reshape(-1, through.shape[-1]),
            strict=True,
        ):
            ways, mirrored, solid_angle = self.sphere(point)
            light = self.first(np.broadcast_to(point, ways.shape), ways)
            into_view = 0.5 * (air.scattered(rho, ways @ d) + air.scattered(rho, mirrored @ d))
            radiance += w * t * (solid_angle @ (light * into_view))
        if ends[0] and np.any(air.albedo > 0):
            spot = self.on_ground(p + leave[0] * d)
            ways, _, solid_angle = self.sphere(spot)
            cosine = np.maximum(ways @ self.up(spot), 0.0)
            light = self.first(np.broadcast_to(spot, ways.shape), ways)
            irradiance = (solid_angle * cosine) @ light
            radiance += air.albedo / np.pi * irradiance * np.exp(-total[0] @ air.extinction)
        return radiance

    def on_ground(self, p):
        """Move points onto the ground that miss it by rounding."""
        return p * [1.0, 1.0, 0.0] if self.flat else self.ground * self.up(p)

    def sphere(self, p):
        """Directions on the half sphere beside the sun, their mirror images, solid angles.

        Light arriving at a point is the same on both sides of the plane through the zenith and
        the sun, so the weights count each direction twice. Zenith angles crowd at the horizon.
        """
        up = self.up(p)
        size = self.ground + max(float(self.altitude(p)), 0.0)
        horizon = np.pi / 2 if self.flat else np.pi - np.arcsin(self.ground / size)
        aside = self.to_sun - (self.to_sun @ up) * up
        if np.linalg.norm(aside) < 1e-9:
            aside = np.cross(up, [0.0, 1.0, 0.0])
        forward = aside / np.linalg.norm(aside)
        left = np.cross(up, forward)
        x, w = np.polynomial.legendre.leggauss(self.steps.zeniths)
        u, w = 0.5 * (x + 1), 0.5 * w
        above, below = horizon, np.pi - horizon
        theta = np.concatenate([horizon - above * u**2, horizon + below * u**2])
        weight = np.concatenate([above * 2 * u * w, below * 2 * u * w]) * np.sin(theta)
        step = np.pi / self.steps.azimuths
        phi = (np.arange(self.steps.azimuths) + 0.5) * step
        theta, phi = (a.ravel() for a in np.meshgrid(theta, phi, indexing="ij"))
        solid_angle = 2 * step * np.repeat(weight, self.steps.azimuths)
        rising = np.cos(theta)[:, None] * up + (np.sin(theta) * np.cos(phi))[:, None] * forward
        sideways = (np.sin(theta) * np.sin(phi))[:, None] * left
        return rising + sideways, rising - sideways, solid_angle
