"""Sky datasets on disk: zarr stores and netCDF files."""

from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import xarray as xr

from .._files import make_room, whole
from ..error_estimate import ERRORS, covers, estimate_of
from ..errors import InputError, not_found
from .form import refuse_impossible_numbers, refuse_malformed
from .record import SCHEMA


SUFFIXES = (".zarr", ".nc")
_NEEDED = ("sun_zenith", "view_zenith", "relative_azimuth")


def save_dataset(
    dataset: xr.Dataset, path: str | PathLike[str], *, overwrite: bool = False
) -> None:
    """Write a sky dataset.

    Args:
        dataset: Skies as `run_campaign` returns them, or measured ones in the same form, where NaN
            is what is missing.
        path: Name that ends in .zarr for a zarr store, in .nc for a netCDF file.
        overwrite: Replace a sky dataset that is there; nothing else is ever replaced.

    Raises:
        InputError: Another ending; something is there that must not be replaced; what could not be
            read back: no skies, or simulated ones with a NaN or an infinity.
    """
    missing = [name for name in _NEEDED if name not in dataset.variables]
    if missing or not {"radiance", "luminance"} & set(dataset.variables):
        words = ", ".join(missing or ["radiance or luminance"])
        raise InputError(f"save_dataset(dataset=...): expected skies; there is no {words}")
    refuse_malformed("save_dataset(dataset=...)", dataset)
    refuse_impossible_numbers("save_dataset(dataset=...)", dataset)
    dataset = dataset.assign_attrs(schema=SCHEMA)
    kind = refuse_dataset(path, overwrite=overwrite)
    with whole(path) as begun:
        if kind == ".zarr":
            dataset.to_zarr(begun, mode="w", consolidated=False)
        else:
            dataset.to_netcdf(begun, engine="netcdf4")


def refuse_dataset(path: str | PathLike[str], *, overwrite: bool) -> str:
    """The kind of file a name stands for; its folder is made if need be.

    Raises:
        InputError: Another ending; something is there that must not be replaced; nothing can be
            written there.
    """
    kind = check_suffix(path)
    if holds_something(path):
        stored_attributes(path)
        if not overwrite:
            raise InputError(f"{path}: exists already; give another name or overwrite=True")
    make_room(path)
    return kind


def holds_something(path: str | PathLike[str]) -> bool:
    """Whether there is anything under a name but an empty file, such as a full disk leaves."""
    path = Path(path)
    return path.exists() and not (path.is_file() and path.stat().st_size == 0)


def load_dataset(path: str | PathLike[str]) -> xr.Dataset:
    """Read a sky dataset back.

    Estimates of the error that were interrupted before every sky had one are left out.

    Raises:
        FileNotFoundError: There is no such file.
        InputError: The file is not one, is unfinished, or holds an infinity, or a NaN although it
            was simulated.
    """
    stored_attributes(path)
    dataset = _read(path)
    if "done" in dataset:
        done, total = int(dataset["done"].sum()), dataset["done"].size
        if done < total:
            raise InputError(
                f"{path}: {done} of {total} skies are done; run the same campaign into it again "
                "to finish"
            )
        dataset = dataset.drop_vars("done")
    if ERRORS in dataset and not covers(estimate_of(dataset), "all"):
        dataset = dataset.drop_vars(ERRORS)  # interrupted before every sky had one
    refuse_impossible_numbers(path, dataset)
    return dataset


def check_suffix(path: str | PathLike[str]) -> str:
    """The kind of file a name stands for, ".zarr" or ".nc".

    Raises:
        InputError: It is neither.
    """
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise InputError(f"{path}: expected a name ending in {' or '.join(SUFFIXES)}")
    return suffix


def stored_attributes(path: str | PathLike[str]) -> dict[str, Any]:
    """Attributes of a sky dataset on disk.

    Raises:
        FileNotFoundError: There is none.
        InputError: What is there is not a sky dataset of this schema.
    """
    kind = check_suffix(path)
    if not Path(path).exists():
        raise not_found(path)
    with _opened(path, kind) as dataset:
        attributes = dict(dataset.attrs)
    schema = attributes.get("schema", "missing")
    if not isinstance(schema, str) or schema != SCHEMA:
        raise InputError(f"{path}: schema is {schema!r:.60}, expected {SCHEMA!r}")
    return attributes


def _open(path: str | PathLike[str], kind: str) -> xr.Dataset:
    if kind == ".zarr":
        return xr.open_zarr(path, consolidated=False, chunks=None)
    return xr.open_dataset(path, engine="netcdf4")


@contextmanager
def _opened(path: str | PathLike[str], kind: str) -> Iterator[xr.Dataset]:
    """A dataset on disk; what libraries say of one that they cannot read is put into one line."""
    try:
        if not Path(path).is_file() and not Path(path).is_dir():
            raise OSError("a device")
        with _open(path, kind) as dataset:
            yield dataset
    except (InputError, MemoryError):
        raise
    except Exception as error:  # of any kind, from four libraries
        words = " ".join(str(error).split())[:100]
        raise InputError(
            f"{path}: exists and is not a sky dataset, or is damaged ({words})"
        ) from None


def _read(path: str | PathLike[str]) -> xr.Dataset:
    with _opened(path, check_suffix(path)) as dataset:
        refuse_malformed(path, dataset)
        return dataset.load()
