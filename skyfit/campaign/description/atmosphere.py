"""An atmosphere from its description."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import ArrayLike

from ...atmosphere import Atmosphere, Refraction
from ...errors import InputError
from .aerosols import VISIBLE_AT, Surroundings, build_aerosol
from .gases import GASES, build_gas, gas_coefficients, gas_profile
from .spectra import Part, Wavelengths, spectrum_at, sunlight_above
from .sweep import OBSERVER_ALTITUDE, replaced


@dataclass(frozen=True)
class DescribedAtmosphere:
    """An atmosphere in the words of a campaign file.

    Args:
        text: The tables `planet`, `sun`, `ground` and `constituents` as JSON, every default written
            out and every file that they name read.
    """

    text: str

    @classmethod
    def from_description(cls, description: Part) -> "DescribedAtmosphere":
        """From tables that `skyfit.campaign.file` has checked."""
        return cls(json.dumps(description, sort_keys=True))

    @property
    def description(self) -> Part:
        """The tables."""
        return json.loads(self.text)

    def build(
        self, wavelengths: ArrayLike, changes: Mapping[str, float] | None = None
    ) -> Atmosphere:
        """The atmosphere at wavelengths [nm], with other numbers at some keys.

        Raises:
            InputError: Naming the key, what was expected and what came.
        """
        description = self.description
        for key, value in (changes or {}).items():
            if key != OBSERVER_ALTITUDE:
                description = replaced(description, key, value)
        return build_atmosphere(description, np.asarray(wavelengths, float))

    def to_dict(self) -> dict[str, Any]:
        """As plain numbers and words, for JSON."""
        return {"kind": "described", **self.description}

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> "DescribedAtmosphere":
        """Undo `to_dict`."""
        return cls.from_description({k: v for k, v in record.items() if k != "kind"})


def build_atmosphere(description: Part, wavelengths: np.ndarray) -> Atmosphere:
    """The atmosphere of a description at wavelengths [nm]."""
    ground = description["ground"].get("altitude_m", 0.0)
    top = description["planet"]["top_altitude_m"] - ground
    if not top > 0:
        raise InputError(
            f"ground.altitude_m: expected less than planet.top_altitude_m; got {ground:g}"
        )
    # Gases lie around the planet, whatever the ground; aerosols lie on the ground.
    raised = {"ground_altitude_m": ground} if ground else {}
    parts = [
        part | raised if part["kind"] in GASES else part for part in description["constituents"]
    ]
    gases = [part for part in parts if part["kind"] in GASES]
    around = _surroundings(gases, top)
    constituents = [
        build_gas(part, wavelengths, top)
        if part["kind"] in GASES
        else build_aerosol(part, wavelengths, around)
        for part in parts
    ]
    return Atmosphere(
        wavelengths=wavelengths,
        solar_irradiance=sunlight_above(description["sun"], wavelengths),
        constituents=constituents,
        ground_albedo=_ground_albedo(description["ground"], wavelengths),
        planet_radius=description["planet"]["radius_m"] + ground,
        top_altitude=top,
        refraction=_refraction(description["planet"].get("refractivity"), gases),
    )


def _refraction(refractivity: float | None, gases: list[Part]) -> Refraction | None:
    """Of the first gas of which air can consist; None for straight rays.

    Raises:
        InputError: There is none.
    """
    if refractivity is None:
        return None
    air = [part for part in gases if part["kind"] in ("air", "preetham_air", "gas")]
    if not air:
        raise InputError(
            "planet.refractivity: expected a constituent of kind air, preetham_air or gas, whose "
            "profile the index of refraction follows; got none"
        )
    return Refraction(refractivity, gas_profile(air[0]))


def _ground_albedo(ground: Part, wavelengths: Wavelengths) -> Wavelengths:
    """Albedo times its factor, to 1 at most."""
    return np.minimum(ground["scale"] * spectrum_at(ground["albedo"], wavelengths), 1.0)


def _surroundings(gases: list[Part], top: float) -> Surroundings:
    """The gases by which turbidity and visibility are measured."""
    depth = extinction = 0.0
    for part in gases:
        found = gas_coefficients(part, np.array([VISIBLE_AT]), top)
        density = gas_profile(part)
        depth += float(found.scattering[0]) * float(density.column(top))
        extinction += float(found.scattering[0] + found.absorption[0]) * float(density(0.0))
    return Surroundings(depth, extinction, top)
