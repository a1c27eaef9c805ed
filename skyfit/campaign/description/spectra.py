"""Spectra as files give them, and the sun's.

A spectrum is one number for all wavelengths, or a table {wavelength_nm, value} that is linear
between its wavelengths and held constant beyond its ends.
"""

from typing import Any

import numpy as np
from jaxtyping import Float

from ...constants import ASTRONOMICAL_UNIT, SUN_RADIUS
from ...preetham_air import solar_irradiance
from ...tables import read_table


Part = dict[str, Any]
Wavelengths = Float[np.ndarray, " wavelength"]

# CODATA 2018, exact
_PLANCK = 6.62607015e-34  # J s
_LIGHT_SPEED = 299792458.0  # m/s
_BOLTZMANN = 1.380649e-23  # J/K


def spectrum_at(spectrum: Any, wavelengths: Wavelengths) -> Wavelengths:
    """A spectrum at wavelengths [nm]."""
    if isinstance(spectrum, dict):
        nodes, values = np.array(spectrum["wavelength_nm"]), np.array(spectrum["value"])
        return np.interp(wavelengths, nodes, values)
    return np.full(wavelengths.shape, float(spectrum))


def sunlight_above(sun: Part, wavelengths: Wavelengths) -> Wavelengths:
    """Irradiance above the atmosphere, normal to the beam [W m⁻² nm⁻¹].

    Every spectrum is that at one astronomical unit, and falls with the square of the distance.
    """
    kind = sun["spectrum"]
    if kind == "preetham1999":
        light = np.asarray(solar_irradiance(wavelengths), float)
    elif kind == "astm_g173":
        table = read_table("astm_g173_sun")
        nodes, values = table["wavelength_nm"], table["irradiance_W_m-2_nm-1"]
        light = _box_mean(nodes, values, wavelengths, sun["bandwidth_nm"])
    elif kind == "blackbody":
        radius = sun["radius_solar"] * SUN_RADIUS
        light = (
            np.pi * (radius / ASTRONOMICAL_UNIT) ** 2 * planck(sun["temperature_K"], wavelengths)
        )
    else:
        light = spectrum_at(sun["irradiance_W_per_m2_nm"], wavelengths)
    return light / sun["distance_au"] ** 2


def planck(temperature: float, wavelengths: Wavelengths) -> Wavelengths:
    """Spectral radiance of a black body [W m⁻² sr⁻¹ nm⁻¹].

    2 h c² / λ⁵ / (e^{hc/λkT} - 1).

    Args:
        temperature: Temperature of the body [K].
        wavelengths: Wavelengths of the result [nm].
    """
    lam = 1e-9 * wavelengths
    exponent = _PLANCK * _LIGHT_SPEED / (lam * _BOLTZMANN * temperature)
    return 1e-9 * 2 * _PLANCK * _LIGHT_SPEED**2 / lam**5 / np.expm1(exponent)


def _box_mean(nodes, values, wavelengths, width: float) -> Wavelengths:
    """Mean of a table over a band around each wavelength: the sun's lines are narrower."""
    if width == 0:
        return np.interp(wavelengths, nodes, values)
    steps = np.diff(nodes) * 0.5 * (values[1:] + values[:-1])
    total = np.concatenate([[0.0], np.cumsum(steps)])
    low = np.clip(wavelengths - width / 2, nodes[0], nodes[-1] - width)
    return (np.interp(low + width, nodes, total) - np.interp(low, nodes, total)) / width
