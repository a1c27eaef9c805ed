"""Numbers, lists of numbers, spectra and choices of campaign files."""

import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field

from ..._schema import increasing
from ...errors import InputError
from ...tables import read_columns


MOST_NUMBERS = 100_000  # of a list in a file
Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e300, le=1e300)]
AboveZero = Annotated[Number, Field(gt=0)]
ZeroOrMore = Annotated[Number, Field(ge=0)]
Share = Annotated[Number, Field(ge=0, le=1)]


def expand(value: Any) -> tuple[float, ...]:
    """A number, a list, or a table {first, last, count | step}, as numbers."""
    if isinstance(value, dict):
        return _range(value)
    numbers = value if isinstance(value, list | tuple) else [value]
    if len(numbers) > MOST_NUMBERS:
        raise InputError(f"expected at most {MOST_NUMBERS} numbers; got {len(numbers)}")
    for number in numbers:
        if not is_number(number):
            raise InputError(f"expected numbers or {{first, last, count or step}}; got {number!r}")
    if not numbers:
        raise InputError("expected one number or more; got none")
    return tuple(float(number) for number in numbers)


def _range(table: dict[str, Any]) -> tuple[float, ...]:
    keys = set(table)
    if keys not in ({"first", "last", "count"}, {"first", "last", "step"}):
        came = ", ".join(sorted(keys))
        raise InputError(f"expected the keys first, last and one of count, step; got {came}")
    for key, number in table.items():
        if not is_number(number):
            raise InputError(f"{key}: expected a number; got {number!r}")
    first, last = float(table["first"]), float(table["last"])
    if "count" in table:
        count = table["count"]
        if not isinstance(count, int) or not 1 <= count <= MOST_NUMBERS:
            raise InputError(f"count: expected a whole number, 1 to {MOST_NUMBERS}; got {count}")
        return tuple(np.linspace(first, last, table["count"]).tolist())
    step = float(table["step"])
    if not step > 0 or last < first:
        raise InputError(f"expected first <= last and step > 0; got {first}, {last}, {step}")
    steps = (last - first) / step
    if not steps < MOST_NUMBERS:
        raise InputError(
            f"expected at most {MOST_NUMBERS} values; steps of {step} make {steps:.6g}"
        )
    if abs(steps - round(steps)) > 1e-9 * max(1.0, steps):
        raise InputError(f"steps of {step} from {first} do not end at {last}")
    return tuple((first + step * np.arange(round(steps) + 1)).tolist())


def is_number(value: Any) -> bool:
    """Whether a value is a finite number, no larger than what overflows."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return -1e300 < value < 1e300


Numbers = BeforeValidator(expand)
Increasing = BeforeValidator(lambda value: increasing(expand(value)))


def spectral(low: float, high: float, unit: str = "") -> BeforeValidator:
    """For an annotation: a spectrum with values within bounds.

    One number; or {wavelength_nm = [...], value = [...]}; or {csv = "file.csv", column = "name"},
    the file standing next to the campaign's with its wavelengths in a column `wavelength_nm`.
    """
    bounds = f"from {low:g} to {high:g}" if math.isfinite(high) else f"of {low:g} or more"
    expected = f"values {bounds} {unit}".strip()

    def validate(given: Any, info: Any) -> Any:
        if not isinstance(given, dict):
            if not is_number(given):
                raise InputError(f"expected a number or a table over wavelength_nm; got {given!r}")
            table: Any = float(given)
            values: tuple[float, ...] = (table,)
        else:
            nodes, values = _columns(given, "wavelength_nm", "value", info)
            if increasing(nodes)[0] <= 0:
                raise InputError(f"wavelength_nm: expected values above 0; got {nodes[0]:g}")
            table = {"wavelength_nm": nodes, "value": values}
        for value in values:
            if not low <= value <= high:
                raise InputError(f"expected {expected}; got {value:g}")
        return table

    return BeforeValidator(validate)


def over(first: str, second: str, check: Callable[[Any], Any]) -> BeforeValidator:
    """For an annotation: a table of two columns; `csv` may name a file that has them.

    Args:
        first: The column that increases.
        second: The other.
        check: Given both columns as a dictionary; returns it or raises.
    """

    def validate(given: Any, info: Any) -> Any:
        if not isinstance(given, dict):
            raise InputError(f"expected a table with {first} and {second}; got {given!r}")
        nodes, values = _columns(given, first, second, info)
        return check({first: increasing(nodes), second: values})

    return BeforeValidator(validate)


def rows_over(first: str, second: str, by: str, check: Callable[[Any], Any]) -> BeforeValidator:
    """For an annotation: as `over`, or with a row of the second column for each value of another.

    Args:
        first: The column that increases.
        second: The other; with `by`, a list of as many. A CSV file has a column for each, and
            `column` is the list of their names.
        by: What the rows differ by, increasing too.
        check: Given the columns as a dictionary; returns it or raises.
    """
    plain: Any = over(first, second, check).func

    def validate(given: Any, info: Any) -> Any:
        if not isinstance(given, dict) or by not in given:
            return plain(given, info)
        nodes, rest = expand(given[by]), {key: v for key, v in given.items() if key != by}
        key = "column" if "csv" in rest else second
        each = rest.get(key)
        if not isinstance(each, list | tuple) or len(each) != len(nodes):
            raise InputError(f"expected a {key} for each {by}; got {each!r}")
        if increasing(nodes)[0] <= 0:
            raise InputError(f"{by}: expected values above 0; got {nodes[0]:g}")
        tables = [plain(rest | {key: one}, info) for one in each]
        values = tuple(table[second] for table in tables)
        return {by: nodes, first: tables[0][first], second: values}

    return BeforeValidator(validate)


def _columns(given: dict[str, Any], first: str, second: str, info: Any):
    """Two columns of one length, from the table itself or from a file."""
    if set(given) == {"csv", "column"}:
        return _rising(*_read_csv(Path((info.context or {}).get("folder", ".")), given, first))
    if set(given) != {first, second}:
        raise InputError(f"expected the keys {first} and {second}, or csv and column; got "
                         f"{', '.join(given) or 'none'}")  # fmt: skip
    nodes, values = expand(given[first]), expand(given[second])
    if len(nodes) != len(values) or len(nodes) < 2:
        raise InputError(f"expected as many {second} as {first}, two or more; got {len(values)} "
                         f"and {len(nodes)}")  # fmt: skip
    return _rising(nodes, values)


def _rising(nodes: tuple[float, ...], values: tuple[float, ...]):
    """Both columns, turned round where the first falls from row to row."""
    falls = all(after < before for before, after in itertools.pairwise(nodes))
    return (nodes[::-1], values[::-1]) if falls else (nodes, values)


def _beside(folder: Path, name: str) -> Path:
    """A file in the folder of the campaign's or below, or wherever a whole name says."""
    if not name or "\0" in name or (".." in Path(name).parts and not Path(name).is_absolute()):
        raise InputError(
            f"csv: expected a file beside the campaign's, or its whole name; got {name!r}"
        )
    return folder / name


def _read_csv(folder: Path, given: dict[str, Any], first: str):
    path = _beside(folder, str(given["csv"]))
    try:
        columns = read_columns(path, first, str(given["column"]))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    if not 2 <= len(columns[0]) <= MOST_NUMBERS:
        raise InputError(
            f"{path}: expected two rows or more, {MOST_NUMBERS} at most; got {len(columns[0])}"
        )
    for name, column in zip((first, given["column"]), columns, strict=True):
        if not np.isfinite(column).all():
            raise InputError(f"{path}: column {name}: expected a number in every row")
    return tuple(tuple(column.tolist()) for column in columns)
