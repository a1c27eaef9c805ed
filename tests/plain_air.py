"""An atmosphere as plain NumPy: what the slow twin of the simulator works with.

Densities and phase functions are written out once more here, so that a slip in the library's own
shows as a difference.
"""

from collections.abc import Callable

import numpy as np

from skyfit import phase as sky_phase, profile as sky_profile


class Air:
    """An atmosphere as plain arrays and NumPy callables."""

    def __init__(self, atm):
        self.scattering = np.asarray(atm.scattering, float)  # [species, wavelength]
        self.extinction = np.asarray(atm.extinction, float)
        self.sun = np.asarray(atm.solar_irradiance, float)
        self.albedo = np.asarray(atm.ground_albedo, float)
        self.radius, self.top = float(atm.planet_radius), float(atm.top_altitude)
        self.densities = [_density(one.density, self.top) for one in atm.constituents]
        self.phases = [_phase(one.phase) for one in atm.constituents]

    def density(self, altitude):
        """Relative densities [..., species]."""
        return np.stack([rho(altitude) for rho in self.densities], axis=-1)

    def scattered(self, density, cos_angle):
        """Coefficient of scattering into one direction [..., wavelength], in 1/(m sr)."""
        total = 0.0
        for s, phase in enumerate(self.phases):
            total = total + density[..., s, None] * phase(cos_angle) * self.scattering[s]
        return total


def _density(profile, top: float) -> Callable:
    """A profile's relative density as a NumPy callable."""
    if isinstance(profile, sky_profile.Exponential):
        scale_height = float(profile.scale_height)
        return lambda h: np.exp(-h / scale_height)
    if isinstance(profile, sky_profile.Tabulated):
        altitude, rho = np.asarray(profile.altitude), np.asarray(profile.relative_density)
        return lambda h: np.interp(h, altitude, rho, right=0.0)
    # Any other is sampled so finely that interpolation errs by (5 m / 7 km)² / 8 = 6e-8 at most.
    grid = np.arange(-5.0, top + 10.0, 5.0)
    logarithm = np.log(np.asarray(profile(grid), float))
    return lambda h: np.exp(np.interp(h, grid, logarithm))


def _phase(phase) -> Callable:
    """A phase function as a NumPy callable, [...] -> [..., wavelength or 1]."""
    if isinstance(phase, sky_phase.Isotropic):
        return lambda mu: np.full((*np.shape(mu), 1), 1 / (4 * np.pi))
    if isinstance(phase, sky_phase.Rayleigh):
        delta = np.asarray(phase.depolarisation)
        scale = 1.5 / (2 + delta) / (4 * np.pi)
        return lambda mu: scale * (1 + delta + (1 - delta) * mu[..., None] ** 2)
    if isinstance(phase, sky_phase.HenyeyGreenstein):
        return lambda mu: _henyey_greenstein(np.asarray(phase.g), mu)
    if isinstance(phase, sky_phase.CornetteShanks):
        g = np.asarray(phase.g)
        return lambda mu: 1.5 * (1 + mu[..., None] ** 2) / (2 + g**2) * _henyey_greenstein(g, mu)
    angle, log_value = np.asarray(phase.angle), np.asarray(phase.log_value)

    def tabulated(mu):
        theta = np.arccos(np.clip(mu, -1, 1))
        return np.stack([np.exp(np.interp(theta, angle, row)) for row in log_value.T], axis=-1)

    return tabulated


def _henyey_greenstein(g, mu):
    return (1 - g**2) / (4 * np.pi * (1 + g**2 - 2 * g * mu[..., None]) ** 1.5)
