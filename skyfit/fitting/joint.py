"""One Levenberg-Marquardt fit of all numbers of a channel to all of its skies.

A sky's coefficients are a matrix of numbers times the sky's terms, so the normal equations of all
numbers are sums over skies of those of one sky's few coefficients, multiplied by its terms. Only
the small ones need derivatives: some hundred numbers cost as much as the nine of a sky.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import as_float
from ..models.shapes import AbstractShape


class JointProblem(eqx.Module):
    """One channel's skies.

    Attributes:
        shape: The formula.
        cos_view: Cosine of the view zenith angle.
        gamma: Angle between view and sun [rad].
        sun_zenith: [rad].
        target: Values over the scale, or values whose scale is free; above 0.
        weight: Of each relative residual.
    """

    shape: AbstractShape
    cos_view: Float[Array, "sky direction"]
    gamma: Float[Array, "sky direction"]
    sun_zenith: Float[Array, " sky"]
    target: Float[Array, "sky direction"]
    weight: Float[Array, "sky direction"]


class Penalty(NamedTuple):
    """What draws numbers that the skies leave open.

    Attributes:
        prior: Weight of the squared distance of a sky's free numbers from `centre`, in units of
            one residual.
        centre: Free numbers.
        smoothness: Weight of `roughness`.
        roughness: Quadratic form in the numbers of one coefficient.
    """

    prior: float
    centre: Float[np.ndarray, " coefficient"]
    smoothness: float
    roughness: Float[np.ndarray, "term term"]


class JointFit(NamedTuple):
    """Numbers, half the penalised sum of squares, residuals, each sky's scale, normal matrix."""

    numbers: Float[np.ndarray, "coefficient term"]
    objective: float
    residual: Float[np.ndarray, "sky direction"]
    scale: Float[np.ndarray, " sky"]
    normal: Float[np.ndarray, "number number"]
    steps: int
    converged: bool


def sky_residual(
    free: Float[Array, " coefficient"], problem: JointProblem
) -> tuple[Float[Array, " direction"], Float[Array, ""]]:
    """Weighted relative residuals of one sky, and its scale: the best where the shape has one."""
    coefficients = problem.shape.coefficients(free)
    views = problem.cos_view, problem.gamma, jnp.cos(problem.gamma)
    value = problem.shape.value(coefficients[:, None], *views)
    scale = jnp.ones_like(problem.sun_zenith)
    if problem.shape.relative:
        overhead = jnp.ones_like(problem.sun_zenith)
        sun = problem.sun_zenith
        value = value / problem.shape.value(coefficients, overhead, sun, jnp.cos(sun))
    ratio = value / problem.target
    if problem.shape.relative:
        square = problem.weight**2
        total = (square * ratio**2).sum()
        # Skies that are left out have no weight at all.
        scale = (square * ratio).sum() / jnp.where(total > 0, total, 1.0)
    return problem.weight * (scale * ratio - 1), scale


@eqx.filter_jit
def _equations(free: Float[Array, "sky coefficient"], problem: JointProblem):
    """Residuals, scale, JᵀJ and Jᵀr of every sky."""

    def one(free, problem):
        def residual(free):
            value, scale = sky_residual(free, problem)
            return value, (value, scale)

        jacobian, (value, scale) = jax.jacfwd(residual, has_aux=True)(free)
        return value, scale, jacobian.T @ jacobian, value @ jacobian

    return jax.vmap(one)(free, problem)


def fit_joint(
    problem: JointProblem,
    terms: Float[np.ndarray, "sky term"],
    start: Float[np.ndarray, "coefficient term"],
    penalty: Penalty,
    *,
    max_steps: int = 100,
    rtol: float = 1e-7,
) -> JointFit:
    """Minimise the weighted squares of the residuals and the penalty from one start.

    Args:
        problem: The skies.
        terms: Of the basis, for every sky.
        start: Numbers.
        penalty: What draws the numbers where the skies do not.
        max_steps: Evaluations of the residuals.
        rtol: Relative decrease of the objective that ends the fit.
    """
    count = start.shape[0]
    around = np.kron(penalty.smoothness * penalty.roughness, np.eye(count))
    pull = penalty.prior * np.eye(count)

    def evaluate(numbers):
        free = terms @ numbers.T
        residual, scale, gram, slope = (
            np.asarray(x, float) for x in _equations(as_float(free), problem)
        )
        away = free - penalty.centre
        flat = numbers.T.ravel()
        value = 0.5 * (residual**2).sum() + 0.5 * penalty.prior * (away**2).sum()
        value += 0.5 * flat @ around @ flat
        normal = np.einsum("si,sj,skl->ikjl", terms, terms, gram + pull, optimize=True)
        normal = normal.reshape(flat.size, flat.size) + around
        gradient = (terms.T @ (slope + penalty.prior * away)).ravel() + around @ flat
        return value, gradient, JointFit(numbers, float(value), residual, scale, normal, 0, False)

    value, gradient, best = evaluate(start)
    damping, growth = (1e-14, 2.0) if problem.shape.linear else (1e-3, 2.0)
    converged, steps = False, 0
    while steps < max_steps and not damping > 1e10:
        steps += 1
        size = np.sqrt(np.maximum(np.diag(best.normal), 1e-300))
        scaled = best.normal / size / size[:, None] + damping * np.eye(size.size)
        change = -_solve(scaled, gradient / size) / size
        promised = -(gradient @ change + 0.5 * change @ best.normal @ change)
        if promised <= rtol * value and damping <= 1e-2:
            converged = True
            break
        trial = best.numbers + change.reshape(best.numbers.shape[::-1]).T
        new_value, new_gradient, new = evaluate(trial)
        ratio = (value - new_value) / max(promised, 1e-300)
        if np.isfinite(new_value) and ratio > 1e-4:
            best, value, gradient = new, new_value, new_gradient
            damping, growth = max(damping * np.clip(1 - (2 * ratio - 1) ** 3, 0.1, 2), 1e-14), 2.0
        else:
            damping, growth = damping * growth, 2 * growth
    return best._replace(steps=steps, converged=converged)


def _solve(matrix, vector):
    from scipy.linalg import cho_factor, cho_solve

    try:
        return cho_solve(cho_factor(matrix), vector)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(matrix, vector, rcond=1e-14)[0]
