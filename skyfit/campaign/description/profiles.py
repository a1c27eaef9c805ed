"""Density profiles as files give them."""

from ... import profile
from ...errors import InputError
from ...preetham_air import ozone_layer
from .spectra import Part


def column_of(density: profile.AbstractProfile, top: float, name: str) -> float:
    """Vertical column of a profile from the ground to the top, of which there must be some [m].

    Args:
        density: Profile.
        top: Altitude where the atmosphere ends [m].
        name: Name of the constituent, for messages.

    Raises:
        InputError: Nothing of it is below the top.
    """
    column = float(density.column(top))
    if not column > 0:
        raise InputError(
            f"constituents.{name}.profile: expected some density below top_altitude_m; got a "
            f"column of {column:g} m"
        )
    return column


def build_profile(part: Part) -> profile.AbstractProfile:
    """The profile that a table of a campaign file describes."""
    kind = part["kind"]
    if kind == "exponential":
        return profile.Exponential(part["scale_height_m"])
    if kind == "table":
        return profile.Tabulated(part["density"]["altitude_m"], part["density"]["value"])
    if kind == "tent":
        ends = part["bottom_m"], part["peak_m"], part["top_m"]
        altitudes = ends if ends[0] == 0 else (0.0, *ends)
        return profile.Tabulated(altitudes, [0.0] * (len(altitudes) - 2) + [1.0, 0.0])
    return {
        "us_standard_1976": profile.StandardAtmosphere,
        "elterman_1968": profile.elterman_haze,
        "ozone": ozone_layer,
    }[kind]()
