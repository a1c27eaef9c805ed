"""The record between simulation and fit: an xarray dataset with CF-style names, and its files.

Dimensions are the swept parameter (`turbidity`, or any other; none where nothing is swept),
`sun_zenith`, `direction` and `wavelength`, plus `order` where the orders of scattering are kept.
Angles are in radians. Attributes describe the atmospheres and the versions that made the record, so
that it can be simulated or fitted again from the file alone. Where the error was estimated, the
attribute `error_estimate` sums it up, and the variable of that name has it for every radiance if
every sky was checked.
"""

import dataclasses
import json
import os
import platform
from os import PathLike
from pathlib import Path
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import xarray as xr

from .campaign import Campaign, PaperAtmosphere
from .colour import spectrum_to_xyY
from .error_estimate import ERRORS, covers, estimate_of
from .versions import version_of


SCHEMA = "skyfit/dataset/1"
UNITS = {
    "radiance": ("sky spectral radiance", "W m-2 sr-1 nm-1"),
    "radiance_by_order": ("sky spectral radiance of one order of scattering", "W m-2 sr-1 nm-1"),
    "luminance": ("sky luminance", "cd m-2"),
    "x": ("CIE 1931 chromaticity x", "1"),
    "y": ("CIE 1931 chromaticity y", "1"),
    "turbidity": ("turbidity: optical thickness of air and haze over that of air, 550 nm", "1"),
    "sun_zenith": ("zenith angle of the sun", "rad"),
    "view_zenith": ("zenith angle of the view direction", "rad"),
    "relative_azimuth": ("azimuth of the view direction from the sun's", "rad"),
    "wavelength": ("wavelength", "nm"),
    "order": ("number of interactions of the light with air, haze or ground", "1"),
    ERRORS: ("estimate of the relative error of the radiance", "1"),
    "done": ("whether the sky has been simulated", "1"),
}
STANDARD_NAMES = {
    "sun_zenith": "solar_zenith_angle",
    "wavelength": "radiation_wavelength",
}


def sky_dataset(campaign: Campaign, variables: dict[str, np.ndarray]) -> xr.Dataset:
    """Put simulated skies on record.

    Args:
        campaign: What was simulated.
        variables: From `sky_variables`, with the campaign's `sky_dims` before their axes.
    """
    swept, values = campaign.swept
    front = campaign.sky_dims
    arrays = {
        name: (_dims(name, front), array, describe(name)) for name, array in variables.items()
    }
    coordinates = (
        {} if swept is None else {swept: (swept, np.array(values), _describe_swept(campaign))}
    )
    coordinates |= {
        "sun_zenith": ("sun_zenith", np.array(campaign.sun_zenith), describe("sun_zenith")),
        "wavelength": ("wavelength", np.array(campaign.wavelengths), describe("wavelength")),
        "view_zenith": ("direction", np.array(campaign.view_zenith), describe("view_zenith")),
        "relative_azimuth": (
            "direction",
            np.array(campaign.relative_azimuth),
            describe("relative_azimuth"),
        ),
    }
    if "radiance_by_order" in variables:
        count = variables["radiance_by_order"].shape[-3]
        coordinates["order"] = ("order", np.arange(1, count + 1), describe("order"))
    attributes = _attributes(campaign) | {"precision": str(variables["radiance"].dtype)}
    return xr.Dataset(arrays, coordinates, attributes)


def sky_variables(
    radiance: np.ndarray, wavelengths: np.ndarray, by_order: np.ndarray | None = None
) -> dict[str, np.ndarray]:
    """Radiance, and the luminance and chromaticity it has where there is a spectrum to weigh.

    Args:
        radiance: [..., direction, wavelength] in W m⁻² sr⁻¹ nm⁻¹.
        wavelengths: [nm].
        by_order: [..., order, direction, wavelength], if kept.
    """
    variables = {"radiance": radiance}
    if len(wavelengths) > 1:
        xyY = np.asarray(spectrum_to_xyY(jnp.asarray(radiance), wavelengths))
        variables |= {"luminance": xyY[..., 2], "x": xyY[..., 0], "y": xyY[..., 1]}
    if by_order is not None:
        variables["radiance_by_order"] = by_order
    return variables


def with_errors(dataset: xr.Dataset, errors: np.ndarray) -> xr.Dataset:
    """A dataset with the estimated relative error of every radiance beside it.

    Args:
        dataset: As `run_campaign` returns it.
        errors: Of the radiance's shape. Kept in single precision: two digits are all they are
            worth.
    """
    values = errors.astype(np.float32)
    return dataset.assign({ERRORS: (dataset["radiance"].dims, values, describe(ERRORS))})


def campaign_of(dataset: xr.Dataset) -> Campaign:
    """The campaign that made a simulated dataset, from its attributes alone.

    Raises:
        ValueError: The dataset was not simulated, or by an incompatible version.
    """
    if "campaign" not in dataset.attrs:
        raise ValueError("dataset: attribute 'campaign' is missing; it was not simulated by skyfit")
    return Campaign.from_dict(json.loads(dataset.attrs["campaign"]))


def save_dataset(
    dataset: xr.Dataset, path: str | PathLike[str], *, overwrite: bool = False
) -> None:
    """Write a sky dataset.

    Args:
        dataset: As `run_campaign` returns it.
        path: Ends in .zarr for a zarr store, in .nc for a netCDF file.
        overwrite: Replace a sky dataset that is there; nothing else is ever replaced.

    Raises:
        ValueError: Another ending; something is there that must not be replaced.
    """
    kind = check_suffix(path)
    if Path(path).exists():
        stored_attributes(path)
        if not overwrite:
            raise ValueError(f"{path}: exists already; give another name or overwrite=True")
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
        ValueError: The file is not one, is unfinished, or holds a NaN or an infinity.
    """
    stored_attributes(path)
    dataset = _read(path)
    if "done" in dataset:
        done, total = int(dataset["done"].sum()), dataset["done"].size
        if done < total:
            raise ValueError(
                f"{path}: {done} of {total} skies are done; run the same campaign into it again "
                "to finish"
            )
        dataset = dataset.drop_vars("done")
    if ERRORS in dataset and not covers(estimate_of(dataset), "all"):
        dataset = dataset.drop_vars(ERRORS)  # interrupted before every sky had one
    for name, array in dataset.data_vars.items():
        bad = int(np.count_nonzero(~np.isfinite(array.values)))
        if bad:
            raise ValueError(f"{path}: {name} has {bad} non-finite values of {array.size}")
    return dataset


def check_suffix(path: str | PathLike[str]) -> str:
    """The kind of file a name stands for, ".zarr" or ".nc".

    Raises:
        ValueError: It is neither.
    """
    suffix = Path(path).suffix
    if suffix not in (".zarr", ".nc"):
        raise ValueError(f"{path}: expected a name ending in .zarr or .nc")
    return suffix


def stored_attributes(path: str | PathLike[str]) -> dict[str, Any]:
    """Attributes of a sky dataset on disk.

    Raises:
        ValueError: There is none, or what is there is not a sky dataset of this schema.
    """
    kind = check_suffix(path)
    if not Path(path).exists():
        raise ValueError(f"{path}: not found")
    try:
        with _open(path, kind) as dataset:
            attributes = dict(dataset.attrs)
    except (OSError, ValueError, KeyError):
        raise ValueError(f"{path}: exists and is not a sky dataset") from None
    if (schema := attributes.get("schema", "missing")) != SCHEMA:
        raise ValueError(f"{path}: schema is {schema!r}, expected {SCHEMA!r}")
    return attributes


def versions() -> dict[str, str]:
    """Versions of what makes the numbers."""
    packages = {name: version_of(name) for name in ("skyfit", "jax", "equinox", "numpy")}
    return packages | {"python": platform.python_version()}


def _open(path: str | PathLike[str], kind: str) -> xr.Dataset:
    if kind == ".zarr":
        return xr.open_zarr(path, consolidated=False, chunks=None)
    return xr.open_dataset(path, engine="netcdf4")


def _read(path: str | PathLike[str]) -> xr.Dataset:
    with _open(path, check_suffix(path)) as dataset:
        return dataset.load()


def _dims(name: str, front: tuple[str, ...]) -> tuple[str, ...]:
    order = ("order",) if name == "radiance_by_order" else ()
    spectrum = ("wavelength",) if name.startswith("radiance") else ()
    return (*front, *order, "direction", *spectrum)


def describe(name: str) -> dict[str, str]:
    """Attributes of a variable or coordinate: what it is, and its unit."""
    long_name, units = UNITS[name]
    standard = {"standard_name": STANDARD_NAMES[name]} if name in STANDARD_NAMES else {}
    return {"long_name": long_name, "units": units} | standard


def _describe_swept(campaign: Campaign) -> dict[str, str]:
    """Attributes of the swept parameter's coordinate."""
    if campaign.sweep is None:
        return describe("turbidity")
    return {"long_name": campaign.sweep.long_name, "units": campaign.sweep.units}


def _attributes(campaign: Campaign) -> dict[str, str]:
    atmospheres = [_plain(campaign.build_atmosphere(value)) for value in campaign.swept[1]]
    paper = "Preetham, Shirley & Smits (1999), A Practical Analytic Model for Daylight"
    return {
        "Conventions": "CF-1.11",
        "title": "Simulated clear-sky radiance",
        "source": f"skyfit {version_of('skyfit')}",
        **({"references": paper} if isinstance(campaign.atmosphere, PaperAtmosphere) else {}),
        "schema": SCHEMA,
        "campaign": json.dumps(campaign.to_dict()),
        "atmosphere": json.dumps(atmospheres),
        "versions": json.dumps(versions()),
    }


def _plain(part: Any) -> Any:
    """An atmosphere, part by part, as names and numbers."""
    if isinstance(part, eqx.Module):
        fields = {field.name: getattr(part, field.name) for field in dataclasses.fields(part)}
        return {"type": type(part).__name__} | {name: _plain(v) for name, v in fields.items()}
    if isinstance(part, tuple):
        return [_plain(one) for one in part]
    return np.asarray(part).tolist()
