"""From a sky dataset to a sky model: `fit_sky`."""

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from .._typing import as_float
from ..models.perez import CHANNELS, COEFFICIENTS
from ..models.shapes import AbstractShape
from .channels import Channels, read_channels
from .choices import (
    Dependence,
    chosen_dependence,
    chosen_shape,
)
from .diagnostics import (
    Diagnostics,
    condition_number,
    covariance,
    jacobians,
    line_with_errors,
    loose_combinations,
)
from .document import plain, versions
from .formula_fit import fit_formula
from .formula_record import FormulaFit
from .groups import MAX_VIEW_ZENITH, PRIOR, BatchFit, FitSettings, Starts, fit_groups
from .positivity import positivity
from .record import SkyFit, TwoStage
from .shape import ShapeProblem, shape_residuals
from .skies import Residuals, Skies, Weights, read_skies
from .zenith import ZenithFit, fit_zenith_chromaticity, fit_zenith_luminance


if TYPE_CHECKING:
    import xarray as xr


@overload
def fit_sky(
    data: "xr.Dataset",
    *,
    weights: Weights = ...,
    residuals: Residuals = ...,
    max_view_zenith: float = ...,
    prior: float | None = ...,
    starts: Starts | None = ...,
) -> SkyFit: ...


@overload
def fit_sky(
    data: "xr.Dataset",
    *,
    distribution: str | AbstractShape = ...,
    dependence: str | Dependence = ...,
    channels: Channels = ...,
    weights: Weights = ...,
    residuals: Residuals = ...,
    max_view_zenith: float = ...,
    prior: float | None = ...,
    starts: Starts | None = ...,
) -> SkyFit | FormulaFit: ...


def fit_sky(
    data: "xr.Dataset",
    *,
    distribution: str | AbstractShape = "perez",
    dependence: str | Dependence = "linear",
    channels: Channels = "Yxy",
    weights: Weights = "equal",
    residuals: Residuals = "relative",
    max_view_zenith: float = float(MAX_VIEW_ZENITH),
    prior: float | None = None,
    starts: Starts | None = None,
) -> SkyFit | FormulaFit:
    """Fit a formula to skies: by default Perez's, as Preetham et al. (1999) do.

    By default, for each of x, y and Y the ten numbers of five coefficients linear in the swept
    parameter are fitted to all skies at once by Levenberg-Marquardt; then the zenith's luminance
    and chromaticity over the sun and the parameter. For comparison `SkyFit.two_stage` has what
    Preetham et al. (1999) describe: five coefficients for each value of the parameter, and a line
    through them. Any other distribution, dependence or channels is fitted as
    `skyfit.fitting.formula_fit` describes.

    Where no direction is the zenith, each sky's zenith value is a free parameter.

    Args:
        data: Skies in the form of `skyfit.dataset`, simulated or measured.
        distribution: "perez", "cie", "hosek-wilkie", "series", or one of
            `skyfit.models.shapes` with settings of its own.
        dependence: Of the coefficients, on the swept parameter and the sun: "linear" in the
            parameter, "polynomial" in both, linear between "nodes", or a `Dependence`.
        channels: "Yxy", "XYZ", "RGB", "spectrum" for every wavelength of the data, or the
            wavelengths of spectral bands [nm].
        weights: "equal" counts every direction equally, "solid angle" by its share of the dome.
        residuals: "relative" (model / data - 1) or "absolute" (over the RMS of the data).
        max_view_zenith: Leave out directions closer to the horizon [rad].
        prior: Multiplies the loss by 1 + prior |u - u₀|², u being the free coordinates of
            `PerezDistribution` and u₀ the first of its starts: what the skies do not determine
            stays near it, and perfect data are fitted perfectly. Other formulas than the default
            have a prior of their own, see `skyfit.fitting.formula_fit`.
        starts: Coefficients A to E to start from, by channel; for the default formula only.

    Returns:
        Coefficients, their standard errors, and what a sceptic asks of them: a `SkyFit` for the
        default formula, a `FormulaFit` for any other.

    Raises:
        ValueError: The data are incomplete or cannot be fitted; an unknown choice.
    """
    settings = FitSettings(
        weights, residuals, max_view_zenith, PRIOR if prior is None else prior, starts
    )
    if (distribution, dependence, channels) != ("perez", "linear", "Yxy"):
        shape, choice = chosen_shape(distribution), chosen_dependence(dependence)
        if starts is not None:
            raise ValueError("fit_sky(starts=...): only the default formula takes starts")
        skies = read_channels(data, channels)
        return fit_formula(skies, settings, shape, choice, prior=prior, provenance=data.attrs)
    return fit_published(read_skies(data), settings, data.attrs)


def fit_published(skies: Skies, settings: FitSettings, provenance: Mapping[Any, Any]) -> SkyFit:
    """Fit the published form; `provenance` is that of the data."""
    joint = fit_groups(skies, settings, "all")
    lines, errors, diagnostics = read_joint(joint, skies)
    zenith = _zenith(skies, joint)
    fit = SkyFit(
        coefficients=lines,
        standard_errors=errors,
        zenith={name: fit.numbers for name, fit in zenith.items()},
        zenith_standard_errors={name: fit.standard_errors for name, fit in zenith.items()},
        zenith_rms={name: fit.rms for name, fit in zenith.items()},
        parameter_name=skies.parameter_name,
        parameter_range=skies.parameter_range if skies.parameter_name else None,
        sun_zenith_range=skies.sun_zenith_range,
        diagnostics=diagnostics,
        two_stage=_two_stage(skies, settings, joint),
        settings={
            "distribution": type(joint.problem.distribution).__name__,
            "dependence": type(joint.dependence).__name__,
            **plain(dataclasses.asdict(settings)),
        },
        provenance={"data": plain(dict(provenance)), "versions": versions()},
    )
    return dataclasses.replace(fit, positivity=positivity(fit))


class EachSky(NamedTuple):
    """Five coefficients for every sky by itself.

    Attributes:
        coefficients: A to E for x, y, Y over the dataset's sky dimensions.
        rms: Root mean square of each fit's weighted residuals.
        converged: The solver's word.
        starts: How many starts each fit took.
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
    determined coefficients are to be expected, within the bounds of `PerezDistribution`.

    Args:
        data: As for `fit_sky`.
        weights: As for `fit_sky`.
        residuals: As for `fit_sky`.
        max_view_zenith: As for `fit_sky` [rad].
        starts: Coefficients A to E to start from first, by channel.
    """
    settings = FitSettings(weights, residuals, max_view_zenith, 0.0, starts)
    skies = read_skies(data, "fit_each_sky")
    fit = fit_groups(skies, settings, "sky")
    shape = (len(CHANNELS), *skies.shape)
    return EachSky(
        fit.nodes.reshape(*shape, len(COEFFICIENTS)),
        fit.rms.reshape(shape),
        fit.converged.reshape(shape),
        fit.starts.reshape(shape),
    )


def read_joint(
    joint: BatchFit, skies: Skies
) -> tuple[dict[str, Any], dict[str, Any], dict[str, Diagnostics]]:
    """Lines, standard errors and diagnostics of each channel."""
    distribution, dependence = joint.problem.distribution, joint.dependence
    found = jacobians(as_float(joint.solution.free), joint.problem)
    by_node, by_free, residuals = (np.asarray(x, float) for x in found)
    places = _places(skies, dependence.num_nodes)
    lines, errors, diagnostics = {}, {}, {}
    for k, name in enumerate(CHANNELS):
        residual = residuals[k]
        lines[name], errors[name] = line_with_errors(
            joint.nodes[k, 0], covariance(by_node[k], residual), dependence
        )
        diagnostics[name] = Diagnostics(
            rms=float(joint.rms[k, 0]),
            worst=float(np.abs(residual).max()),
            condition=condition_number(by_node[k]),
            unidentified=loose_combinations(covariance(by_free[k], residual), distribution, places),
            converged=bool(joint.converged[k, 0]),
            steps=int(joint.solution.steps[k]),
        )
    return lines, errors, diagnostics


def _places(skies: Skies, num_nodes: int) -> tuple[str, ...]:
    if num_nodes == 1:
        return ("",)
    return tuple(f"{skies.parameter_name} {end:g}" for end in skies.parameter_range)


def _two_stage(skies: Skies, settings: FitSettings, joint: BatchFit) -> dict[str, TwoStage] | None:
    """Five coefficients for each value of the parameter, then a line through them."""
    values = np.unique(skies.parameter)
    if values.size < 2:
        return None
    fit = fit_groups(skies, settings, "parameter")
    table = fit.nodes[:, :, 0]
    lines = np.stack([np.polyfit(values, rows, 1).T for rows in table])
    ends = np.stack([skies.parameter_range, (1.0, 1.0)])
    nodes = np.swapaxes(lines @ ends, 1, 2)
    residuals, _ = (np.asarray(x, float) for x in evaluate(nodes, joint.problem))
    count = np.count_nonzero(np.asarray(joint.problem.weight), axis=(1, 2))
    rms = np.sqrt((residuals**2).sum((1, 2)) / count)
    return {
        name: TwoStage(values, table[k], lines[k], fit.rms[k], float(rms[k]))
        for k, name in enumerate(CHANNELS)
    }


def _zenith(skies: Skies, joint: BatchFit) -> dict[str, ZenithFit]:
    """Fits of the zenith values: the skies' own, or those that their shapes imply."""
    values = skies.zenith
    if values is None:
        _, implied = evaluate(joint.nodes[:, 0], joint.problem)
        values = np.asarray(implied, float)
    fits = {}
    for name, value in zip(CHANNELS, values, strict=True):
        fit = fit_zenith_luminance if name == "Y" else fit_zenith_chromaticity
        fits[name] = fit(skies.parameter, skies.sun_zenith, value)
    return fits


def evaluate(
    nodes: Float[np.ndarray, "lane node coefficient"], problem: ShapeProblem
) -> tuple[Float[Array, "lane sky direction"], Float[Array, "lane sky"]]:
    """Residuals and zenith values of a batch at given coefficients."""
    return _evaluate(as_float(nodes), problem)


@eqx.filter_jit
def _evaluate(nodes, problem):
    return jax.vmap(shape_residuals)(nodes, problem)
