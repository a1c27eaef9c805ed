import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.transfer.harmonics import cosines, legendre
from skyfit.transfer.quadrature import even_stencil, lagrange_weights, safe_sqrt


def test_interpolation_reproduces_cubics_between_uneven_nodes():
    nodes = jnp.asarray([0.0, 0.3, 1.0, 2.5, 3.0, 7.0])
    x = jnp.asarray([0.0, 0.1, 0.9, 1.7, 2.99, 6.5, 7.0])
    weights = lagrange_weights(nodes, x)
    # Four nodes carry a cubic exactly; the weights themselves are rounded to 1e-16.
    np.testing.assert_allclose(weights @ nodes**3, x**3, rtol=1e-12, atol=1e-12)
    assert np.all(np.count_nonzero(weights, axis=-1) <= 4)


@pytest.mark.parametrize("width", [4, 6])
def test_a_stencil_on_even_nodes_carries_polynomials(width):
    position = jnp.asarray([0.0, 0.4, 3.7, 8.0, 9.0])
    first, weights = even_stencil(position, 10, width)
    power = width - 1
    values = sum(w * np.asarray(first + k, float) ** power for k, w in enumerate(weights))
    # Powers up to 59049, rounded to 1e-16 of the largest.
    np.testing.assert_allclose(values, position**power, rtol=1e-11, atol=1e-10)


def test_interpolation_holds_the_ends_outside_and_works_with_few_nodes():
    nodes = jnp.asarray([1.0, 2.0, 4.0])
    weights = lagrange_weights(nodes, jnp.asarray([0.0, 3.0, 9.0]))
    np.testing.assert_allclose(weights @ nodes**2, [1.0, 9.0, 16.0], rtol=1e-13)
    assert lagrange_weights(jnp.asarray([2.0]), jnp.asarray([5.0])).tolist() == [[1.0]]


@pytest.mark.slow
@pytest.mark.parametrize("degree", [0, 1, 5, 26])
def test_harmonics_obey_the_addition_theorem(degree):
    rng = np.random.default_rng(degree)
    mu, other = rng.uniform(-1, 1, 50), rng.uniform(-1, 1, 50)
    azimuth = rng.uniform(0, np.pi, 50)
    mine, theirs = (
        np.asarray(legendre(degree, degree, jnp.asarray(m), jnp.sqrt(1 - m**2)))
        for m in (mu, other)
    )
    modes = np.asarray(cosines(degree, jnp.cos(azimuth)))
    got = np.einsum("mx,mx,mx->x", mine[:, degree], theirs[:, degree], modes)
    cos_angle = mu * other + np.sqrt((1 - mu**2) * (1 - other**2)) * np.cos(azimuth)
    want = np.polynomial.legendre.Legendre.basis(degree)(cos_angle)
    # The three-term recurrence loses about one digit per ten degrees.
    np.testing.assert_allclose(got, want, atol=1e-12)


def test_cosines_of_multiples_are_those_of_the_multiples():
    azimuth = np.linspace(0, np.pi, 9)
    want = np.cos(np.arange(8)[:, None] * azimuth)
    np.testing.assert_allclose(cosines(7, jnp.cos(azimuth)), want, atol=1e-13)


def test_square_root_is_zero_below_zero_with_no_slope():
    import jax

    assert jax.vmap(jax.grad(safe_sqrt))(jnp.asarray([-1.0, 0.0, 4.0])).tolist() == [0, 0, 0.25]
