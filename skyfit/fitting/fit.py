"""From a sky dataset to a sky model: `fit_sky`."""

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from .._typing import as_float
from ..models.distribution import AbstractDistribution
from ..provenance import versions
from .batch import BatchFit, evaluate, fit_groups
from .channels import Channels, read_channels
from .choices import (
    MAX_VIEW_ZENITH,
    PRIOR,
    PUBLISHED,
    FitSettings,
    Formula,
    Starts,
    chosen_formula,
)
from .dependence import Dependence
from .diagnostics import (
    Diagnostics,
    Examined,
    examine,
    lane,
    loose_combinations,
    spectrum,
    variance,
)
from .document import plain
from .positivity import positivity
from .record import Notes, SkyFit, TwoStage
from .scales import early_night, fit_scale
from .skies import Residuals, Skies, Weights
from .targets import terms_of


if TYPE_CHECKING:
    import xarray as xr


def fit_sky(
    data: "xr.Dataset",
    *,
    distribution: str | AbstractDistribution = "perez",
    dependence: str | Dependence = "linear",
    channels: Channels = "Yxy",
    weights: Weights = "equal",
    residuals: Residuals = "relative",
    max_view_zenith: float = float(MAX_VIEW_ZENITH),
    prior: float = PRIOR,
    starts: Starts | None = None,
    zenith: str = "paper",
) -> SkyFit:
    """Fit a formula to skies: by default Perez's, as Preetham et al. (1999) do.

    A formula is a distribution over the dome, whose coefficients depend on what was swept and on
    the sun, times a scale. By default, for each of x, y and Y the ten numbers of five coefficients
    linear in the swept parameter are fitted to all skies at once by Levenberg-Marquardt; the scale
    is the zenith's luminance and chromaticity by the paper's formulas. For comparison
    `SkyFit.two_stage` has what Preetham et al. (1999) describe: five coefficients for each value of
    the parameter, and a line through them. The scale of any other formula is e to the power of a
    polynomial in the parameters and the sun: the value of the zenith where the distribution is
    relative to it, else the mean over the dome.

    Where no direction is the zenith, each sky's zenith value is a free parameter.

    Args:
        data: Skies in the form of `skyfit.dataset`, simulated or measured; suns above the horizon,
            for other formulas than the default also in twilight, to 18° below it.
        distribution: "perez", "cie", "hosek-wilkie", "series", or a distribution of
            `skyfit.models` with settings of its own.
        dependence: Dependence of the coefficients on the swept parameters and the sun: "linear" in
            the parameters, "polynomial" in both, linear between "nodes", polynomial with the terms
            of a low "total degree" for several parameters and twilight, or a `Dependence`.
        channels: "Yxy", "XYZ", "RGB", "spectrum" for every wavelength of the data, or the
            wavelengths of spectral bands [nm].
        weights: "equal" counts every direction equally, "solid angle" by its share of the dome.
        residuals: "relative" (model / data - 1) or "absolute" (over the RMS of the data).
        max_view_zenith: View zenith angle beyond which directions are left out [rad]. "series" and
            "hosek-wilkie" keep a twentieth of their weight there, lest they turn negative.
        prior: Multiplies the loss by 1 + prior |u - u₀|², u being the free coordinates of the
            coefficients and u₀ the first of the distribution's starts: what the skies do not
            determine stays near it, and perfect data are fitted perfectly.
        starts: Coefficients to start from, by channel.
        zenith: Zenith of the default formula: "paper" for that of Preetham et al. (1999), or
            "logarithm" for the scale of all other formulas, which is never 0.

    Returns:
        Coefficients, their standard errors, and what a sceptic asks of them.

    Raises:
        ValueError: The data are incomplete or cannot be fitted; an unknown choice.

    Warns:
        UserWarning: The fitted zenith turns black before the sun has set.
    """
    settings = FitSettings(weights, residuals, max_view_zenith, prior, starts)
    formula = chosen_formula(distribution, dependence, zenith=zenith)
    skies = read_channels(data, channels, night=not formula.by_day_alone)
    fit = fit_formula(skies, formula, settings, provenance=data.attrs)
    if (said := early_night(fit)) is not None:
        warnings.warn(f"fit_sky: {said}", stacklevel=2)
    return fit


def fit_formula(
    skies: Skies,
    formula: Formula = PUBLISHED,
    settings: FitSettings | None = None,
    *,
    provenance: Mapping[Any, Any] | None = None,
    use: Bool[np.ndarray, " sky"] | None = None,
    start: SkyFit | None = None,
) -> SkyFit:
    """Fit a formula to skies in the channels to fit.

    Args:
        skies: What to fit.
        formula: Distribution and dependence.
        settings: Weights, residuals, prior, starts.
        provenance: Attributes of the data.
        use: Skies to fit; all by default.
        start: a fit of the same formula to begin from.
    """
    settings = FitSettings() if settings is None else settings
    use = np.ones(skies.count, bool) if use is None else use
    seen = skies if use.all() else skies.subset(use)
    if formula.has_paper_zenith(skies):
        # One set of starts serves it, and the zenith is asked of the skies in use alone.
        skies, use, start = seen, np.ones(seen.count, bool), None
    begin = _sums(start, skies) if start is not None and formula.dependence.linked else None
    joint = fit_groups(skies, formula, settings, use=use, start=begin)
    read = [_read(joint, k, skies, formula, settings) for k in range(len(skies.channels))]
    named = dict(zip(skies.channels, read, strict=True))
    convert = formula.dependence.from_fitted(seen)
    _, free = evaluate(as_float(joint.numbers[:, 0]), joint.problem)
    scale, scale_errors, scale_rms = fit_scale(
        skies, formula, settings, np.asarray(free, float), use
    )
    notes: dict[str, Any] = {
        "diagnostics": {name: one.diagnostics for name, one in named.items()},
        "scale_rms": scale_rms,
        "two_stage": _two_stage(skies, formula, settings, joint),
        "positivity": None,
        "settings": {
            "distribution": formula.distribution.name,
            "dependence": formula.dependence.describe(),
            "channels": skies.kind,
            "zenith": formula.zenith,
            **plain(settings),
        },
        "provenance": {
            "data": plain(dict(provenance or {})),
            "versions": versions("optimistix", "lineax"),
        },
    }

    def fit(notes):
        return SkyFit(
            numbers={
                name: (convert @ joint.numbers[k, 0, : joint.basis.num_terms]).T
                for k, name in enumerate(skies.channels)
            },
            number_errors={name: _errors(one.covariance, convert) for name, one in named.items()},
            basis=formula.dependence.basis(seen),
            distribution=formula.distribution,
            scale=scale,
            scale_errors=scale_errors,
            wavelengths=skies.wavelengths,
            linked=formula.dependence.linked,
            kind=skies.kind,
            channels=skies.channels,
            ranges=tuple(seen.ranges.items()),
            sun_zenith_range=seen.sun_zenith_range,
            notes=Notes(**notes),
        )

    return fit(notes | {"positivity": positivity(fit(notes))})


class _Read(NamedTuple):
    diagnostics: Diagnostics
    covariance: Float[np.ndarray, "term coefficient term coefficient"]


def _read(joint: BatchFit, k: int, skies: Skies, formula: Formula, settings: FitSettings) -> _Read:
    """Diagnostics and covariance of one channel of a joint fit."""
    terms, count = joint.basis.num_terms, len(formula.distribution.names)
    free = np.asarray(joint.solution.free)[k].reshape(-1, count)[:terms]
    one = examine(as_float(free.ravel()), lane(joint.problem, k, terms))
    found = Examined(*(np.asarray(field, float) for field in one))
    weighed = np.asarray(joint.problem.weight)[k] > 0
    inside = weighed & (skies.view_zenith <= settings.max_view_zenith + 1e-6)
    residual = found.residual[inside]
    noise = variance(found.residual[weighed], free.size)
    by_number, by_free = spectrum(found.by_number), spectrum(found.by_free)
    diagnostics = Diagnostics(
        rms=float(np.sqrt(np.mean(residual**2))),
        worst=float(np.abs(residual).max()),
        condition=by_number.condition,
        unidentified=loose_combinations(
            by_free, noise, formula.distribution, _places(skies, formula, terms)
        ),
        converged=bool(joint.converged[k, 0]),
        steps=int(joint.solution.steps[k]),
    )
    spread = noise * by_number.covariance()
    return _Read(diagnostics, spread.reshape(terms, count, terms, count))


def _places(skies: Skies, formula: Formula, num_terms: int) -> tuple[str, ...]:
    """Where the terms of a line between two ends are."""
    if formula.dependence.linked or num_terms != 2:
        return ()
    varied = ((name, ends) for name, ends in skies.ranges.items() if ends[0] < ends[1])
    return tuple(f"{name} {end:g}" for name, ends in varied for end in ends)


def _errors(covariance, convert) -> Float[np.ndarray, "coefficient term"]:
    """Standard errors of numbers that are made of those fitted."""
    return np.sqrt(np.maximum(np.einsum("it,tcuc,iu->ci", convert, covariance, convert), 0.0))


def _sums(fit: SkyFit, skies: Skies) -> Float[np.ndarray, "channel sky coefficient"]:
    """Sums of a fit's numbers times terms for every sky."""
    along = terms_of(fit.basis, skies)
    return np.stack([along @ np.asarray(fit.numbers[name]).T for name in fit.channels])


def _two_stage(
    skies: Skies, formula: Formula, settings: FitSettings, joint: BatchFit
) -> dict[str, TwoStage] | None:
    """Coefficients for each value of the one parameter, then a line through them."""
    if not formula.has_paper_zenith(skies) or joint.basis.num_terms != 2:
        return None
    (parameter,) = skies.swept.values()
    values = np.unique(parameter)
    fit = fit_groups(skies, formula, settings, "swept")
    table = fit.numbers[:, :, 0]
    lines = np.stack([np.polyfit(values, rows, 1).T for rows in table])
    ends = np.stack([(values[0], values[-1]), (1.0, 1.0)])
    numbers = as_float(np.swapaxes(lines @ ends, 1, 2))
    residuals, _ = (np.asarray(x, float) for x in evaluate(numbers, joint.problem))
    count = np.count_nonzero(np.asarray(joint.problem.weight), axis=(1, 2))
    rms = np.sqrt((residuals**2).sum((1, 2)) / count)
    return {
        name: TwoStage(values, table[k], lines[k], fit.rms[k], float(rms[k]))
        for k, name in enumerate(skies.channels)
    }
