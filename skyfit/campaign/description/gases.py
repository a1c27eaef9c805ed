"""Gases: air, the paper's air, absorbers by their cross-sections or bands, and any other gas."""

from typing import NamedTuple

import numpy as np

from ... import constants
from ...atmosphere import Constituent
from ...phase import Rayleigh
from ...preetham_air import rayleigh_scattering, table2
from ...profile import AbstractProfile, Raised, Squared
from ...tables import read_table
from .bands import oxygen, water_vapour
from .profiles import build_profile, column_of
from .spectra import Part, Wavelengths, spectrum_at


DOBSON_UNIT = 1e-5  # m of pure gas at NTP
BANDED = ("water_vapour", "oxygen")
GASES = ("air", "preetham_air", "gas", "ozone", "nitrogen_dioxide", "oxygen_dimer", *BANDED)
NITROGEN_DIOXIDE_AT = 220.0, 294.0  # K, of the two columns of Vandaele et al. (1998)
CARBON_DIOXIDE = 0.036  # % of air by volume; Bodhaine et al. (1999) have 360 ppm


class Coefficients(NamedTuple):
    """Scattering and absorption where the relative density is 1 [m⁻¹]."""

    scattering: Wavelengths
    absorption: Wavelengths


def build_gas(part: Part, wavelengths: Wavelengths, top: float) -> Constituent:
    """The constituent a table of a campaign file describes; it scatters after Rayleigh."""
    if part["kind"] in BANDED:
        column_of(gas_profile(part), top, part["name"])
    if part["kind"] == "water_vapour":
        water = part["precipitable_water_cm"] * 1e-2
        return water_vapour(wavelengths, water, gas_profile(part), top)
    if part["kind"] == "oxygen":
        profile, pressure = gas_profile(part), part["pressure_ratio"]
        if ground := part.get("ground_altitude_m"):
            whole = build_profile(part["profile"]).column(top + ground)
            pressure *= float(profile.column(top) / whole)
        return oxygen(wavelengths, pressure, profile, top)
    found = gas_coefficients(part, wavelengths, top)
    return Constituent(gas_profile(part), *found, phase=_phase(part, wavelengths))


def gas_profile(part: Part) -> AbstractProfile:
    """Relative density of what scatters or absorbs; pairs of molecules go with the square."""
    profile = build_profile(part["profile"])
    if "ground_altitude_m" in part:
        profile = Raised(profile, part["ground_altitude_m"])
    return Squared(profile) if part["kind"] == "oxygen_dimer" else profile


def gas_coefficients(part: Part, wavelengths: Wavelengths, top: float) -> Coefficients:
    """Coefficients of a gas, without bands.

    Args:
        part: Table of the gas.
        wavelengths: Wavelengths of the result [nm].
        top: Altitude where the atmosphere ends [m].
    """
    none = np.zeros_like(wavelengths)
    kind = part["kind"]
    if kind == "air":
        density = part["pressure_ratio"] * constants.AIR_NUMBER_DENSITY
        return Coefficients(density * air_cross_section(wavelengths), none)
    if kind == "preetham_air":
        return Coefficients(np.asarray(rayleigh_scattering(wavelengths), float), none)
    if kind == "oxygen_dimer":
        oxygen = part["oxygen_fraction"] * part["pressure_ratio"] * constants.AIR_NUMBER_DENSITY
        return Coefficients(none, oxygen**2 * oxygen_dimer_cross_section(wavelengths))
    if kind in ("ozone", "nitrogen_dioxide"):
        depth = _vertical_absorption(part, wavelengths)
        return Coefficients(none, depth / column_of(gas_profile(part), top, part["name"]))
    # Gases with bands have nothing else: no line of them is near the wavelength of visibilities.
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


def air_depolarisation(wavelengths: Wavelengths) -> Wavelengths:
    """Depolarisation δ of light scattered by dry air at 90° [1]: 0.0283 at 550 nm.

    From the King factor F that the cross-section contains, δ = 6 (F - 1) / (3 + 7 F): Bodhaine et
    al. (1999), equations 5, 6 and 23, at 360 ppm of carbon dioxide.

    Args:
        wavelengths: 200 nm or more [nm].
    """
    square = (1e-3 * wavelengths) ** 2  # µm²
    nitrogen = 1.034 + 3.17e-4 / square
    oxygen = 1.096 + 1.385e-3 / square + 1.448e-4 / square**2
    parts = 78.084, 20.946, 0.934, CARBON_DIOXIDE
    king = (parts[0] * nitrogen + parts[1] * oxygen + parts[2] + parts[3] * 1.15) / sum(parts)
    return 6 * (king - 1) / (3 + 7 * king)


def ozone_cross_section(wavelengths: Wavelengths) -> Wavelengths:
    """Absorption cross-section of ozone at 223 K [m²]: 3.5e-23 at 300, 5.2e-25 at 600 nm.

    Bogumil et al. (2003); means over 1 nm up to 360 nm (Hartley's and Huggins's bands), over 5 nm
    above (Chappuis's). Another measurement (Malicet et al. 1995, Brion et al. 1998) is within 3 %
    of it up to 325 nm, 7 % to 345 nm, and 4 % at 480 to 650 nm; in between, where 300 Dobson units
    have an optical depth of 0.004 at most, they differ more. Sampled more coarsely than by 1 nm,
    Huggins's bands are met or missed.

    Args:
        wavelengths: 280 to 830 [nm]; held constant beyond.
    """
    return _measured("bogumil2003_ozone", "cross_section_m2", wavelengths)


def nitrogen_dioxide_cross_section(wavelengths: Wavelengths, temperature: float) -> Wavelengths:
    """Absorption cross-section of nitrogen dioxide [m²]: 6.4e-23 at 400 nm.

    Vandaele et al. (1998) up to 660 nm, Bogumil et al. (2003) above; means over 5 nm, linear in
    temperature. Up to 600 nm the latter are 1 % (294 K) and 4 % (220 K) above the former.

    Args:
        wavelengths: 300 to 760 [nm]; held constant beyond.
        temperature: 220 to 294 [K].
    """
    cold, warm = (
        _measured("vandaele1998_nitrogen_dioxide", f"cross_section_{at:.0f}K_m2", wavelengths)
        for at in NITROGEN_DIOXIDE_AT
    )
    share = (temperature - NITROGEN_DIOXIDE_AT[0]) / np.ptp(NITROGEN_DIOXIDE_AT)
    return (1 - share) * cold + share * warm


def oxygen_dimer_cross_section(wavelengths: Wavelengths) -> Wavelengths:
    """Absorption of pairs of oxygen molecules, over the square of their density [m⁵].

    Thalman & Volkamer (2013) at 273 K, and Karman et al. (2019) above 600 nm; means over 2 nm. At
    293 K the bands' peaks are up to 5 % lower, and their areas the same within 5 %.

    Args:
        wavelengths: 336 to 792 [nm]; none beyond.
    """
    return _measured("thalman2013_oxygen_dimer", "binary_cross_section_m5", wavelengths)


def _measured(table: str, column: str, wavelengths: Wavelengths) -> Wavelengths:
    """Linear between a table's wavelengths, constant beyond its ends."""
    data = read_table(table)
    return np.interp(wavelengths, data["wavelength_nm"], data[column])


def _vertical_absorption(part: Part, wavelengths: Wavelengths) -> Wavelengths:
    """Vertical optical depth of a gas of which the column is given."""
    # Records of campaigns from before there was a choice have none, and had the paper's.
    if part["kind"] == "ozone" and part.get("cross_section", "preetham1999") == "preetham1999":
        thickness = part["dobson_units"] * DOBSON_UNIT
        return np.asarray(table2("k_ozone_m-1", wavelengths), float) * thickness
    if "column_per_m2" in part:
        molecules = part["column_per_m2"]
    else:
        molecules = part["dobson_units"] * DOBSON_UNIT * constants.LOSCHMIDT
    if part["kind"] == "ozone":
        return molecules * ozone_cross_section(wavelengths)
    return molecules * nitrogen_dioxide_cross_section(wavelengths, part["temperature_K"])


def _phase(part: Part, wavelengths: Wavelengths) -> Rayleigh:
    """Rayleigh's, with the gas's depolarisation; records from before there was one have none."""
    if part["kind"] == "air" and part.get("depolarised", False):
        return Rayleigh(air_depolarisation(wavelengths))
    delta = part.get("depolarisation", 0.0)
    return Rayleigh(spectrum_at(delta, wavelengths) if isinstance(delta, dict) else delta)


def _fourth_power(part: Part, spectrum, wavelengths: Wavelengths) -> Wavelengths:
    """One number holds at the reference wavelength and falls as λ⁻⁴; tables are interpolated."""
    fall = (part["reference_wavelength_nm"] / wavelengths) ** 4
    if not isinstance(spectrum, dict):
        return spectrum * fall
    # Tables may be coarse: what is linear between their wavelengths is λ⁴ times the coefficient.
    nodes = np.array(spectrum["wavelength_nm"])
    risen = np.array(spectrum["value"]) * (nodes / part["reference_wavelength_nm"]) ** 4
    return np.interp(wavelengths, nodes, risen) * fall
