"""The tables in `skyfit/data`, read once and checked. `data/SOURCES.md` says where each is from."""

import csv
from functools import cache
from importlib import resources

import numpy as np


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
