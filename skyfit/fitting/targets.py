"""What a distribution is to follow: skies over their scale, and the weight of each direction."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from .._typing import as_float
from ..errors import InputError
from ..models.basis import Basis
from .choices import FitSettings, Formula
from .skies import Skies


class Targets(NamedTuple):
    """What a formula's distribution is to follow.

    Attributes:
        target: Values over the scale, or values whose scale is free.
        weight: Weight of each relative residual.
        free_scale: Whether each sky has a scale of its own.
    """

    target: Float[np.ndarray, "channel sky direction"]
    weight: Float[np.ndarray, "channel sky direction"]
    free_scale: bool


def targets(
    skies: Skies,
    formula: Formula,
    settings: FitSettings,
    use: Bool[np.ndarray, " sky"] | None = None,
) -> Targets:
    """Divide skies by their scale where that comes first, and weigh their directions.

    Args:
        skies: What to fit.
        formula: The paper's own is fitted to values over the zenith's where that is seen, a
            distribution that is relative to the zenith by a free scale of each sky, and any other
            to values over the mean of the dome as the scale has it.
        settings: Weights and residuals.
        use: Skies to fit; all by default.
    """
    use = np.ones(skies.count, bool) if use is None else use
    weight = direction_weights(skies, formula, settings) * use[:, None]
    target, free_scale = skies.values, True
    if not formula.distribution.relative:
        along = scale_terms(skies, formula, use)
        size = means(skies, weight, formula)
        numbers = [fit_logarithm(along[use], mean[use]) for mean in size]
        target, free_scale = target / np.exp(np.stack(numbers) @ along.T)[..., None], False
    elif formula.has_paper_zenith(skies) and skies.zenith is not None:
        target, free_scale = target / skies.zenith[..., None], False
    weight = np.broadcast_to(weight, target.shape)
    if settings.residuals == "absolute":
        square = weight**2
        typical = np.sqrt((square * target**2).sum((1, 2)) / square.sum((1, 2)))
        weight = weight * target / typical[:, None, None]
    return Targets(target, weight, free_scale)


def direction_weights(
    skies: Skies, formula: Formula, settings: FitSettings
) -> Float[np.ndarray, "sky direction"]:
    """Weight of each direction; beyond the limit, what the distribution keeps to the horizon."""
    weight = skies.weights(settings.weights, settings.max_view_zenith)
    if not weight.any():
        raise InputError(
            "fit_sky(max_view_zenith=...): no direction lies within "
            f"{settings.max_view_zenith:.6g} rad of the zenith"
        )
    above = skies.view_zenith <= np.pi / 2 + 1e-6
    return np.where(weight > 0, weight, formula.distribution.horizon_weight * above)


def means(
    skies: Skies, weight: Float[np.ndarray, "sky direction"], formula: Formula
) -> Float[np.ndarray, "channel sky"]:
    """Mean of every channel over the directions that count; of any value where none does.

    The geometric mean where the total degree counts: in the other a direction close to the sun,
    which the grid has under one sun and not under the next, weighs as much as half the dome.
    """
    square = weight**2
    total = np.where((total := square.sum(1)) > 0, total, 1.0)
    if formula.dependence.total_degree:
        return np.exp((square * np.log(skies.values)).sum(2) / total)
    return (square * skies.values).sum(2) / total


def scale_terms(
    skies: Skies, formula: Formula, use: Bool[np.ndarray, " sky"]
) -> Float[np.ndarray, "sky scale_term"]:
    """Terms of the scale's logarithm for all skies, over the ranges of those in use."""
    return terms_of(formula.scale_dependence.basis(skies.subset(use)), skies)


def fit_logarithm(terms: Float[np.ndarray, "sky term"], value: Float[np.ndarray, " sky"]):
    """Numbers whose sums are closest to the logarithm of values."""
    return np.linalg.lstsq(terms, np.log(value), rcond=1e-10)[0]


def terms_of(basis: Basis, skies: Skies) -> Float[np.ndarray, "sky term"]:
    """Terms of a basis for every sky."""
    at = {name: as_float(values) for name, values in skies.quantities.items()}
    return np.asarray(basis.terms(at), float).T
