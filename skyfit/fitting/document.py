"""Fit files: JSON documents that outlive the program that wrote them.

`schema` says how to read one. Version 2 added `form`, which formula the file holds, and
`positivity`; version 1 held the published form only. Older versions load.
"""

import dataclasses
import json
import platform
from importlib.metadata import PackageNotFoundError, version
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from .diagnostics import Diagnostics


SCHEMA = "skyfit/fit/2"
READABLE = ("skyfit/fit/1", SCHEMA)


def write_document(path: str | PathLike[str], form: str, fields: dict[str, Any]) -> None:
    """Write a fit's fields as JSON.

    Raises:
        ValueError: There is a file that is no fit of skyfit: it is not replaced.
    """
    target = Path(path)
    if target.exists():
        read_document(target)
    document = {"schema": SCHEMA, "form": form, **plain(fields)}
    target.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def read_document(path: Path) -> dict[str, Any]:
    """A fit's document, of this version or an older one, with its `form`.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is no fit, or of a later version.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: expected a fit in JSON; {error}") from error
    schema = document.get("schema", "missing") if isinstance(document, dict) else "missing"
    if schema not in READABLE:
        raise ValueError(f"{path}: schema is {schema!r}, expected {SCHEMA!r} or an older one")
    return {"form": "published", **document}


def array_of(path: Any, key: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Finite numbers of a shape, or an error that names file and key."""
    try:
        array = np.array(value, float)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {key}: expected {shape} numbers; {error}") from error
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"{path}: {key}: expected {shape} numbers; got shape {array.shape}")
    return array


def diagnostics_from(record: dict[str, Any]) -> Diagnostics:
    """Diagnostics of a channel as they were saved."""
    fields: dict[str, Any] = {f.name: record[f.name] for f in dataclasses.fields(Diagnostics)}
    fields["unidentified"] = tuple(fields["unidentified"])
    return Diagnostics(**fields)


def plain(value: Any) -> Any:
    """The same in dictionaries, lists, numbers and words alone, for JSON."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return str(value)


def versions() -> dict[str, str]:
    """Versions of what a fit's numbers depend on."""
    found = {"python": platform.python_version()}
    for name in ("skyfit", "jax", "equinox", "optimistix", "lineax", "numpy"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "unreleased"
    return found
