"""Measured skies, in the same form as simulated ones."""

from importlib import resources
from os import PathLike
from typing import Any, Literal

import numpy as np
import xarray as xr
from jaxtyping import Float

from ..angles import azimuth_from_south
from ..errors import InputError
from ..sun import SunPosition
from ..tables import read_columns
from .record import describe, sky_variables


RELIABLE_COMMENT = "false for the low northern sample, which the instrument misjudged"


def cornell_skies() -> xr.Dataset:
    """Clear skies over Ithaca, New York, on 2013-05-27: 8 times, 81 directions, 360–830 nm.

    Returns:
        Dimensions (time, direction, wavelength); the azimuth from the sun varies with time. Where
        `reliable` is false the direction is to be left out. `local_time` is in minutes after
        midnight, UTC-4.

    Source: Kider, Knowlton, Newlin, Li & Greenberg (2014), "A framework for the experimental
    comparison of solar and skydome illumination", ACM Transactions on Graphics 33(6), 180; data
    under the Apache License 2.0.
    """
    file = resources.files("skyfit") / "data" / "cornell_2013-05-27_sky_radiance.nc"
    with resources.as_file(file) as path, xr.open_dataset(path, engine="netcdf4") as opened:
        raw = opened.load()
    wavelengths = raw["wavelength"].values
    radiance = raw["radiance"].transpose("time", "direction", "wavelength").values.astype(float)
    by_direction = ("time", "direction")
    dims = {"radiance": (*by_direction, "wavelength")}
    variables: dict[str, Any] = {
        name: (dims.get(name, by_direction), array, describe(name))
        for name, array in sky_variables(radiance, wavelengths).items()
    }
    reliable = raw["kider_sample_index"].values != 0
    variables["reliable"] = ("direction", reliable, {"comment": RELIABLE_COMMENT})
    coordinates = {
        name: (raw[name].dims, np.radians(raw[name].values), describe(name))
        for name in ("sun_zenith", "view_zenith", "relative_azimuth")
    } | {
        "wavelength": ("wavelength", wavelengths, describe("wavelength")),
        "local_time": ("time", raw["local_time"].values, {"comment": "minutes, UTC-4"}),
    }
    attributes = {name: raw.attrs[name] for name in ("title", "source", "notes")}
    return xr.Dataset(variables, coordinates, attributes)


def read_sky_scanner(
    path: str | PathLike[str],
    sun: SunPosition,
    *,
    azimuth: str = "azimuth_deg",
    altitude: str = "altitude_deg",
    luminance: str = "luminance",
    unit: float = 1.0,
    zero: Literal["north", "south"] = "north",
) -> xr.Dataset:
    """A sky scanner's table of patches, such as Tregenza's 145, as a measured sky.

    Luminances that are empty, or not above 0, are NaN: fits and domes leave them out.

    Args:
        path: A CSV file with a row for each patch; commas, semicolons or tabs, # for comments.
        sun: Where the sun stood, as `skyfit.sun_at` says.
        azimuth: Name of the column of azimuths, which grow clockwise [degrees].
        altitude: Name of the column of angles above the horizon [degrees].
        luminance: Name of the column of luminances.
        unit: Unit of the luminances [cd m⁻²]: 1000 for kcd m⁻².
        zero: Where azimuths are 0.

    Returns:
        One sky in the form of `skyfit.dataset`, with `luminance` over `direction`.

    Raises:
        FileNotFoundError: There is no such file.
        InputError: A column that is not there, what is no number, or an angle out of its range.
    """
    if zero not in ("north", "south"):
        raise InputError(f"read_sky_scanner(zero=...): expected 'north' or 'south'; got {zero!r}")
    turn, height, light = read_columns(path, azimuth, altitude, luminance)
    if not ((height >= 0) & (height <= 90)).all() or not (abs(turn) <= 360).all():
        raise InputError(
            f"{path}: expected {altitude} from 0 to 90 and {azimuth} from -360 to 360 in every row"
        )
    compass = np.radians(turn + (180.0 if zero == "south" else 0.0))
    values = np.where(light > 0, unit * light, np.nan)
    return measured_sky(sun, np.radians(90 - height), compass, luminance=values)


def measured_sky(
    sun: SunPosition,
    view_zenith: Float[np.ndarray, " direction"],
    azimuth: Float[np.ndarray, " direction"],
    **light: Float[np.ndarray, " direction"],
) -> xr.Dataset:
    """One sky from values in directions.

    Args:
        sun: Where the sun stood, azimuth from the south westward [rad].
        view_zenith: Zenith angle of every direction [rad].
        azimuth: Its compass azimuth [rad].
        light: Values of `luminance`, and of `x` and `y` where colours are known.

    Raises:
        InputError: More than one sun.
    """
    if np.ndim(sun.zenith) or np.ndim(sun.azimuth):
        raise InputError(f"sun: expected one; got shape {np.shape(sun.zenith)}")
    relative = np.asarray(azimuth_from_south(azimuth), float) - float(sun.azimuth)
    relative = np.remainder(relative + np.pi, 2 * np.pi) - np.pi
    return xr.Dataset(
        {name: ("direction", values, describe(name)) for name, values in light.items()},
        {
            "sun_zenith": ((), float(sun.zenith), describe("sun_zenith")),
            "view_zenith": ("direction", view_zenith, describe("view_zenith")),
            "relative_azimuth": ("direction", relative, describe("relative_azimuth")),
        },
    )
