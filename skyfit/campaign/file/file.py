"""A campaign file as a whole: an atmosphere, what is swept, sampling and simulation."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    StringConstraints,
    Tag,
    ValidationError,
    model_validator,
)

from ..._schema import one_of
from ...errors import InputError
from ...preetham_air import TURBIDITY_MEANINGS
from ...spectrum import PAPER_WAVELENGTHS
from ...transfer.quality import QUALITIES
from ..campaign import GEOMETRIES, MOST_DIRECTIONS, MOST_ORDERS, SCHEMA, Campaign
from ..description import DescribedAtmosphere, PaperAtmosphere, Sweep
from ..description.sweep import GROUND_ALBEDO, OBSERVER_ALTITUDE, replaced, unit_of
from ..directions import (
    PAPER_RELATIVE_AZIMUTHS_DEG,
    PAPER_SUN_ZENITHS_DEG,
    PAPER_TURBIDITIES,
    PAPER_VIEW_ZENITHS_DEG,
    half_dome,
)
from ..swept import is_taken
from .aerosols import Constituent
from .numbers import Increasing, Number, Numbers, ZeroOrMore
from .parts import Ground, Name, Planet, Sun
from .section import Section


Angles = tuple[Annotated[Number, Field(ge=0, le=180)], ...]


class _Paper(Section):
    """The atmosphere of Preetham et al. (1999)."""

    kind: Literal["preetham1999"] = "preetham1999"
    turbidity_means: Annotated[Any, one_of(*TURBIDITY_MEANINGS)] = "optical thickness"
    ozone: bool = False
    ground_albedo: Annotated[Number, Field(ge=0, le=1)] = 0.0


class _Sweep(Section):
    """The paper's turbidity, or any number of the file."""

    turbidity: Annotated[tuple[Annotated[Number, Field(ge=1, le=1e4)], ...], Increasing] | None = (
        None
    )
    key: str | None = None
    values: Annotated[tuple[Number, ...], Increasing] | None = None
    name: Name | None = None

    @model_validator(mode="after")
    def _complete(self) -> "_Sweep":
        self.exactly_one_of("turbidity", "key")
        if (self.key is None) != (self.values is None):
            raise InputError("key and values are expected together")
        if is_taken(str(self.called)):
            raise InputError(f"name: {self.called} is taken; give the parameter another name")
        return self

    @property
    def called(self) -> str | None:
        """Name of the parameter."""
        if self.key is None:
            return "turbidity"
        return self.name or unit_of(self.key)[0]


# One table [sweep], or several [[sweep]].
_Sweeps = Annotated[
    Annotated[_Sweep, Tag("one")] | Annotated[list[_Sweep], Tag("several")],
    Discriminator(lambda given: "several" if isinstance(given, list) else "one"),
]


class _Sampling(Section):
    sun_zenith_deg: Annotated[Angles, Increasing] = PAPER_SUN_ZENITHS_DEG
    zenith: bool = True
    view_zenith_deg: Annotated[Angles, Numbers] = PAPER_VIEW_ZENITHS_DEG
    relative_azimuth_deg: Annotated[
        tuple[Annotated[Number, Field(ge=-360, le=360)], ...], Numbers
    ] = PAPER_RELATIVE_AZIMUTHS_DEG
    wavelengths_nm: Annotated[tuple[Annotated[Number, Field(gt=0)], ...], Increasing] = tuple(
        PAPER_WAVELENGTHS.tolist()
    )
    samples: Annotated[int, Field(ge=3, le=1_000_000)] | None = None


class _Simulation(Section):
    orders: Annotated[
        Annotated[int, Field(ge=1, le=MOST_ORDERS)] | None,
        BeforeValidator(lambda value: None if value == "all" else value),
    ] = 2
    geometry: Annotated[str, one_of(*GEOMETRIES)] = "spherical"
    quality: Annotated[str, one_of(*QUALITIES)] = "default"
    observer_altitude_m: Annotated[ZeroOrMore, Field(le=1e7)] = 0.0
    keep_orders: bool = False


class File(Section):
    """All tables of a campaign file."""

    schema_: Annotated[Literal["skyfit/campaign/1"], Field(alias="schema")]
    title: Annotated[str, StringConstraints(min_length=1)] = "untitled"
    atmosphere: _Paper | None = None
    planet: Planet | None = None
    sun: Sun | None = None
    ground: Ground | None = None
    constituents: Annotated[list[Constituent], Field(min_length=1)] | None = None
    sweep: _Sweeps | None = None
    sampling: _Sampling = _Sampling()
    simulation: _Simulation = _Simulation()

    @model_validator(mode="before")
    @classmethod
    def _needs_schema(cls, content: Any) -> Any:
        if not isinstance(content, dict) or "schema" not in content:
            raise InputError(f'schema is missing: expected the line schema = "{SCHEMA}"')
        return content

    @model_validator(mode="after")
    def _one_atmosphere(self) -> "File":
        own = [n for n in ("planet", "sun", "ground", "constituents") if getattr(self, n)]
        if own and self.atmosphere:
            raise InputError(f"{own[0]}: the [atmosphere] of kind {self.atmosphere.kind} is "
                             "complete; remove one of them")  # fmt: skip
        if own and not self.constituents:
            raise InputError(f"constituents: {own[0]} is given, but nothing that scatters")
        names = [part.name for part in self.constituents or []]
        for number, name in enumerate(names):
            if name in names[:number]:
                raise InputError(f"constituents[{number}].name: {name} is taken")
        return self

    @model_validator(mode="after")
    def _sweep_of_what_there_is(self) -> "File":
        for where, sweep in self._sweeps():
            if self.is_the_papers:
                if sweep.key not in (None, GROUND_ALBEDO, OBSERVER_ALTITUDE):
                    raise InputError(
                        f"{where}.key: the paper's atmosphere is swept over turbidity, "
                        f"{GROUND_ALBEDO} and {OBSERVER_ALTITUDE}"
                    )
            elif sweep.key is None:
                raise InputError(
                    f"{where}.turbidity: is for the paper's atmosphere; expected key, values"
                )
            for number, value in enumerate(sweep.values or ()):
                self._try(where, str(sweep.key), number, value)
        names = [sweep.called for _, sweep in self._sweeps()]
        for number, name in enumerate(names):
            if name in names[:number]:
                raise InputError(f"sweep[{number}].name: {name} is swept already; give another")
        return self

    def _sweeps(self) -> list[tuple[str, _Sweep]]:
        """Every table of a sweep, and where it stands."""
        if isinstance(self.sweep, list):
            return [(f"sweep[{number}]", one) for number, one in enumerate(self.sweep)]
        return [] if self.sweep is None else [("sweep", self.sweep)]

    def _try(self, where: str, key: str, number: int, value: float) -> None:
        """Check one value of a sweep like the number whose place it takes."""
        content = self._plain()
        try:
            changed = replaced(content, key, value)
        except InputError as error:
            raise InputError(f"{where}.key: {error}") from None
        changed["sweep"] = None
        try:
            File.model_validate(changed)
        except ValidationError as error:
            detail = error.errors(include_url=False)[0]
            words = detail["msg"].replace("Input should be", "expected")
            words = words.removeprefix("Value error, ")
            raise InputError(f"{where}.values[{number}]: {key}: {words}; got {value:g}") from None

    def _plain(self) -> dict[str, Any]:
        """The file in numbers and words, with every default."""
        if self.is_the_papers:
            whole = self.model_copy(update={"atmosphere": self.atmosphere or _Paper()})
        else:
            places = {"planet": self.planet or Planet(), "sun": self.sun or Sun()}
            whole = self.model_copy(update=places | {"ground": self.ground or Ground()})
        return whole.model_dump(mode="json", by_alias=True, exclude_none=True)

    @property
    def is_the_papers(self) -> bool:
        """Whether the atmosphere is that of Preetham et al. (1999)."""
        return not self.constituents

    def campaign(self) -> Campaign:
        """In radians, as the library has it."""
        sampling, simulation = self.sampling, self.simulation
        count = len(sampling.view_zenith_deg) * len(sampling.relative_azimuth_deg)
        if count > MOST_DIRECTIONS:
            raise InputError(
                f"sampling: expected at most {MOST_DIRECTIONS} directions; got {count}"
            )
        view_zenith, relative_azimuth = half_dome(
            np.radians(sampling.view_zenith_deg),
            np.radians(sampling.relative_azimuth_deg),
            zenith=sampling.zenith,
        )
        return Campaign(
            **self._what(),
            sun_zenith=np.radians(sampling.sun_zenith_deg),
            view_zenith=view_zenith,
            relative_azimuth=relative_azimuth,
            wavelengths=sampling.wavelengths_nm,
            orders=simulation.orders,
            geometry=simulation.geometry,
            quality=simulation.quality,
            observer_altitude=simulation.observer_altitude_m,
            keep_orders=simulation.keep_orders,
        )

    def _what(self) -> dict[str, Any]:
        """Arguments of a campaign: the atmosphere and what is swept."""
        sweeps = [one for _, one in self._sweeps()]
        turbidities = [one.turbidity for one in sweeps if one.key is None]
        others = [Sweep(str(one.called), one.key, one.values or ()) for one in sweeps if one.key]
        swept = {"sweep": others, "samples": self.sampling.samples}
        if self.is_the_papers:
            given = self.atmosphere or _Paper()
            return swept | {
                "turbidity": turbidities[0] if turbidities else PAPER_TURBIDITIES,
                "atmosphere": PaperAtmosphere(
                    turbidity_means=given.turbidity_means,
                    ozone=given.ozone,
                    ground_albedo=given.ground_albedo,
                ),
            }
        plain = self._plain()
        tables = {name: plain[name] for name in ("planet", "sun", "ground", "constituents")}
        return swept | {"atmosphere": DescribedAtmosphere.from_description(tables)}
