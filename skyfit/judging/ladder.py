"""The ladder of formulas: what every rung costs in numbers, and how far off it is where unseen.

A rung is a distribution, a dependence and channels. It is fitted with some suns and some values of
the swept parameter left out, and judged on those alone. Ends of the ranges are always fitted: a
formula is not asked beyond them.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

from ..errors import InputError
from ..fitting import Dependence, Positivity, SkyFit
from ..fitting.channels import Channels, read_channels
from ..fitting.choices import MAX_VIEW_ZENITH, FitSettings, chosen_formula
from ..fitting.fit import fit_formula
from ..fitting.skies import Skies, distinct, read_skies
from ..models.distribution import AbstractDistribution
from ..models.domes import DISTRIBUTIONS
from ..models.formula import CHANNELS
from .misfit import Misfit, misfits


if TYPE_CHECKING:
    import xarray as xr


FOLDS = 3


@dataclass(frozen=True)
class Rung:
    """One formula of the ladder.

    Attributes:
        distribution: Name of the distribution.
        dependence: The dependence in words.
        channels: "Yxy", "XYZ", "RGB" or "bands".
        coefficients: Numbers a channel, those of its scale or zenith among them.
        fitted: Errors at the skies fitted, by channel: relative for light, absolute for x and y.
        held_out: Errors at skies left out, by channel, and of x, y and Y whatever was fitted.
        positivity: Margins of the fit to all skies.
        seconds: What the fit to all skies took.
    """

    distribution: str
    dependence: str
    channels: str
    coefficients: int
    fitted: dict[str, Misfit]
    held_out: dict[str, Misfit]
    positivity: Positivity | None
    seconds: float

    @property
    def chromaticity_rms(self) -> float:
        """Held-out error of x and y together."""
        return float(np.hypot(self.held_out["x"].rms, self.held_out["y"].rms) / np.sqrt(2))


def ladder(
    data: "xr.Dataset",
    *,
    held_out: "xr.Dataset | None" = None,
    distributions: Sequence[str | AbstractDistribution] = tuple(DISTRIBUTIONS),
    dependences: Sequence[str | Dependence] = ("linear", "polynomial", "nodes"),
    channels: Sequence[Channels] = ("Yxy", "XYZ"),
    weights: str = "equal",
    residuals: str = "relative",
    max_view_zenith: float = float(MAX_VIEW_ZENITH),
    progress: Callable[[str, int, int], None] | None = None,
) -> list[Rung]:
    """Fit every formula to skies and judge it on skies that it has not seen.

    Args:
        data: Skies, as for `fit_sky`.
        held_out: Skies to judge by, of the same parameter and within the ranges of `data`. Without
            them the data are cross-validated: three times every third inner sun and every third
            inner value of the parameter is left out.
        distributions: Distributions to fit, as for `fit_sky`.
        dependences: Dependences to fit, as for `fit_sky`.
        channels: Kinds of channels to fit, as for `fit_sky`.
        weights: Weights of directions, as for `fit_sky`.
        residuals: Kind of residuals, as for `fit_sky`.
        max_view_zenith: Neither fit nor judge closer to the horizon [rad].
        progress: Called as `progress(rung, done, total)`.

    Raises:
        ValueError: The data cannot be fitted, or there is no inner sun or value to leave out.
    """
    settings = FitSettings(weights, residuals, max_view_zenith)
    skies = read_skies(data, "ladder")
    judged = skies if held_out is None else read_skies(held_out, "ladder")
    _same_kind(skies, judged)
    folds = list(leave_out(skies)) if held_out is None else []
    plan = [
        (chosen_formula(distribution, dependence, "ladder"), kind)
        for kind in channels
        for distribution in distributions
        for dependence in dependences
    ]
    rungs = []
    for done, (formula, kind) in enumerate(plan):
        name, dependence = formula.distribution.name, formula.dependence.describe()
        if progress:
            progress(f"{name} {dependence} {kind}", done, len(plan))
        table = read_channels(data, kind, "ladder")
        start = time.perf_counter()
        fit = fit_formula(table, formula, settings)
        seconds = time.perf_counter() - start
        everywhere = np.ones(skies.count, bool)
        if held_out is None:
            away = [
                (_evaluate(fit_formula(table, formula, settings, use=~out, start=fit), table), out)
                for out in folds
            ]
        else:
            away = [(_evaluate(fit, judged), np.ones(judged.count, bool))]
        truth = table if held_out is None else read_channels(held_out, kind, "ladder")
        rungs.append(
            Rung(
                name,
                dependence,
                table.kind,
                fit.num_numbers,
                misfits([(_evaluate(fit, skies), everywhere)], skies, table, max_view_zenith),
                misfits(away, judged, truth, max_view_zenith),
                fit.positivity,
                seconds,
            )
        )
    return rungs


def leave_out(skies: Skies) -> Iterator[Bool[np.ndarray, " sky"]]:
    """Which skies to leave out, fold by fold: every third inner sun and value of the parameter.

    Raises:
        ValueError: There are no inner ones.
    """
    quantities = list(skies.quantities.values())
    axes = [distinct(values)[1:-1] for values in quantities]
    if not any(axis.size for axis in axes):
        raise InputError(
            "ladder(data=...): nothing to leave out; expected three or more suns, or values of "
            "the parameter, or skies to judge by in held_out"
        )
    for fold in range(FOLDS):
        parts = [
            np.isclose(values[:, None], axis[None, fold::FOLDS], rtol=1e-9, atol=0).any(1)
            for values, axis in zip(quantities, axes, strict=True)
        ]
        away = np.any(parts, axis=0)
        if away.any():
            yield away


def _evaluate(fit: SkyFit, skies: Skies) -> dict[str, Float[np.ndarray, "sky direction"]]:
    """Values of the fit's channels and of x, y, Y for every sky, whatever kind those are."""
    model = fit.sky(**{name: skies.swept[name][:, None] for name in fit.swept})
    at = skies.sun_zenith[:, None], skies.view_zenith, skies.relative_azimuth
    tables: list[tuple[Sequence[str], Any]] = [(CHANNELS, model.xyY(*at))]
    if fit.kind != "Yxy":
        tables.append((fit.channels, model.channels(*at)))
    return {
        name: value
        for names, table in tables
        for name, value in zip(names, np.moveaxis(np.asarray(table, float), -1, 0), strict=True)
    }


def _same_kind(skies: Skies, judged: Skies) -> None:
    if set(skies.swept) != set(judged.swept):
        raise InputError(
            f"ladder(held_out=...): expected skies over {sorted(skies.swept)}; "
            f"got {sorted(judged.swept)}"
        )
    given = {"sun_zenith": skies.sun_zenith_range, **skies.ranges}
    for name, (low, high) in given.items():
        first, last = {"sun_zenith": judged.sun_zenith_range, **judged.ranges}[name]
        if first < low - 1e-6 or last > high + 1e-6:
            raise InputError(
                f"ladder(held_out=...): {name} must lie within that of data, "
                f"{low:.6g} to {high:.6g}; got {first:.6g} to {last:.6g}"
            )


def colour_claim(rungs: Sequence[Rung]) -> str | None:
    """Whether X and Z fit badly and x and y well, as Preetham et al. (1999) found, in a sentence.

    The errors compared are relative, on skies left out, of Perez's distribution with coefficients
    linear in the parameter. None if the rungs do not have it in both kinds of channels.
    """
    found = {
        rung.channels: rung
        for rung in rungs
        if (rung.distribution, rung.dependence) == ("perez", "linear")
    }
    if not {"Yxy", "XYZ"} <= set(found):
        return None
    parts = (("XYZ", "X"), ("XYZ", "Z"), ("Yxy", "x"), ("Yxy", "y"))
    off = {name: 100 * found[kind].held_out[name].relative_rms for kind, name in parts}
    worse = min(off["X"], off["Z"]) > 2 * max(off["x"], off["y"])
    verdict = "X and Z fit badly, x and y well" if worse else "X and Z fit no worse than x and y"
    return (
        f"Perez's form linear in the parameter, relative RMS: X {off['X']:.1f} %, "
        f"Z {off['Z']:.1f} %, x {off['x']:.1f} %, y {off['y']:.1f} %: {verdict}. "
        f"The colours that follow from X, Y, Z are off by "
        f"{found['XYZ'].chromaticity_rms:.4f} in x and y, those fitted as x and y by "
        f"{found['Yxy'].chromaticity_rms:.4f}."
    )
