import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit.angles import cos_view_sun_angle, unit_vector, view_sun_angle
from skyfit.compare.peers import HosekWilkieSky


pytestmark = pytest.mark.any_precision


RNG = np.random.default_rng(7)
# Generic directions; a few suns stand below the horizon.
VIEW, SUN, AZIMUTH = (jnp.asarray(RNG.uniform(0, top, 200)) for top in (3.1, 2.0, 6.2))
AT_THE_SUN, OPPOSITE = (0.7, 0.7, 0.0), (np.pi - 0.7, 0.7, np.pi)
SPECIAL = [AT_THE_SUN, OPPOSITE, (0.0, 0.7, 0.3), (np.pi / 2, 0.7, 0.3), (0.4, 0.0, 0.3)]


@pytest.mark.float64
def test_in_the_suns_plane_zenith_angles_subtract_on_its_side_and_add_on_the_other():
    view, sun = jnp.array(0.9), jnp.array(0.25)
    np.testing.assert_allclose(view_sun_angle(view, sun, jnp.array(0.0)), 0.65, rtol=1e-14)
    np.testing.assert_allclose(view_sun_angle(view, sun, jnp.array(np.pi)), 1.15, rtol=1e-14)


@pytest.mark.float64
def test_seen_at_the_zenith_the_angle_to_the_sun_is_its_zenith_angle():
    np.testing.assert_allclose(view_sun_angle(jnp.array(0.0), SUN, AZIMUTH), SUN, rtol=1e-14)


@pytest.mark.float64
def test_the_cosine_is_that_of_the_angle_between_unit_vectors():
    view, sun = unit_vector(VIEW, AZIMUTH), unit_vector(SUN, jnp.zeros(200))
    want = jnp.sum(view * sun, axis=-1)
    np.testing.assert_allclose(cos_view_sun_angle(VIEW, SUN, AZIMUTH), want, atol=1e-15)
    np.testing.assert_allclose(jnp.cos(view_sun_angle(VIEW, SUN, AZIMUTH)), want, atol=1e-14)


def test_the_sky_is_mirrored_about_the_suns_plane():
    left, right = view_sun_angle(VIEW, SUN, AZIMUTH), view_sun_angle(VIEW, SUN, -AZIMUTH)
    np.testing.assert_array_equal(left, right)


@pytest.mark.float64
def test_unit_vectors_have_z_up_and_x_at_azimuth_zero():
    angle = jnp.array([0.0, np.pi / 2, np.pi / 2])
    azimuth = jnp.array([0.3, 0.0, np.pi / 2])
    want = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    np.testing.assert_allclose(unit_vector(angle, azimuth), want, atol=1e-16)


def test_a_direction_and_an_azimuth_broadcast():
    assert unit_vector(jnp.zeros((4, 1)), jnp.zeros((1, 3))).shape == (4, 3, 3)


def test_a_hundredth_of_a_degree_from_the_sun_survives_float32(float32):
    away = np.radians(0.01)
    got = view_sun_angle(jnp.array(0.7 + away), jnp.array(0.7), jnp.array(0.0))
    # Rounding 0.7 in float32 moves the view by up to 6e-8 rad, 3e-4 of the angle; arccos of the
    # dot product would answer 0.
    np.testing.assert_allclose(got, away, rtol=5e-4)


@pytest.mark.parametrize(("point", "gamma"), [(AT_THE_SUN, 0.0), (OPPOSITE, np.pi)])
def test_the_angle_is_exact_where_its_cone_has_its_apex(point, gamma):
    # arcsin near 1 turns the last bit of 1 into the square root of it, 1.5e-8.
    np.testing.assert_allclose(view_sun_angle(*map(jnp.array, point)), gamma, atol=3e-8)


@pytest.mark.parametrize("point", SPECIAL)
@pytest.mark.parametrize("function", [view_sun_angle, cos_view_sun_angle])
def test_gradients_are_finite_in_special_directions(function, point):
    gradient = jax.grad(function, argnums=(0, 1, 2))(*map(jnp.array, point))
    assert np.all(np.isfinite(gradient))


@pytest.mark.float64
@pytest.mark.parametrize("function", [view_sun_angle, cos_view_sun_angle])
def test_gradients_agree_with_differences(function):
    args = (VIEW, SUN, AZIMUTH)
    gradient = jax.vmap(jax.grad(function, argnums=(0, 1, 2)))(*args)
    for k, got in enumerate(gradient):
        up, down = ([a + s * 1e-6 * (j == k) for j, a in enumerate(args)] for s in (1, -1))
        want = (function(*up) - function(*down)) / 2e-6
        # Rounding of γ over the step of 1e-6: 1e-16 / 1e-6, times the cone's curvature near γ = 0.
        np.testing.assert_allclose(got, want, atol=1e-7)


OVERCAST = skyfit.cie_overcast_sky()
DOME = skyfit.surfaces.sky_dome(OVERCAST, 0.5, zeniths=2, azimuths=4)
SHOWN = skyfit.render.ModelSource(OVERCAST, None, "overcast")
IN_DEGREES = {
    "formula": lambda: skyfit.preetham_sky(3.0).xyY(45.0, 0.5, 0.0),
    "formula, view": lambda: skyfit.preetham_sky(3.0).xyY(0.8, [0.5, 30.0], 0.0),
    "formula, azimuth": lambda: skyfit.preetham_sky(3.0).rgb(0.8, 0.5, 90.0),
    "formula, relative": lambda: skyfit.preetham_sky(3.0).relative(45.0, 0.5, 0.0),
    "formula, coefficients": lambda: skyfit.preetham_sky(3.0).coefficients(45.0),
    "sun below the zenith": lambda: skyfit.preetham_sky(3.0).xyY(-0.1, 0.5, 0.0),
    "luminance": lambda: OVERCAST.radiance(45.0, 0.5, 0.0, [500.0]),
    "day": lambda: skyfit.day_sky(3.0).srgb(45.0, 0.5, 0.0),
    "blend": lambda: skyfit.overcast_blend_sky(8.0).xyY(45.0, 0.5, 0.0),
    "hoffman": lambda: skyfit.hoffman_preetham_sky(3.0).rgb(45.0, 0.5, 0.0),
    "marcher": lambda: skyfit.scs_sky().rgb(45.0, 0.5, 0.0),
    "peer": lambda: HosekWilkieSky(3.0).xyY(45.0, 0.5, 0.0),
    "sunlight": lambda: skyfit.sun_xyY(3.0, 45.0),
    "irradiance": lambda: skyfit.clear_sky_irradiance(3.0, 45.0),
    "longitude": lambda: skyfit.sun_position(0.8, 45.0, 80, 12.0, 0.0),
    "meridian": lambda: skyfit.sun_position(0.8, 0.0, 80, 12.0, 15.0),
    "dome": lambda: skyfit.surfaces.sky_dome(OVERCAST, 45.0),
    "plane": lambda: skyfit.surfaces.plane_light(DOME, 45.0),
    "aerial": lambda: skyfit.ward_larson_aerial(3.0, OVERCAST, 0.8).transmittance(1e3, 90.0),
    "simulate": lambda: skyfit.simulate(skyfit.preetham_atmosphere(2.0), 0.8, 0.5, 90.0),
    "camera": lambda: skyfit.render.Panorama(centre=90.0),
    "ground": lambda: skyfit.render.horizontal_irradiance(SHOWN, 45.0, 1.0),
    "terrain": lambda: skyfit.render.render_terrain(
        SHOWN,
        skyfit.render.sample_elevation(),
        skyfit.render.Perspective(8, 8),
        (9.0, 9.0),
        0.8,
        135.0,
        None,
    ),
    "judging": lambda: skyfit.shape_error(OVERCAST, OVERCAST, max_view_zenith=80.0),
}


@pytest.mark.parametrize("call", IN_DEGREES.values(), ids=IN_DEGREES)
def test_degrees_are_refused(call):
    with pytest.raises(skyfit.InputError, match=r"must lie in .* rad"):
        call()


def test_what_is_missing_passes_and_two_azimuths_may_differ_by_more_than_a_turn():
    sky = skyfit.preetham_sky(3.0)
    assert np.isnan(sky.xyY(np.nan, 0.5, 0.0)).all()
    turned = sky.xyY(0.8, 0.5, 0.3 + 2 * np.pi)
    np.testing.assert_allclose(turned, sky.xyY(0.8, 0.5, 0.3), rtol=1e-5)


def test_nothing_is_checked_while_tracing():
    sky = skyfit.preetham_sky(3.0)

    def luminance(sun):
        return sky.xyY(sun, 0.5, 0.0)[2]

    text = str(jax.make_jaxpr(luminance)(0.8))
    assert "error" not in text
    assert "callback" not in text
    assert np.isfinite(jax.jit(jax.grad(luminance))(0.8))
    suns = jnp.asarray([0.3, 0.8])
    np.testing.assert_allclose(
        jax.vmap(luminance)(suns), [luminance(sun) for sun in suns], rtol=1e-5
    )
