"""Pictures of skies: where things land, how bright they are, what is refused."""

import math

import numpy as np
import pytest

import skyfit
from skyfit.constants import SUN_ANGULAR_RADIUS, SUN_SOLID_ANGLE
from skyfit.render import (
    Fisheye,
    ModelSource,
    Panorama,
    Perspective,
    horizontal_irradiance,
    load_source,
    render,
)
from skyfit.render.cameras import direction_of


NORTH, EAST, SOUTH, WEST = (k * math.pi / 2 for k in range(4))
CAMERAS = [
    Fisheye(96),
    Fisheye(96, "equal-area", top=1.0),
    Panorama(96, centre=2.0),
    Perspective(120, 90, azimuth=4.0, elevation=0.6, field_of_view=1.0),
]


@pytest.fixture(scope="module")
def published():
    return load_source(None, 3.0)


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda camera: type(camera).__name__)
def test_looking_through_a_place_and_placing_the_direction_are_inverse(camera):
    rng = np.random.default_rng(0)
    rows, columns = camera.shape
    row, column = rng.uniform(0.2, 0.8, (2, 200)) * np.array([[rows], [columns]])
    rays = camera.look(column, row)
    assert np.linalg.norm(rays.direction, axis=-1) == pytest.approx(1.0)
    back_column, back_row = camera.place(rays.direction)
    assert back_column == pytest.approx(column, abs=1e-9)
    assert back_row == pytest.approx(row, abs=1e-9)


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda camera: type(camera).__name__)
def test_solid_angles_are_those_of_the_pixels_corners(camera):
    # The area that the vectors to the right and down span, by differences.
    rows, columns = camera.shape
    row, column = np.array([0.3, 0.5, 0.6]) * rows, np.array([0.4, 0.45, 0.7]) * columns
    h = 1e-4
    right = camera.look(column + h, row).direction - camera.look(column - h, row).direction
    down = camera.look(column, row + h).direction - camera.look(column, row - h).direction
    area = np.linalg.norm(np.cross(right, down), axis=-1) / (2 * h) ** 2
    assert camera.look(column, row).solid_angle == pytest.approx(area, rel=1e-3)


@pytest.mark.parametrize("camera", CAMERAS[:2], ids=["equidistant", "equal-area"])
def test_a_fisheyes_pixels_fill_the_dome(camera):
    rays = camera.rays()
    assert rays.solid_angle[rays.inside].sum() == pytest.approx(2 * math.pi, rel=2e-3)


def test_a_panoramas_pixels_fill_the_sphere():
    assert Panorama(64).rays().solid_angle.sum() == pytest.approx(4 * math.pi, rel=1e-12)


def test_the_equal_area_fisheye_has_the_tutorials_zenith_angles():
    # Simulating the Colors of the Sky: theta = acos(1 - x² - y²).
    camera = Fisheye(100, "equal-area")
    direction = camera.look(np.asarray(80.0), np.asarray(40.0)).direction
    assert math.acos(direction[2]) == pytest.approx(math.acos(1 - 0.6**2 - 0.2**2))


def test_a_fisheye_has_north_at_the_top_and_east_on_the_left():
    column, row = Fisheye(100).place(np.stack([direction_of(1.5, a) for a in (NORTH, EAST)]))
    assert (column[0], row[0]) == (pytest.approx(50), pytest.approx(50 - 50 * 1.5 / (math.pi / 2)))
    assert (column[1], row[1]) == (pytest.approx(50 - 50 * 1.5 / (math.pi / 2)), pytest.approx(50))


def test_a_panorama_has_east_to_the_right_of_north_and_the_zenith_on_top():
    azimuths = (NORTH, EAST, WEST)
    column, row = Panorama(100).place(np.stack([direction_of(math.pi / 4, a) for a in azimuths]))
    assert column == pytest.approx([100, 150, 50])
    assert row == pytest.approx(25)
    # South is the seam.
    assert Panorama(100).place(direction_of(1.0, SOUTH + 0.01))[0] == pytest.approx(
        0.01 * 100 / math.pi
    )


def test_a_perspective_has_right_on_the_right():
    camera = Perspective(80, 60, azimuth=SOUTH, field_of_view=math.pi / 2)
    column, row = camera.place(direction_of(math.pi / 2, SOUTH + math.pi / 4))
    assert (column, row) == (pytest.approx(80), pytest.approx(30))
    assert np.isnan(camera.place(direction_of(math.pi / 2, NORTH))[0])


@pytest.mark.parametrize("camera", CAMERAS[:3], ids=["equidistant", "equal-area", "panorama"])
def test_pixels_have_the_models_luminance(published, camera):
    sun, azimuth = 0.8, 2.5
    picture = render(published, camera, sun, azimuth, sun_disc=False)
    for view, around in ((0.3, 1.0), (1.2, 4.0), (1.5, 2.5)):
        column, row = (int(x) for x in camera.place(direction_of(view, around)))
        seen = camera.look(np.array(column + 0.5), np.array(row + 0.5)).direction
        zenith, compass = math.acos(seen[2]), math.atan2(seen[0], seen[1])
        expected = published.model.rgb(sun, zenith, compass - azimuth)
        assert picture.rgb[row, column] == pytest.approx(np.asarray(expected), rel=2e-4)


def test_a_panoramas_irradiance_is_the_models(published):
    # Required: 0.5 %. The reference is a quadrature in angles, which shares no pixel with it.
    sun = 1.0
    picture = render(published, Panorama(128), sun, sun_disc=False, ground_albedo=0.0)
    rays = picture.camera.rays()
    light = picture.rgb @ np.array([0.2126, 0.7152, 0.0722])
    measured = np.sum(light * np.maximum(rays.direction[..., 2], 0) * rays.solid_angle)
    x, w = np.polynomial.legendre.leggauss(64)
    view = (x + 1) * math.pi / 4
    around = (np.arange(128) + 0.5) * 2 * math.pi / 128
    bright = np.asarray(published.model.xyY(sun, view[:, None], around[None, :]))[..., 2]
    expected = (w * math.pi / 4) @ (bright.sum(1) * np.cos(view) * np.sin(view)) * 2 * math.pi / 128
    assert measured == pytest.approx(expected, rel=2e-3)
    assert horizontal_irradiance(published, sun, 0.3)[1] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    "camera", [Fisheye(32), Fisheye(512), Panorama(700, centre=1.0), CAMERAS[3]], ids=str
)
def test_the_disc_brings_all_its_light_whatever_the_pixels(published, camera):
    sun, azimuth = 1.0, 4.1
    with_disc, without = (
        render(published, camera, sun, azimuth, sun_disc=disc, ground_albedo=0.0)
        for disc in (True, False)
    )
    extra = (with_disc.rgb - without.rgb).astype(float) @ [0.2126, 0.7152, 0.0722]
    light = np.sum(extra * camera.rays().solid_angle * with_disc.inside)
    # The last digits of sRGB's luminance weights; pixels of the disc are small, so one solid
    # angle for each does.
    assert light == pytest.approx(published.sun_xyz(sun)[1] * SUN_SOLID_ANGLE, rel=2e-3)


def test_the_disc_is_as_wide_as_the_sun(published):
    camera = Perspective(400, 400, azimuth=1.0, elevation=0.3, field_of_view=math.radians(2))
    picture = render(published, camera, math.pi / 2 - 0.3, 1.0)
    bright = picture.rgb[..., 1] > 1e7
    width = math.radians(2) / 400
    radius = math.sqrt(bright.sum() / math.pi) * width
    assert radius == pytest.approx(SUN_ANGULAR_RADIUS, rel=5e-3)
    # 959.63 arc seconds (IAU 1976)
    assert math.degrees(SUN_ANGULAR_RADIUS) * 3600 == pytest.approx(959.63, rel=1e-3)


def test_a_setting_sun_is_cut_by_the_horizon(published):
    camera = Perspective(400, 400, azimuth=1.0, field_of_view=math.radians(2))
    with_disc, without = (
        render(published, camera, math.pi / 2, 1.0, sun_disc=disc, ground_albedo=0.0)
        for disc in (True, False)
    )
    bright = (with_disc.rgb - without.rgb)[..., 0] > 100
    assert bright[:200].sum() > 1000
    assert bright[200:].sum() == 0


def test_the_suns_luminance_is_that_of_direct_sunlight(published):
    # 1.6e9 cd/m² overhead (CIE S 011, IES handbook); a tenth of it and redder 5° above the horizon.
    high, low = published.sun_xyz(0.0), published.sun_xyz(math.radians(85))
    assert 1.3e9 < high[1] < 1.8e9
    assert 0.02 < low[1] / high[1] < 0.3
    assert low[0] / low[2] > 2 * high[0] / high[2]
    assert published.sun_xyz(math.radians(91))[1] == 0


def test_ground_reflects_what_falls_on_it(published):
    camera, sun = Panorama(64), 0.6
    picture = render(published, camera, sun, ground_albedo=0.3)
    direct = published.sun_xyz(sun) * SUN_SOLID_ANGLE * math.cos(sun)
    light = 0.3 / math.pi * (horizontal_irradiance(published, sun, math.pi) + direct)
    ground = picture.rgb[50, 10] @ [0.2126, 0.7152, 0.0722]
    assert ground == pytest.approx(light[1], rel=1e-3)


def test_without_known_air_the_sun_must_be_left_out():
    source = ModelSource(skyfit.preetham_sky(3.0), None, "a fit")
    with pytest.raises(ValueError, match="a fit: what dims the sun is unknown"):
        render(source, Fisheye(8), 0.5)
    assert render(source, Fisheye(8), 0.5, sun_disc=False).rgb.max() > 1e3


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Fisheye(0), r"Fisheye\(pixels=...\): expected 1 to 16384; got 0"),
        (lambda: Fisheye(8, "stereographic"), "expected 'equidistant' or 'equal-area'"),
        (lambda: Panorama(20000), r"Panorama\(height=...\): expected 1 to 16384; got 20000"),
        (lambda: Perspective(field_of_view=3.2), "expected 0.0001 to pi rad; got 3.2"),
        (lambda: Perspective(altitude=-1.0), "expected 0 m or more; got -1"),
    ],
)
def test_impossible_cameras_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"sun_zenith": 4.0}, "sun_zenith=...\\): expected 0 to pi rad; got 4"),
        ({"sun_zenith": math.nan}, "sun_zenith=...\\): expected 0 to pi rad; got nan"),
        ({"sun_azimuth": math.inf}, "sun_azimuth=...\\): expected a number; got inf"),
        ({"ground_albedo": 1.5}, "ground_albedo=...\\): expected 0 to 1; got 1.5"),
    ],
)
def test_impossible_suns_are_refused(published, given, message):
    with pytest.raises(ValueError, match=message):
        render(published, Fisheye(8), **({"sun_zenith": 0.5} | given))
