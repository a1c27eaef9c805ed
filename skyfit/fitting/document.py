"""Fit files: JSON documents that outlive the program that wrote them.

`schema` says how to read one. Version 1 held the published form only; version 2 had two forms, of
the published formula and of any other; version 3 has one. Older versions load.
"""

import dataclasses
import json
from os import PathLike
from pathlib import Path
from typing import Any

import jax
import numpy as np

from .._files import read_text, write_text
from ..errors import InputError
from .older_files import upgraded


_MOST_BYTES = 100_000_000  # a fit has some ten thousand
SCHEMA = "skyfit/fit/3"
READABLE = ("skyfit/fit/1", "skyfit/fit/2", SCHEMA)


def write_document(path: str | PathLike[str], fields: dict[str, Any]) -> None:
    """Write a fit's fields as JSON.

    Raises:
        ValueError: There is a file that is no fit of skyfit: it is not replaced.
    """
    refuse_no_fit(path)
    document = {"schema": SCHEMA, **plain(fields)}
    write_text(path, json.dumps(document, indent=1, allow_nan=False) + "\n")


def refuse_no_fit(path: str | PathLike[str]) -> None:
    """Refuse a place where there is something that is no fit of skyfit's, and so not replaced.

    Raises:
        InputError: There is.
    """
    target = Path(path)
    if target.exists() and not (target.is_file() and target.stat().st_size == 0):
        _read(target)


def read_document(path: str | PathLike[str]) -> dict[str, Any]:
    """A fit's document in the form of this version.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is no fit, or of a later version, or an older one lacks a key.
    """
    document = _read(Path(path))
    if document["schema"] == SCHEMA:
        return document
    try:
        return upgraded(document)
    except KeyError as error:
        raise InputError(f"{path}: key {error} is missing") from error
    except (AttributeError, IndexError, TypeError) as error:
        raise InputError(f"{path}: expected a fit as skyfit writes it; {error}") from error
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error


def _read(path: Path) -> dict[str, Any]:
    text = read_text(path, _MOST_BYTES)
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: expected a fit in JSON; {error}") from error
    schema = document.get("schema", "missing") if isinstance(document, dict) else "missing"
    if schema not in READABLE:
        raise InputError(f"{path}: schema is {schema!r}, expected {SCHEMA!r} or an older one")
    return document


def plain(value: Any) -> Any:
    """The same in dictionaries, lists, numbers and words alone, for JSON."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        value = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic | jax.Array):
        return np.asarray(value).tolist()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return str(value)
