"""Tables of the atmosphere: planet, sun, ground, profiles, gases."""

from typing import Annotated, Any, Literal

from pydantic import Field, StringConstraints, model_validator

from ...constants import EARTH_RADIUS, TOP_OF_ATMOSPHERE
from ...errors import InputError
from .numbers import AboveZero, Number, Share, ZeroOrMore, over, spectral
from .section import Section


Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]


class Planet(Section):
    """How large, and how high its atmosphere reaches."""

    # From a small moon to a giant planet; no atmosphere that scatters is thinner than a kilometre.
    radius_m: Annotated[Number, Field(ge=1e5, le=1e9)] = EARTH_RADIUS
    top_altitude_m: Annotated[Number, Field(ge=1e3, le=1e7)] = TOP_OF_ATMOSPHERE
    refractivity: Annotated[ZeroOrMore, Field(le=0.01)] | None = None


class Sun(Section):
    """Sunlight above the atmosphere."""

    spectrum: Literal["preetham1999", "astm_g173", "blackbody", "table"] = "preetham1999"
    distance_au: Annotated[Number, Field(ge=1e-3, le=1e4)] = 1.0
    bandwidth_nm: Annotated[ZeroOrMore, Field(le=100)] = 10.0
    temperature_K: Annotated[Number, Field(ge=300, le=1e6)] | None = None
    radius_solar: Annotated[Number, Field(ge=1e-4, le=1e4)] = 1.0
    irradiance_W_per_m2_nm: Annotated[Any, spectral(0.0, 1e9, "W/m2/nm")] | None = None

    @model_validator(mode="after")
    def _complete(self) -> "Sun":
        needs = {"blackbody": "temperature_K", "table": "irradiance_W_per_m2_nm"}
        for kind, key in needs.items():
            if (self.spectrum == kind) != (getattr(self, key) is not None):
                raise InputError(f'{key} is expected where spectrum = "{kind}", and only there')
        return self


class Ground(Section):
    """A Lambertian ground, and how high it lies above sea level.

    Gases have their profiles above sea level, aerosols above the ground they lie on.
    """

    albedo: Annotated[Any, spectral(0.0, 1.0)] = 0.0
    scale: Annotated[ZeroOrMore, Field(le=10)] = 1.0
    altitude_m: Annotated[ZeroOrMore, Field(le=20e3)] | None = None


class Exponential(Section):
    """Falls by a factor e with every scale height."""

    kind: Literal["exponential"]
    scale_height_m: Annotated[Number, Field(gt=0, le=1e6)]


class Tent(Section):
    """Rises from nothing to 1 and falls to nothing again, in straight lines."""

    kind: Literal["tent"]
    bottom_m: ZeroOrMore
    peak_m: AboveZero
    top_m: AboveZero

    @model_validator(mode="after")
    def _in_order(self) -> "Tent":
        if not self.bottom_m < self.peak_m < self.top_m:
            raise InputError(f"expected bottom_m < peak_m < top_m; got {self.bottom_m:g}, "
                             f"{self.peak_m:g}, {self.top_m:g}")  # fmt: skip
        return self


def _none_below_zero(table: dict[str, tuple[float, ...]]) -> dict[str, tuple[float, ...]]:
    if min(table["value"]) < 0:
        raise InputError(f"expected densities of 0 or more; got {min(table['value']):g}")
    return table


class Table(Section):
    """Densities at altitudes, linear in between; none above the last."""

    kind: Literal["table"]
    density: Annotated[Any, over("altitude_m", "value", _none_below_zero)]


class Standard(Section):
    """Profiles known by name."""

    kind: Literal["us_standard_1976", "elterman_1968", "ozone"]


Profile = Annotated[Exponential | Tent | Table | Standard, Field(discriminator="kind")]


class Air(Section):
    """Dry air, after Bodhaine et al. (1999); its molecules depolarise, unless told not to."""

    name: Name
    kind: Literal["air"]
    pressure_ratio: Annotated[Number, Field(gt=0, le=1e4)] = 1.0
    depolarised: bool = True
    profile: Profile = Standard(kind="us_standard_1976")


class PreethamAir(Section):
    """Air as Preetham et al. (1999) have it."""

    name: Name
    kind: Literal["preetham_air"]
    profile: Profile = Standard(kind="us_standard_1976")


class Ozone(Section):
    """Ozone, after Bogumil et al. (2003), or Preetham et al. (1999), table 2."""

    name: Name
    kind: Literal["ozone"]
    dobson_units: Annotated[ZeroOrMore, Field(le=1e6)]
    cross_section: Literal["bogumil2003", "preetham1999"] = "bogumil2003"
    profile: Profile = Standard(kind="ozone")


class NitrogenDioxide(Section):
    """Nitrogen dioxide, after Vandaele et al. (1998): of the stratosphere, unless told otherwise.

    The profile's peak is rounded from the AFGL U.S. Standard Atmosphere (Anderson et al. 1986).
    """

    name: Name
    kind: Literal["nitrogen_dioxide"]
    dobson_units: Annotated[ZeroOrMore, Field(le=1e6)] | None = None
    column_per_m2: Annotated[ZeroOrMore, Field(le=1e32)] | None = None
    temperature_K: Annotated[Number, Field(ge=220, le=294)] = 220.0
    profile: Profile = Tent(kind="tent", bottom_m=12e3, peak_m=25e3, top_m=40e3)

    @model_validator(mode="after")
    def _complete(self) -> "NitrogenDioxide":
        self.exactly_one_of("dobson_units", "column_per_m2")
        return self


class OxygenDimer(Section):
    """Pairs of colliding oxygen molecules, after Thalman & Volkamer (2013).

    The profile is that of the air.
    """

    name: Name
    kind: Literal["oxygen_dimer"]
    pressure_ratio: Annotated[Number, Field(gt=0, le=1e4)] = 1.0
    oxygen_fraction: Share = 0.20946
    profile: Profile = Standard(kind="us_standard_1976")


class WaterVapour(Section):
    """Water vapour, after Bird & Riordan (1986); its scale height is that of ITU-R P.835."""

    name: Name
    kind: Literal["water_vapour"]
    precipitable_water_cm: Annotated[ZeroOrMore, Field(le=20)]
    profile: Profile = Exponential(kind="exponential", scale_height_m=2000.0)


class Oxygen(Section):
    """Oxygen's own bands, after Bird & Riordan (1986). The profile is that of the air."""

    name: Name
    kind: Literal["oxygen"]
    pressure_ratio: Annotated[Number, Field(ge=0, le=1e4)] = 1.0
    profile: Profile = Standard(kind="us_standard_1976")


class Gas(Section):
    """Any gas: it scatters after Rayleigh, and may absorb.

    Coefficients and number density hold where the profile's density is 1. Scattering given by one
    number holds at the reference wavelength and falls as the fourth power.
    """

    name: Name
    kind: Literal["gas"]
    number_density_per_m3: Annotated[ZeroOrMore, Field(le=1e32)] | None = None
    scattering_per_m: Annotated[Any, spectral(0.0, 1e3, "1/m")] | None = None
    scattering_cross_section_m2: Annotated[Any, spectral(0.0, 1e-20, "m2")] | None = None
    absorption_per_m: Annotated[Any, spectral(0.0, 1e3, "1/m")] | None = None
    absorption_cross_section_m2: Annotated[Any, spectral(0.0, 1e-15, "m2")] | None = None
    reference_wavelength_nm: Annotated[Number, Field(ge=10, le=1e6)] = 550.0
    depolarisation: Annotated[Any, spectral(0.0, 1.0)] = 0.0
    profile: Profile

    @model_validator(mode="after")
    def _complete(self) -> "Gas":
        scattering = "scattering_per_m", "scattering_cross_section_m2"
        absorption = "absorption_per_m", "absorption_cross_section_m2"
        self.exactly_one_of(*scattering, or_none=True)
        self.exactly_one_of(*absorption, or_none=True)
        if all(getattr(self, name) is None for name in (*scattering, *absorption)):
            raise InputError(f"expected one of {', '.join((*scattering, *absorption))}; got none")
        sections = [getattr(self, name) for name in (scattering[1], absorption[1])]
        if any(section is not None for section in sections) != (
            self.number_density_per_m3 is not None
        ):
            raise InputError(
                "number_density_per_m3 is expected with cross-sections, and only there"
            )
        return self
