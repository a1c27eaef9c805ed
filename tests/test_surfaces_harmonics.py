"""Spherical harmonics of skies, and directions drawn from them."""

import inspect
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.models import cie_general_sky, cie_overcast_sky, preetham_sky
from skyfit.surfaces import (
    Dome,
    harmonic_irradiance,
    harmonic_light,
    plane_light,
    project,
    real_harmonics,
    sky_dome,
    sky_sampler,
)
from skyfit.surfaces.harmonics import cosine_share


pytestmark = pytest.mark.any_precision


def directions(count, seed=1):
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_the_first_nine_are_those_of_the_irradiance_paper():
    # Ramamoorthi & Hanrahan (2001), equation 3
    x, y, z = directions(20).T
    want = [
        0.282095 + 0 * x, 0.488603 * y, 0.488603 * z, 0.488603 * x,
        1.092548 * x * y, 1.092548 * y * z, 0.315392 * (3 * z**2 - 1),
        1.092548 * x * z, 0.546274 * (x**2 - y**2),
    ]  # fmt: skip
    np.testing.assert_allclose(real_harmonics(directions(20)), np.stack(want, -1), atol=3e-6)


@pytest.mark.float64
def test_harmonics_are_orthonormal_over_the_sphere():
    mu, weight = np.polynomial.legendre.leggauss(12)
    around = (np.arange(24) + 0.5) * np.pi / 12
    sine = np.sqrt(1 - mu**2)[:, None]
    z = np.broadcast_to(mu[:, None], (12, 24))
    basis = real_harmonics(np.stack([sine * np.cos(around), sine * np.sin(around), z], -1), 6)
    gram = jnp.einsum("z,zan,zam->nm", jnp.asarray(weight * np.pi / 12), basis, basis)
    np.testing.assert_allclose(gram, np.eye(49), atol=1e-12)


def test_the_clamped_cosine_keeps_the_published_shares():
    want = [math.pi, 2 * math.pi / 3, math.pi / 4, 0, -math.pi / 24, 0, math.pi / 64]
    np.testing.assert_allclose([cosine_share(degree) for degree in range(7)], want, atol=1e-15)


@pytest.mark.float64
def test_coefficients_of_a_uniform_sky_by_hand():
    # Half a sphere of 1: 2π Y00, and ∫ √(3/4π) cos θ dω = π √(3/4π).
    dome = Dome(jnp.ones((16, 32, 1)), jnp.asarray(0.5))
    got = project(dome, 2)[:, 0]
    want = np.zeros(9)
    want[0], want[2] = 2 * np.pi * 0.28209479, np.pi * 0.48860251
    np.testing.assert_allclose(got, want, atol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("make", [lambda: preetham_sky(3.0), lambda: cie_general_sky(15)])
@pytest.mark.parametrize("sun", [0.3, 0.9, 1.4])
def test_order_two_lights_planes_within_three_percent_of_the_brightest(make, sun):
    dome = sky_dome(make(), sun)
    normals = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 0, -1], [0.6, 0, 0.8]])
    tilt = np.arccos(normals[:, 2])
    azimuth = np.arctan2(normals[:, 1], normals[:, 0])
    want = plane_light(dome, tilt, azimuth).sky[:, 1]
    got = harmonic_irradiance(project(dome, 2), normals.astype(float))[:, 1]
    assert np.abs(got - want).max() < 0.03 * want.max()
    better = harmonic_irradiance(project(dome, 8), normals.astype(float))[:, 1]
    assert np.abs(better - want).max() < 0.006 * want.max()


@pytest.mark.slow
def test_light_comes_back_from_many_coefficients():
    # A sky that fades to nothing at the horizon: cos²θ and its mirror image are smooth enough.
    dome = sky_dome(cie_overcast_sky(), 0.5)
    faded = Dome(dome.light * dome.directions[..., 2:] ** 4, dome.sun_zenith)
    views = directions(30)
    views = views[views[:, 2] > 0.3]
    got = harmonic_light(project(faded, 14), views)[:, 1]
    zenith = dome.light[0, 0, 1] / (1 + 2 * dome.directions[0, 0, 2])
    want = zenith * (1 + 2 * views[:, 2]) * views[:, 2] ** 4
    np.testing.assert_allclose(got, want, atol=2e-3 * float(want.max()))


@pytest.mark.slow
def test_gradients_of_harmonics_are_finite_at_the_zenith_and_the_horizon():
    def total(vector):
        return real_harmonics(vector, 4).sum()

    at = jnp.asarray([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    assert np.isfinite(jax.vmap(jax.grad(total))(at)).all()

    def first(sun):
        return project(sky_dome(cie_general_sky(13), sun, zeniths=16, azimuths=32))[3, 1]

    step, value = 1e-5, jax.jit(first)
    slope = (value(0.8 + step) - value(0.8 - step)) / (2 * step)
    np.testing.assert_allclose(jax.jit(jax.grad(first))(0.8), slope, rtol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("cosine", [False, True])
def test_drawn_directions_have_the_density_and_estimate_the_light(cosine):
    sun, sky = 0.9, preetham_sky(3.0)
    dome = sky_dome(sky, sun)
    sampler = sky_sampler(dome, cosine=cosine)
    drawn, density = sampler.sample(jax.random.key(5), (40000,))
    np.testing.assert_allclose(jnp.linalg.norm(drawn, axis=-1), 1, rtol=1e-12)
    np.testing.assert_allclose(sampler.density(drawn), density, rtol=1e-9)
    luminance = sky.xyz(drawn, jnp.asarray([np.sin(sun), 0.0, np.cos(sun)]))[:, 1]
    estimate = np.asarray(luminance * drawn[:, 2] / density)
    spread = estimate.std() / np.sqrt(estimate.size)
    # Four standard errors; and following the sky must beat an even density.
    assert abs(estimate.mean() - plane_light(dome).sky[1]) < 4 * spread
    even = np.asarray(dome.light[..., 1] * dome.directions[..., 2])
    share = np.asarray(dome.solid_angle)[:, None] / (2 * np.pi)
    mean = (share * even).sum()
    deviation = np.sqrt((share * (even - mean) ** 2).sum()) / mean
    assert estimate.std() / estimate.mean() < (0.05 if cosine else 0.9) * deviation


@pytest.mark.slow
def test_the_density_is_one_over_the_hemisphere_and_nothing_below():
    sampler = sky_sampler(sky_dome(preetham_sky(3.0), 0.9), floor=0.1)
    zenith = (np.arange(400) + 0.5) * np.pi / 800
    around = (np.arange(512) + 0.5) * np.pi / 256
    sine = np.sin(zenith)[:, None]
    z = np.broadcast_to(np.cos(zenith)[:, None], (400, 512))
    density = sampler.density(np.stack([sine * np.cos(around), sine * np.sin(around), z], -1))
    total = (np.asarray(density) * sine).sum() * np.pi / 800 * np.pi / 256
    # Rings of the table and of the sum do not meet.
    np.testing.assert_allclose(total, 1, rtol=2e-3)
    assert np.asarray(density).min() >= 0.1 / (2 * np.pi) * 0.999
    np.testing.assert_array_equal(sampler.density(np.array([[0.0, 0.6, -0.8]])), 0)


@pytest.mark.slow
def test_cells_are_drawn_as_often_as_they_should():
    light = jnp.asarray(np.random.default_rng(2).uniform(0.0, 1.0, (4, 8, 1)))
    dome = Dome(light, jnp.asarray(0.5))
    sampler = sky_sampler(dome, channel=0, floor=0.0)
    drawn, _ = sampler.sample(jax.random.key(1), (50000,))
    ring = np.searchsorted(-np.asarray(sampler.edges), -np.asarray(drawn[:, 2])) - 1
    turn = np.arctan2(drawn[:, 1], drawn[:, 0]) / (2 * np.pi) % 1
    counts = np.zeros((4, 8))
    np.add.at(counts, (ring, (turn * 8).astype(int)), 1)
    expected = 50000 * np.asarray(sampler.probability)
    # χ² of 31 degrees of freedom is below 61 in 999 of 1000 cases.
    assert ((counts - expected) ** 2 / expected).sum() < 61
    # A cell's share is its light times its solid angle.
    want = np.asarray(light[..., 0] * dome.solid_angle[:, None])
    np.testing.assert_allclose(sampler.probability, want / want.sum(), rtol=1e-12)


@pytest.mark.slow
def test_drawing_compiles_and_maps_over_keys():
    sampler = sky_sampler(sky_dome(preetham_sky(3.0), 0.9, zeniths=8, azimuths=16))
    keys = jax.random.split(jax.random.key(0), 3)
    drawn, density = jax.jit(jax.vmap(lambda key: sampler.sample(key, (5,))))(keys)
    assert drawn.shape == (3, 5, 3)
    assert density.shape == (3, 5)


@pytest.mark.parametrize(
    ("function", "arguments", "options", "message"),
    [
        (real_harmonics, (np.ones((2, 2)),), {}, "three components on the last axis"),
        (real_harmonics, (np.ones((2, 3)), -1), {}, "must be 0 or more; got -1"),
        (harmonic_light, (np.ones((5, 1)), np.ones(3)), {}, "expected a square number"),
        (
            sky_sampler,
            (Dome(jnp.ones((4, 8, 1)), jnp.asarray(0.0)),),
            {},
            "expected one of 1; got 1",
        ),
        (
            sky_sampler,
            (Dome(jnp.zeros((4, 8, 1)), jnp.asarray(0.0)),),
            {"channel": 0},
            "must hold some light; got 0",
        ),
        (
            sky_sampler,
            (Dome(jnp.ones((4, 8, 1)), jnp.asarray(0.0)),),
            {"channel": 0, "floor": 2.0},
            r"floor=...\) must lie in 0 to 1; got 2",
        ),
    ],
)
def test_mistakes_are_named(function, arguments, options, message):
    with pytest.raises(ValueError, match=message):
        inspect.unwrap(function)(*arguments, **options)
