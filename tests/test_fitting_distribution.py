"""Free coordinates of coefficients: there and back, bounds, gradients."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.models.domes import DISTRIBUTIONS
from skyfit.models.perez import Perez
from skyfit.models.preetham import published_coefficients


PEREZ = Perez()
PUBLISHED = np.concatenate(
    [published_coefficients() @ [turbidity, 1.0] for turbidity in (2.0, 4.0, 6.0)]
)
STARTS = np.array([s for channel in ("x", "Y") for s in PEREZ.starts(channel)])


@pytest.mark.parametrize("coefficients", [PUBLISHED, STARTS], ids=["published", "starts"])
def test_coefficients_come_back_from_their_free_coordinates(coefficients):
    free = PEREZ.release(jnp.asarray(coefficients))
    assert np.all(np.isfinite(free))
    # C = 1000 means a rest of 1e-3 of D: three digits are lost on the way.
    np.testing.assert_allclose(PEREZ.constrain(free), coefficients, rtol=1e-9)


def test_any_real_numbers_give_coefficients_within_bounds():
    rng = np.random.default_rng(0)
    free = jnp.asarray(rng.standard_normal((500, 5)) * [5, 20, 5, 20, 3])
    a, b, c, d, _ = np.asarray(PEREZ.constrain(free)).T
    assert np.all(b < 0)
    assert np.all(d < 0)
    assert np.all(1 + c > 0)
    assert np.all(1 + a * np.exp(b) > 0)


@pytest.mark.slow
def test_coordinates_have_finite_gradients_even_far_out():
    for scale in (1, 10, 100):
        free = scale * jnp.array([1.0, -2.0, -1.0, -2.0, 1.0])
        assert np.all(np.isfinite(jax.jacfwd(PEREZ.constrain)(free)))


def test_large_c_and_small_d_hide_behind_one_finite_coordinate():
    # Along the fourth coordinate C grows without bound while the slope of the indicatrix at the
    # sun stays what it is: there ln(1 + C e^{Dγ} + E cos²γ) has the derivative C D / (1 + C + E).
    slopes = []
    for log_rest in (0.0, -2.0, -4.0, -6.0):
        _, _, c, d, e = PEREZ.constrain(jnp.array([0.5, -1.0, -0.3, log_rest, 0.1]))
        slopes.append(c * d / (1 + c + e))
    np.testing.assert_allclose(slopes, -0.3 / 1.1, rtol=1e-3)
    assert c > 100


@pytest.mark.parametrize("name", DISTRIBUTIONS)
def test_starts_come_back_from_their_free_numbers_and_coordinates(name):
    distribution = DISTRIBUTIONS[name]()
    for start in distribution.starts("Y"):
        coefficients = jnp.asarray(start)
        free = distribution.free_numbers(coefficients)
        np.testing.assert_allclose(distribution.coefficients(free), start, rtol=1e-12)
        free = distribution.release(coefficients)
        np.testing.assert_allclose(distribution.constrain(free), start, rtol=1e-9)
