"""Gases: air, the paper's air, ozone, and any other by its cross-sections."""

from typing import NamedTuple

import numpy as np

from .. import constants
from ..atmosphere import Constituent
from ..phase import Rayleigh
from ..preetham_air import rayleigh_scattering, table2
from .profiles import build_profile
from .spectra import Part, Wavelengths, spectrum_at


DOBSON_UNIT = 1e-5  # m of pure gas at NTP
GASES = ("air", "preetham_air", "gas", "ozone")


class Coefficients(NamedTuple):
    """Scattering and absorption where the relative density is 1 [m⁻¹]."""

    scattering: Wavelengths
    absorption: Wavelengths


def build_gas(part: Part, wavelengths: Wavelengths, top: float) -> Constituent:
    """The constituent a table of a campaign file describes; it scatters after Rayleigh."""
    found = gas_coefficients(part, wavelengths, top)
    return Constituent(build_profile(part["profile"]), *found, phase=Rayleigh())


def gas_coefficients(part: Part, wavelengths: Wavelengths, top: float) -> Coefficients:
    """Coefficients of a gas.

    Args:
        part: Its table.
        wavelengths: [nm].
        top: Altitude where the atmosphere ends [m].
    """
    none = np.zeros_like(wavelengths)
    if part["kind"] == "air":
        density = part["pressure_ratio"] * constants.AIR_NUMBER_DENSITY
        return Coefficients(density * air_cross_section(wavelengths), none)
    if part["kind"] == "preetham_air":
        return Coefficients(np.asarray(rayleigh_scattering(wavelengths), float), none)
    if part["kind"] == "ozone":
        column = float(build_profile(part["profile"]).column(top))
        amount = part["dobson_units"] * DOBSON_UNIT
        return Coefficients(none, np.asarray(table2("k_ozone_m-1", wavelengths)) * amount / column)
    scattering, absorption = none, none
    if "scattering_per_m" in part:
        scattering = _fourth_power(part, part["scattering_per_m"], wavelengths)
    if "scattering_cross_section_m2" in part:
        section = _fourth_power(part, part["scattering_cross_section_m2"], wavelengths)
        scattering = part["number_density_per_m3"] * section
    if "absorption_per_m" in part:
        absorption = spectrum_at(part["absorption_per_m"], wavelengths)
    if "absorption_cross_section_m2" in part:
        section = spectrum_at(part["absorption_cross_section_m2"], wavelengths)
        absorption = part["number_density_per_m3"] * section
    return Coefficients(scattering, absorption)


def air_cross_section(wavelengths: Wavelengths) -> Wavelengths:
    """Rayleigh scattering cross-section of a molecule of dry air [m²].

    Bodhaine, Wood, Dutton & Slusser (1999), "On Rayleigh Optical Depth Calculations", J. Atmos.
    Oceanic Technol. 16, equation 29: at 550 nm 4.513e-31. It is 15 % below the coefficient of
    Preetham et al. (1999), whose refractive index of 1.0003 is rounded up.

    Args:
        wavelengths: 250 to 850 [nm].
    """
    square = (1e-3 * wavelengths) ** 2  # µm²
    above = 1.0455996 - 341.29061 / square - 0.90230850 * square
    below = 1 + 0.0027059889 / square - 85.968563 * square
    return 1e-32 * above / below


def _fourth_power(part: Part, spectrum, wavelengths: Wavelengths) -> Wavelengths:
    """One number holds at the reference wavelength and falls as λ⁻⁴; tables are interpolated."""
    fall = (part["reference_wavelength_nm"] / wavelengths) ** 4
    if not isinstance(spectrum, dict):
        return spectrum * fall
    # Tables may be coarse: what is linear between their wavelengths is λ⁴ times the coefficient.
    nodes = np.array(spectrum["wavelength_nm"])
    risen = np.array(spectrum["value"]) * (nodes / part["reference_wavelength_nm"]) ** 4
    return np.interp(wavelengths, nodes, risen) * fall
