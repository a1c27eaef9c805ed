"""Standard errors and condition numbers against textbook cases."""

import numpy as np

from skyfit.fitting.dependence import linear_in
from skyfit.fitting.diagnostics import (
    condition_number,
    covariance,
    line_with_errors,
    loose_combinations,
)
from skyfit.fitting.distribution import PerezDistribution


def test_errors_of_a_straight_line_are_those_of_the_textbook():
    # y = a + b x through (0, 1), (1, 3), (2, 2), (3, 5): b = 1.1, a = 1.1, residuals
    # -0.1, 0.8, -1.3, 0.6, s² = 2.7 / (4 - 2); var b = s² / 5, var a = s² (1/4 + 1.5² / 5).
    x, y = np.arange(4.0), np.array([1.0, 3.0, 2.0, 5.0])
    jacobian = np.stack([np.ones(4), x], axis=1)
    residual = jacobian @ [1.1, 1.1] - y
    spread = covariance(jacobian, residual)
    np.testing.assert_allclose(np.diag(spread), [1.35 * 0.7, 1.35 / 5], rtol=1e-12)
    np.testing.assert_allclose(spread[0, 1], -1.35 * 1.5 / 5, rtol=1e-12)


def test_residuals_without_weight_do_not_count():
    rng = np.random.default_rng(0)
    jacobian, residual = rng.standard_normal((20, 3)), rng.standard_normal(20)
    padded = np.r_[jacobian, np.zeros((7, 3))], np.r_[residual, np.zeros(7)]
    np.testing.assert_allclose(covariance(*padded), covariance(jacobian, residual), rtol=1e-12)


def test_a_parameter_nobody_sees_has_no_variance_rather_than_nan():
    jacobian = np.stack([np.arange(5.0), np.zeros(5)], axis=1)
    spread = covariance(jacobian, np.ones(5))
    assert spread[0, 0] > 0
    np.testing.assert_array_equal(spread[1], 0)


def test_condition_number_ignores_units():
    angle = 0.01
    jacobian = np.array([[1.0, np.cos(angle)], [0.0, np.sin(angle)]])
    # Two unit vectors at an angle α have singular values √(1 ± cos α), a ratio of cot(α/2).
    want = 1 / np.tan(angle / 2)
    np.testing.assert_allclose(condition_number(jacobian), want, rtol=1e-8)
    np.testing.assert_allclose(condition_number(jacobian * [1e-6, 1e3]), want, rtol=1e-8)


def test_a_factor_of_less_than_e_to_the_half_is_identified():
    distribution = PerezDistribution()
    spread = np.diag([0.0, 0.0, 0.0, 0.49, 0.0]) ** 2
    assert loose_combinations(spread, distribution, ("",)) == ()
    spread = np.diag([0.0, 0.0, 0.0, 0.6, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0]) ** 2
    assert loose_combinations(spread, distribution, ("turbidity 2", "turbidity 6")) == (
        "A and B at a given slope near the zenith at turbidity 6 (±3)",
        "C, D and E at a given slope near the sun at turbidity 2 (±0.6)",
    )


def test_errors_at_the_ends_become_errors_of_slope_and_intercept():
    # Ends at 2 and 6, both with a variance of 1: var slope = 2 / 16, intercept = (6² + 2²) / 16.
    nodes = np.array([[3.0], [5.0]])
    line, errors = line_with_errors(nodes, np.eye(2), linear_in([2.0, 6.0]))
    np.testing.assert_allclose(line, [[0.5, 2.0]], rtol=1e-12)
    np.testing.assert_allclose(errors, [[np.sqrt(2) / 4, np.sqrt(40) / 4]], rtol=1e-12)
