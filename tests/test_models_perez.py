"""The Perez sky: its limits, its interface, its gradients."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.angles import unit_vector
from skyfit.colour import spectrum_to_xyY, xyY_to_xyz, xyz_to_rgb
from skyfit.models import preetham_sky
from skyfit.models.perez import perez


MODEL = preetham_sky(3.0)
SUN = np.radians(40.0)
# (view zenith, azimuth) where a formula could break: zenith, horizon, at the sun, opposite, below
EDGES = [(0.0, 0.0), (np.pi / 2, 0.3), (SUN, 0.0), (np.pi - SUN, np.pi), (1.8, 0.2), (np.pi, 0.0)]


def test_distribution_is_what_the_equation_says():
    # (1 + A e^{B/cos θ}) (1 + C e^{Dγ} + E cos²γ) by hand at θ = 60°, γ = 30°
    a, b, c, d, e = -1.0, -0.32, 10.0, -3.0, 0.45
    want = (1 - np.exp(-0.64)) * (1 + 10 * np.exp(-np.pi / 2) + 0.45 * 0.75)
    gamma = jnp.asarray(np.pi / 6)
    got = perez(jnp.array([a, b, c, d, e]), jnp.asarray(0.5), gamma, jnp.cos(gamma))
    np.testing.assert_allclose(got, want, rtol=1e-14)


def test_the_horizon_is_the_exact_limit_of_the_distribution():
    coefficients, gamma = jnp.array([-1.0, -0.32, 10.0, -3.0, 0.45]), jnp.asarray(0.8)
    horizon = perez(coefficients, jnp.asarray(0.0), gamma, jnp.cos(gamma))
    # e^{B/0} = 0
    want = 1 + 10 * np.exp(-2.4) + 0.45 * np.cos(0.8) ** 2
    np.testing.assert_allclose(horizon, want, rtol=1e-15)
    just_above = perez(coefficients, jnp.asarray(1e-3), gamma, jnp.cos(gamma))
    np.testing.assert_allclose(just_above, horizon, rtol=1e-15)


@pytest.mark.parametrize("cos_view", [0.0, 1e-12, 1e-9, 1e-3, -0.5])
@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_no_gradient_of_the_distribution_is_nan_at_the_horizon(cos_view, dtype):
    coefficients = jnp.array([-1.0, -0.32, 10.0, -3.0, 0.45], dtype)
    gamma = jnp.asarray(0.8, dtype)
    gradients = jax.grad(perez, argnums=(0, 1, 2))(
        coefficients, jnp.asarray(cos_view, dtype), gamma, jnp.cos(gamma)
    )
    assert all(np.all(np.isfinite(g)) for g in gradients)


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("sun", [0.0, SUN, np.pi / 2, 1.7, 2.5])
def test_every_gradient_of_the_sky_is_finite(edge, sun):
    def total(turbidity, sun, view, azimuth):
        return preetham_sky(turbidity).xyY(sun, view, azimuth).sum()

    gradients = jax.grad(total, argnums=(0, 1, 2, 3))(3.0, sun, *edge)
    assert np.all(np.isfinite(gradients))


@pytest.mark.slow
@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_gradients_with_respect_to_directions_are_finite(edge, dtype):
    toward = unit_vector(jnp.asarray(SUN), jnp.asarray(0.0)).astype(dtype)
    view = unit_vector(jnp.asarray(edge[0]), jnp.asarray(edge[1])).astype(dtype)
    # Exactly at the sun, which sines and cosines of equal angles need not be.
    view = toward if edge == EDGES[2] else -toward if edge == EDGES[3] else view
    gradients = jax.grad(lambda v, s: MODEL.xyz(v, s).sum(), argnums=(0, 1))(view, toward)
    assert np.all(np.isfinite(gradients))


def test_gradients_agree_with_differences_in_general_directions():
    def colour(turbidity, sun, view, azimuth):
        return preetham_sky(turbidity).xyY(sun, view, azimuth)

    at, step = np.array([3.3, 0.9, 1.1, 0.7]), 1e-6
    jacobian = np.stack(jax.jacfwd(colour, argnums=(0, 1, 2, 3))(*at), axis=-1)
    for k in range(4):
        d = step * np.eye(4)[k]
        slope = (colour(*(at + d)) - colour(*(at - d))) / (2 * step)
        # Central differences err by step² and by 1e-16 / step of the value.
        np.testing.assert_allclose(jacobian[:, k], slope, rtol=1e-6, atol=1e-9)


@pytest.mark.slow
def test_unit_vectors_and_angles_see_the_same_sky():
    rng = np.random.default_rng(0)
    sun, view = rng.uniform(0, 1.5, (20, 1)), rng.uniform(0, 1.7, 30)
    azimuth, north = rng.uniform(0, 2 * np.pi, 30), 0.4
    by_angle = xyY_to_xyz(MODEL.xyY(sun, view, azimuth))
    directions = unit_vector(jnp.asarray(view), jnp.asarray(azimuth + north))
    suns = unit_vector(jnp.asarray(sun), jnp.asarray(north).reshape(1, 1))
    np.testing.assert_allclose(MODEL.xyz(directions, suns), by_angle, rtol=1e-12)


def test_float32_vectors_are_within_1e_5_of_float64():
    rng = np.random.default_rng(3)
    v = rng.standard_normal((20_000, 3)).astype(np.float32)
    v /= np.linalg.norm(v, axis=1)[:, None]
    # Towards the sun the aureole is steepest: look at it closely.
    toward = np.array([np.sin(1.0), 0.0, np.cos(1.0)], np.float32)
    near = toward + 1e-3 * rng.standard_normal((2000, 3)).astype(np.float32)
    v = np.r_[v, near / np.linalg.norm(near, axis=1)[:, None]]
    for turbidity in (2.0, 6.0, 10.0):
        model = preetham_sky(turbidity)
        small = jax.tree.map(lambda a: a.astype(jnp.float32), model)
        got = small.xyz(jnp.asarray(v), jnp.asarray(toward))
        assert got.dtype == jnp.float32
        want = model.xyz(jnp.asarray(v, jnp.float64), jnp.asarray(toward, jnp.float64))
        np.testing.assert_allclose(got, want, rtol=1e-5)


@pytest.mark.slow
def test_a_hundred_thousand_directions_have_the_colours_and_gradients_of_each():
    rng = np.random.default_rng(5)
    view = rng.standard_normal((80_000, 3))
    view = jnp.asarray(view / np.linalg.norm(view, axis=1)[:, None])
    toward = unit_vector(jnp.asarray(SUN), jnp.asarray(0.0))

    def light(sun, view):
        return MODEL.xyz(view, sun)[..., 1].sum() / view.shape[0]

    some = slice(0, None, 997)
    np.testing.assert_allclose(MODEL.xyz(view, toward)[some], MODEL.xyz(view[some], toward))
    halves = [jax.grad(light)(toward, half) for half in (view[:40_000], view[40_000:])]
    np.testing.assert_allclose(jax.grad(light)(toward, view), sum(halves) / 2, rtol=1e-12)


def test_a_view_below_the_horizon_sees_the_horizons_brightness():
    # The gradation is held; the angle to the sun goes on.
    below, at = MODEL.relative(SUN, np.pi / 2 + 0.01, 0.5), MODEL.relative(SUN, np.pi / 2, 0.5)
    np.testing.assert_allclose(below, at, rtol=0.01)
    straight_down = MODEL.xyY(SUN, np.pi, 0.0)
    np.testing.assert_allclose(straight_down, MODEL.xyY(SUN, np.pi, 2.0), rtol=1e-12)


def test_dusk_falls_without_a_jump_and_by_a_decade_in_two_and_a_half_degrees():
    degrees = np.array([90 - 1e-9, 90.0, 90 + 1e-9, 92.5])
    zenith = np.asarray(MODEL.xyY(np.radians(degrees), 0.0, 0.0))
    np.testing.assert_allclose(zenith[[0, 2]], zenith[[1, 1]], rtol=1e-8)
    np.testing.assert_allclose(zenith[3, 2], 0.1 * zenith[1, 2], rtol=1e-12)
    np.testing.assert_allclose(zenith[3, :2], zenith[1, :2], rtol=1e-12)


@pytest.mark.parametrize("turbidity", [1.9, 2.0, 4.0, 6.0, 10.0])
def test_luminance_is_never_negative_and_never_nan(turbidity):
    sun = np.linspace(0, np.pi, 37)[:, None, None]
    view, azimuth = np.linspace(0, np.pi, 37)[:, None], np.linspace(0, np.pi, 13)
    xyY = np.asarray(preetham_sky(turbidity).xyY(sun, view, azimuth))
    assert np.all(np.isfinite(xyY))
    assert xyY[..., 2].min() >= 0
    assert xyY[..., :2].min() > 0


def test_a_sky_is_mirrored_about_the_plane_of_the_sun():
    np.testing.assert_allclose(MODEL.xyY(SUN, 1.0, 0.8), MODEL.xyY(SUN, 1.0, -0.8), rtol=1e-14)


def test_zenith_relative_to_itself_is_one():
    suns = np.radians([0.0, 30.0, 85.0])
    np.testing.assert_allclose(MODEL.relative(suns, 0.0, 1.0), 1, rtol=1e-14)


def test_rgb_and_radiance_have_the_colour_of_xyY():
    colour = MODEL.xyY(SUN, 1.0, 0.8)
    rgb = MODEL.rgb(SUN, 1.0, 0.8)
    np.testing.assert_allclose(rgb, xyz_to_rgb(xyY_to_xyz(colour)), rtol=1e-14)
    assert rgb[2] > rgb[0]  # away from the sun the sky is blue
    lam = np.arange(300.0, 831.0, 5.0)
    back = spectrum_to_xyY(MODEL.radiance(SUN, 1.0, 0.8, lam), lam)
    np.testing.assert_allclose(back, colour, rtol=1e-3)


@pytest.mark.slow
def test_arguments_broadcast_and_turbidities_too():
    many = preetham_sky(np.array([2.0, 3.0, 4.0])[:, None])
    got = many.xyY(np.linspace(0, 1, 5), 0.5, 0.2)
    assert got.shape == (3, 5, 3)
    np.testing.assert_allclose(got[1], MODEL.xyY(np.linspace(0, 1, 5), 0.5, 0.2), rtol=1e-14)
    lam = [400.0, 500.0, 600.0]
    assert MODEL.radiance(np.zeros((4, 1)), np.zeros(7), 0.0, lam).shape == (4, 7, 3)


def test_one_program_serves_every_turbidity():
    evaluate = eqx.filter_jit(
        eqx.debug.assert_max_traces(lambda model, *angles: model.xyY(*angles), max_traces=1)
    )
    for turbidity in (2, 3.0, np.float64(4.5)):
        evaluate(preetham_sky(turbidity), jnp.asarray(0.5), jnp.asarray(0.3), jnp.asarray(0.1))


def test_a_model_maps_over_turbidity():
    def luminance(turbidity):
        return preetham_sky(turbidity).xyY(SUN, 0.5, 0.2)[2]

    mapped = jax.vmap(luminance)(jnp.array([2.0, 3.0]))
    np.testing.assert_allclose(mapped[1], MODEL.xyY(SUN, 0.5, 0.2)[2], rtol=1e-14)


@pytest.mark.slow
@pytest.mark.usefixtures("float32")
def test_the_model_works_in_a_float32_program():
    model = preetham_sky(3.0)
    got = model.xyY(SUN, np.linspace(0, 1.6, 9), 0.4)
    assert got.dtype == jnp.float32
    np.testing.assert_allclose(got, MODEL.xyY(SUN, np.linspace(0, 1.6, 9), 0.4), rtol=1e-4)
