"""Tables of aerosols: how much of them, and how they scatter."""

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ...errors import InputError
from .numbers import AboveZero, Number, ZeroOrMore, rows_over, spectral
from .parts import (
    Air,
    Gas,
    Name,
    NitrogenDioxide,
    Oxygen,
    OxygenDimer,
    Ozone,
    PreethamAir,
    Profile,
    Standard,
    WaterVapour,
)
from .section import Section


AMOUNTS = ("optical_depth", "turbidity", "visibility_m", "extinction_per_m")


class Aerosol(Section):
    """What all aerosols have: a name, a profile, an amount.

    Optical depth (vertical) and extinction (where the density is 1) hold at the reference
    wavelength; turbidity by its definition, and visibility as the meteorological range of aerosol
    and gases together at the ground, at 550 nm.
    """

    name: Name
    profile: Profile = Standard(kind="elterman_1968")
    optical_depth: Annotated[ZeroOrMore, Field(le=1e4)] | None = None
    turbidity: Annotated[Number, Field(ge=1, le=1e4)] | None = None
    visibility_m: Annotated[Number, Field(ge=1, le=1e9)] | None = None
    extinction_per_m: Annotated[ZeroOrMore, Field(le=1e3)] | None = None
    reference_wavelength_nm: Annotated[Number, Field(ge=10, le=1e6)] = 550.0


class Lobed(Aerosol):
    """An aerosol with a phase function of one parameter: g of the published form."""

    asymmetry: Annotated[Any, spectral(-0.999, 0.999)] | None = None
    phase_form: Literal["henyey_greenstein", "cornette_shanks"] = "henyey_greenstein"


class PreethamHaze(Aerosol):
    """The haze of Preetham et al. (1999), tables 1 and 2."""

    kind: Literal["preetham_haze"]

    @model_validator(mode="after")
    def _complete(self) -> "PreethamHaze":
        self.exactly_one_of(*AMOUNTS)
        return self


class AngstromAerosol(Lobed):
    """Optical depth as a power of the wavelength: β (λ / 1 µm)^-α."""

    kind: Literal["angstrom_aerosol"]
    angstrom_beta: Annotated[ZeroOrMore, Field(le=1e4)] | None = None
    angstrom_exponent: Annotated[Number, Field(ge=-4, le=4)]
    single_scattering_albedo: Annotated[Any, spectral(0.0, 1.0)] = 1.0

    @model_validator(mode="after")
    def _complete(self) -> "AngstromAerosol":
        self.exactly_one_of(*AMOUNTS, "angstrom_beta")
        self.exactly_one_of("asymmetry")
        return self


class Lognormal(Section):
    """Number of particles lognormal in the radius."""

    kind: Literal["lognormal"]
    median_radius_nm: AboveZero
    geometric_deviation: Annotated[Number, Field(gt=1, le=10)]
    smallest_radius_nm: AboveZero
    largest_radius_nm: AboveZero


class Gamma(Section):
    """Hansen & Travis's gamma distribution."""

    kind: Literal["gamma"]
    effective_radius_nm: AboveZero
    effective_variance: Annotated[Number, Field(gt=0, lt=0.5)]
    smallest_radius_nm: AboveZero
    largest_radius_nm: AboveZero


class PowerLaw(Section):
    """Junge's distribution: dN / d ln r as a power of the radius."""

    kind: Literal["power_law"]
    exponent: Annotated[Number, Field(ge=0, le=10)]
    smallest_radius_nm: AboveZero
    largest_radius_nm: AboveZero


class MieAerosol(Aerosol):
    """Spheres of many sizes and one material, n - i k."""

    kind: Literal["mie_aerosol"]
    number_density_per_m3: Annotated[ZeroOrMore, Field(le=1e20)] | None = None
    size: Annotated[Lognormal | Gamma | PowerLaw, Field(discriminator="kind")]
    refractive_index: Annotated[Any, spectral(1.0, 5.0)]
    absorption_index: Annotated[Any, spectral(0.0, 5.0)] = 0.0
    forward_peak_deg: Annotated[Number, Field(ge=0, le=30)] = 0.0

    @model_validator(mode="after")
    def _complete(self) -> "MieAerosol":
        self.exactly_one_of(*AMOUNTS, "number_density_per_m3")
        small, large = self.size.smallest_radius_nm, self.size.largest_radius_nm
        if small >= large:
            raise InputError(f"size: expected smallest_radius_nm below largest_radius_nm; got "
                             f"{small:g} and {large:g}")  # fmt: skip
        if large > 50e3:
            raise InputError(f"size.largest_radius_nm: expected at most 50000; got {large:g}")
        return self


def _phase_table(table: dict[str, tuple[float, ...]]) -> dict[str, tuple[float, ...]]:
    first, last = table["angle_deg"][0], table["angle_deg"][-1]
    if first < 0 or last > 180:
        raise InputError(f"angle_deg: expected angles from 0 to 180; got {first:g} to {last:g}")
    if min(table["value"]) <= 0:
        raise InputError(f"expected values above 0; got {min(table['value']):g}")
    return table


class TableAerosol(Lobed):
    """Any spectrum of extinction and, as a table too, any phase function.

    The extinction is that where the density is 1, unless an amount is given: then it is a shape.
    """

    kind: Literal["table_aerosol"]
    extinction: Annotated[Any, spectral(0.0, 1e3, "1/m")]
    single_scattering_albedo: Annotated[Any, spectral(0.0, 1.0)] = 1.0
    phase: Annotated[Any, rows_over("angle_deg", "value", "wavelength_nm", _phase_table)] | None = (
        None
    )

    @model_validator(mode="after")
    def _complete(self) -> "TableAerosol":
        self.exactly_one_of(*AMOUNTS, or_none=True)
        self.exactly_one_of("phase", "asymmetry")
        return self


Constituent = Annotated[
    Air
    | PreethamAir
    | Ozone
    | NitrogenDioxide
    | OxygenDimer
    | WaterVapour
    | Oxygen
    | Gas
    | PreethamHaze
    | AngstromAerosol
    | MieAerosol
    | TableAerosol,
    Field(discriminator="kind"),
]
