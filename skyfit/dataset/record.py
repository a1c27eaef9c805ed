"""The form of sky datasets: dimensions, variables and attributes, as `skyfit.dataset` describes."""

import json
from typing import Any

import jax.numpy as jnp
import numpy as np
import xarray as xr

from ..campaign import Campaign, PaperAtmosphere
from ..campaign.given import KIND
from ..campaign.places import SAMPLE
from ..campaign.plain import to_plain
from ..colour import spectrum_to_xyY
from ..error_estimate import ERRORS
from ..errors import InputError
from ..provenance import package_version, versions


SCHEMA = "skyfit/dataset/1"
UNITS = {
    "radiance": ("sky spectral radiance", "W m-2 sr-1 nm-1"),
    "radiance_by_order": ("sky spectral radiance of one order of scattering", "W m-2 sr-1 nm-1"),
    "luminance": ("sky luminance", "cd m-2"),
    "x": ("CIE 1931 chromaticity x", "1"),
    "y": ("CIE 1931 chromaticity y", "1"),
    "turbidity": ("turbidity: optical thickness of air and haze over that of air, 550 nm", "1"),
    SAMPLE: ("number of the place among the swept parameters", "1"),
    "sun_zenith": ("zenith angle of the sun", "rad"),
    "view_zenith": ("zenith angle of the view direction", "rad"),
    "relative_azimuth": ("azimuth of the view direction from the sun's", "rad"),
    "wavelength": ("wavelength", "nm"),
    "order": ("number of interactions of the light with air, haze or ground", "1"),
    ERRORS: ("estimate of the relative error of the radiance", "1"),
    "done": ("whether the sky has been simulated", "1"),
}
MOST_ATMOSPHERES = 100  # so many are written out in the attributes of a dataset
STANDARD_NAMES = {
    "sun_zenith": "solar_zenith_angle",
    "wavelength": "radiation_wavelength",
}


def sky_dataset(campaign: Campaign, variables: dict[str, np.ndarray]) -> xr.Dataset:
    """Put simulated skies on record.

    Args:
        campaign: Campaign that was simulated.
        variables: Arrays of `sky_variables`, with the campaign's `sky_dims` before their axes.
    """
    front = campaign.sky_dims
    arrays = {
        name: (_dims(name, front), array, describe(name)) for name, array in variables.items()
    }
    coordinates = _swept_coordinates(campaign) | {
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
        radiance: Spectral radiance [..., direction, wavelength] in W m⁻² sr⁻¹ nm⁻¹.
        wavelengths: Wavelengths of the radiance [nm].
        by_order: Radiance by order [..., order, direction, wavelength], if kept.
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
        dataset: Skies as `run_campaign` returns them.
        errors: Relative errors, of the radiance's shape. Kept in single precision: two digits are
            all they are worth.
    """
    values = errors.astype(np.float32)
    return dataset.assign({ERRORS: (dataset["radiance"].dims, values, describe(ERRORS))})


def campaign_of(dataset: xr.Dataset) -> Campaign:
    """The campaign that made a simulated dataset, from its attributes alone.

    Raises:
        InputError: The dataset was not simulated, or by an incompatible version.
    """
    if "campaign" not in dataset.attrs:
        raise InputError("dataset: attribute 'campaign' is missing; it was not simulated by skyfit")
    try:
        plan = json.loads(dataset.attrs["campaign"])
        if plan["atmosphere"].get("kind") == KIND:
            plan["atmosphere"]["atmospheres"] = json.loads(dataset.attrs["atmosphere"])
        return Campaign.from_dict(plan)
    except InputError:
        raise
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"dataset: attribute 'campaign' is damaged; {error!r}") from None


def _dims(name: str, front: tuple[str, ...]) -> tuple[str, ...]:
    order = ("order",) if name == "radiance_by_order" else ()
    spectrum = ("wavelength",) if name.startswith("radiance") else ()
    return (*front, *order, "direction", *spectrum)


def describe(name: str) -> dict[str, str]:
    """Attributes of a variable or coordinate: what it is, and its unit."""
    long_name, units = UNITS[name]
    standard = {"standard_name": STANDARD_NAMES[name]} if name in STANDARD_NAMES else {}
    return {"long_name": long_name, "units": units} | standard


def _swept_coordinates(campaign: Campaign) -> dict[str, Any]:
    """Coordinates of the swept parameters: each its own dimension, or all over the sample."""
    about = {one.name: {"long_name": one.long_name, "units": one.units} for one in campaign.sweep}
    about = {"turbidity": describe("turbidity")} | about
    if campaign.samples is None:
        return {
            name: (name, np.array(values), about[name]) for name, values in campaign.swept.items()
        }
    places = campaign.places
    coordinates = {SAMPLE: (SAMPLE, np.arange(len(places)), describe(SAMPLE))}
    return coordinates | {
        name: (SAMPLE, np.array([place[name] for place in places]), about[name])
        for name in campaign.swept
    }


def _attributes(campaign: Campaign) -> dict[str, str]:
    places = campaign.places
    if len(places) > MOST_ATMOSPHERES and not callable(campaign.atmosphere):
        # The campaign builds the others; a program's function is known by its atmospheres alone.
        places = (places[0], places[-1])
    atmospheres = [to_plain(campaign.build_atmosphere(**place)) for place in places]
    plan = campaign.to_dict()
    plan["atmosphere"].pop("atmospheres", None)  # what a program gave is on record once
    paper = "Preetham, Shirley & Smits (1999), A Practical Analytic Model for Daylight"
    return {
        "Conventions": "CF-1.11",
        "title": "Simulated clear-sky radiance",
        "source": f"skyfit {package_version('skyfit')}",
        **({"references": paper} if isinstance(campaign.atmosphere, PaperAtmosphere) else {}),
        "schema": SCHEMA,
        "campaign": json.dumps(plan),
        "atmosphere": json.dumps(atmospheres),
        "versions": json.dumps(versions()),
    }
