"""Angles between unit vectors from their chord."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.angles import unit_vector, view_sun_angle
from skyfit.models.directions import align, angle_between, combine, components, in_pieces


pytestmark = pytest.mark.any_precision


def vectors(seed, count):
    v = np.random.default_rng(seed).standard_normal((count, 3))
    return v / np.linalg.norm(v, axis=1)[:, None]


@pytest.mark.float64
@pytest.mark.parametrize(("dtype", "tolerance"), [(jnp.float32, 4e-7), (jnp.float64, 2e-14)])
def test_angle_is_that_of_the_haversine_form(dtype, tolerance):
    rng = np.random.default_rng(1)
    zenith, azimuth = rng.uniform(0, np.pi, 400), rng.uniform(0, 2 * np.pi, 400)
    sun = 0.7
    view = unit_vector(jnp.asarray(zenith), jnp.asarray(azimuth))
    toward = unit_vector(jnp.asarray(sun), jnp.asarray(0.0))
    angle, cosine = angle_between(components(view.astype(dtype)), components(toward.astype(dtype)))
    want = view_sun_angle(jnp.asarray(zenith), jnp.asarray(sun), jnp.asarray(azimuth))
    # Towards the antisolar point rounding of the chord is magnified, as near any maximum.
    usual = np.asarray(want) < 2.7
    np.testing.assert_allclose(angle[usual], want[usual], atol=tolerance)
    np.testing.assert_allclose(cosine, np.cos(want), atol=tolerance)


@pytest.mark.parametrize("offset", [1e-7, 1e-5, 1e-3])
def test_small_angles_keep_their_digits_in_float32(offset):
    # One vector is 1: half an ulp of it, 6e-8, is all that can be lost. (arccos loses 3e-4.)
    view = jnp.array([np.sin(offset), 0.0, np.cos(offset)], jnp.float32)
    angle, _ = angle_between(components(view), components(jnp.array([0.0, 0.0, 1.0], jnp.float32)))
    np.testing.assert_allclose(angle, offset, rtol=1e-5)


@pytest.mark.float64
def test_gradient_is_finite_where_vectors_meet_and_oppose():
    def angle(v, s):
        return angle_between(components(v), components(s))[0]

    sun = jnp.array([0.6, 0.0, 0.8])
    for view in (sun, -sun):
        for gradient in jax.grad(angle, argnums=(0, 1))(view, sun):
            np.testing.assert_array_equal(gradient, 0)
    # Beside the sun the angle grows by 1 rad per rad, in the direction away from it.
    away = jnp.array([0.8, 0.0, -0.6])
    near = sun + 1e-6 * away
    np.testing.assert_allclose(jax.grad(angle)(near, sun) @ away, 1, rtol=1e-6)


@pytest.mark.float64
def test_components_and_combinations_are_exact():
    v = jnp.asarray(vectors(2, 24).reshape(4, 6, 3))
    x, y, z = components(v)
    np.testing.assert_array_equal(jnp.stack([x, y, z], axis=-1), v)
    mixed = combine(((1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (-1.0, -1.0, 1.0)), jnp.stack([x, y, z]))
    np.testing.assert_allclose(mixed, jnp.stack([x, 2 * y, z - x - y], axis=-1), atol=1e-15)


def test_alignment_adds_leading_axes_only():
    a, b, c = align(jnp.zeros((4, 1, 3)), jnp.zeros(3), jnp.zeros(()))
    assert (a.shape, b.shape, c.shape) == ((4, 1, 3), (1, 1, 3), (1, 1, 1))


@pytest.mark.parametrize(("count", "pieces"), [(10, 1), (80_000, 5), (2 * 65_537, 1)])
def test_pieces_of_many_directions_are_put_together_in_order(count, pieces):
    sizes = []

    def double(piece):
        sizes.append(piece.size // 3)
        return 2 * piece

    direction = jnp.arange(3.0 * count).reshape(2, count // 2, 3)
    np.testing.assert_array_equal(in_pieces(double, direction), 2 * direction)
    doubled = in_pieces(lambda piece: double(piece)[..., :2], direction)
    np.testing.assert_array_equal(doubled, 2 * direction[..., :2])
    # Traced once: 80 000 are five times 16 000; twice a prime has no divisor of use.
    assert sizes[0] * pieces == count
