"""What a formula is fitted to: x, y, Y, tristimulus values, linear RGB, or spectral bands."""

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from .._typing import as_float
from ..colour import xyY_to_xyz, xyz_to_rgb
from ..errors import InputError
from ..models.formula import CHANNEL_KINDS
from .skies import Skies, read_skies, without_gaps, zenith_values


if TYPE_CHECKING:
    import xarray as xr


Channels = str | Sequence[float] | np.ndarray


def read_channels(
    data: "xr.Dataset", channels: Channels, caller: str = "fit_sky", *, night: bool = False
) -> Skies:
    """Skies of a dataset in the channels asked for.

    Args:
        data: Skies, as for `skyfit.fitting.skies.read_skies`.
        channels: "Yxy", "XYZ", "RGB", "spectrum" for every wavelength of the data, or the
            wavelengths of spectral bands [nm].
        caller: Name of the function whose arguments these are, for messages.
        night: Whether suns below the horizon are taken, as by `read_skies`.

    Raises:
        ValueError: An unknown choice, a band beyond the data, or values that cannot be fitted.
    """
    skies = read_skies(data, caller, night=night)
    if isinstance(channels, str) and channels in CHANNEL_KINDS:
        return _colours(skies, channels, caller)
    if isinstance(channels, str) and channels != "spectrum":
        raise InputError(
            f"{caller}(channels=...): expected one of {[*CHANNEL_KINDS, 'spectrum']}, or "
            f"wavelengths in nm; got {channels!r}"
        )
    for name in ("radiance", "wavelength"):
        if name not in data.variables:
            raise InputError(f"{caller}(data=...): spectral bands need {name!r}; there is none")
    known = np.asarray(data["wavelength"].values, float)
    bands = known if isinstance(channels, str) else np.asarray(channels, float)
    if bands.ndim != 1 or bands.size < 2 or np.any(np.diff(bands) <= 0):
        raise InputError(f"{caller}(channels=...): expected two or more increasing wavelengths")
    if bands[0] < known[0] or bands[-1] > known[-1]:
        raise InputError(
            f"{caller}(channels=...): expected wavelengths within {known[0]:g} to {known[-1]:g} "
            f"nm, those of the data; got {bands[0]:g} to {bands[-1]:g}"
        )
    values = _between(_spectra(data), known, bands)
    names = tuple(f"{band:g} nm" for band in bands)
    return _with(skies, values, names, "bands", caller, bands)


def _colours(skies: Skies, kind: str, caller: str) -> Skies:
    if kind == "Yxy":
        return skies
    xyz = xyY_to_xyz(as_float(np.moveaxis(skies.values, 0, -1)))
    values = np.asarray(xyz if kind == "XYZ" else xyz_to_rgb(xyz), float)
    return _with(skies, np.moveaxis(values, -1, 0), CHANNEL_KINDS[kind], kind, caller)


def _with(skies, values, names, kind, caller, bands=None):
    view, azimuth, values = without_gaps(skies.view_zenith, skies.relative_azimuth, values, caller)
    for name, value in zip(names, values, strict=True):
        bad = np.count_nonzero(~(np.isfinite(value) & (value > 0)))
        if bad:
            raise InputError(
                f"{caller}(channels=...): {name} must be above 0; {bad} of {value.size} are not"
            )
    return dataclasses.replace(
        skies,
        view_zenith=view,
        relative_azimuth=azimuth,
        values=values,
        zenith=zenith_values(view, values),
        channels=tuple(names),
        kind=kind,
        wavelengths=bands,
    )


def _spectra(data: "xr.Dataset") -> Float[np.ndarray, "sky direction wavelength"]:
    light = data["radiance"].transpose(..., "direction", "wavelength")
    if "luminance" in data.variables:
        dims = [d for d in data["luminance"].dims if d != "direction"]
        light = light.transpose(*dims, "direction", "wavelength")
    array = np.asarray(light.values, float)
    return array.reshape(-1, *array.shape[-2:])


def _between(spectra, known, bands):
    """Values at the bands, linear in wavelength, the bands first."""
    cell = np.clip(np.searchsorted(known, bands, side="right") - 1, 0, known.size - 2)
    share = (bands - known[cell]) / (known[cell + 1] - known[cell])
    values = spectra[..., cell] * (1 - share) + spectra[..., cell + 1] * share
    return np.moveaxis(values, -1, 0)
