"""Atmospheres that are hard to simulate, by name; monochromatic, under a sun of 1.

Set U unless said: a planet of 6371 km with a top at 80 km, Rayleigh air of scale height 8 km,
ozone that only absorbs, and what the name says. Optical depths are vertical. Their radiances,
computed by Monte Carlo, stand in `tests/reference/`.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

import skyfit
from skyfit import phase, profile
from skyfit.campaign.description.mie import mie_optics
from skyfit.preetham_air import preetham_atmosphere


WAVELENGTH = 550.0  # nm; only where optics are computed from it does it matter
OZONE_ALTITUDE = np.array([8e3, 15e3, 22e3, 30e3, 40e3, 60e3])  # m
OZONE = np.array([0.0, 0.3, 1.0, 0.5, 0.1, 0.0])
LAYER = np.array([2999.0, 3400.0, 4600.0, 5000.0])  # m
STRATOSPHERE = np.array([17e3, 19e3, 21e3, 25e3])  # m
SLAB = np.array([0.0, 1.0, 1.0, 0.0])


class Planet(NamedTuple):
    """Radius, top and scale heights [m], and by what the altitudes of ozone are stretched."""

    radius: float
    top: float
    air: float
    haze: float
    stretch: float = 1.0


EARTH = Planet(6.371e6, 80e3, 8e3, 1.5e3)
MARS = Planet(3.39e6, 100e3, 11e3, 11e3)
TITAN = Planet(2.575e6, 600e3, 45e3, 50e3, 8.0)


class Particles(NamedTuple):
    """Optical depth, single-scattering albedo and phase function of an aerosol."""

    depth: float
    albedo: float
    phase: phase.AbstractPhaseFunction


class Case(NamedTuple):
    """What an atmosphere is made of; haze is exponential, layers are between their altitudes."""

    ground_albedo: float = 0.1
    air: float = 0.0973
    ozone: float = 0.03
    haze: Particles | None = None
    layer: Particles | None = None
    layer_altitude: np.ndarray = LAYER
    planet: Planet = EARTH


def _henyey(depth: float, albedo: float, g: float) -> Particles:
    return Particles(depth, albedo, phase.HenyeyGreenstein(g))


def _two_terms(depth: float) -> Particles:
    """0.98 of Henyey & Greenstein's function at g = 0.93, 0.02 at -0.5."""
    angle = np.pi * (np.arange(601) / 600) ** 2
    mu = np.cos(angle)

    def one(g):
        return (1 - g**2) / (1 + g**2 - 2 * g * mu) ** 1.5

    return Particles(depth, 1.0, phase.Tabulated(angle, 0.98 * one(0.93) + 0.02 * one(-0.5)))


@cache
def _mars_dust():
    """Albedo and phase function of the dust of `sims/mars.toml`, its forward peak left in."""
    part = {
        "size": {
            "kind": "gamma",
            "effective_radius_nm": 1600,
            "effective_variance": 0.2,
            "smallest_radius_nm": 30,
            "largest_radius_nm": 8000,
        },
        "refractive_index": 1.5,
        "absorption_index": {
            "wavelength_nm": [380, 440, 530, 600, 670, 780],
            "value": [0.016, 0.0115, 0.0066, 0.0031, 0.0024, 0.0022],
        },
    }
    optics = mie_optics(part, np.array([WAVELENGTH]))
    return float(optics.albedo[0]), phase.Tabulated(optics.angle, optics.phase[:, 0])


def _mie_dust(depth: float) -> Case:
    return Case(0.2, haze=Particles(depth, *_mars_dust()))


def _haze_2(planet: Planet = EARTH) -> Case:
    return Case(haze=_henyey(0.2, 1.0, 0.7), planet=planet)


def _dust(planet: Planet = EARTH) -> Case:
    return Case(0.2, haze=_henyey(0.5, 0.95, 0.9), planet=planet)


# Functions: arrays made at import would not know the precision asked for later.
CASES = {
    "clear550": lambda: Case(0.0),
    "haze.2": _haze_2,
    "haze1": lambda: Case(haze=_henyey(1.0, 1.0, 0.75)),
    "haze4": lambda: Case(haze=_henyey(4.0, 1.0, 0.75)),
    "smoke.5": lambda: Case(layer=_henyey(0.5, 0.9, 0.65)),
    "smoke3": lambda: Case(layer=_henyey(3.0, 0.9, 0.65)),
    "dust g.9 t.5": _dust,
    "snow.9": lambda: Case(0.9),
    "uv320": lambda: Case(0.05, 0.93, 0.28, haze=_henyey(0.1, 0.9, 0.7)),
    "planet mars dust g.9 t.5": lambda: _dust(MARS),
    "planet titan clear550": lambda: Case(0.0, planet=TITAN),
    "planet titan haze.2": lambda: _haze_2(TITAN),
    "volcanic": lambda: Case(layer=_henyey(0.2, 1.0, 0.7), layer_altitude=STRATOSPHERE),
    "dust g.95 t1": lambda: Case(0.2, haze=_henyey(1.0, 0.95, 0.95)),
    "two terms t.5": lambda: Case(haze=_two_terms(0.5)),
    "mie dust t.5": lambda: _mie_dust(0.5),
    "mie dust t2": lambda: _mie_dust(2.0),
}
PREETHAM = {"preetham 20": 20.0, "preetham 40": 40.0}


def name_of(set_name: str, case: str) -> str:
    """The name of an atmosphere by the columns `set` and `case` of `hard_atmospheres.npz`."""
    if set_name.startswith("preetham"):
        return case.replace("turbidity", "preetham")
    return case if set_name == "U" else f"{set_name} {case}"


def hard_atmosphere(name: str) -> skyfit.Atmosphere:
    """An atmosphere of `CASES` or `PREETHAM`."""
    if name in PREETHAM:
        atm = preetham_atmosphere(PREETHAM[name], wavelengths=[WAVELENGTH])
        return skyfit.Atmosphere(
            atm.wavelengths,
            1.0,
            atm.constituents,
            atm.ground_albedo,
            atm.planet_radius,
            atm.top_altitude,
        )
    case = CASES[name]()
    planet = case.planet
    made = [_constituent(_exponential(planet.air, planet.top), case.air, 1.0, phase.Rayleigh())]
    if case.haze:
        made.append(_constituent(_exponential(planet.haze, planet.top), *case.haze))
    if case.layer:
        made.append(_constituent(_tabulated(case.layer_altitude, SLAB), *case.layer))
    ozone = _tabulated(planet.stretch * OZONE_ALTITUDE, OZONE)
    made.append(_constituent(ozone, case.ozone, 0.0, phase.Isotropic()))
    return skyfit.Atmosphere([WAVELENGTH], 1.0, made, case.ground_albedo, planet.radius, planet.top)


def _exponential(scale_height: float, top: float):
    """A profile and its column up to the top [m]."""
    return profile.Exponential(scale_height), scale_height * -np.expm1(-top / scale_height)


def _tabulated(altitude, density):
    return profile.Tabulated(altitude, density), np.trapezoid(density, altitude)


def _constituent(shape, depth: float, albedo: float, spread) -> skyfit.Constituent:
    density, column = shape
    scattering, absorption = depth * albedo / column, depth * (1 - albedo) / column
    return skyfit.Constituent(density, scattering, absorption, phase=spread)


def random_atmosphere(rng, wavelengths):
    """Air, haze, a layer anywhere and an absorber, over Earth, Mars or a moon."""
    relative = np.asarray(wavelengths) / 550.0
    bottom, depth = 10 ** rng.uniform(2, 4.6), 10 ** rng.uniform(2, 4)
    knots = bottom + depth * np.array([0, 0.2, 0.8, 1.0])
    haze, smoke = 10 ** rng.uniform(-2, 1.3, 2)
    albedo = np.where(rng.random(2) < 0.3, 1.0, rng.uniform(0.3, 1, 2))
    scale = rng.uniform(500, 3000)
    haze = haze * relative ** rng.uniform(-2, 0.3) / scale
    smoke = smoke * relative ** rng.uniform(-2, 0.3) / (0.8 * depth)
    sharp = phase.HenyeyGreenstein(rng.uniform(-0.3, 0.97))
    parts = (
        skyfit.Constituent(profile.Exponential(rng.uniform(5e3, 12e3)),
                    10 ** rng.uniform(-6.5, -4) * relative**-4.08, phase=phase.Rayleigh()),
        skyfit.Constituent(profile.Exponential(scale), haze * albedo[0], haze * (1 - albedo[0]),
                    phase=sharp),
        skyfit.Constituent(profile.Tabulated(knots, [0, 1, 1, 0]), smoke * albedo[1],
                    smoke * (1 - albedo[1]), phase=phase.HenyeyGreenstein(rng.uniform(0, 0.95))),
        skyfit.Constituent(profile.Tabulated([10e3, 22e3, 40e3], [0, 1, 0]), 0.0,
                    10 ** rng.uniform(-8, -5) * relative**3, phase=phase.Rayleigh()),
    )  # fmt: skip
    radius = rng.choice([6.371e6, 3.39e6, 1.2e6])
    return skyfit.Atmosphere(wavelengths, 1.0, parts, rng.uniform(0, 1), radius, 100e3)
