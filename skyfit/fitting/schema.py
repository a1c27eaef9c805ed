"""What a fit file may say: names, shapes and ranges, checked before any number is used."""

import math
from os import PathLike
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    StringConstraints,
    Tag,
    ValidationError,
    model_validator,
)

from .._schema import increasing, one_of
from ..errors import InputError
from ..models.axes import FUNCTIONS, SUN
from ..models.domes import DISTRIBUTIONS
from ..models.formula import CHANNEL_KINDS


_MOST_TERMS = 100_000  # of one coefficient; a fit of skyfit's has some hundred at most
_MOST_DEGREE = 40


def _low_to_high(ends: tuple[float, float]) -> tuple[float, float]:
    if not ends[0] <= ends[1]:
        raise InputError(f"expected low, high; got {ends[0]:g}, {ends[1]:g}")
    return ends


def _rectangular(rows: list[list[float]]) -> list[list[float]]:
    if len({len(row) for row in rows}) > 1:
        raise InputError("expected rows of one length")
    return rows


def _numbers(value: Any) -> Any:
    """A number, or lists of them of one length, as `np.array` takes them."""
    try:
        fine = np.isfinite(np.array(value, float)).all()
    except (OverflowError, TypeError, ValueError):
        fine = False
    if not fine:
        raise InputError("expected finite numbers")
    return value


# No number of a formula of the sky is near to what overflows when it is squared.
Finite = Annotated[float, Field(ge=-1e30, le=1e30, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Name = Annotated[str, StringConstraints(min_length=1, max_length=200)]
Sun = Annotated[float, Field(ge=0, le=math.pi)]
Pair = Annotated[
    tuple[Finite, Finite], Field(strict=False), AfterValidator(_low_to_high)
]  # JSON has lists alone
Suns = Annotated[tuple[Sun, Sun], Field(strict=False), AfterValidator(_low_to_high)]
Table = Annotated[list[list[Finite]], AfterValidator(_rectangular)]


class _Part(BaseModel):
    """An object of the document; what it has besides is for readers."""

    model_config = ConfigDict(extra="ignore", strict=True, frozen=True)


class _Tents(_Part):
    quantity: Name
    kind: Literal["tents"]
    nodes: Annotated[list[Finite], Field(min_length=1, max_length=1000), AfterValidator(increasing)]

    @property
    def size(self) -> int:
        return len(self.nodes)


class _Ends(_Part):
    quantity: Name
    low: Finite
    high: Finite

    @model_validator(mode="after")
    def _in_order(self):
        _low_to_high((self.low, self.high))
        return self


class _Line(_Ends):
    kind: Literal["line"]
    size: Literal[2] = 2


class _Chebyshev(_Ends):
    kind: Literal["chebyshev"]
    of: Annotated[str, one_of(*FUNCTIONS)]
    degree: Annotated[int, Field(ge=0, le=_MOST_DEGREE)]

    @property
    def size(self) -> int:
        return self.degree + 1


Axis = Annotated[_Tents | _Line | _Chebyshev, Field(discriminator="kind")]


def _one_axis_each(axes: list[Any]) -> list[Any]:
    names = [axis.quantity for axis in axes]
    if len(set(names)) < len(names):
        raise InputError(f"expected one axis for a quantity; got {', '.join(names)}")
    if math.prod(axis.size for axis in axes) > _MOST_TERMS:
        raise InputError(f"expected at most {_MOST_TERMS} terms")
    return axes


Axes = Annotated[list[Axis], AfterValidator(_one_axis_each)]


class _TotalDegree(_Part):
    total_degree: Literal[True]
    axes: Axes

    @model_validator(mode="after")
    def _of_polynomials(self):
        if not all(isinstance(axis, _Chebyshev) for axis in self.axes):
            raise InputError("axes: expected polynomials alone where the total degree counts")
        return self


Basis = Annotated[
    Annotated[Axes, Tag("product")] | Annotated[_TotalDegree, Tag("total")],
    Discriminator(lambda given: "product" if isinstance(given, list) else "total"),
]


class _Series(_Part):
    thicknesses: list[Annotated[float, Field(ge=0, le=1e3)]] = []
    powers: list[Annotated[int, Field(ge=0, le=100)]] = []
    decays: list[Annotated[float, Field(ge=0, le=1e3)]] = []
    asymmetries: list[Annotated[float, Field(gt=-1, lt=1)]] = []


class _Distribution(_Part):
    name: Annotated[str, one_of(*DISTRIBUTIONS)]
    fixed: _Series | None = None


class _PaperZenith(_Part):
    kind: Literal["paper zenith"]
    quantity: str
    numbers: dict[str, Any]  # whose shapes `scale_from` knows


class _Logarithm(_Part):
    kind: Literal["logarithm"]
    basis: Basis
    numbers: Table
    dimming: list[Finite]
    lowest_sun: Sun
    night: list[bool]


class _Formula(_Part):
    kind: Annotated[str, one_of(*CHANNEL_KINDS, "bands")]
    channels: Annotated[list[Name], Field(min_length=1, max_length=1000)]
    wavelengths: (
        Annotated[list[Annotated[float, Field(ge=100, le=1e5)]], AfterValidator(increasing)] | None
    )
    ranges: dict[Name, Pair]
    sun_zenith_range: Suns
    distribution: _Distribution
    basis: Basis
    linked: bool
    numbers: dict[str, Table]
    scale: Annotated[_PaperZenith | _Logarithm, Field(discriminator="kind")]

    @model_validator(mode="after")
    def _of_one_piece(self):
        count = len(self.channels)
        if len(set(self.channels)) < count:
            raise InputError(f"channels: expected different names; got {', '.join(self.channels)}")
        if self.kind in CHANNEL_KINDS and tuple(self.channels) != CHANNEL_KINDS[self.kind]:
            raise InputError(
                f"channels: expected {CHANNEL_KINDS[self.kind]}; got {', '.join(self.channels)}"
            )
        if (self.kind == "bands") != (self.wavelengths is not None):
            raise InputError("wavelengths: expected those of bands, and of nothing else")
        if self.wavelengths is not None and len(self.wavelengths) != count:
            raise InputError(f"wavelengths: expected {count}; got {len(self.wavelengths)}")
        if SUN in self.ranges:
            raise InputError(f"ranges: {SUN} is the sun's, and no parameter")
        if isinstance(self.scale, _PaperZenith) and self.kind != "Yxy":
            raise InputError(f"scale: the paper's zenith is of kind 'Yxy'; got {self.kind!r}")
        if isinstance(self.scale, _Logarithm) and len(self.scale.night) != count:
            raise InputError(f"scale.night: expected {count}; got {len(self.scale.night)}")
        return self


class _Diagnostics(_Part):
    rms: Share
    worst: Share
    condition: Share
    unidentified: list[str]
    converged: bool
    steps: Annotated[int, Field(ge=0)]


class _TwoStage(_Part):
    values: list[Finite]
    coefficients: Table
    line: Table
    rms_by_value: list[Share]
    rms: Share


class _Positivity(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    least_luminance: Finite
    least_luminance_at: dict[str, Finite]
    locus_margin: Finite
    locus_margin_at: dict[str, Finite]


class _Document(_Part):
    formula: _Formula
    standard_errors: dict[str, Table]
    scale_errors: dict[str, dict[str, Annotated[Any, AfterValidator(_numbers)]]]
    scale_rms: dict[str, Share]
    diagnostics: dict[str, _Diagnostics]
    two_stage: dict[str, _TwoStage] | None
    positivity: _Positivity | None
    settings: dict[str, Any]
    provenance: dict[str, Any]


def refuse_malformed(path: str | PathLike[str], document: dict[str, Any]) -> None:
    """Refuse a fit's document of the present version that no fit can have written.

    Raises:
        InputError: Naming the file, the key, what was expected and what came.
    """
    try:
        _Document.model_validate(document)
    except ValidationError as error:
        raise InputError(f"{path}: {_first(error)}") from None


def _first(error: ValidationError) -> str:
    one = error.errors(include_url=False)[0]
    kinds = ("tents", "line", "chebyshev", "paper zenith", "logarithm", "product", "total")
    place = ".".join(str(part) for part in one["loc"] if part not in kinds)
    if one["type"] == "missing":
        owner, _, key = place.rpartition(".")
        return f"{owner + ': ' if owner else ''}key {key!r} is missing"
    words = one["msg"].removeprefix("Value error, ").replace("Input should be", "expected")
    words = "expected an object" if "model" in one["type"] else words.replace("a valid ", "a ")
    came = "" if one["type"] == "value_error" else f"; got {one['input']!r:.60}"
    return f"{place}: {words}{came}"
