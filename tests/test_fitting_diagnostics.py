"""Standard errors and condition numbers against textbook cases."""

import numpy as np
import pytest
from model_skies import model_skies, noisy

from skyfit._typing import as_float
from skyfit.fitting.batch import fit_groups
from skyfit.fitting.choices import PUBLISHED, FitSettings
from skyfit.fitting.dependence import NAMED
from skyfit.fitting.diagnostics import lane, loose_combinations, spectrum, variance
from skyfit.fitting.fit import _errors
from skyfit.fitting.problem import normal_equations, objective
from skyfit.fitting.skies import read_skies
from skyfit.models.domes import Series
from skyfit.models.perez import Perez


def test_errors_of_a_straight_line_are_those_of_the_textbook():
    # y = a + b x through (0, 1), (1, 3), (2, 2), (3, 5): b = 1.1, a = 1.1, residuals
    # -0.1, 0.8, -1.3, 0.6, s² = 2.7 / (4 - 2); var b = s² / 5, var a = s² (1/4 + 1.5² / 5).
    x, y = np.arange(4.0), np.array([1.0, 3.0, 2.0, 5.0])
    jacobian = np.stack([np.ones(4), x], axis=1)
    noise = variance(jacobian @ [1.1, 1.1] - y, 2)
    assert noise == pytest.approx(1.35, rel=1e-12)
    spread = noise * spectrum(jacobian.T @ jacobian).covariance()
    np.testing.assert_allclose(np.diag(spread), [1.35 * 0.7, 1.35 / 5], rtol=1e-12)
    np.testing.assert_allclose(spread[0, 1], -1.35 * 1.5 / 5, rtol=1e-12)


def test_a_parameter_nobody_sees_has_no_variance_rather_than_nan():
    jacobian = np.stack([np.arange(5.0), np.zeros(5)], axis=1)
    spread = spectrum(jacobian.T @ jacobian).covariance()
    assert spread[0, 0] > 0
    np.testing.assert_array_equal(spread[1], 0)


def test_condition_number_ignores_units():
    angle = 0.01
    jacobian = np.array([[1.0, np.cos(angle)], [0.0, np.sin(angle)]])
    # Two unit vectors at an angle α have singular values √(1 ± cos α), a ratio of cot(α/2).
    want = 1 / np.tan(angle / 2)
    for units in ([1.0, 1.0], [1e-6, 1e3]):
        scaled = jacobian * units
        # The normal matrix squares the condition number, and with it rounding errors.
        np.testing.assert_allclose(spectrum(scaled.T @ scaled).condition, want, rtol=1e-6)


def found(deviations):
    """A spectrum of independent coordinates with these standard deviations."""
    return spectrum(np.diag(1 / np.square(np.maximum(deviations, 1e-3))))


def test_a_factor_of_less_than_e_to_the_half_is_identified():
    perez = Perez()
    assert loose_combinations(found([0, 0, 0, 0.49, 0]), 1.0, perez, ()) == ()
    loose = found([0, 0, 0, 0.6, 0, 0, 3.0, 0, 0, 0])
    assert loose_combinations(loose, 1.0, perez, ("turbidity 2", "turbidity 6")) == (
        "A and B at a given slope near the zenith at turbidity 6 (±3)",
        "C, D and E at a given slope near the sun at turbidity 2 (±0.6)",
    )


def test_two_numbers_that_trade_are_named_together():
    series = Series((0.5,), (0,), (), ())
    jacobian = np.array([[1.0, 1.0], [1e-3, -1e-3]])
    (words,) = loose_combinations(spectrum(jacobian.T @ jacobian), 1.0, series, ())
    assert words.startswith(("w00 with w10 (±", "w10 with w00 (±"))


def test_errors_at_the_ends_become_errors_of_slope_and_intercept():
    # Ends at 2 and 6, both with a variance of 1: var slope = 2 / 16, intercept = (6² + 2²) / 16.
    skies = read_skies(model_skies(turbidities=(2.0, 6.0), suns=[0.5]))
    convert = NAMED["linear"].from_fitted(skies)
    np.testing.assert_allclose(convert @ [3.0, 5.0], [0.5, 2.0], rtol=1e-12)
    errors = _errors(np.eye(2).reshape(2, 1, 2, 1), convert)
    np.testing.assert_allclose(errors, [[np.sqrt(2) / 4, np.sqrt(40) / 4]], rtol=1e-12)


def test_one_value_of_the_parameter_allows_no_slope():
    skies = read_skies(model_skies(turbidities=(3.0,)))
    assert NAMED["linear"].basis(skies).num_terms == 1
    np.testing.assert_array_equal(NAMED["linear"].from_fitted(skies), [[1.0]])


@pytest.mark.slow
@pytest.mark.parametrize("dependence", ["linear", "polynomial"])
def test_normal_equations_in_closed_form_are_those_of_the_jacobian(dependence):
    import jax

    skies = read_skies(noisy(model_skies(), 0.05))
    formula = type(PUBLISHED)(PUBLISHED.distribution, NAMED[dependence])
    fit = fit_groups(skies, formula, FitSettings(prior=0.3))
    problem = lane(fit.problem, 2, fit.basis.num_terms)
    size = fit.basis.num_terms * 5
    free = as_float(np.asarray(fit.solution.free)[2, :size])
    free = free + 0.1 * as_float(np.random.default_rng(0).standard_normal(size))
    loss, gram, slope = normal_equations(free, problem)
    residual, jacobian = objective(free, problem), jax.jacfwd(objective)(free, problem)
    np.testing.assert_allclose(loss, 0.5 * residual @ residual, rtol=1e-12)
    scale = np.abs(gram).max()
    np.testing.assert_allclose(gram, jacobian.T @ jacobian, rtol=1e-9, atol=1e-12 * scale)
    slopes = jacobian.T @ residual
    np.testing.assert_allclose(slope, slopes, rtol=1e-9, atol=1e-11 * np.abs(slopes).max())
