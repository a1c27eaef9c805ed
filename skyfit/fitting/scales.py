"""Fits of a formula's scale: the paper's zenith formulas, or the logarithm of any other."""

from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Bool, Float

from .._typing import as_float
from ..models.axes import SUN
from ..models.formula import CHANNELS
from ..models.preetham import ZENITH_ANGLE
from ..models.scale import AbstractScale, CubicZenith, LogScale, PaperZenith, TangentZenith
from .choices import FitSettings, Formula
from .diagnostics import spectrum, variance
from .record import SkyFit
from .skies import Skies
from .solver import NormalEquationsLM
from .targets import direction_weights, fit_logarithm, means, scale_terms


def fit_scale(
    skies: Skies,
    formula: Formula,
    settings: FitSettings,
    values: Float[np.ndarray, "channel sky"],
    use: Bool[np.ndarray, " sky"],
) -> tuple[AbstractScale, dict[str, dict[str, Any]], dict[str, float]]:
    """Fit the scale of a formula whose distribution is known.

    Args:
        skies: Skies that were fitted.
        formula: Distribution and dependence.
        settings: Weights of directions.
        values: Scale of each sky with which its distribution fits best.
        use: Skies in use.

    Returns:
        The scale, the standard errors of its numbers where they are known, and the relative RMS by
        channel.
    """
    if formula.has_paper_zenith(skies):
        return _paper_zenith(skies, values if skies.zenith is None else skies.zenith)
    if not formula.distribution.relative:
        values = means(skies, direction_weights(skies, formula, settings), formula)
    along = scale_terms(skies, formula, use)[use]
    rows = [fit_logarithm(along, value[use]) for value in values]
    rms = [
        float(np.sqrt(np.mean((np.log(value[use]) - along @ row) ** 2)))
        for value, row in zip(values, rows, strict=True)
    ]
    night = tuple(name not in ("x", "y") for name in skies.channels)
    seen = skies.subset(use)
    scale = LogScale(
        numbers=as_float(np.stack(rows)),
        basis=formula.scale_dependence.basis(seen),
        dimming=as_float(np.zeros(len(rows))),
        lowest_sun=seen.sun_zenith_range[1],
        night=night,
    )
    dimming = _dimming(scale, seen)
    scale = LogScale(scale.numbers, scale.basis, dimming, scale.lowest_sun, night)
    return scale, {}, dict(zip(skies.channels, rms, strict=True))


def _dimming(scale: LogScale, skies: Skies):
    """How channels fall over the last degree of the suns, in the middle of every parameter."""
    first, last = skies.sun_zenith_range
    if last - first < np.radians(1.0):
        return scale.dimming
    at = {name: as_float(np.full(2, np.mean(ends))) for name, ends in skies.ranges.items()}
    at[SUN] = as_float(last - np.radians([1.0, 0.0]))
    before, after = np.moveaxis(np.log(np.asarray(scale(at), float)), -1, 0)
    return as_float(np.maximum(before - after, 0.0) / np.radians(1.0) * np.array(scale.night))


def _paper_zenith(skies: Skies, values: Float[np.ndarray, "channel sky"]):
    """Fits of the zenith values: the skies' own, or those that their shapes imply."""
    name = next(iter(skies.swept), "")
    parameter = skies.swept[name] if name else np.zeros(skies.count)
    fits = {}
    for channel, value in zip(CHANNELS, values, strict=True):
        fit = fit_zenith_luminance if channel == "Y" else fit_zenith_chromaticity
        fits[channel] = fit(parameter, skies.sun_zenith, value)
    x, y = (CubicZenith(as_float(fits[c].numbers["matrix"])) for c in "xy")
    linear, angle = (as_float(fits["Y"].numbers[part]) for part in ("linear", "angle"))
    return (
        PaperZenith(x, y, TangentZenith(linear, angle), name),
        {channel: fit.standard_errors for channel, fit in fits.items()},
        {channel: fit.rms for channel, fit in fits.items()},
    )


def early_night(fit: SkyFit) -> str | None:
    """Where the tangent of the paper's zenith falls to 0 while the sun is up, in words.

    The light of a sky is far from 0 there: at turbidity 6 it is 130 cd/m² at sunset.
    """
    if not isinstance(fit.scale, PaperZenith):
        return None
    suns = np.radians(np.linspace(0.0, 90.0, 181))
    for value in fit.swept.get(fit.scale.quantity, (0.0,)):
        luminance = np.asarray(fit.scale.luminance(as_float(value), as_float(suns)))
        if (black := luminance <= 0).any():
            where = f" at {fit.scale.quantity} {value:g}" if fit.scale.quantity else ""
            at = np.degrees(suns[black.argmax()])
            return (
                f"the fitted zenith is black{where} with the sun {at:.3g} degrees from the zenith, "
                "before it has set; zenith='logarithm' stays positive, and distribution='series' "
                "with dependence='polynomial' fits better"
            )
    return None


class ZenithFit(NamedTuple):
    """Numbers of a zenith formula, their standard errors, and the relative RMS of the fit."""

    numbers: dict[str, Float[np.ndarray, "..."]]
    standard_errors: dict[str, Float[np.ndarray, "..."]]
    rms: float


def fit_zenith_chromaticity(
    parameter: Float[np.ndarray, " sky"],
    sun_zenith: Float[np.ndarray, " sky"],
    value: Float[np.ndarray, " sky"],
) -> ZenithFit:
    """Fit the matrix of `CubicZenith` by linear least squares of relative residuals.

    Powers that the skies cannot tell apart are left out: there are at most as many powers of the
    parameter, or of the sun's zenith angle, as it has values. Their entries are 0.

    Args:
        parameter: What was swept.
        sun_zenith: [rad].
        value: x or y of the zenith.
    """
    powers = min(3, np.unique(parameter).size), min(4, np.unique(sun_zenith).size)
    along_parameter = np.vander(parameter, 3)[:, 3 - powers[0] :]
    along_sun = np.vander(sun_zenith, 4)[:, 4 - powers[1] :]
    terms = (along_parameter[:, :, None] * along_sun[:, None, :]).reshape(value.size, -1)
    solution, errors, residual = _linear(terms / value[:, None], np.ones_like(value))
    matrix, spread = np.zeros((3, 4)), np.zeros((3, 4))
    matrix[3 - powers[0] :, 4 - powers[1] :] = solution.reshape(powers)
    spread[3 - powers[0] :, 4 - powers[1] :] = errors.reshape(powers)
    return ZenithFit({"matrix": matrix}, {"matrix": spread}, _rms(residual))


def fit_zenith_luminance(
    parameter: Float[np.ndarray, " sky"],
    sun_zenith: Float[np.ndarray, " sky"],
    value: Float[np.ndarray, " sky"],
) -> ZenithFit:
    """Fit the numbers of `TangentZenith` by Levenberg-Marquardt on relative residuals.

    All six are free: a, b, c, d, in which the formula is linear, and p, q inside the tangent, whose
    argument is kept between 0 and π/2. Where nothing was swept a, c and q are 0. With two suns p
    keeps the published 4/9, with one only the constant is left.

    Args:
        parameter: What was swept.
        sun_zenith: [rad].
        value: Luminance of the zenith [cd m⁻²].
    """
    ends = np.unique([parameter.min(), parameter.max()])
    share = np.interp(parameter, ends, np.linspace(0, 1, ends.size))
    basis = np.stack([1 - share, share], axis=1)[:, : ends.size]
    suns = np.unique(sun_zenith).size
    determined = np.repeat([suns > 1, True, suns > 2], ends.size).astype(float)
    # The published angle, at turbidities for which it was made.
    angle = np.polyval(ZENITH_ANGLE[::-1], np.clip(ends, 2, 6)) if ends.size > 1 else [4 / 9]
    tangent = np.tan(basis @ angle * (np.pi - 2 * sun_zenith))
    scale = np.mean(value)
    terms = np.concatenate([tangent[:, None] * basis, basis], axis=1) / (value / scale)[:, None]
    linear, *_ = np.linalg.lstsq(terms * determined[: terms.shape[1]], np.ones_like(value))
    start = np.concatenate([linear, np.log(2 * np.array(angle) / (1 - 2 * np.array(angle)))])
    args = tuple(map(as_float, (basis, sun_zenith, value / scale, determined, start)))
    free, jacobian, residual = (np.asarray(x, float) for x in _solve_tangent(args[-1], args))

    def numbers(free):
        tangents, constants, angles = free.reshape(3, -1)
        nodes = jnp.stack([scale * tangents, scale * constants, 0.5 * jax.nn.sigmoid(angles)])
        return jnp.asarray(_line(ends), nodes.dtype) @ nodes.T

    fitted = np.asarray(numbers(as_float(free)), float)
    change = np.asarray(jax.jacfwd(numbers)(as_float(free)), float)
    spread = np.sqrt(np.einsum("ijk,kl,ijl->ij", change, _covariance(jacobian, residual), change))
    return ZenithFit(*map(_tangent_numbers, (fitted, spread)), rms=_rms(residual))


def _tangent_numbers(table):
    """a, b, c, d and p, q from (slope, intercept) of the three coefficients."""
    (a, c, q), (b, d, p) = table
    return {"linear": np.array([a, b, c, d]), "angle": np.array([p, q])}


def _line(ends: Float[np.ndarray, " node"]) -> Float[np.ndarray, "2 node"]:
    """Slope and intercept from the values at one or two ends."""
    if ends.size == 1:
        return np.array([[0.0], [1.0]])
    return np.linalg.inv(np.stack([ends, np.ones(2)], axis=1))


def _tangent_residuals(free, args):
    basis, sun_zenith, value, determined, start = args
    free = determined * free + (1 - determined) * start
    tangents, constants, angles = free.reshape(3, -1)
    chi = basis @ (0.5 * jax.nn.sigmoid(angles)) * (jnp.pi - 2 * sun_zenith)
    return (basis @ tangents * jnp.tan(chi) + basis @ constants) / value - 1


@eqx.filter_jit
def _solve_tangent(start: Float[Array, " free"], args):
    precision = float(jnp.finfo(start.dtype).eps)
    solver = NormalEquationsLM(rtol=precision, atol=precision)
    solution = optx.least_squares(
        _tangent_residuals, solver, start, args, max_steps=256, throw=False
    )
    jacobian = jax.jacfwd(_tangent_residuals)(solution.value, args)
    return solution.value, jacobian, _tangent_residuals(solution.value, args)


def _linear(terms, target):
    """Least squares with columns of unit length: solution, its standard errors, residuals."""
    length = np.linalg.norm(terms, axis=0)
    solution, *_ = np.linalg.lstsq(terms / length, target)
    residual = terms @ (solution / length) - target
    return solution / length, np.sqrt(np.diag(_covariance(terms, residual))), residual


def _rms(residual):
    return float(np.sqrt(np.mean(residual**2)))


def _covariance(jacobian, residual):
    """Covariance of least-squares parameters, as if residuals were independent."""
    noise = variance(residual, jacobian.shape[1])
    return noise * spectrum(jacobian.T @ jacobian).covariance()
