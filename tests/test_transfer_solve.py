"""The sum of a series in which light scatters again and again."""

import jax
import jax.numpy as jnp
import numpy as np

from skyfit.transfer.field import Field
from skyfit.transfer.solve import sum_of_orders


SHAPE = (6, 3, 4, 2, 2)  # level, m, l, sun, wavelength
FIRST = Field(jnp.ones(SHAPE), jnp.ones(SHAPE[3:]))


def scaled(shares, field):
    """Every moment, and the irradiance, times a share of its own."""
    return Field(field.moments * shares, field.irradiance * shares[0, 0, 0])


def test_the_sum_is_that_of_geometric_series():
    shares = jnp.asarray(np.random.default_rng(1).uniform(0, 0.97, SHAPE))
    got = sum_of_orders(scaled, shares, FIRST, 1e-6)
    want = shares / (1 - shares)
    # The remainder is 1e-6 of the whole; the sum 1 / (1 - 0.97) times as far off, at most.
    np.testing.assert_allclose(got.moments, want, rtol=1e-4, atol=1e-4)
    np.testing.assert_allclose(got.irradiance, want[0, 0, 0], rtol=1e-4, atol=1e-4)


def test_a_series_that_does_not_converge_has_no_sum():
    rng = np.random.default_rng(2)
    shares = rng.uniform(0, 0.5, SHAPE)
    shares[..., 1] = rng.uniform(-300, 300, SHAPE[:-1])
    got = sum_of_orders(scaled, jnp.asarray(shares), FIRST, 1e-6)
    for leaf in jax.tree.leaves(got):
        assert np.all(np.isfinite(leaf[..., 0]))
        assert np.all(np.isnan(leaf[..., 1]))
