"""Batches of fits side by side, from several starts each: which to run, and which to run again."""

from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Bool, Float, Int

from .problem import FitProblem, normal_equations, objective, residuals
from .solver import NormalEquationsLM


# So many fits of one sky each are solved by one call, and so many steps are made before those that
# have converged make room. It is the slowest fit of a call that the others wait for.
FITS_AT_ONCE = 60
STEPS_AT_ONCE = 16
# The first step of a linear problem is all but undamped.
_FIRST_DAMPING, _LINEAR_DAMPING = 1e-3, 1e-14


class Solution(NamedTuple):
    """What came out of a batch of fits, one entry a lane.

    Attributes:
        free: Free coordinates of all terms.
        objective: Half the sum of squares that was minimised.
        loss: The same without the prior.
        steps: Number of Levenberg-Marquardt steps.
        converged: The solver's word, not that the minimum is the lowest.
    """

    free: Float[Array | np.ndarray, "lane free"]
    objective: Float[Array | np.ndarray, " lane"]
    loss: Float[Array | np.ndarray, " lane"]
    steps: Int[Array | np.ndarray, " lane"]
    converged: Bool[Array | np.ndarray, " lane"]


def solve(
    problem: FitProblem, start: Float[Array, "lane free"], *, rtol: float, max_steps: int = 64
) -> Solution:
    """Fit a batch, one lane each, from one start a lane.

    Differentiable in the problem's arrays by the implicit function theorem. A lane that fails is
    reported, not raised.

    Args:
        problem: What to fit; every array has the lanes first.
        start: Free coordinates of all terms.
        rtol: Relative decrease of the objective below which a fit has converged.
        max_steps: Number of steps up to which the batch waits for its slowest lane.
    """
    tolerance = jnp.asarray(rtol, start.dtype)
    return _solve_compiled(problem, start, tolerance, max_steps=max_steps)


@eqx.filter_jit
def _solve_compiled(problem, start, rtol, *, max_steps) -> Solution:
    adjoint = optx.ImplicitAdjoint(linear_solver=least_norm())
    solver = NormalEquationsLM(
        rtol=rtol,
        atol=float(jnp.finfo(start.dtype).eps),
        first_damping=_LINEAR_DAMPING if problem.distribution.linear else _FIRST_DAMPING,
        equations=normal_equations,
        longest_step=np.inf if problem.distribution.linear else 2.0,
    )

    def one(problem, start):
        solution = optx.least_squares(
            objective, solver, start, problem, max_steps=max_steps, adjoint=adjoint, throw=False
        )
        residual, _ = residuals(problem.numbers(solution.value), problem)
        return Solution(
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


class _Jobs(NamedTuple):
    """Fits that have been run: of which lane, and what came out."""

    lanes: Int[np.ndarray, " job"]
    solution: Solution

    @property
    def objective(self) -> Float[np.ndarray, " job"]:
        """What was minimised; infinite where a fit was lost."""
        objective = np.asarray(self.solution.objective)
        return np.where(np.isfinite(objective), objective, np.inf)

    def best(self, num_lanes: int, rounding: float) -> tuple[Solution, Int[np.ndarray, " lane"]]:
        """The lowest of each lane, and how many came within 0.1 % and rounding errors of it."""
        order = np.lexsort((self.objective, self.lanes))
        winners = order[np.unique(self.lanes[order], return_index=True)[1]]
        lowest = self.objective[winners]
        close = self.objective <= 1.001 * lowest[self.lanes] + rounding
        agreeing = np.bincount(self.lanes, close, minlength=num_lanes).astype(int)
        return Solution(*(np.asarray(field)[winners] for field in self.solution)), agreeing


def solve_from_starts(
    problem: FitProblem,
    starts: Float[np.ndarray, "start lane free"],
    *,
    first: int,
    rtol: float,
    max_steps: int,
    at_once: int | None = None,
) -> tuple[Solution, Int[np.ndarray, " lane"]]:
    """Fit every lane from the first few starts, and lanes in doubt from the rest.

    A lane is in doubt if its best fit did not converge or if, of several starts, only one came
    within 0.1 % of the lowest objective.

    Args:
        problem: What to fit; every array has the lanes first.
        starts: Free coordinates.
        first: Number of starts that all lanes are given.
        rtol: As for `solve`.
        max_steps: As for `solve`.
        at_once: Number of lanes that one call solves; by default all of them, or as many single
            skies as run well together.

    Returns:
        The best of each lane, and the number of starts it took.
    """
    lanes = np.arange(starts.shape[1])
    every = np.tile(lanes, first)
    run = _Runner(problem, rtol, max_steps, at_once)
    jobs = run(every, starts[:first].reshape(every.size, -1))
    # Perfect data are fitted to a loss of no digits.
    rounding = float(jnp.finfo(problem.target.dtype).eps) * problem.target[0].size
    best, agreeing = jobs.best(lanes.size, rounding)
    used = np.full(lanes.size, first)
    doubtful = ~np.asarray(best.converged) | ((agreeing < 2) & (first > 1))
    if doubtful.any() and len(starts) > first:
        again = np.tile(np.flatnonzero(doubtful), len(starts) - first)
        more = run(again, starts[first:, doubtful].reshape(again.size, -1))
        both = (np.concatenate(pair) for pair in zip(jobs.solution, more.solution, strict=True))
        jobs = _Jobs(np.concatenate([jobs.lanes, more.lanes]), Solution(*both))
        best, _ = jobs.best(lanes.size, rounding)
        used[doubtful] = len(starts)
    return best, used


class _Runner:
    """Fits lanes of a problem, each maybe more than once, from a start a job."""

    def __init__(self, problem: FitProblem, rtol: float, max_steps: int, at_once: int | None):
        num_lanes, num_skies = problem.target.shape[:2]
        self.single = num_skies == 1
        self.batch = at_once or (min(FITS_AT_ONCE, num_lanes) if self.single else num_lanes)
        self.arrays = jax.tree.map(np.asarray, problem)
        self.dtype, self.rtol, self.max_steps = problem.target.dtype, rtol, max_steps

    def __call__(self, lanes: Int[np.ndarray, " job"], free: Float[np.ndarray, "job free"]):
        count, batch = lanes.size, self.batch
        solution = Solution(
            free=np.array(free),
            objective=np.full(count, np.inf),
            loss=np.full(count, np.inf),
            steps=np.zeros(count, int),
            converged=np.zeros(count, bool),
        )
        waiting = np.arange(count)
        while waiting.size:
            calls = [waiting[at : at + batch] for at in range(0, waiting.size, batch)]
            # Every call has the same shape: the last is filled up with a job that it has already.
            calls = [np.pad(call, (0, batch - call.size), mode="edge") for call in calls]
            answers = []
            for call in calls:
                part = jax.tree.map(lambda array, at=lanes[call]: array[at], self.arrays)
                start = jnp.asarray(solution.free[call], self.dtype)
                steps = STEPS_AT_ONCE if self.single else self.max_steps
                answers.append(solve(part, start, rtol=self.rtol, max_steps=steps))
            for call, answer in zip(calls, answers, strict=True):
                made = solution.steps[call] + np.asarray(answer.steps)
                for field, new in zip(solution, answer._replace(steps=made), strict=True):
                    np.asarray(field)[call] = np.asarray(new)
            unfinished = ~np.asarray(solution.converged) & (solution.steps < self.max_steps)
            waiting = np.flatnonzero(unfinished & np.isfinite(solution.objective))
        return _Jobs(lanes, solution)
