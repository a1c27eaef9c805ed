"""What a stored sky dataset must look like, checked before its numbers are read and after."""

import json
import math
from collections.abc import Hashable
from os import PathLike

import numpy as np
import xarray as xr

from ..errors import InputError


MOST_BYTES = 32_000_000_000
# Dimensions at the end of a variable; those before tell skies apart.
_ENDS = {
    "radiance": ("direction", "wavelength"),
    "radiance_by_order": ("order", "direction", "wavelength"),
    "error_estimate": ("direction", "wavelength"),
    "luminance": ("direction",),
    "x": ("direction",),
    "y": ("direction",),
    "view_zenith": ("direction",),
    "relative_azimuth": ("direction",),
    "reliable": ("direction",),
    "wavelength": ("wavelength",),
}
# No sky is brighter than the sun's disc: 2e9 cd/m², 2e4 W/(m² sr nm).
_BOUNDS = {
    "luminance": (-1e12, 1e12),
    "radiance": (-1e9, 1e9),
    "radiance_by_order": (-1e9, 1e9),
    "x": (-1.0, 2.0),
    "y": (-1.0, 2.0),
    "sun_zenith": (0.0, math.pi + 1e-6),
    "view_zenith": (0.0, math.pi + 1e-6),
    "relative_azimuth": (-1e3, 1e3),
    "wavelength": (1.0, 1e6),
}
_TEXTS = ("campaign", "atmosphere", "versions", "error_estimate")


def refuse_malformed(path: str | PathLike[str], dataset: xr.Dataset) -> None:
    """Refuse a dataset whose parts do not belong together, before any array is read.

    Raises:
        InputError: A variable is none of numbers, or of other dimensions than skies have, or all
            are too large to be read; an attribute that is JSON is none.
    """
    total = sum(array.nbytes for array in dataset.variables.values())
    if total > MOST_BYTES:
        raise InputError(f"{path}: expected at most {MOST_BYTES} bytes; its arrays have {total}")
    for name, array in dataset.variables.items():
        if array.dtype.kind not in "fiub" or 0 in array.shape:
            raise InputError(
                f"{path}: {name}: expected numbers; got {array.dtype} of shape {array.shape}"
            )
        ends = _ENDS.get(str(name))
        if ends is not None and array.dims[-len(ends) :] != ends:
            raise InputError(f"{path}: {name}: expected dimensions that end in {ends}; "
                             f"got {array.dims}")  # fmt: skip
    if not {"radiance", "luminance"} & set(dataset.variables):
        raise InputError(f"{path}: expected a radiance or a luminance; got none")
    for name in ("sun_zenith", "view_zenith", "relative_azimuth"):
        if name not in dataset.coords:
            raise InputError(f"{path}: {name} is missing")
    for name in {"radiance", "luminance"} & set(dataset.variables):
        _refuse_unknown_skies(path, dataset, dataset[name].dims[: -len(_ENDS[name])])
    for name in _TEXTS:
        if name in dataset.attrs:
            _refuse_no_json(path, name, dataset.attrs[name])


def _refuse_unknown_skies(
    path: str | PathLike[str], dataset: xr.Dataset, skies: tuple[Hashable, ...]
) -> None:
    """Refuse dimensions of skies of which nothing says where on them a sky is."""
    suns = dataset["sun_zenith"].dims
    if not set(suns) <= set(skies) or len(suns) > 1:
        raise InputError(f"{path}: sun_zenith: expected one of {skies}; got {suns}")
    for dim in skies:
        if dim not in (*suns, *dataset.coords):
            raise InputError(f"{path}: {dim}: expected its values; got none")
        if dim in ("time", "sun_zenith") and suns != (dim,):
            raise InputError(f"{path}: sun_zenith: expected one a {dim}; got {suns}")


def _refuse_no_json(path: str | PathLike[str], name: str, text: object) -> None:
    try:
        found = json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict | list):
        raise InputError(f"{path}: attribute {name!r}: expected JSON; got {text!r:.40}")


def refuse_impossible_numbers(path: str | PathLike[str], dataset: xr.Dataset) -> None:
    """Refuse numbers that no sky has.

    In what was measured NaN stands for a patch that is missing; simulations have none.

    Raises:
        InputError: One is not finite or out of its bounds; an axis does not increase.
    """
    impossible = np.isinf if "campaign" not in dataset.attrs else lambda v: ~np.isfinite(v)
    for name, array in dataset.variables.items():
        values = np.asarray(array.values, float)
        bad = int(np.count_nonzero(impossible(values)))
        if bad:
            raise InputError(f"{path}: {name} has {bad} non-finite values of {values.size}")
        low, high = _BOUNDS.get(str(name), (-math.inf, math.inf))
        outside = (values < low) | (values > high)
        if outside.any():
            raise InputError(
                f"{path}: {name}: expected {low:.6g} to {high:.6g}; got {values[outside][0]:.6g}"
            )
        if array.dims == (name,) and np.any(np.diff(values) <= 0):
            raise InputError(f"{path}: {name}: expected increasing values")
