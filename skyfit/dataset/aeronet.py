"""AERONET's inversions: sizes, phase functions and single-scattering albedo of aerosols."""

import csv
import re
from datetime import UTC, datetime
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .._files import read_text
from .._typing import ArrayLike, as_wavelengths
from ..atmosphere import Constituent
from ..campaign.description.aerosols import phase_between
from ..constants import TOP_OF_ATMOSPHERE
from ..errors import InputError, not_found
from ..profile import AbstractProfile, elterman_haze
from ..tables import MOST_BYTES


MISSING = -999.0
# Columns of one number per wavelength, by the name that the dataset gives them.
_SPECTRA = {
    "single_scattering_albedo": r"Single_Scattering_Albedo\[([\d.]+)nm\]",
    "optical_depth": r"AOD_Extinction-Total\[([\d.]+)nm\]",
    "direct_sun_optical_depth": r"AOD_([\d.]+)nm",
    "asymmetry": r"Asymmetry_Factor-Total\[([\d.]+)nm\]",
    "refractive_index": r"Refractive_Index-Real_Part\[([\d.]+)nm\]",
    "absorption_index": r"Refractive_Index-Imaginary_Part\[([\d.]+)nm\]",
}
_PHASE, _SIZE = r"([\d.]+)\[([\d.]+)nm\]", r"(\d+\.\d+)"
_UNITS = {
    "phase_function": ("phase function, whose mean over the sphere is 1", "1"),
    "size_distribution": ("volume of particles by logarithm of the radius", "um3 um-2"),
    "wavelength": ("wavelength", "nm"),
    "scattering_angle": ("scattering angle", "rad"),
    "radius": ("radius", "um"),
    "time": ("time of the measurement, universal time", ""),
}


def read_aeronet(*paths: str | PathLike[str]) -> xr.Dataset:
    """Inversions of version 3, from one file with all products or from several.

    Args:
        paths: Files of one site: all products in one (.all), or one each (.pfn, .siz, .ssa, .aod,
            .asy, .rin), whatever their ending; what is in a file is told by its columns. Direct
            sun measurements (.lev15, .lev20) as well.

    Returns:
        What the files have of `phase_function` over time, wavelength and scattering angle;
        `size_distribution` over time and radius; `single_scattering_albedo`, `optical_depth`,
        `direct_sun_optical_depth`, `asymmetry`, `refractive_index` and `absorption_index` over time
        and wavelength. NaN where a file has none.

    Raises:
        FileNotFoundError: There is no such file.
        InputError: A file is no inversion of AERONET's, or holds what is no number.
    """
    if not paths:
        raise InputError("read_aeronet: expected one file or more")
    found = xr.merge([_read(Path(path)) for path in paths], join="outer", compat="no_conflicts")
    for name, variable in found.variables.items():
        long_name, unit = _UNITS.get(str(name), (str(name).replace("_", " "), "1"))
        variable.attrs = {"long_name": long_name} | ({"units": unit} if unit else {})
    return found


def _read(path: Path) -> xr.Dataset:
    if not path.exists():
        raise not_found(path)
    lines = read_text(path, MOST_BYTES, "latin-1").splitlines()
    start = next((k for k, line in enumerate(lines) if "Date(dd:mm:yyyy)," in line), None)
    if start is None:
        raise InputError(f"{path}: expected a line of columns with Date(dd:mm:yyyy); there is none")
    header, *rows = csv.reader(lines[start:])
    header, rows = [name.strip() for name in header], [row for row in rows if row]
    for number, row in enumerate(rows, start=start + 2):
        if len(row) < len(header):
            raise InputError(f"{path}:{number}: expected {len(header)} columns; got {len(row)}")
    times = [_time(path, header, row) for row in rows]

    def table(pattern):
        """The numbers in the names of the columns that match, and what these columns hold."""
        matches = {k: re.fullmatch(pattern, name) for k, name in enumerate(header)}
        places = {k: match.groups() for k, match in matches.items() if match}
        try:
            values = np.array([[float(row[k] or MISSING) for k in places] for row in rows])
        except ValueError as error:
            raise InputError(f"{path}: expected numbers; {error}") from None
        keys = np.array(list(places.values()), float)
        return keys, np.where(values <= MISSING, np.nan, values)

    found: dict[str, Any] = {}
    for name, pattern in _SPECTRA.items():
        keys, values = table(pattern)
        if keys.size:
            axes = {"time": times, "wavelength": keys[:, 0]}
            array = xr.DataArray(values, axes, tuple(axes)).sortby("wavelength")
            found[name] = array.dropna("wavelength", how="all")
    keys, values = table(_SIZE)
    if keys.size:
        axes = {"time": times, "radius": keys[:, 0]}
        found["size_distribution"] = xr.DataArray(values, axes, tuple(axes))
    keys, values = table(_PHASE)
    if keys.size:
        angles, lam = np.unique(keys[:, 0]), np.unique(keys[:, 1])
        cube = np.full((len(rows), lam.size, angles.size), np.nan)
        cube[:, np.searchsorted(lam, keys[:, 1]), np.searchsorted(angles, keys[:, 0])] = values
        axes = {"time": times, "wavelength": lam, "scattering_angle": np.radians(angles)}
        found["phase_function"] = xr.DataArray(cube, axes, tuple(axes))
    if not found:
        raise InputError(f"{path}: expected columns of an inversion, such as "
                         "Single_Scattering_Albedo[440nm]; there are none")  # fmt: skip
    return xr.Dataset(found)


def _time(path, header, row):
    day = row[header.index("Date(dd:mm:yyyy)")]
    clock = row[header.index("Time(hh:mm:ss)")] if "Time(hh:mm:ss)" in header else "12:00:00"
    try:
        at = datetime.strptime(f"{day} {clock}", "%d:%m:%Y %H:%M:%S").replace(tzinfo=UTC)
    except ValueError:
        raise InputError(f"{path}: expected a date and time; got {day!r} {clock!r}") from None
    return np.datetime64(at.replace(tzinfo=None), "ns")


def aeronet_aerosol(
    inversion: xr.Dataset, wavelengths: ArrayLike, profile: AbstractProfile | None = None
) -> Constituent:
    """The aerosol of one inversion as a constituent of an atmosphere.

    Between the wavelengths of the inversion the optical depth is a power of the wavelength, as by
    Ångström's law, and goes on so beyond them; single-scattering albedo and phase function are
    linear in between and held beyond.

    Args:
        inversion: `read_aeronet(...).isel(time=0)`, with `phase_function`,
            `single_scattering_albedo` and `optical_depth`.
        wavelengths: Wavelengths of the atmosphere [nm].
        profile: How the aerosol thins with altitude; Elterman's (1968) if not given.

    Raises:
        InputError: More than one time, or a product that is missing.
    """
    lam = np.asarray(as_wavelengths(wavelengths, "aeronet_aerosol(wavelengths=...)"), float)
    argument = "aeronet_aerosol(inversion=...)"
    if "time" in inversion.dims:
        raise InputError(f"{argument}: expected one time, as by .isel(time=0); got several")
    parts = []
    for name in ("optical_depth", "single_scattering_albedo", "phase_function"):
        part = inversion[name].dropna("wavelength") if name in inversion else None
        if part is None or part.sizes["wavelength"] == 0:
            raise InputError(f"{argument}: expected {name}; there is none")
        parts.append(part)
    depth, albedo, phase = parts
    density = elterman_haze() if profile is None else profile
    extinction = _power_law(depth, lam) / float(density.column(TOP_OF_ATMOSPHERE))
    share = np.interp(lam, albedo["wavelength"], albedo)
    return Constituent(
        density,
        share * extinction,
        (1 - share) * extinction,
        phase=phase_between(
            phase["scattering_angle"].values, phase["wavelength"].values, phase.values, lam
        ),
    )


def _power_law(depth: xr.DataArray, lam: np.ndarray) -> np.ndarray:
    """Optical depth between wavelengths, and beyond them with the slope at the end."""
    known, value = np.log(depth["wavelength"].values), np.log(depth.values)
    if known.size == 1:
        return np.full(lam.shape, depth.values[0])
    cell = np.clip(np.searchsorted(known, np.log(lam)) - 1, 0, known.size - 2)
    slope = np.diff(value) / np.diff(known)
    return np.exp(value[cell] + slope[cell] * (np.log(lam) - known[cell]))
