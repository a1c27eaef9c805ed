"""Path integrals through exponential layers, and the closed forms, against dense quadrature."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.aerial import closed, integrals, layers
from skyfit.preetham_air import haze_scattering, rayleigh_scattering


pytestmark = pytest.mark.any_precision


WAVELENGTHS = np.array([400.0, 550.0, 700.0])
GAUSS = np.polynomial.legendre.leggauss(8)


def paper_layers(turbidity):
    spectra = jnp.stack([rayleigh_scattering(WAVELENGTHS), haze_scattering(turbidity, WAVELENGTHS)])
    return layers.Layers(jnp.array(layers.PAPER_SCALE_HEIGHTS), spectra)


def dense(air, distance, cosine, height):
    """The integrals and the transmittance by 8 nodes on each of 600 panels, closer at both ends."""
    scale, beta = np.asarray(air.scale_height), np.asarray(air.extinction)
    ground = (height - layers.LOWEST) / -cosine if cosine < 0 else np.inf
    end = min(distance, ground, 1e9)
    near = 0.5 * np.geomspace(1e-7, 1, 300)
    edges = end * np.unique(np.concatenate([[0.0], near, 1 - near, [1.0]]))
    x, w = GAUSS
    half = 0.5 * np.diff(edges)[:, None]
    s = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * x).ravel()
    weight = (half * w).ravel()

    def column(s):
        start = np.exp(-height / scale)[:, None]
        if cosine == 0:
            return start * s
        return -start * (scale / cosine)[:, None] * np.expm1(-s * cosine / scale[:, None])

    density = np.exp(-(height + s * cosine) / scale[:, None])
    seen = np.exp(-beta.T @ column(s))
    return np.einsum("n,in,ln->il", weight, density, seen), np.exp(-beta.T @ column(end))[..., 0]


def case(turbidity, degrees, distances, height):
    """Layers, the rays, and the answers of `dense` [species, ray, channel]."""
    air = paper_layers(turbidity)
    cosines = [0.0 if d == 90 else float(np.cos(np.radians(d))) for d in degrees]
    rays = [(s, c) for c in cosines for s in distances]
    answers, seen = zip(*(dense(air, s, c, height) for s, c in rays), strict=True)
    far, cosine = (jnp.array(a) for a in zip(*rays, strict=True))
    ray = layers.stretch(air, far, cosine, jnp.full_like(far, height))
    return air, ray, np.stack(answers, axis=1), np.stack(seen)


DEGREES = (0, 40, 70, 80, 85, 88, 89, 89.7, 89.9, 90, 90.1, 90.5, 91, 93, 100, 130, 180)
DISTANCES = (1.0, 1e3, 1e4, 5e4, 2e5, 1e6, np.inf)


@pytest.mark.slow
@pytest.mark.parametrize("height", [0.0, 2000.0, 12000.0])
@pytest.mark.parametrize("turbidity", [1.0, 3.0, 10.0])
def test_quadrature_is_within_a_thousandth_for_every_ray(turbidity, height):
    air, ray, answers, seen = case(turbidity, DEGREES, DISTANCES, height)
    found = np.asarray(jax.jit(integrals.by_quadrature)(air, ray))
    # What each constituent adds to the light, for sources of which either may be the brighter.
    for haze_brightness in (0.3, 1.0, 10.0):
        glow = np.array([1.0, haze_brightness])[:, None, None] * np.asarray(air.extinction)[:, None]
        light, exact = ((glow * paths).sum(axis=0) for paths in (found, answers))
        np.testing.assert_allclose(light, exact, rtol=4e-4)
    np.testing.assert_allclose(layers.transmittance(air, ray), seen, rtol=1e-9, atol=1e-8)


@pytest.mark.float64
def test_light_lost_by_scattering_is_the_light_that_is_scattered():
    # Σ β_i I_i = 1 - τ, since the left side is the integral of -dτ/dx.
    air, ray, _, seen = case(3.0, DEGREES, DISTANCES, 100.0)
    paths = np.asarray(jax.jit(integrals.by_quadrature)(air, ray))
    total = (np.asarray(air.extinction)[:, None] * paths).sum(axis=0)
    np.testing.assert_allclose(total, 1 - seen, rtol=1e-6)


def test_single_precision_serves_as_well():
    air, ray, answers, _ = case(3.0, DEGREES, DISTANCES, 2.0)
    air32 = layers.Layers(*(a.astype(jnp.float32) for a in (air.scale_height, air.extinction)))
    ray32 = layers.Stretch(*(a.astype(jnp.float32) for a in (ray.length, ray.cosine, ray.density)))
    found = np.asarray(jax.jit(integrals.by_quadrature)(air32, ray32))
    assert found.dtype == np.float32
    glow = np.asarray(air.extinction)[:, None]
    np.testing.assert_allclose((glow * found).sum(axis=0), (glow * answers).sum(axis=0), rtol=5e-4)


def light_error(method, turbidity, degrees, distances, height=0.0):
    air, ray, answers, _ = case(turbidity, degrees, distances, height)
    glow = np.asarray(air.extinction)[:, None]
    light, exact = (
        (glow * np.asarray(a)).sum(axis=0) for a in (jax.jit(method)(air, ray), answers)
    )
    return np.abs(light / exact - 1).max(axis=-1).reshape(len(degrees), len(distances))


@pytest.mark.slow
def test_equation_10_is_exact_on_the_level_and_good_while_rays_climb_little():
    assert light_error(closed.near_level, 3.0, [90], [1e3, 1e5, np.inf]).max() < 1e-6
    # 100 m under 85° climb 9 m, less than a hundredth of a scale height.
    assert light_error(closed.near_level, 3.0, [85, 95], [100.0], 1000.0).max() < 1e-4
    steep = light_error(closed.near_level, 3.0, [0, 60], [1e5])
    assert 0.3 < steep.min() < steep.max() < 0.4


def by_v(air, ray):
    return closed.by_hermite(air, ray, "by v")


@pytest.mark.slow
def test_the_hermite_form_diverges_with_right_slopes_and_stays_bounded_with_wrong_ones():
    assert light_error(by_v, 3.0, [60, 85], [1e3]).max() < 1e-4
    assert light_error(by_v, 3.0, [45], [5e4]).min() > 1e6
    assert light_error(closed.by_hermite, 3.0, [0, 45, 80], [1e4, 5e4, 1e6]).max() < 0.35


@pytest.mark.float64
def test_the_hermite_form_is_the_papers_antiderivative():
    # Appendix A.4 with K > 0, for a ray where its powers of 1/K cancel least.
    air, ray, _, _ = case(6.0, [80], [2e4], 0.0)
    (h1, h2), (u1, u2) = ray.density[:, 0], layers.lengths(air, ray, ray.length)[0][:, 0]
    cosine, (beta1, beta2) = np.cos(np.radians(80)), np.asarray(air.extinction)[:, 1]
    alpha1, alpha2 = 1 / np.asarray(air.scale_height)
    k1, k2 = beta1 / (alpha1 * cosine), beta2 / (alpha2 * cosine)
    far = np.exp(-k2 * (h2 - u2))
    slopes = -beta2 * h2, -beta2 * u2 * far
    rows = [[v**3, v**2, v, 1] for v in (h1, u1)] + [[3 * v**2, 2 * v, 1, 0] for v in (h1, u1)]
    a, b, c, d = np.linalg.solve(rows, [1, far, *slopes])

    def bracket(v):
        g = a * v**3 + b * v**2 + c * v + d
        g1, g2, g3 = 3 * a * v**2 + 2 * b * v + c, 6 * a * v + 2 * b, 6 * a
        return np.exp(-k1 * (h1 - v)) * (g / k1 - g1 / k1**2 + g2 / k1**3 - g3 / k1**4)

    printed = -(bracket(u1) - bracket(h1)) / (alpha1 * cosine)
    np.testing.assert_allclose(closed.by_hermite(air, ray)[0, 0, 1], printed, rtol=1e-8)


def test_the_papers_choice_of_forms_is_percents_off_and_worst_near_the_level():
    errors = light_error(closed.as_published, 3.0, [40, 70, 89, 90], DISTANCES).max(axis=1)
    np.testing.assert_allclose(errors[:2], [0.025, 0.112], rtol=0.05)
    assert 0.5 < errors[2] < 1.2  # over hundreds of kilometres
    assert errors[3] < 1e-6


def test_paths_end_where_land_does():
    air = paper_layers(3.0)
    down = layers.stretch(
        air, jnp.array([1e3, 5e4]), jnp.array([-1.0, -1.0]), jnp.array([2e3, 2e3])
    )
    np.testing.assert_allclose(down.length, [1e3, 2e3 - layers.LOWEST])


def test_nothing_scatters_in_no_air():
    air = layers.Layers(jnp.array([8e3, 1e3]), jnp.zeros((2, 1)))
    ray = layers.stretch(air, jnp.array([1e4]), jnp.array([0.0]), jnp.array([0.0]))
    np.testing.assert_allclose(layers.transmittance(air, ray), [[1.0]])
    np.testing.assert_allclose(integrals.by_quadrature(air, ray)[:, 0, 0], 1e4, rtol=1e-9)
