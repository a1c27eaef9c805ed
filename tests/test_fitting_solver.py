"""Levenberg-Marquardt on problems whose answer is known."""

import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
import pytest

from skyfit.fitting.solver import NormalEquationsLM


SOLVER = NormalEquationsLM(rtol=1e-14, atol=1e-14)


def rosenbrock(y, args):
    return jnp.stack([10 * (y[1] - y[0] ** 2), args - y[0]])


def line(y, args):
    matrix, target = args
    return matrix @ y - target


def solve(residual, start, args, **options):
    return optx.least_squares(residual, SOLVER, start, args, max_steps=200, throw=False, **options)


def test_rosenbrocks_valley_ends_at_one_one():
    solution = solve(rosenbrock, jnp.array([-1.2, 1.0]), jnp.asarray(1.0))
    np.testing.assert_allclose(solution.value, [1, 1], atol=1e-10)
    assert solution.result == optx.RESULTS.successful
    assert solution.stats["num_steps"] < 40


@pytest.mark.slow
def test_the_loss_never_rises_from_step_to_step():
    # Gauss and Newton alone would first leap across the valley, to a loss of hundreds.
    losses = []
    for steps in range(1, 15):
        solution = optx.least_squares(
            rosenbrock,
            SOLVER,
            jnp.array([-1.2, 1.0]),
            jnp.asarray(1.0),
            max_steps=steps,
            throw=False,
        )
        at = rosenbrock(solution.value, jnp.asarray(1.0))
        losses.append(float(0.5 * at @ at))
    assert losses[-1] < losses[0]
    assert np.all(np.diff(losses) <= 0)


def test_a_linear_problem_is_solved_as_lapack_does():
    rng = np.random.default_rng(0)
    # Columns on scales from 1e-3 to 1e3: the diagonal scaling makes nothing of that.
    matrix = rng.standard_normal((40, 4)) * [1e-3, 1, 30, 1e3]
    target = rng.standard_normal(40)
    want = np.linalg.lstsq(matrix, target)[0]
    args = (jnp.asarray(matrix), jnp.asarray(target))
    # Long steps are cut to 2, so a coefficient of 1000 takes a few hundred of them; start near.
    solution = solve(line, jnp.asarray(want + 1), args)
    np.testing.assert_allclose(solution.value, want, rtol=1e-8, atol=1e-10)


def test_a_direction_the_residuals_do_not_see_stays_where_it_is():
    matrix = jnp.array([[1.0, 0.0], [2.0, 0.0]])
    solution = solve(line, jnp.array([5.0, 7.0]), (matrix, jnp.array([1.0, 2.0])))
    np.testing.assert_allclose(solution.value, [1, 7], atol=1e-10)
    assert solution.result == optx.RESULTS.successful


def test_a_trial_that_overflows_is_stepped_back_from():
    def steep(y, args):
        return jnp.exp(jnp.exp(y)) - args

    solution = solve(steep, jnp.array([-4.0]), jnp.asarray(np.exp(np.exp(1.9))))
    np.testing.assert_allclose(solution.value, [1.9], rtol=1e-8)


def test_one_bad_fit_in_a_batch_leaves_the_others_alone():
    goals = jnp.array([1.0, np.nan, 3.0])

    def one(goal):
        solution = solve(rosenbrock, jnp.array([-1.2, 1.0]), goal)
        return solution.value, solution.result == optx.RESULTS.successful

    values, good = jax.vmap(one)(goals)
    np.testing.assert_array_equal(good, [True, False, True])
    np.testing.assert_allclose(values[jnp.array([0, 2])], [[1, 1], [3, 9]], rtol=1e-8)


def test_the_solution_differentiates_as_the_pseudoinverse():
    rng = np.random.default_rng(1)
    matrix = jnp.asarray(rng.standard_normal((12, 3)))

    def fitted(target):
        return solve(line, jnp.zeros(3), (matrix, target)).value

    jacobian = jax.jacrev(fitted)(jnp.asarray(rng.standard_normal(12)))
    np.testing.assert_allclose(jacobian, np.linalg.pinv(matrix), atol=1e-10)


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_precision_is_that_of_the_start(dtype):
    start, goal = jnp.array([-1.2, 1.0], dtype), jnp.asarray(1.0, dtype)
    solver = NormalEquationsLM(rtol=1e-6, atol=1e-6)
    solution = optx.least_squares(rosenbrock, solver, start, goal, throw=False)
    assert solution.value.dtype == dtype
    np.testing.assert_allclose(solution.value, [1, 1], atol=2e-3)
