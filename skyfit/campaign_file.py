"""Campaign files (TOML): their schema, and errors that name file and key.

Angles are in degrees here, and only here: the keys say so.
"""

import difflib
import itertools
import math
import tomllib
from os import PathLike
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StringConstraints,
    ValidationError,
    model_validator,
)

from .campaign import (
    PAPER_RELATIVE_AZIMUTHS_DEG,
    PAPER_SUN_ZENITHS_DEG,
    PAPER_TURBIDITIES,
    PAPER_VIEW_ZENITHS_DEG,
    SCHEMA,
    Campaign,
    PaperAtmosphere,
    half_dome,
)
from .preetham_air import PAPER_WAVELENGTHS


def load_campaign(path: str | PathLike[str]) -> Campaign:
    """Read a campaign file.

    Args:
        path: A TOML file; `sims/preetham1999.toml` shows every key with its default.

    Raises:
        ValueError: One line that names the file, the key, what was expected and what came.
        OSError: The file cannot be read.
    """
    with open(path, "rb") as file:
        try:
            content = tomllib.load(file)
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise ValueError(f"{path}: not a TOML file: {error}") from None
    try:
        return _File.model_validate(content).campaign()
    except ValidationError as error:
        raise ValueError(f"{path}: {_one_line(error)}") from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _expand(value: Any) -> tuple[float, ...]:
    """A number, a list, or a table {first, last, count | step}, as numbers."""
    if isinstance(value, dict):
        return _range(value)
    numbers = value if isinstance(value, list) else [value]
    for number in numbers:
        if not _is_number(number):
            raise ValueError(f"expected numbers or {{first, last, count or step}}; got {number!r}")
    if not numbers:
        raise ValueError("expected one number or more; got none")
    return tuple(float(number) for number in numbers)


def _range(table: dict[str, Any]) -> tuple[float, ...]:
    keys = set(table)
    if keys not in ({"first", "last", "count"}, {"first", "last", "step"}):
        came = ", ".join(sorted(keys))
        raise ValueError(f"expected the keys first, last and one of count, step; got {came}")
    for key, number in table.items():
        if not _is_number(number):
            raise ValueError(f"{key}: expected a number; got {number!r}")
    first, last = float(table["first"]), float(table["last"])
    if "count" in table:
        if not isinstance(table["count"], int) or table["count"] < 1:
            raise ValueError(f"count: expected a whole number, 1 or more; got {table['count']}")
        return tuple(np.linspace(first, last, table["count"]).tolist())
    step = float(table["step"])
    if not step > 0 or last < first:
        raise ValueError(f"expected first <= last and step > 0; got {first}, {last}, {step}")
    steps = (last - first) / step
    if abs(steps - round(steps)) > 1e-9 * max(1.0, steps):
        raise ValueError(f"steps of {step} from {first} do not end at {last}")
    return tuple((first + step * np.arange(round(steps) + 1)).tolist())


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _increasing(values: tuple[float, ...]) -> tuple[float, ...]:
    for before, after in itertools.pairwise(values):
        if after <= before:
            raise ValueError(f"expected increasing values; got {before:g} before {after:g}")
    return values


def _all_orders(value: Any) -> Any:
    return None if value == "all" else value


Number = Annotated[float, Field(allow_inf_nan=False)]
Angles = tuple[Annotated[Number, Field(ge=0, le=180)], ...]
Numbers = BeforeValidator(_expand)
Increasing = BeforeValidator(lambda value: _increasing(_expand(value)))


class _Section(BaseModel):
    """A table of the file: no unknown key, no silent conversion."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class _Atmosphere(_Section):
    kind: Literal["preetham1999"] = "preetham1999"
    turbidity_means: Literal["optical thickness", "coefficients"] = "optical thickness"
    ozone: bool = False
    ground_albedo: Annotated[Number, Field(ge=0, le=1)] = 0.0


class _Sweep(_Section):
    turbidity: Annotated[tuple[Annotated[Number, Field(ge=1)], ...], Increasing] = PAPER_TURBIDITIES


class _Sampling(_Section):
    sun_zenith_deg: Annotated[Angles, Increasing] = PAPER_SUN_ZENITHS_DEG
    zenith: bool = True
    view_zenith_deg: Annotated[Angles, Numbers] = PAPER_VIEW_ZENITHS_DEG
    relative_azimuth_deg: Annotated[
        tuple[Annotated[Number, Field(ge=-360, le=360)], ...], Numbers
    ] = PAPER_RELATIVE_AZIMUTHS_DEG
    wavelengths_nm: Annotated[tuple[Annotated[Number, Field(gt=0)], ...], Increasing] = tuple(
        PAPER_WAVELENGTHS.tolist()
    )


class _Simulation(_Section):
    orders: Annotated[Annotated[int, Field(ge=1)] | None, BeforeValidator(_all_orders)] = 2
    geometry: Literal["spherical", "flat", "paper"] = "spherical"
    quality: Literal["draft", "default", "high"] = "default"
    observer_altitude_m: Annotated[Number, Field(ge=0)] = 0.0
    keep_orders: bool = False


class _File(_Section):
    schema_: Annotated[Literal["skyfit/campaign/1"], Field(alias="schema")]
    title: Annotated[str, StringConstraints(min_length=1)] = "untitled"
    atmosphere: _Atmosphere = _Atmosphere()
    sweep: _Sweep = _Sweep()
    sampling: _Sampling = _Sampling()
    simulation: _Simulation = _Simulation()

    @model_validator(mode="before")
    @classmethod
    def _needs_schema(cls, content: Any) -> Any:
        if "schema" not in content:
            raise ValueError(f'schema is missing: expected the line schema = "{SCHEMA}"')
        return content

    def campaign(self) -> Campaign:
        """In radians, as the library has it."""
        sampling, simulation = self.sampling, self.simulation
        view_zenith, relative_azimuth = half_dome(
            np.radians(sampling.view_zenith_deg),
            np.radians(sampling.relative_azimuth_deg),
            zenith=sampling.zenith,
        )
        return Campaign(
            turbidity=self.sweep.turbidity,
            sun_zenith=np.radians(sampling.sun_zenith_deg),
            view_zenith=view_zenith,
            relative_azimuth=relative_azimuth,
            wavelengths=sampling.wavelengths_nm,
            atmosphere=PaperAtmosphere(
                turbidity_means=self.atmosphere.turbidity_means,
                ozone=self.atmosphere.ozone,
                ground_albedo=self.atmosphere.ground_albedo,
            ),
            orders=simulation.orders,
            geometry=simulation.geometry,
            quality=simulation.quality,
            observer_altitude=simulation.observer_altitude_m,
            keep_orders=simulation.keep_orders,
        )


# Where pydantic's own words are for programmers.
_WORDS = {"model_type": "expected a table", "int_type": "expected a whole number"}


def _one_line(error: ValidationError) -> str:
    """The first thing wrong with the file, and how many more there are."""
    first, *others = error.errors(include_url=False)
    key = _key(first["loc"])
    if first["type"] == "extra_forbidden":
        known = _known_keys(first["loc"][:-1])
        near = difflib.get_close_matches(str(first["loc"][-1]), known, n=1)
        text = "unknown key; " + (
            f"did you mean {near[0]}?" if near else f"expected one of {', '.join(known)}"
        )
    elif first["type"] == "value_error":
        text = first["msg"].removeprefix("Value error, ")
    else:
        text = first["msg"].replace("Input should be", "expected").replace("a valid ", "a ")
        text = _WORDS.get(first["type"], text) + f"; got {first['input']!r}"
    more = f" (and {len(others)} more)" if others else ""
    return f"{key}: {text}{more}" if key else f"{text}{more}"


def _key(loc: tuple[int | str, ...]) -> str:
    words = [f"[{part}]" if isinstance(part, int) else f".{part}" for part in loc]
    return "".join(words).removeprefix(".")


def _known_keys(loc: tuple[int | str, ...]) -> list[str]:
    fields = _File.model_fields
    for part in loc:
        section = fields[str(part)].annotation
        fields = section.model_fields if isinstance(section, type) else fields
    return [field.alias or name for name, field in fields.items()]
