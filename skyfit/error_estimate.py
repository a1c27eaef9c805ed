"""How far the radiances of a campaign may be off: which skies are checked, and what is kept of it.

A sky is checked by simulating it once more at the next coarser sizes; half the distance is the
estimate, as in `simulate(..., estimate_error=True)`. It is no bound, and it cannot see what all
sizes leave out, such as polarisation.
"""

import dataclasses
import json
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

from .campaign import Campaign
from .errors import InputError
from .transfer.quality import QUALITIES, coarser
from .transfer.trust import SHARE_OF_DISTANCE, TOLERANCE, AccuracyWarning


if TYPE_CHECKING:
    import xarray as xr


ERRORS = "error_estimate"  # an attribute of datasets, and a variable where every sky was checked
CHECKS = ("none", "sample", "all")  # how many skies are checked


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated relative errors of a campaign's radiances, summed up.

    Every radiance of the skies that were checked counts the same. What is darker than a
    ten-thousandth of the brightest direction of its sky is compared with that.

    Attributes:
        skies: "sample" or "all".
        checked: Skies that were checked.
        total: Skies of the campaign.
        compared_with: Sizes with which they were compared.
        share_of_distance: Share of the distance that is the estimate.
        worst: The largest estimate [1].
        rms: Root mean square [1].
        median: Median [1].
        tolerance: Estimate above which is warned [1].
        share_above: Share of the radiances whose estimate is above the tolerance [1].
        worst_at: Place of the worst: the value of what is swept, under its name; `sun_zenith`,
            `view_zenith`, `relative_azimuth` [rad]; `wavelength` [nm].
    """

    skies: str
    checked: int
    total: int
    compared_with: str
    share_of_distance: float
    worst: float
    rms: float
    median: float
    tolerance: float
    share_above: float
    worst_at: dict[str, float]

    @property
    def where(self) -> str:
        """Where the worst is, in words; angles in degrees."""
        angles = ("sun_zenith", "view_zenith", "relative_azimuth")
        words = [
            f"{name.replace('_', ' ')} {np.degrees(value):.4g}°"
            if name in angles
            else f"{name.replace('_', ' ')} {value:g}"
            for name, value in self.worst_at.items()
        ]
        return ", ".join(words) + " nm"  # the wavelength is the last

    def __str__(self) -> str:
        """The whole in one line."""
        return (
            f"up to {self.worst:.2%}, RMS {self.rms:.2%}, median {self.median:.2%}, estimated from "
            f"{self.checked} of {self.total} skies by comparison with {self.compared_with}; "
            f"worst at {self.where}"
        )


def sampled_skies(campaign: Campaign) -> Bool[np.ndarray, "*sky"]:
    """Which few skies stand for a campaign, over its `sky_dims`.

    Those where every swept parameter has its first or its last value, under the highest, the
    middle and the lowest sun: errors grow with the haze and towards sunset.
    """
    suns = len(campaign.sun_zenith)
    corner = [
        all(value in (values[0], values[-1]) for value, values in _pairs(place, campaign.swept))
        for place in campaign.places
    ]
    seen = np.isin(np.arange(suns), (0, suns // 2, suns - 1))
    return (np.array(corner)[:, None] & seen).reshape(campaign.sky_shape)


def _pairs(
    place: Mapping[str, float], swept: Mapping[str, tuple[float, ...]]
) -> list[tuple[float, tuple[float, ...]]]:
    return [(value, swept[name]) for name, value in place.items()]


def sum_up(
    campaign: Campaign, skies: str, errors: Float[np.ndarray, "*sky direction wavelength"]
) -> ErrorEstimate:
    """Sum the estimates of a campaign up.

    Args:
        campaign: Campaign that was simulated.
        skies: "sample" or "all".
        errors: Errors over the campaign's `sky_dims`, direction and wavelength; NaN where a sky
            was not checked.
    """
    known = errors[np.isfinite(errors)].astype(float)
    place = np.unravel_index(np.nanargmax(errors), errors.shape)
    *sky, direction, wavelength = (int(number) for number in place)
    *front, sun = sky
    at = int(np.ravel_multi_index(tuple(front), campaign.sky_shape[:-1])) if front else 0
    where = campaign.places[at] | {
        "sun_zenith": campaign.sun_zenith[sun],
        "view_zenith": campaign.view_zenith[direction],
        "relative_azimuth": campaign.relative_azimuth[direction],
        "wavelength": campaign.wavelengths[wavelength],
    }
    checked = int(np.isfinite(errors[..., 0, 0]).sum())
    return ErrorEstimate(
        skies=skies,
        checked=checked,
        total=campaign.num_skies,
        compared_with=_coarser_in_words(campaign.quality),
        share_of_distance=SHARE_OF_DISTANCE,
        worst=float(known.max()),
        rms=float(np.sqrt(np.mean(known**2))),
        median=float(np.median(known)),
        tolerance=TOLERANCE,
        share_above=float(np.mean(known > TOLERANCE)),
        worst_at=where,
    )


def estimate_of(dataset: "xr.Dataset") -> ErrorEstimate | None:
    """The error estimate that a simulated dataset has on record; None if it has none.

    Raises:
        InputError: Another version wrote it, with other fields.
    """
    if ERRORS not in dataset.attrs:
        return None
    found = json.loads(dataset.attrs[ERRORS])
    expected = {field.name for field in dataclasses.fields(ErrorEstimate)}
    if not isinstance(found, dict) or set(found) != expected:
        odd = ", ".join(sorted(set(found) ^ expected))
        raise InputError(
            f"dataset: attribute {ERRORS!r} is of another version; it differs in {odd}"
        )
    if not _is_estimate(found):
        raise InputError(f"dataset: attribute {ERRORS!r} is no estimate of an error")
    return ErrorEstimate(**found)


def _is_estimate(found: dict[str, Any]) -> bool:
    """Whether words and numbers stand where they should."""
    at = found["worst_at"]
    words = ("skies", "compared_with", "worst_at")
    numbers = [value for name, value in found.items() if name not in words]
    if not isinstance(at, dict):
        return False
    numbers += at.values()
    return (
        found["skies"] in CHECKS
        and {"sun_zenith", "view_zenith", "relative_azimuth", "wavelength"} <= set(at)
        and all(isinstance(number, int | float) and np.isfinite(number) for number in numbers)
    )


def covers(estimate: ErrorEstimate | None, skies: str) -> bool:
    """Whether an estimate is from as many skies as asked for, one of `CHECKS`."""
    held = "none" if estimate is None else estimate.skies
    return CHECKS.index(held) >= CHECKS.index(skies)


def recorded(estimate: ErrorEstimate) -> dict[str, str]:
    """Attributes of a dataset that put an estimate on record."""
    return {ERRORS: json.dumps(dataclasses.asdict(estimate))}


def warn_where_large(estimate: ErrorEstimate, quality: str) -> None:
    """Warn in one line where a campaign's estimated error exceeds what is tolerated.

    Args:
        estimate: Error estimate of the campaign.
        quality: Quality of the campaign.
    """
    if estimate.worst <= estimate.tolerance:
        return
    cure = "" if quality == list(QUALITIES)[-1] else "; a higher quality lowers it"
    warnings.warn(
        f"the estimated error of the skies is up to {estimate.worst:.1%} ({estimate.where}) and "
        f"exceeds {estimate.tolerance:.0%} in {100 * estimate.share_above:.2g}% of the radiances "
        f"of {estimate.checked} skies{cure}",
        AccuracyWarning,
        stacklevel=3,
    )


def _coarser_in_words(quality: str) -> str:
    sizes = coarser(QUALITIES[quality])
    named = [f"quality '{name}'" for name, known in QUALITIES.items() if known == sizes]
    return named[0] if named else f"two thirds of the sizes of quality '{quality}'"
