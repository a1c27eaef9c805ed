"""What the choice of weights does to the coefficients of the published form."""

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from .._typing import as_float
from ..errors import InputError
from ..fitting.batch import evaluate, fit_groups
from ..fitting.choices import PUBLISHED, FitSettings
from ..fitting.document import plain
from ..fitting.fit import fit_formula
from ..fitting.problem import FitProblem
from ..fitting.skies import read_skies
from ..models.formula import CHANNELS


if TYPE_CHECKING:
    import xarray as xr


# Which weights each direction has, and whether residuals are relative or absolute.
CHOICES = {
    "relative": FitSettings(),
    "absolute": FitSettings(residuals="absolute"),
    "solid angle": FitSettings(weights="solid angle"),
}


@dataclass(frozen=True)
class Weighting:
    """The published form fitted with one choice of weights, by channel.

    Attributes:
        coefficients: A to E by (slope in the parameter, intercept).
        standard_errors: Standard errors of `coefficients`, in the same shape.
        rms: Root mean square of the residuals by every choice's measure, this fit's own included.
    """

    coefficients: dict[str, Float[np.ndarray, "5 2"]]
    standard_errors: dict[str, Float[np.ndarray, "5 2"]]
    rms: dict[str, dict[str, float]]

    def to_dict(self) -> dict[str, Any]:
        """As plain numbers, for JSON."""
        return plain(dataclasses.asdict(self))


def compare_weights(data: "xr.Dataset") -> dict[str, Weighting]:
    """Fit Perez's form with relative, absolute and solid-angle weights.

    Args:
        data: Skies, as for `fit_sky`, over one parameter or none.

    Returns:
        By choice: "relative" (model / data - 1, every direction alike; what `fit_sky` does),
        "absolute" (differences, over the RMS of the data) and "solid angle" (relative, each
        direction by its share of the dome).
    """
    skies = read_skies(data, "compare_weights")
    if len(skies.swept) > 1:
        raise InputError(
            f"compare_weights(data=...): expected one swept parameter; got {list(skies.swept)}"
        )
    fits = {name: fit_groups(skies, PUBLISHED, settings) for name, settings in CHOICES.items()}
    found = {}
    for name, settings in CHOICES.items():
        numbers = fits[name].numbers[:, 0]
        rms = {other: _rms(numbers, fits[other].problem) for other in fits}
        by_channel = {
            channel: {other: float(values[k]) for other, values in rms.items()}
            for k, channel in enumerate(CHANNELS)
        }
        fit = fit_formula(skies, PUBLISHED, settings)
        found[name] = Weighting(fit.coefficients, fit.standard_errors, by_channel)
    return found


def _rms(numbers, problem: FitProblem) -> Float[np.ndarray, " channel"]:
    residual, _ = evaluate(as_float(numbers), problem)
    weight = np.asarray(problem.weight, float)
    total = np.asarray(residual, float) ** 2
    return np.sqrt(total.sum((1, 2)) / np.count_nonzero(weight, axis=(1, 2)))
