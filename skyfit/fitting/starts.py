"""Many fits from several starts each: which to run together, and which to run again."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from .shape import ShapeProblem, ShapeSolution, solve_shapes


# So many fits of one sky each are solved by one call, and so many steps are made before those that
# have converged make room. It is the slowest fit of a call that the others wait for.
FITS_AT_ONCE = 60
STEPS_AT_ONCE = 16


class _Jobs(NamedTuple):
    """Fits that have been run: of which lane, and what came out."""

    lanes: Int[np.ndarray, " job"]
    solution: ShapeSolution

    @property
    def objective(self) -> Float[np.ndarray, " job"]:
        """What was minimised; infinite where a fit was lost."""
        objective = np.asarray(self.solution.objective)
        return np.where(np.isfinite(objective), objective, np.inf)

    def best(
        self, num_lanes: int, rounding: float
    ) -> tuple[ShapeSolution, Int[np.ndarray, " lane"]]:
        """The lowest of each lane, and how many came within 0.1 % and rounding errors of it."""
        order = np.lexsort((self.objective, self.lanes))
        winners = order[np.unique(self.lanes[order], return_index=True)[1]]
        lowest = self.objective[winners]
        close = self.objective <= 1.001 * lowest[self.lanes] + rounding
        agreeing = np.bincount(self.lanes, close, minlength=num_lanes).astype(int)
        return ShapeSolution(*(np.asarray(field)[winners] for field in self.solution)), agreeing


def solve_from_starts(
    problem: ShapeProblem,
    starts: Float[np.ndarray, "start lane free"],
    *,
    first: int,
    rtol: float,
    max_steps: int,
) -> tuple[ShapeSolution, Int[np.ndarray, " lane"]]:
    """Fit every lane from the first few starts, and lanes in doubt from the rest.

    A lane is in doubt if its best fit did not converge or if, of several starts, only one came
    within 0.1 % of the lowest objective.

    Args:
        problem: Every array with the lanes first.
        starts: Free coordinates.
        first: How many starts all lanes are given.
        rtol: As for `solve_shapes`.
        max_steps: As for `solve_shapes`.

    Returns:
        The best of each lane, and how many starts it took.
    """
    lanes = np.arange(starts.shape[1])
    every = np.tile(lanes, first)
    jobs = _solve(problem, every, starts[:first].reshape(every.size, -1), rtol, max_steps)
    # Perfect data are fitted to a loss of no digits.
    rounding = float(jnp.finfo(problem.target.dtype).eps) * problem.target[0].size
    best, agreeing = jobs.best(lanes.size, rounding)
    used = np.full(lanes.size, first)
    doubtful = ~np.asarray(best.converged) | ((agreeing < 2) & (first > 1))
    if doubtful.any() and len(starts) > first:
        again = np.tile(np.flatnonzero(doubtful), len(starts) - first)
        rest = starts[first:, doubtful].reshape(again.size, -1)
        more = _solve(problem, again, rest, rtol, max_steps)
        both = (np.concatenate(pair) for pair in zip(jobs.solution, more.solution, strict=True))
        jobs = _Jobs(np.concatenate([jobs.lanes, more.lanes]), ShapeSolution(*both))
        best, _ = jobs.best(lanes.size, rounding)
        used[doubtful] = len(starts)
    return best, used


def _solve(
    problem: ShapeProblem,
    lanes: Int[np.ndarray, " job"],
    free: Float[np.ndarray, "job free"],
    rtol: float,
    max_steps: int,
) -> _Jobs:
    """Fit lanes, each maybe more than once, from a start a job."""
    single = problem.target.shape[-2] == 1
    batch = min(FITS_AT_ONCE, problem.target.shape[0]) if single else problem.target.shape[0]
    arrays = jax.tree.map(np.asarray, problem)
    count = lanes.size
    solution = ShapeSolution(
        free=np.array(free),
        objective=np.full(count, np.inf),
        loss=np.full(count, np.inf),
        steps=np.zeros(count, int),
        converged=np.zeros(count, bool),
    )
    waiting = np.arange(count)
    while waiting.size:
        calls = [waiting[at : at + batch] for at in range(0, waiting.size, batch)]
        # Every call has the same shape: the last is filled up with a job that is in it already.
        calls = [np.pad(call, (0, batch - call.size), mode="edge") for call in calls]
        answers = []
        for call in calls:
            part = jax.tree.map(lambda array, at=lanes[call]: array[at], arrays)
            start = jnp.asarray(solution.free[call], problem.target.dtype)
            steps = STEPS_AT_ONCE if single else max_steps
            answers.append(solve_shapes(part, start, rtol=rtol, max_steps=steps))
        for call, answer in zip(calls, answers, strict=True):
            made = solution.steps[call] + np.asarray(answer.steps)
            for field, new in zip(solution, answer._replace(steps=made), strict=True):
                np.asarray(field)[call] = np.asarray(new)
        unfinished = ~np.asarray(solution.converged) & (np.asarray(solution.steps) < max_steps)
        waiting = np.flatnonzero(unfinished & np.isfinite(solution.objective))
    return _Jobs(lanes, solution)
