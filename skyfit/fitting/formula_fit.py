"""Fits of any distribution, dependence and channels: the ladder's one fitter.

Each channel is fitted on its own. The scale comes first: the logarithm of each sky's mean over the
dome (or, where the distribution is relative to the zenith, of the scale that fits each sky best) as
a polynomial. Then all numbers of the distribution are fitted to all skies at once. A series is one
linear problem. Other distributions are led from simple to rich: the same coefficients for all
skies, from every one of the distribution's starts; then polynomials of rising degree, each begun
from the one before.
"""

import dataclasses
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from .._typing import as_float
from ..models.basis import AbstractBasis, Nodes, Polynomial
from ..models.formula import dims_at_night
from ..models.shapes import AbstractShape
from .choices import SCALE, Dependence
from .document import plain, versions
from .formula_errors import formula_diagnostics, spectrum_of
from .formula_record import FormulaFit
from .groups import FitSettings
from .joint import JointFit, JointProblem, Penalty, fit_joint
from .positivity import positivity
from .skies import Skies


# Per squared unit that a sky's free number is away from the prior's centre, in units of one
# relative residual of 1 in every direction. The numbers of a series are larger and trade more.
PRIOR, SERIES_PRIOR = 1e-6, 1e-8
# Directions too close to the horizon for the formula to follow keep so much of their weight: they
# bend the rest by a hundredth of what it is off, and light stays positive down to the horizon.
HORIZON = 0.05
SMOOTHNESS, SERIES_SMOOTHNESS = 1e-4, 1e-7  # of coefficients at nodes, in the same unit
FINAL = 1e-5  # relative decrease of the objective that ends a fit
_LADDER = ((0, 0), (1, 1), (2, 3))  # degrees on the way to those asked for


class ChannelFit(NamedTuple):
    """One channel: its numbers, those of its scale, and how the scale fits."""

    joint: JointFit
    scale: Float[np.ndarray, " scale_term"]
    scale_rms: float


def fit_formula(
    skies: Skies,
    settings: FitSettings,
    shape: AbstractShape,
    dependence: Dependence,
    *,
    prior: float | None = None,
    provenance: Mapping[Any, Any] | None = None,
    use: Bool[np.ndarray, " sky"] | None = None,
    start: FormulaFit | None = None,
) -> FormulaFit:
    """Fit a formula to skies.

    Args:
        skies: In the channels to fit.
        settings: Weights, residuals, and how far down to look.
        shape: The distribution.
        dependence: Of its coefficients.
        prior: Weight of the prior, see `PRIOR`; by default that of the distribution.
        provenance: Of the data.
        use: Which skies to fit; all by default.
        start: A fit of the same formula to begin from.
    """
    prior = (SERIES_PRIOR if shape.linear else PRIOR) if prior is None else prior
    fitted = skies if use is None else skies.subset(use)
    basis, scale_basis = dependence.basis(fitted), SCALE.basis(fitted)
    begin = {name: _numbers_in(start, name, basis) for name in skies.channels} if start else {}
    fits = [
        fit_channel(
            skies,
            channel,
            settings,
            shape,
            basis,
            scale_basis,
            prior,
            use,
            begin.get(name),
        )
        for channel, name in enumerate(skies.channels)
    ]
    named = dict(zip(skies.channels, fits, strict=True))
    spectra = {name: spectrum_of(fit.joint) for name, fit in named.items()}
    dimmed = np.broadcast_to(dims_at_night(skies.kind), len(fits))
    fit = FormulaFit(
        shape=shape,
        basis=basis,
        scale_basis=scale_basis,
        kind=skies.kind,
        wavelengths=skies.wavelengths,
        coefficients={name: fit.joint.numbers for name, fit in named.items()},
        standard_errors={
            name: spectrum.errors().reshape(basis.num_terms, -1).T
            for name, spectrum in spectra.items()
        },
        scale={name: fit.scale for name, fit in named.items()},
        scale_rms={name: fit.scale_rms for name, fit in named.items()},
        dimming={
            name: _dimming(fit.scale, scale_basis, skies) if dims else 0.0
            for (name, fit), dims in zip(named.items(), dimmed, strict=True)
        },
        parameter_name=skies.parameter_name,
        parameter_range=skies.parameter_range if skies.parameter_name else None,
        sun_zenith_range=skies.sun_zenith_range,
        diagnostics={
            name: formula_diagnostics(fit.joint, spectra[name], shape, basis)
            for name, fit in named.items()
        },
        positivity=None,
        settings={
            "distribution": shape.name,
            "dependence": dependence.describe(),
            "channels": skies.kind,
            "weights": settings.weights,
            "residuals": settings.residuals,
            "max_view_zenith": settings.max_view_zenith,
            "prior": prior,
        },
        provenance={"data": plain(dict(provenance or {})), "versions": versions()},
    )
    return dataclasses.replace(fit, positivity=positivity(fit))


def _numbers_in(fit: FormulaFit, channel: str, basis: AbstractBasis):
    """Numbers of a fit in another basis of the same kind: fewer nodes, or a lower degree."""
    numbers = fit.coefficients[channel]
    if isinstance(basis, Nodes):
        there = fit.basis.terms(basis.parameter[:, None], basis.sun_zenith[None, :])
        return numbers @ np.asarray(there, float).reshape(fit.basis.num_terms, -1)
    assert isinstance(basis, Polynomial)
    assert isinstance(fit.basis, Polynomial)
    table = numbers.reshape(len(numbers), fit.basis.parameter_degree + 1, -1)
    table = table[:, : basis.parameter_degree + 1, : basis.sun_degree + 1]
    return table.reshape(len(numbers), -1)


def fit_channel(
    skies: Skies,
    channel: int,
    settings: FitSettings,
    shape: AbstractShape,
    basis: AbstractBasis,
    scale_basis: AbstractBasis,
    prior: float,
    use: Bool[np.ndarray, " sky"] | None = None,
    start: Float[np.ndarray, "coefficient term"] | None = None,
) -> ChannelFit:
    """Fit one channel to the skies in use; `start` replaces the way from simple to rich."""
    use = np.ones(skies.parameter.size, bool) if use is None else use
    values = skies.values[channel]
    weight = skies.weights(settings.weights, settings.max_view_zenith)
    weight = np.where(weight > 0, weight, HORIZON * (skies.view_zenith <= np.pi / 2 + 1e-6))
    weight = weight * use[:, None]
    square = weight**2
    along = _terms(scale_basis, skies)
    scale, factor = np.zeros(scale_basis.num_terms), np.ones(len(values))
    mean = (square * values).sum(1) / np.where(use, square.sum(1), 1.0)
    if not shape.relative:
        scale = _fit_scale(along[use], mean[use])
        factor = np.exp(along @ scale)
    if settings.residuals == "absolute":
        weight = weight * values / np.sqrt((square * values**2).sum() / square.sum())
    problem = JointProblem(
        shape=shape,
        cos_view=as_float(np.cos(skies.view_zenith)),
        gamma=as_float(skies.gamma),
        sun_zenith=as_float(skies.sun_zenith),
        target=as_float(values / factor[:, None]),
        weight=as_float(weight),
    )
    unit = float(square[use].sum(1).mean())

    def terms(basis):
        return _terms(basis, skies) * use[:, None]

    joint = _lead(problem, skies, terms, basis, prior * unit, unit, start)
    if shape.relative:
        mean = joint.scale
        scale = _fit_scale(along[use], mean[use])
    rms = float(np.sqrt(np.mean((np.log(mean[use]) - along[use] @ scale) ** 2)))
    return ChannelFit(joint, scale, rms)


def _lead(problem, skies, terms, basis, prior, unit, start) -> JointFit:
    """From simple to rich."""
    shape = problem.shape
    starts = np.array(shape.starts())
    centre = np.zeros(len(shape.names)) if shape.linear else starts[0]

    def solve(basis, numbers, rtol=1e-3):
        smoothness = unit * (SERIES_SMOOTHNESS if shape.linear else SMOOTHNESS)
        penalty = Penalty(prior, centre, smoothness, basis.roughness())
        return fit_joint(problem, terms(basis), numbers, penalty, rtol=rtol)

    if shape.linear and start is None:
        start = np.zeros((len(centre), basis.num_terms))
    if start is not None:
        return solve(basis, start, FINAL)
    if isinstance(basis, Polynomial):
        top = basis.parameter_degree, basis.sun_degree
        function = basis.sun_function
    else:
        top, function = (2, 3), "zenith angle"
    degrees = [(min(p, top[0]), min(q, top[1])) for p, q in (*_LADDER, top)]
    ranges = skies.parameter_range, skies.sun_zenith_range
    steps = [Polynomial(*ranges, *degree, function) for degree in dict.fromkeys(degrees)]
    first = min((solve(steps[0], row[:, None]) for row in starts), key=lambda fit: fit.objective)
    fits, previous = first, steps[0]
    for step in steps[1:]:
        precision = FINAL if step is steps[-1] and isinstance(basis, Polynomial) else 1e-3
        fits = solve(step, _raise_degree(fits.numbers, previous, step), precision)
        previous = step
    if isinstance(basis, Nodes):
        at = basis.parameter[:, None], basis.sun_zenith[None, :]
        there = np.asarray(previous.terms(*at), float).reshape(previous.num_terms, -1)
        return solve(basis, fits.numbers @ there, FINAL)
    return fits


def _raise_degree(numbers, low: Polynomial, high: Polynomial):
    """The same polynomial with terms of higher degree, which are 0."""
    table = np.zeros((len(numbers), high.parameter_degree + 1, high.sun_degree + 1))
    shape = low.parameter_degree + 1, low.sun_degree + 1
    table[:, : shape[0], : shape[1]] = numbers.reshape(-1, *shape)
    return table.reshape(len(numbers), -1)


def _terms(basis: AbstractBasis, skies: Skies) -> Float[np.ndarray, "sky term"]:
    return np.asarray(basis.terms(as_float(skies.parameter), as_float(skies.sun_zenith)), float).T


def _fit_scale(terms, mean):
    return np.linalg.lstsq(terms, np.log(mean), rcond=1e-10)[0]


def _dimming(scale, basis: AbstractBasis, skies: Skies) -> float:
    """How the scale falls over the last degree of the suns, for the middle of the parameter."""
    last = skies.sun_zenith_range[1]
    if last - skies.sun_zenith_range[0] < np.radians(1.0):
        return 0.0
    suns = as_float(last - np.radians([1.0, 0.0]))
    middle = as_float(np.full(2, np.mean(skies.parameter_range)))
    before, after = np.asarray(basis.terms(middle, suns), float).T @ scale
    return float(max(before - after, 0.0) / np.radians(1.0))
