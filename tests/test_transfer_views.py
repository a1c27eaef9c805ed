"""Directions laid out by sun and line of sight, and brought back."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit._typing import as_float
from skyfit.transfer.views import group


SUN, GROUND = as_float([[0.2], [0.9]]), as_float(0.0)
VIEW, AZIMUTH = (as_float(a.ravel()) for a in np.meshgrid([0.1, 0.7, 1.3], [0.0, 2.0]))


def laid_out(sun):
    views, shape = group(sun, VIEW, AZIMUTH, GROUND)
    assert views.azimuth.shape == (2, 3, 2)  # 2 suns, 3 lines of sight, 2 azimuths each
    sun, view = views.sun[:, None, None], views.view[..., None]
    # Something that tells every direction apart, in place of radiance.
    parts = jnp.broadcast_arrays(sun, view, views.azimuth)
    light = parts[0] + 10 * parts[1] + 100 * parts[2]
    return shape.restore(light[None, ..., None])


@pytest.mark.parametrize("transform", [lambda f: f, jax.jit], ids=["plain", "jit"])
def test_known_lines_of_sight_are_shared_and_values_come_back_in_place(transform):
    light = transform(laid_out)(SUN)
    expected = np.asarray(SUN) + np.asarray(10 * VIEW + 100 * AZIMUTH)
    np.testing.assert_allclose(light[0, ..., 0], expected, rtol=1e-14)


def test_traced_directions_are_lines_of_their_own():
    def lines(view):
        return group(SUN, view, AZIMUTH, GROUND)[0].azimuth

    assert jax.eval_shape(lines, VIEW).shape == (2, 6, 1)


def test_uneven_lines_are_not_padded():
    view = jnp.concatenate([jnp.zeros(5), jnp.arange(1.0, 6.0)])
    views, _ = group(SUN, view, 0 * view, GROUND)
    assert views.azimuth.shape == (2, 10, 1)
