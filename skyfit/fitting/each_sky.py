"""Perez's coefficients of every sky by itself: the best that the formula can do."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from ..models.formula import CHANNELS
from ..models.perez import COEFFICIENTS
from .batch import fit_groups
from .choices import MAX_VIEW_ZENITH, PUBLISHED, FitSettings, Starts
from .skies import Residuals, Weights, read_skies


if TYPE_CHECKING:
    import xarray as xr


class EachSky(NamedTuple):
    """Five coefficients for every sky by itself.

    Attributes:
        coefficients: A to E for x, y, Y over the dataset's sky dimensions.
        rms: Root mean square of each fit's weighted residuals.
        converged: The solver's word.
        starts: Number of starts each fit took.
    """

    coefficients: Float[np.ndarray, "channel *sky coefficient"]
    rms: Float[np.ndarray, "channel *sky"]
    converged: Bool[np.ndarray, "channel *sky"]
    starts: Int[np.ndarray, "channel *sky"]


def fit_each_sky(
    data: "xr.Dataset",
    *,
    weights: Weights = "equal",
    residuals: Residuals = "relative",
    max_view_zenith: float = float(MAX_VIEW_ZENITH),
    starts: Starts | None = None,
) -> EachSky:
    """Fit Perez's five coefficients to every sky by itself: the best the formula can do.

    All skies and channels are fitted side by side, from three starts each; those that did not
    converge, or whose lowest loss only one start reached, from three more. There is no prior: badly
    determined coefficients are to be expected, within the bounds of `skyfit.models.perez.Perez`.

    Args:
        data: Skies, as for `fit_sky`.
        weights: Weights of directions, as for `fit_sky`.
        residuals: Kind of residuals, as for `fit_sky`.
        max_view_zenith: View zenith angle beyond which directions are left out [rad].
        starts: Coefficients A to E to start from first, by channel.
    """
    settings = FitSettings(weights, residuals, max_view_zenith, 0.0, starts)
    skies = read_skies(data, "fit_each_sky")
    fit = fit_groups(skies, PUBLISHED, settings, "sky")
    shape = (len(CHANNELS), *skies.shape)
    return EachSky(
        fit.numbers.reshape(*shape, len(COEFFICIENTS)),
        fit.rms.reshape(shape),
        fit.converged.reshape(shape),
        fit.starts.reshape(shape),
    )
