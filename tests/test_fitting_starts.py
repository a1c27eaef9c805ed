"""Several starts a fit: which is kept, and which fits are run again."""

import jax.numpy as jnp
import numpy as np
import pytest
from model_skies import model_skies

from skyfit.fitting.batch import fit_groups
from skyfit.fitting.choices import FitSettings
from skyfit.fitting.fit import PUBLISHED
from skyfit.fitting.lanes import solve_from_starts
from skyfit.fitting.skies import read_skies
from skyfit.models.preetham import published_coefficients


TRUTH = published_coefficients() @ [3.0, 1.0]
SKIES = read_skies(model_skies(turbidities=[3.0], suns=[0.7]))


@pytest.fixture(scope="module")
def problem():
    return fit_groups(SKIES, PUBLISHED, FitSettings(prior=0.0), "sky", again=False).problem


def free(problem, coefficients):
    return np.asarray(problem.distribution.release(jnp.asarray(coefficients)))


def solve(problem, starts, first):
    return solve_from_starts(problem, np.stack(starts), first=first, rtol=1e-10, max_steps=64)


@pytest.mark.slow
def test_starts_that_agree_are_enough(problem):
    near = [free(problem, TRUTH * factor) for factor in (0.95, 1.05, 1.0)]
    best, used = solve(problem, near, 2)
    np.testing.assert_array_equal(used, 2)
    np.testing.assert_allclose(problem.distribution.constrain(best.free), TRUTH, rtol=1e-6)


def test_a_fit_whose_starts_disagree_is_run_again_from_all(problem):
    right = free(problem, TRUTH)
    # From a spike at the zenith x and y end in a local minimum, Y does not.
    spike = free(problem, np.tile([-2e5, -14.0, 0.05, -19.0, 0.1], (3, 1)))
    best, used = solve(problem, [spike, right, right, spike], 2)
    np.testing.assert_array_equal(used, [4, 4, 2])
    np.testing.assert_allclose(problem.distribution.constrain(best.free), TRUTH, rtol=1e-6)


def test_a_lost_start_does_not_hide_a_good_one(problem):
    lost = np.full((3, 5), np.nan)
    best, used = solve(problem, [lost, free(problem, TRUTH * 1.02)], 2)
    assert np.all(best.converged)
    np.testing.assert_array_equal(used, 2)
    np.testing.assert_allclose(problem.distribution.constrain(best.free), TRUTH, rtol=1e-6)


def test_hopeless_fits_are_reported_and_end(problem):
    best, used = solve(problem, [np.full((3, 5), np.nan)] * 2, 1)
    assert not np.any(best.converged)
    np.testing.assert_array_equal(used, 2)
