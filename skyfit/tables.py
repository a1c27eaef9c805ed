"""Tables in files: those in `skyfit/data`, read once and checked, and those of a user.

`data/SOURCES.md` says where each of the first is from.
"""

import csv
from functools import cache
from importlib import resources
from os import PathLike

import numpy as np

from ._files import read_text
from .errors import InputError


MOST_BYTES = 50_000_000  # of a user's table


@cache
def read_table(name: str) -> dict[str, np.ndarray]:
    """Read `data/<name>.csv`.

    Args:
        name: File name without its ending.

    Returns:
        Column name to values, read-only. Numeric columns are float64 with NaN where the table is
        blank; columns that hold any word are arrays of strings.

    Raises:
        FileNotFoundError: There is no such table.
        ValueError: A row is longer or shorter than the header.
    """
    path = resources.files("skyfit") / "data" / f"{name}.csv"
    header, *rows = csv.reader(path.read_text(encoding="utf-8").splitlines())
    for number, row in enumerate(rows, start=2):
        if len(row) != len(header):
            raise ValueError(f"{path}:{number}: expected {len(header)} columns, got {len(row)}")
    return {title: _column([row[k] for row in rows]) for k, title in enumerate(header)}


def _column(cells: list[str]) -> np.ndarray:
    try:
        column = np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        column = np.array(cells)
    column.flags.writeable = False
    return column


def read_columns(path: str | PathLike[str], *names: str) -> tuple[np.ndarray, ...]:
    """Columns of numbers of a user's CSV file.

    Columns are separated by commas, semicolons or tabs, in the latter two cases also with decimal
    commas. A byte order mark, empty lines and those that begin with # are passed over; an empty
    cell is NaN.

    Args:
        path: The file, in UTF-8, its first line naming the columns.
        names: Columns to read.

    Raises:
        OSError: There is no such file.
        InputError: One line that names the file, the line or column, and what was expected.
    """
    text = read_text(path, MOST_BYTES)
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise InputError(f"{path}: expected columns {', '.join(names)}; the file is empty")
    separator = max(";\t,", key=lines[0][1].count)
    rows = csv.reader((line for _, line in lines), delimiter=separator, skipinitialspace=True)
    header, *cells = ([cell.strip() for cell in row] for row in rows)
    for name in names:
        if name not in header:
            raise InputError(f"{path}: expected a column {name}; there is {', '.join(header)}")
    for (number, _), row in zip(lines[1:], cells, strict=False):
        if len(row) != len(header):
            raise InputError(f"{path}:{number}: expected {len(header)} columns; got {len(row)}")
    decimal = "." if separator == "," else ","
    columns = []
    for name in names:
        place, values = header.index(name), np.empty(len(cells))
        for k, row in enumerate(cells):
            try:
                values[k] = float(row[place].replace(decimal, ".") or "nan")
            except ValueError:
                where = f"{path}:{lines[k + 1][0]}: column {name}"
                raise InputError(f"{where}: expected a number; got {row[place]!r}") from None
        columns.append(values)
    return tuple(columns)
