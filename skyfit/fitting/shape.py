"""Fits of a distribution to skies: residuals, and Levenberg-Marquardt over a batch of fits."""

from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Bool, Float, Int

from .distribution import AbstractDistribution
from .solver import NormalEquationsLM


class ShapeProblem(eqx.Module):
    """What one fit is given: skies whose coefficients a few nodes share.

    Attributes:
        distribution: The function to fit.
        cos_view: Cosine of the view zenith angle.
        gamma: Angle between view and sun [rad].
        sun_zenith: [rad].
        basis: Weight of each node's coefficients in each sky.
        target: Values, over the zenith's unless `free_zenith`; above 0.
        weight: Of each residual; 0 leaves it out.
        prior: How much the loss grows, as a share of itself, per squared unit that a free
            coordinate lies away from `centre`.
        centre: Free coordinates that the prior draws towards.
        free_zenith: Whether each sky has a zenith value of its own, the one that fits best.
    """

    distribution: AbstractDistribution
    cos_view: Float[Array, "*lane sky direction"]
    gamma: Float[Array, "*lane sky direction"]
    sun_zenith: Float[Array, "*lane sky"]
    basis: Float[Array, "*lane sky node"]
    target: Float[Array, "*lane sky direction"]
    weight: Float[Array, "*lane sky direction"]
    prior: Float[Array, "*lane"]
    centre: Float[Array, "*lane coefficient"]
    free_zenith: bool = eqx.field(static=True)

    def per_node(self, free: Float[Array, " free"]) -> Float[Array, "node coefficient"]:
        """Free coordinates of each node."""
        return free.reshape(self.basis.shape[-1], -1)


class ShapeSolution(NamedTuple):
    """What came out of a batch of fits, one entry a lane.

    `free` are the free coordinates of all nodes; `objective` is half the sum of squares that was
    minimised, `loss` the same without the prior; `converged` is the solver's word, not that the
    minimum is the lowest.
    """

    free: Float[Array | np.ndarray, "lane free"]
    objective: Float[Array | np.ndarray, " lane"]
    loss: Float[Array | np.ndarray, " lane"]
    steps: Int[Array | np.ndarray, " lane"]
    converged: Bool[Array | np.ndarray, " lane"]


def shape_residuals(
    nodes: Float[Array, "node coefficient"], problem: ShapeProblem
) -> tuple[Float[Array, "sky direction"], Float[Array, " sky"]]:
    """Weighted relative residuals, model / data - 1, and the zenith value of each sky."""
    coefficients = (problem.basis @ nodes).T[..., None]
    shape = problem.distribution.relative(
        coefficients, problem.cos_view, problem.gamma, problem.sun_zenith[:, None]
    )
    ratio = shape / problem.target
    zenith = jnp.ones_like(problem.sun_zenith)
    if problem.free_zenith:
        square = problem.weight**2
        zenith = (square * ratio).sum(-1) / (square * ratio**2).sum(-1)
    return problem.weight * (zenith[:, None] * ratio - 1), zenith


def objective(free: Float[Array, " free"], problem: ShapeProblem) -> Float[Array, " residual"]:
    """Residuals of the fit and of the prior: half their sum of squares is minimised.

    The prior multiplies the loss, L (1 + p |u - c|²), so that it decides where the skies do not
    and vanishes where a fit is perfect.
    """
    coordinates = problem.per_node(free)
    residual, _ = shape_residuals(problem.distribution.constrain(coordinates), problem)
    tiny = jnp.finfo(residual.dtype).tiny
    misfit = jnp.sqrt(jnp.sum(residual**2) + tiny)
    pull = jnp.sqrt(problem.prior) * misfit * (coordinates - problem.centre[None])
    return jnp.concatenate([residual.ravel(), pull.ravel()])


@eqx.filter_jit
def solve_shapes(
    problem: ShapeProblem,
    start: Float[Array, "lane free"],
    *,
    rtol: float,
    max_steps: int = 64,
) -> ShapeSolution:
    """Fit a batch, one lane each, from one start a lane.

    Differentiable in the problem's arrays by the implicit function theorem. A lane that fails is
    reported, not raised.

    Args:
        problem: Every array with the lanes first.
        start: Free coordinates of all nodes.
        rtol: Relative decrease of the loss below which a fit has converged.
        max_steps: The batch waits for its slowest lane up to here.
    """
    adjoint = optx.ImplicitAdjoint(linear_solver=least_norm())
    solver = NormalEquationsLM(rtol=rtol, atol=float(jnp.finfo(start.dtype).eps))

    def one(problem, start):
        solution = optx.least_squares(
            objective, solver, start, problem, max_steps=max_steps, adjoint=adjoint, throw=False
        )
        nodes = problem.distribution.constrain(problem.per_node(solution.value))
        residual, _ = shape_residuals(nodes, problem)
        return ShapeSolution(
            solution.value,
            solution.stats["loss"],
            0.5 * jnp.sum(residual**2),
            solution.stats["num_steps"],
            solution.result == optx.RESULTS.successful,
        )

    return jax.vmap(one)(problem, start)


def least_norm() -> Any:
    """Linear solver for adjoints, since a direction may not be identified at all."""
    import lineax as lx

    return lx.SVD()
