"""Measured skies, in the same form as simulated ones."""

from importlib import resources
from typing import Any

import numpy as np
import xarray as xr

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
