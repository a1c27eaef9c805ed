"""Sky datasets on disk: zarr stores and netCDF files."""

import os
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ..error_estimate import ERRORS, covers, estimate_of
from ..errors import InputError, not_found
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
    kind = check_suffix(path)
    missing = [name for name in _NEEDED if name not in dataset.variables]
    if missing or not {"radiance", "luminance"} & set(dataset.variables):
        words = ", ".join(missing or ["radiance or luminance"])
        raise InputError(f"save_dataset(dataset=...): expected skies; there is no {words}")
    _refuse_holes(dataset, "save_dataset(dataset=...)")
    dataset = dataset.assign_attrs(schema=SCHEMA)
    if Path(path).exists():
        stored_attributes(path)
        if not overwrite:
            raise InputError(f"{path}: exists already; give another name or overwrite=True")
    if kind == ".zarr":
        dataset.to_zarr(path, mode="w", consolidated=False)
    else:
        # A record that is replaced stays whole until the new one is.
        begun = Path(path).with_name(f".{Path(path).name}.{os.getpid()}")
        try:
            dataset.to_netcdf(begun, engine="netcdf4")
            begun.replace(path)
        finally:
            begun.unlink(missing_ok=True)


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
    _refuse_holes(dataset, path)
    return dataset


def _refuse_holes(dataset: xr.Dataset, where: object) -> None:
    simulated = "campaign" in dataset.attrs
    for name, array in dataset.data_vars.items():
        if array.dtype.kind not in "fc":
            continue
        values = array.values
        bad = int(np.count_nonzero(~np.isfinite(values) if simulated else np.isinf(values)))
        if bad:
            raise InputError(f"{where}: {name} has {bad} non-finite values of {array.size}")


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
    try:
        with _open(path, kind) as dataset:
            attributes = dict(dataset.attrs)
    except (OSError, ValueError, KeyError):
        raise InputError(f"{path}: exists and is not a sky dataset") from None
    if (schema := attributes.get("schema", "missing")) != SCHEMA:
        raise InputError(f"{path}: schema is {schema!r}, expected {SCHEMA!r}")
    return attributes


def _open(path: str | PathLike[str], kind: str) -> xr.Dataset:
    if kind == ".zarr":
        return xr.open_zarr(path, consolidated=False, chunks=None)
    return xr.open_dataset(path, engine="netcdf4")


def _read(path: str | PathLike[str]) -> xr.Dataset:
    with _open(path, check_suffix(path)) as dataset:
        return dataset.load()
