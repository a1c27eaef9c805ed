"""Aerial perspective: path integrals, source functions, and the two models made of them."""

import dataclasses
import functools
import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit import colour, phase, profile
from skyfit.aerial import sunset_airlight
from skyfit.aerial.layers import exponential_layers
from skyfit.aerial.source import sky_directions, sunlight_at_ground


pytestmark = pytest.mark.any_precision


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


@pytest.mark.slow
def test_light_is_seen_unchanged_from_no_distance(aerial):
    light0 = jnp.array([0.7, 0.2])
    np.testing.assert_array_equal(aerial.apply(light0, 0.0, LEVEL, 0.3, 100.0), light0)


@pytest.mark.float64
def test_a_level_transmittance_is_beers_law(aerial, air):
    beta = np.asarray(air.extinction).sum(axis=0)
    seen = aerial.transmittance(20e3, LEVEL)
    np.testing.assert_allclose(seen, np.exp(-beta * 20e3), rtol=1e-12)


def test_a_level_view_without_end_shows_the_source_function(aerial, air):
    beta = np.asarray(air.extinction).sum(axis=0)
    source = aerial.source(jnp.array(LEVEL), jnp.array(1.0)).sum(axis=0)
    seen = aerial.apply(jnp.array([9.0, 9.0]), np.inf, LEVEL, 1.0)
    np.testing.assert_allclose(seen, source / beta, rtol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["quadrature", "paper"])
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


@pytest.mark.float64
def test_ward_larsons_model_fades_into_one_colour(air):
    model = skyfit.ward_larson_aerial(air, even_sky, SUN)
    beta = np.asarray(air.extinction).sum(axis=0)
    np.testing.assert_allclose(model.transmittance(1e3), np.exp(-1e3 * beta), rtol=1e-12)
    np.testing.assert_allclose(model.apply(jnp.ones(2), np.inf, 0.0, 0.0), [0.3, 0.1], rtol=1e-9)


# The source functions


def of_one(phase_function, sky, sun=SUN, **options):
    """Aerial perspective in air of one constituent, 1e-5 per metre at 550 and 650 nm."""
    one = skyfit.Constituent(profile.Exponential(8e3), 1e-5, phase=phase_function)
    air = skyfit.Atmosphere([550.0, 650.0], 1.0, (one,), **options)
    return skyfit.aerial_perspective(air, sky, sun, sun_irradiance=[0.5, 0.0])


def test_isotropic_air_scatters_half_an_even_sky_and_the_sun_over_4_pi():
    found = of_one(phase.Isotropic(), even_sky).source(jnp.array(1.0), jnp.array(2.0))
    expected = 1e-5 * (np.array([0.3, 0.1]) / 2 + np.array([0.5, 0.0]) / (4 * np.pi))
    np.testing.assert_allclose(found[0], expected, rtol=1e-6)


def test_a_level_view_gets_half_an_even_sky_whatever_the_phase_function():
    # The lower half of the sphere mirrors the upper about the horizon.
    found = of_one(phase.HenyeyGreenstein(0.7), even_sky).source(jnp.array(LEVEL), jnp.array(2.0))
    np.testing.assert_allclose(found[0, 1], 1e-5 * 0.1 / 2, rtol=1e-6)


@pytest.mark.slow
def test_a_white_ground_under_an_even_sky_closes_the_sphere():
    # At 650 nm there is no sun, and the ground is as bright as the sky.
    model = of_one(phase.CornetteShanks(0.6), even_sky, ground_albedo=1.0)
    found = model.source(jnp.array([0.0, 1.0, 3.0]), jnp.array([0.0, 1.0, 2.0]))
    np.testing.assert_allclose(found[:, 0, 1], 1e-5 * 0.1, rtol=1e-6)


@pytest.mark.slow
def test_sunlight_follows_the_phase_function():
    haze = phase.HenyeyGreenstein(0.76)
    model = of_one(haze, lambda z, a: jnp.zeros((*z.shape, 2)))
    views = jnp.array([0.0, 0.3, SUN - 0.02, SUN, SUN + 0.1, 1.5, 3.1])
    found = model.source(views, jnp.zeros(7))[:, 0, 0]
    np.testing.assert_allclose(found, 0.5e-5 * haze(jnp.cos(views - SUN)), rtol=5e-4)


@pytest.mark.slow
def test_the_tables_follow_a_real_sky_and_a_real_haze():
    air = skyfit.preetham_atmosphere(3.0, wavelengths=[550.0])
    sky = skyfit.preetham_sky(3.0)
    model = skyfit.aerial_perspective(air, sky, SUN)
    haze = air.constituents[1]
    x, w = np.polynomial.legendre.leggauss(120)
    zenith, azimuth = np.meshgrid(np.pi / 4 * (1 + x), np.pi * (1 + x))
    area = np.pi / 4 * np.pi * np.outer(w, w) * np.sin(zenith)
    light = np.asarray(sky.radiance(SUN, zenith, azimuth, [550.0]))[..., 0]

    def brute(view, side):
        mu = np.cos(view) * np.cos(zenith) + np.sin(view) * np.sin(zenith) * np.cos(side - azimuth)
        return np.sum(area * light * np.asarray(haze.phase(np.clip(mu, -1, 1)))[..., 0])

    views, sides = np.radians([0, 45, 60, 85, 90, 95, 120]), np.radians([0, 30, 0, 100, 0, 170, 60])
    expected = [brute(*direction) for direction in zip(views, sides, strict=True)]
    found = model.source(jnp.array(views), jnp.array(sides))[:, 1, 0]
    sun = model.source.sun[:, 1, 0]
    gamma = skyfit.angles.view_sun_angle(jnp.array(views), jnp.full(7, SUN), jnp.array(sides))
    direct = haze.phase(jnp.cos(gamma))[:, 0] * sun[0] / haze.phase(1.0)[0]
    diffuse = (found - direct) / haze.scattering[0]
    # Forty degrees of harmonics against the peak of the haze.
    np.testing.assert_allclose(diffuse, expected, rtol=0.01)


# Atmospheres, channels, the sunset


def test_a_turbidity_brings_the_papers_scale_heights():
    model = skyfit.aerial_perspective(3.0, lambda z, a: jnp.ones((*z.shape, 1)), SUN,
                                      wavelengths=[550.0])  # fmt: skip
    np.testing.assert_allclose(1e3 / model.layers.scale_height, [0.1136, 0.8333])
    air = skyfit.preetham_atmosphere(3.0, wavelengths=[550.0])
    np.testing.assert_allclose(model.layers.extinction, air.extinction)


@pytest.mark.slow
@pytest.mark.float64
def test_other_profiles_are_replaced_by_exponentials_of_the_same_column():
    air = skyfit.preetham_atmosphere(3.0, wavelengths=[550.0], ozone=True)
    found = exponential_layers(air)
    h = np.asarray(found.scale_height)
    columns = [float(one.density.column(10e3)) for one in air.constituents]
    np.testing.assert_allclose(h[:2] * (1 - np.exp(-10e3 / h[:2])), columns[:2], rtol=1e-9)
    assert found.extinction[2, 0] == 0  # no ozone at the ground


@pytest.mark.slow
def test_colours_through_rgb_are_those_through_the_spectrum():
    sky = skyfit.preetham_sky(3.0)
    spectral = skyfit.aerial_perspective(3.0, sky, SUN)
    rgb = skyfit.aerial_perspective(3.0, sky, SUN, channels="rgb")
    views = np.array([1e3, 1e4, 5e4]), LEVEL, np.pi / 2
    exact = spectrum_to_rgb(spectral.inscatter(*views), spectral.wavelengths)
    np.testing.assert_allclose(rgb.inscatter(*views), exact, rtol=0.03)


def spectrum_to_rgb(radiance, wavelengths):
    return colour.xyz_to_rgb(colour.spectrum_to_xyz(radiance, wavelengths))


@pytest.mark.slow
def test_at_sunset_the_air_is_yellow_to_the_west_and_bluer_to_the_east():
    # Preetham et al. (1999), figure 8: a half hour before sunset, turbidity 6.
    view = sunset_airlight([1e3, 5e3, 20e3])
    x = np.stack([view.east.xyY[:, 0], view.west.xyY[:, 0]])
    np.testing.assert_allclose(x[1] - x[0], 0.045, atol=0.002)
    assert view.east.hue[0] < 0 < view.west.hue[0]  # near the eye blue against yellow
    assert (view.chroma_shift > 0.025).all()
    assert (view.west.xyY[:, 2] > 2 * view.east.xyY[:, 2]).all()


@pytest.mark.slow
def test_without_an_own_sky_the_air_is_lit_by_the_simulated_one(air, monkeypatch):
    # One order compiles in a fraction of the time that two take.
    simulate = functools.partial(skyfit.simulate, orders=1)
    monkeypatch.setattr("skyfit.aerial.scene.simulate", simulate)
    model = skyfit.aerial_perspective(air, None, SUN)
    light = simulate(air, SUN, *sky_directions()).radiance
    given = skyfit.aerial_perspective(air, lambda z, a: light, SUN)
    np.testing.assert_allclose(model.inscatter(1e4, 1.5, 1.0), given.inscatter(1e4, 1.5, 1.0))


def test_direct_sunlight_is_dimmed_by_the_air_before_it(air):
    sun = jnp.array(0.0)
    depth = np.asarray(air.optical_depth()).sum(axis=0)
    exact = np.asarray(air.solar_irradiance) * np.exp(-depth)
    np.testing.assert_allclose(sunlight_at_ground(air, sun), exact, rtol=1e-5)
    np.testing.assert_array_equal(sunlight_at_ground(air, jnp.array(1.7)), 0.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"method": "magic"}, "method=...): expected one of 'quadrature'"),
        ({"channels": "cmyk"}, "channels=...): expected 'spectral' or 'rgb'; got 'cmyk'"),
        ({"sun_zenith": -0.1}, "sun_zenith=...) must lie in"),
        ({"wavelengths": [500.0]}, "wavelengths=...): the atmosphere has its own"),
        ({"sky": lambda z, a: z}, "sky=...): expected radiance of shape (576, 2)"),
    ],
)
def test_mistakes_are_answered_with_one_line(air, change, message):
    arguments = {"atmosphere": air, "sky": even_sky, "sun_zenith": SUN} | change
    with pytest.raises(ValueError, match=re.escape(message)):
        skyfit.aerial_perspective(**arguments)


def test_a_negative_distance_is_refused(aerial):
    with pytest.raises(ValueError, match="distance must be 0 m or more; got -1"):
        aerial.transmittance(-1.0, LEVEL)
