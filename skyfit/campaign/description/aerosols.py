"""Aerosols: the paper's haze, Ångström's law, spheres after Mie, tables."""

from typing import NamedTuple

import numpy as np

from ..._typing import ArrayLike
from ...atmosphere import Constituent
from ...errors import InputError
from ...phase import AbstractPhaseFunction, CornetteShanks, HenyeyGreenstein, Tabulated
from ...preetham_air import haze_phase, haze_scattering
from .mie import mie_optics
from .profiles import build_profile, column_of
from .spectra import Part, Wavelengths, spectrum_at


KOSCHMIEDER = 3.912  # -ln 0.02: contrast at the meteorological range
VISIBLE_AT = 550.0  # nm, of turbidity and meteorological range


class Optics(NamedTuple):
    """How an aerosol scatters, whatever the amount.

    Attributes:
        extinction: Up to a factor, unless the table gives no other amount [m⁻¹].
        albedo: Scattering over extinction.
        phase: Phase function.
    """

    extinction: Wavelengths
    albedo: Wavelengths
    phase: AbstractPhaseFunction


class Surroundings(NamedTuple):
    """What amounts are measured against.

    Attributes:
        gas_depth: Vertical optical depth of scattering by gases at 550 nm.
        extinction: Extinction of all gases at the ground, 550 nm [m⁻¹].
        top: Altitude where the atmosphere ends [m].
    """

    gas_depth: float
    extinction: float
    top: float


def build_aerosol(part: Part, wavelengths: Wavelengths, around: Surroundings) -> Constituent:
    """The constituent a table of a campaign file describes.

    Raises:
        InputError: The amount asked for is impossible among the gases around.
    """
    density = build_profile(part["profile"])
    optics = _optics(part, wavelengths)
    wanted, at = _extinction_wanted(part, around, column_of(density, around.top, part["name"]))
    if wanted is not None:
        whole = part | {"forward_peak_deg": 0.0}  # amounts count all that is scattered
        per_amount = float(_optics(whole, np.array([at])).extinction[0])
        if not per_amount > 0:
            raise InputError(
                f"constituents.{part['name']}: expected an extinction above 0 at {at:g} nm, where "
                f"the amount holds; got {per_amount:g}"
            )
        scale = wanted / per_amount
    else:
        scale = part.get("number_density_per_m3", 1.0)
    extinction = scale * optics.extinction
    scattering = extinction * optics.albedo
    return Constituent(density, scattering, extinction - scattering, phase=optics.phase)


def _extinction_wanted(
    part: Part, around: Surroundings, column: float
) -> tuple[float | None, float]:
    """Extinction at density 1 and the wavelength where it holds [m⁻¹, nm], if asked for."""
    at = part.get("reference_wavelength_nm", VISIBLE_AT)
    if "optical_depth" in part:
        return part["optical_depth"] / column, at
    if "extinction_per_m" in part:
        return part["extinction_per_m"], at
    if "angstrom_beta" in part:
        return part["angstrom_beta"] / column, 1000.0
    if "turbidity" in part:
        return (part["turbidity"] - 1) * around.gas_depth / column, VISIBLE_AT
    if "visibility_m" in part:
        rest = KOSCHMIEDER / part["visibility_m"] - around.extinction
        if rest < 0:
            clear = KOSCHMIEDER / around.extinction
            raise InputError(
                f"constituents.{part['name']}.visibility_m: expected at most {clear:.6g}, the "
                f"meteorological range of the gases alone; got {part['visibility_m']:g}"
            )
        return rest, VISIBLE_AT
    return None, at


def _optics(part: Part, wavelengths: Wavelengths) -> Optics:
    if part["kind"] == "preetham_haze":
        # Any turbidity: the amount is a factor.
        extinction = np.asarray(haze_scattering(2.0, wavelengths), float)
        return Optics(extinction, np.ones_like(wavelengths), haze_phase(wavelengths))
    if part["kind"] == "angstrom_aerosol":
        extinction = (VISIBLE_AT / wavelengths) ** part["angstrom_exponent"]
        albedo = spectrum_at(part["single_scattering_albedo"], wavelengths)
        return Optics(extinction, albedo, _lobe(part, wavelengths))
    if part["kind"] == "mie_aerosol":
        found = mie_optics(part, wavelengths)
        return Optics(found.extinction, found.albedo, Tabulated(found.angle, found.phase))
    extinction = spectrum_at(part["extinction"], wavelengths)
    albedo = spectrum_at(part["single_scattering_albedo"], wavelengths)
    if "phase" not in part:
        return Optics(extinction, albedo, _lobe(part, wavelengths))
    table = part["phase"]
    angle = np.radians(table["angle_deg"])
    if "wavelength_nm" in table:
        phase = phase_between(angle, table["wavelength_nm"], table["value"], wavelengths)
    else:
        phase = Tabulated(angle, table["value"])
    return Optics(extinction, albedo, phase)


def phase_between(
    angle: ArrayLike, nodes: ArrayLike, value: ArrayLike, wavelengths: Wavelengths
) -> Tabulated:
    """Phase functions known at some wavelengths, linear in between and held beyond.

    Args:
        angle: Scattering angles, increasing [rad].
        nodes: Wavelengths at which they are known, increasing [nm].
        value: Values above 0 at each angle, a row for each of these; any factor.
        wavelengths: Wavelengths of the result [nm].
    """
    known = Tabulated(angle, np.asarray(value, float).T)
    known_at, rows = np.asarray(nodes, float), np.exp(np.asarray(known.log_value, float))
    return Tabulated(angle, np.stack([np.interp(wavelengths, known_at, row) for row in rows]))


def _lobe(part: Part, wavelengths: Wavelengths) -> AbstractPhaseFunction:
    forms = {"henyey_greenstein": HenyeyGreenstein, "cornette_shanks": CornetteShanks}
    g = part["asymmetry"]
    return forms[part["phase_form"]](spectrum_at(g, wavelengths) if isinstance(g, dict) else g)
