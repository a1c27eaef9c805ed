"""A slow, obvious Monte Carlo twin of the simulator: photons followed backward from the eye.

Scalar radiance in a spherical atmosphere over a Lambertian ground; rays are straight. The centre of
the planet is the origin, the observer stands on the z axis, the sun lies in the plane y = 0. It
shares nothing with the simulator but the description of the atmosphere.

The atmosphere is cut into some 250 shells, in each of which coefficients are linear in altitude. A
ray is a chain of pieces, one a shell; along a piece the coefficient is nearly quadratic in the
distance, and Simpson's rule integrates it. No transmittance is tabulated.

From the eye a path goes backward from collision to collision. Every collision is forced to happen
within the atmosphere; what is scattered there and what the ground reflects at the end of the ray
both look at the sun (the local estimate), and the path goes on from one of the two, drawn in
proportion to their weights. An order counts the interactions, a reflection by the ground being one.

Three things keep the variance small where phase functions are peaked and where the sun is low:

- Beside the direction in which a path goes on, another is drawn around the sun and followed for one
  collision only; the two estimates of the next order are weighted by the balance heuristic (Veach &
  Guibas 1995, "Optimally combining sampling techniques for Monte Carlo rendering").
- Some paths go on around the sun, the fewer the later, and carry the ratio of the densities (Buras
  & Mayer 2011, "Efficient unbiased variance reduction techniques for Monte Carlo simulations of
  radiative transfer in cloudy atmospheres").
- The point that looks at the sun is drawn where the planet throws no shadow, another one than the
  path goes on from if part of the ray is in the shadow.

Numba compiles the loops, in `photon_paths.py` and `photon_rays.py`. It comes with miepython; the
tests themselves need only the numbers that `tests/reference/make_monte_carlo_skies.py` keeps.
"""

import time
from dataclasses import dataclass

import numpy as np
from photon_paths import NUM_ANGLES, single, walk
from photon_rays import Tables, enter
from plain_air import Air


BATCHES = 16
FINE = 16_000  # altitudes between which the description is taken as linear
COLUMN_ERROR = 1e-6  # in a shell, of a constituent's whole column
SHELL_ERROR = 1.5e-4  # in a shell, of the extinction in it
NODE, WEIGHT = (0.5 * a for a in np.polynomial.legendre.leggauss(6))
NODE += 0.5


@dataclass(frozen=True)
class Sky:
    """Radiance of one direction per unit solar irradiance [sr⁻¹], with standard errors."""

    order1: float
    order2: float
    order2_se: float
    order3: float
    order3_se: float
    total: float
    total_se: float


class Shells:
    """An atmosphere at one wavelength, in shells.

    Attributes:
        shells: Radii of the edges of the shells, the ground's first [m].
        extinction: At each edge [m⁻¹].
        scattering: Of each constituent that scatters, at each edge [m⁻¹].
        phase: Of each such constituent at NUM_ANGLES + 1 angles π (i / NUM_ANGLES)² [sr⁻¹].
        chance: Cumulative probability of those angles.
        albedo: Of the ground.
    """

    def __init__(self, atm, wavelength: int = 0):
        air, knots = Air(atm), np.asarray(atm.knots())
        fine = np.union1d(np.linspace(0, air.top, FINE + 1), knots)
        fine = fine[(fine >= 0) & (fine <= air.top)]
        density = air.density(fine)
        scattering, extinction = air.scattering[:, wavelength], air.extinction[:, wavelength]
        edge = _edges(fine, density * extinction, knots)
        # Columns stay what they are: chords of a convex profile lie above it.
        columns = (np.trapezoid(density[e], fine[e], axis=0) for e in (slice(None), edge))
        density = density * np.divide(*columns)
        self.shells = air.radius + fine[edge]
        self.extinction = density[edge] @ extinction
        bright = np.nonzero(scattering > 0)[0]
        self.scattering = np.ascontiguousarray((density[edge][:, bright] * scattering[bright]).T)
        tables = [_phase_table(air.phases[k], wavelength) for k in bright]
        self.phase, self.chance = (np.array(a) for a in zip(*tables, strict=True))
        self.albedo = float(air.albedo[wavelength])
        column = np.trapezoid(self.scattering, self.shells, axis=1)
        self.share = column / column.sum()

    def aim(self, sun_zenith: float):
        """Density and cumulative probability of the angles from the sun that are tried beside.

        The constituents' own functions by their columns; with a low sun, half of the time a cone
        along the horizon.
        """
        value = self.share @ self.phase
        if sun_zenith > np.radians(85):
            g, mu = 0.85, np.cos(_angles())
            cone = (1 - g**2) / (4 * np.pi * (1 + g**2 - 2 * g * mu) ** 1.5)
            value = 0.5 * value + 0.5 * cone
        return _normalised(value)


def sky(
    air: Shells,
    sun_zenith: float,
    view_zenith: float,
    relative_azimuth: float,
    observer_altitude: float = 0.0,
    target: float = 0.005,
    seconds: float = 60.0,
    first: int = 2000,
    seed: int = 1,
) -> Sky:
    """Radiance of one direction by orders. Angles in radians.

    Args:
        air: The atmosphere.
        sun_zenith: From the observer's vertical.
        view_zenith: From the observer's vertical.
        relative_azimuth: 0 toward the sun.
        observer_altitude: [m]; above the top too.
        target: Standard error over total at which to stop.
        seconds: Time of the processor after which to stop in any case.
        first: Paths of each batch before the first look at the error.
        seed: Of the random numbers.
    """
    to_sun = np.array([np.sin(sun_zenith), 0.0, np.cos(sun_zenith)])
    sine = np.sin(view_zenith)
    ray = np.array(
        [sine * np.cos(relative_azimuth), sine * np.sin(relative_azimuth), np.cos(view_zenith)]
    )
    eye = np.array([0.0, 0.0, air.shells[0] + observer_altitude])
    eye = enter(air.shells, eye, ray)
    if eye[0] != eye[0]:  # the ray misses the atmosphere
        return Sky(*[0.0] * 7)
    tables = Tables(
        air.shells,
        air.extinction,
        air.scattering,
        air.phase,
        air.chance,
        *air.aim(sun_zenith),
        air.albedo,
    )
    order1 = single(tables, eye, ray, to_sun, NODE, WEIGHT)
    randoms = np.random.default_rng(seed).spawn(BATCHES)
    sums, paths, number = np.zeros((BATCHES, 3)), 0, first
    start = time.process_time()
    while True:
        for batch, rng in enumerate(randoms):
            sums[batch] += walk(tables, eye, ray, to_sun, number, rng)
        paths += number
        mean = sums / paths
        total = order1 + mean.sum(axis=1)
        error = total.std(ddof=1) / np.sqrt(BATCHES)
        spent = time.process_time() - start
        # Errors of 16 batches are themselves uncertain by a fifth: aim a little lower.
        wanted = (1.1 * error / (target * max(total.mean(), 1e-30))) ** 2
        if wanted <= 1 or spent >= seconds:
            break
        rate = spent / paths
        number = int(min(max((wanted - 1) * paths, first), 3 * paths, (seconds - spent) / rate))
        number = max(number, first // 4)
    se = mean.std(axis=0, ddof=1) / np.sqrt(BATCHES)
    two, three, _ = mean.mean(axis=0)
    return Sky(*map(float, (order1, two, se[0], three, se[1], total.mean(), error)))


# ---- what the description becomes


def _edges(altitude, extinction, knots):
    """Indices of altitudes between which coefficients are linear enough, all knots among them."""
    panel = 0.5 * np.diff(altitude)[:, None] * (extinction[1:] + extinction[:-1])
    depth = np.concatenate([np.zeros_like(panel[:1]), np.cumsum(panel, axis=0)])
    stops = np.isin(altitude, knots)
    edge, last = [0], len(altitude) - 1
    while edge[-1] < last:
        i = edge[-1]
        j = np.arange(i + 1, min(i + FINE // 40, last) + 1)
        linear = 0.5 * (altitude[j] - altitude[i])[:, None] * (extinction[j] + extinction[i])
        true = depth[j] - depth[i]
        good = np.all(np.abs(true - linear) <= COLUMN_ERROR * depth[-1], axis=1)
        good &= np.abs((true - linear).sum(axis=1)) <= SHELL_ERROR * true.sum(axis=1)
        reach = len(j) if good.all() else max(int(np.argmin(good)), 1)
        stop = np.nonzero(stops[j[:reach]])[0]
        edge.append(int(j[stop[0]] if len(stop) else j[reach - 1]))
    return np.array(edge)


def _angles():
    return np.pi * (np.arange(NUM_ANGLES + 1) / NUM_ANGLES) ** 2


def _phase_table(phase, wavelength):
    value = phase(np.cos(_angles()))
    return _normalised(value[:, wavelength if value.shape[1] > 1 else 0])


def _normalised(value):
    """Values that are linear between the angles, and the cumulative integral, 1 at the end."""
    theta = _angles()
    slope = np.diff(value) / np.diff(theta)
    # ∫ (v + s (θ - a)) sinθ dθ from a to b, by parts.
    a, b = theta[:-1], theta[1:]
    # cos a - cos b without cancellation.
    drop = 2 * np.sin(0.5 * (a + b)) * np.sin(0.5 * (b - a))
    part = value[:-1] * drop + slope * (np.sin(b) - np.sin(a) - (b - a) * np.cos(b))
    chance = np.concatenate([[0.0], np.cumsum(2 * np.pi * part)])
    return value / chance[-1], chance / chance[-1]
