"""The published sky normalised for a screen, and the course of a day."""

import inspect

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit import sun_position
from skyfit.angles import unit_vector
from skyfit.colour import xyY_to_xyz
from skyfit.models import cie_overcast_sky, day_course, day_sky, preetham_sky


pytestmark = pytest.mark.any_precision


def printed_zenith(turbidity, sun):
    """The shader's Yz / Y0, as it stands."""

    def kilo(angle):
        chi = (4 / 9 - turbidity / 120) * (np.pi - 2 * angle)
        return (4.0453 * turbidity - 4.9710) * np.tan(chi) - 0.2155 * turbidity + 2.4192

    return kilo(sun) / kilo(0.0)


@pytest.mark.float64
@pytest.mark.parametrize("turbidity", [2.0, 5.0])
def test_the_zenith_is_normalised_by_that_of_an_overhead_sun(turbidity):
    suns = np.array([0.0, 0.5, 1.0, 1.5])
    got = day_sky(turbidity).xyY(suns, 0.0, 0.0)[:, 2]
    np.testing.assert_allclose(got, printed_zenith(turbidity, suns), rtol=1e-9)
    np.testing.assert_allclose(got[0], 1.0, rtol=1e-12)


@pytest.mark.float64
def test_colours_and_proportions_are_those_of_the_published_sky():
    angles = np.random.default_rng(5).uniform(0.0, [1.5, 1.5, 6.0], (20, 3)).T
    day, sky = day_sky(3.0), preetham_sky(3.0)
    shown, published = day.xyY(*angles), sky.xyY(*angles)
    np.testing.assert_allclose(shown[:, :2], published[:, :2], rtol=1e-12)
    np.testing.assert_allclose(shown[:, 2] * float(day.white), published[:, 2], rtol=1e-12)


@pytest.mark.float64
def test_unit_vectors_and_angles_give_the_same_light():
    sun, view, azimuth = jnp.asarray([0.9]), jnp.asarray([0.6]), jnp.asarray([1.0])
    got = day_sky(3.0).xyz(unit_vector(view, azimuth), unit_vector(sun, 0 * sun))
    np.testing.assert_allclose(got, xyY_to_xyz(day_sky(3.0).xyY(sun, view, azimuth)), rtol=1e-9)


def test_the_screen_shows_the_shaders_colour():
    # The shader's matrix, rounded to four decimals, on its own Yxy; then the curve of sRGB.
    sun, view, azimuth = 1.0, 0.4, 2.5
    x, y, luminance = np.asarray(day_sky(3.0).xyY(sun, view, azimuth))
    big_x, big_z = x / y * luminance, (1 - x - y) / y * luminance
    linear = np.array(
        [
            3.2406 * big_x - 1.5372 * luminance - 0.4986 * big_z,
            -0.9689 * big_x + 1.8758 * luminance + 0.0415 * big_z,
            0.0557 * big_x - 0.2040 * luminance + 1.0570 * big_z,
        ]
    )
    assert (linear > 0.0031308).all()
    encoded = 1.055 * linear ** (1 / 2.4) - 0.055
    np.testing.assert_allclose(day_sky(3.0).srgb(sun, view, azimuth), encoded, atol=1e-4)


def test_pixels_stay_within_the_screen_and_below_the_horizon_keep_its_colour():
    day = day_sky(6.0)
    angles = np.random.default_rng(6).uniform(0.0, [2.0, 3.1, 6.0], (200, 3)).T
    pixels = np.asarray(day.srgb(*angles))
    assert ((pixels >= 0) & (pixels <= 1)).all()
    # The view is held at the horizon for the gradation; the angle to the sun stays the true one.
    low = day.xyY(0.0, [np.pi / 2, 2.0], 0.0)
    np.testing.assert_allclose(low[0, 0] / low[1, 0], 1.0, atol=0.05)


def test_gradients_are_finite_from_noon_to_night():
    def shown(angles):
        return day_sky(3.0).srgb(*angles).sum()

    at = jnp.asarray(
        [[0.0, 0.0, 0.0], [0.7, 0.7, 0.0], [0.7, 1.6, 1.0], [1.7, 0.5, 0.0], [3.0] * 3]
    )
    assert np.isfinite(jax.jit(jax.vmap(jax.grad(shown)))(at)).all()


@pytest.mark.float64
def test_turbidity_broadcasts():
    got = day_sky(np.array([2.0, 4.0])).xyY(0.5, np.array([[0.1], [0.9]]), 0.0)
    np.testing.assert_allclose(got[1, 0], day_sky(2.0).xyY(0.5, 0.9, 0.0), rtol=1e-12)


BERLIN = np.radians([52.5, 13.4])


def test_a_day_has_a_dark_night_and_its_brightest_zenith_around_noon():
    course = day_course(preetham_sky(3.0), *BERLIN, 172, np.radians(15.0))
    zenith = np.asarray(course.xyY[:, 0, 2])
    assert course.xyY.shape == (24, 1, 3)
    assert zenith.argmax() == 12
    assert zenith[[0, 23]].max() < 1e-3 * zenith.max()
    # Berlin's longest day: the sun is up from before 4 to after 20 h of Central European Time.
    up = np.asarray(course.sun.zenith) < np.pi / 2
    np.testing.assert_array_equal(np.flatnonzero(up), np.arange(4, 21))


def test_the_sky_is_brighter_in_the_east_in_the_morning():
    east, west = -np.pi / 2, np.pi / 2
    course = day_course(
        preetham_sky(3.0), *BERLIN, 80, np.radians(15.0),
        view_zenith=[1.2, 1.2], view_azimuth=[east, west], standard_time=[8.0, 16.5],
    )  # fmt: skip
    morning, evening = np.asarray(course.xyY[..., 2])
    assert morning[0] > 2 * morning[1]
    assert evening[1] > 2 * evening[0]


def test_a_course_is_the_model_under_the_suns_of_sun_position():
    options = {"method": "almanac", "year": 2024}
    clock = np.array([9.0, 15.0])
    course = day_course(
        day_sky(3.0), *BERLIN, 100, np.radians(15.0),
        view_zenith=0.8, view_azimuth=0.3, standard_time=clock, **options,
    )  # fmt: skip
    sun = sun_position(*BERLIN, 100, clock, np.radians(15.0), **options)
    np.testing.assert_allclose(course.sun, sun, rtol=1e-12)
    want = day_sky(3.0).xyY(sun.zenith, 0.8, 0.3 - sun.azimuth)
    np.testing.assert_allclose(course.xyY[:, 0], want, rtol=1e-12)
    np.testing.assert_allclose(course.towards_sun, day_sky(3.0).xyY(sun.zenith, sun.zenith, 0.0))


def test_the_light_towards_the_sun_reddens_in_the_evening():
    clock = [12.0, 18.0, 19.5]
    course = day_course(preetham_sky(3.0), *BERLIN, 172, np.radians(15.0), standard_time=clock)
    assert (np.diff(course.towards_sun[:, 0]) > 0).all()


def test_an_overcast_day_takes_no_turbidity():
    course = day_course(cie_overcast_sky(), *BERLIN, 172, np.radians(15.0))
    assert course.xyY[12, 0, 2] > 5000


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"view_zenith": np.zeros((2, 2))}, r"day_course\(view_zenith=...\): expected one axis"),
        ({"latitude": np.array([[0.1], [0.2]])}, "expected one place and date"),
        ({"day_of_year": 2451545}, "day_of_year=...\\) must lie in 1 to 366"),
    ],
)
def test_mistakes_are_named(change, message):
    place = {"latitude": 0.9, "longitude": 0.2, "day_of_year": 100, "standard_meridian": 0.2}
    with pytest.raises(ValueError, match=message):
        inspect.unwrap(day_course)(preetham_sky(3.0), **(place | change))


def test_an_impossible_turbidity_is_refused():
    with pytest.raises(ValueError, match=r"must be 1 or more; got 0\.5"):
        day_sky(0.5)
