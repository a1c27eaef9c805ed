"""How far a sky stays from negative light and from colours that no light has."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from jaxtyping import Float

from .._typing import as_float
from ..colour import matching_functions
from ..errors import InputError
from ..models import AbstractSkyModel


# The dome from the zenith to the horizon, finer where skies change faster.
_VIEW_ZENITHS = np.radians([0, 15, 30, 45, 55, 65, 70, 75, 80, 83, 85, 87, 88, 89, 89.5, 90])
_AZIMUTHS = np.radians([0, 3, 7, 12, 20, 30, 45, 60, 75, 90, 105, 120, 135, 150, 165, 180])
_NUM_SUNS = 18
# Values of each parameter, by how many are swept.
_NUM_VALUES = {0: 1, 1: 9, 2: 4}
_FEWEST_VALUES = 3


@dataclass(frozen=True)
class Positivity:
    """The least luminance and the least margin of chromaticity over dome, suns and parameter.

    Attributes:
        least_luminance: Least luminance as a share of the mean of the same sky; below 0, light is
            negative.
        least_luminance_at: Sun and view [rad], and the swept parameters, of that.
        locus_margin: Distance of the chromaticity from the boundary of all colours, the spectral
            locus and the line of purples; negative outside.
        locus_margin_at: Sun and view [rad], and the swept parameters, of that.
    """

    least_luminance: float
    least_luminance_at: dict[str, float]
    locus_margin: float
    locus_margin_at: dict[str, float]

    @property
    def holds(self) -> bool:
        """Whether every light is positive and every chromaticity is that of a light."""
        return self.least_luminance > 0 and self.locus_margin > 0

    def sentence(self) -> str:
        """Both margins in words."""
        parts = []
        for good, bad, value, at in (
            ("darkest point", "negative luminance", self.least_luminance, self.least_luminance_at),
            ("locus margin", "impossible colour", self.locus_margin, self.locus_margin_at),
        ):
            names = {"sun_zenith": "sun", "view_zenith": "view", "relative_azimuth": "azimuth"}
            place = ", ".join(
                f"{names[key]} {np.degrees(angle):.3g}°" if key in names else f"{key} {angle:.3g}"
                for key, angle in at.items()
            )
            unit = " of the sky's mean" if at is self.least_luminance_at else ""
            parts.append(f"{good if value > 0 else bad} {value:.2g}{unit} ({place})")
        return "; ".join(parts)


def positivity(
    sky: Any,
    *,
    parameter_range: tuple[float, float] | None = None,
    sun_zenith_range: tuple[float, float] | None = None,
) -> Positivity:
    """Look for negative luminance and impossible chromaticity on a grid over the whole dome.

    The grid has 9 values of the parameter (4 of each of two parameters, 3 of each of more), 18 suns
    and 16 × 16 directions from the zenith to the horizon and from the sun's azimuth to the opposite
    one.

    Args:
        sky: a fit, a model, or a function from one parameter to a model, such as
            `skyfit.preetham_sky`.
        parameter_range: Values of the one parameter between which to look; those of the fit or
            model by default.
        sun_zenith_range: Suns between which to look [rad]; those of the fit or model by default.
    """
    swept, model_at = _family(sky, parameter_range)
    count = _NUM_VALUES.get(len(swept), _FEWEST_VALUES)
    axes = [np.linspace(low, high, count if high > low else 1) for low, high in swept.values()]
    values = [grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")] or [np.zeros(1)]
    model = model_at(*(as_float(row[:, None, None]) for row in values[: len(swept)]))
    highest, lowest = sun_zenith_range or model.valid_range["sun_zenith"]
    suns = np.linspace(highest, lowest, _NUM_SUNS)
    view, azimuth = (a.ravel() for a in np.meshgrid(_VIEW_ZENITHS, _AZIMUTHS, indexing="ij"))
    colours = model.xyY(suns[None, :, None], view[None, None], azimuth[None, None])
    x, y, luminance = np.moveaxis(np.asarray(colours, float), -1, 0)
    mean = np.abs(luminance).mean(-1, keepdims=True)
    luminance = luminance / np.where(mean > 0, mean, 1.0)  # where a sky is black it stays 0

    def where(table):
        i, j, k = np.unravel_index(table.argmin(), table.shape)
        return {name: float(row[i]) for name, row in zip(swept, values, strict=False)} | {
            "sun_zenith": float(suns[j]),
            "view_zenith": float(view[k]),
            "relative_azimuth": float(azimuth[k]),
        }

    margin = locus_margin(np.stack([x, y], axis=-1))
    return Positivity(float(luminance.min()), where(luminance), float(margin.min()), where(margin))


def locus_margin(xy: Float[np.ndarray, "*batch 2"]) -> Float[np.ndarray, "*batch"]:
    """Distance of chromaticities from the edge of all colours; negative outside it.

    Source: CIE 1931 2° standard observer, the hull of its spectral chromaticities.
    """
    normals, offsets = _locus()
    return np.asarray(-(xy @ normals.T + offsets).max(axis=-1))


@cache
def _locus():
    from scipy.spatial import ConvexHull

    _, cmf = matching_functions()
    bright = cmf.sum(axis=1) > 1e-4
    hull = ConvexHull(cmf[bright, :2] / cmf[bright].sum(axis=1, keepdims=True))
    return hull.equations[:, :2], hull.equations[:, 2]


def _family(sky, parameter_range):
    """Every parameter and its range, and a function from their values to a model."""
    if isinstance(sky, AbstractSkyModel):
        return {}, lambda: sky
    if hasattr(sky, "swept"):
        swept = dict(sky.swept)
        if parameter_range is not None:
            if len(swept) != 1:
                raise InputError(
                    "positivity(parameter_range=...): expected a fit over one parameter; got one "
                    f"over {list(swept)}"
                )
            swept = dict.fromkeys(swept, parameter_range)
        return swept, lambda *values: sky.sky(**dict(zip(swept, values, strict=True)))
    probe = sky(3.0 if parameter_range is None else parameter_range[0])
    valid = {name: ends for name, ends in probe.valid_range.items() if name != "sun_zenith"}
    name, ends = next(iter(valid.items()), ("parameter", (0.0, 0.0)))
    return {name: parameter_range or ends}, sky
