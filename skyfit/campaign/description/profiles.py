"""Density profiles as files give them."""

from ... import profile
from ...preetham_air import ozone_layer
from .spectra import Part


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
