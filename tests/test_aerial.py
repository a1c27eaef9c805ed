"""Aerial perspective: path integrals, source functions, and the two models made of them."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit import phase, profile
from skyfit.aerial.perspective import METHODS


LEVEL = np.pi / 2
SUN = np.radians(60.0)


@pytest.fixture(scope="module")
def air():
    """Grey sunlight, air and haze, two wavelengths."""
    return skyfit.Atmosphere(
        wavelengths=[450.0, 650.0],
        solar_irradiance=[2.0, 1.5],
        constituents=(
            skyfit.Constituent(
                profile.Exponential(8.8e3), [2.9e-5, 6.9e-6], phase=phase.Rayleigh()
            ),
            skyfit.Constituent(
                profile.Exponential(1.2e3), [9e-5, 7e-5], 1e-5, phase=phase.HenyeyGreenstein(0.7)
            ),
        ),
    )


def even_sky(view_zenith, relative_azimuth):
    """A sky of the same radiance everywhere."""
    return jnp.broadcast_to(jnp.array([0.3, 0.1]), (*view_zenith.shape, 2))


@pytest.fixture(scope="module")
def aerial(air):
    return skyfit.aerial_perspective(air, even_sky, SUN)


def test_light_is_seen_unchanged_from_no_distance(aerial):
    light0 = jnp.array([0.7, 0.2])
    np.testing.assert_array_equal(aerial.apply(light0, 0.0, LEVEL, 0.3, 100.0), light0)


def test_a_level_transmittance_is_beers_law(aerial, air):
    beta = np.asarray(air.extinction).sum(axis=0)
    seen = aerial.transmittance(20e3, LEVEL)
    np.testing.assert_allclose(seen, np.exp(-beta * 20e3), rtol=1e-12)


def test_a_level_view_without_end_shows_the_source_function(aerial, air):
    beta = np.asarray(air.extinction).sum(axis=0)
    source = aerial.source(jnp.array(LEVEL), jnp.array(1.0)).sum(axis=0)
    seen = aerial.apply(jnp.array([9.0, 9.0]), np.inf, LEVEL, 1.0)
    np.testing.assert_allclose(seen, source / beta, rtol=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_values_and_gradients_are_finite_everywhere(aerial, method):
    model = dataclasses.replace(aerial, method=method)

    def total(distance, view, azimuth, height):
        return model.apply(jnp.ones(2), distance, view, azimuth, height).sum()

    degrees = [0.0, 60.0, 89.999, 90.0, 90.001, 120.0, 180.0]
    rays = np.meshgrid(
        [0.0, 1e-3, 1e4, np.inf], np.radians(degrees), [0.0, np.pi], [0.0, 300.0, 20e3]
    )
    rays = [jnp.asarray(a.ravel()) for a in rays]
    value, slopes = jax.jit(jax.vmap(jax.value_and_grad(total, argnums=(0, 1, 2, 3))))(*rays)
    assert np.isfinite([value, *slopes]).all()


def test_ward_larsons_model_fades_into_one_colour(air):
    model = skyfit.ward_larson_aerial(air, even_sky, SUN)
    beta = np.asarray(air.extinction).sum(axis=0)
    np.testing.assert_allclose(model.transmittance(1e3), np.exp(-1e3 * beta), rtol=1e-12)
    np.testing.assert_allclose(model.apply(jnp.ones(2), np.inf), [0.3, 0.1], rtol=1e-9)
