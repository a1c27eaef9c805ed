"""What the choice of weights does to the coefficients of the published form."""

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from ..models.perez import CHANNELS
from .document import plain
from .groups import FitSettings, fit_groups
from .shape import ShapeProblem
from .skies import read_skies
from .sky_fit import evaluate, read_joint


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
        standard_errors: The same shape.
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
        data: As for `fit_sky`.

    Returns:
        By choice: "relative" (model / data - 1, every direction alike; what `fit_sky` does),
        "absolute" (differences, over the RMS of the data) and "solid angle" (relative, each
        direction by its share of the dome).
    """
    skies = read_skies(data, "compare_weights")
    fits = {name: fit_groups(skies, settings, "all") for name, settings in CHOICES.items()}
    found = {}
    for name, fit in fits.items():
        lines, errors, _ = read_joint(fit, skies)
        rms = {other: _rms(fit.nodes[:, 0], fits[other].problem) for other in fits}
        by_channel = {
            channel: {other: float(values[k]) for other, values in rms.items()}
            for k, channel in enumerate(CHANNELS)
        }
        found[name] = Weighting(lines, errors, by_channel)
    return found


def _rms(nodes, problem: ShapeProblem) -> Float[np.ndarray, " channel"]:
    residual, _ = evaluate(nodes, problem)
    weight = np.asarray(problem.weight, float)
    total = np.asarray(residual, float) ** 2
    return np.sqrt(total.sum((1, 2)) / np.count_nonzero(weight, axis=(1, 2)))
