"""Landscapes: heights, rays that meet land, shadows, light on slopes, air before it."""

import json
import math

import jax.numpy as jnp
import numpy as np
import pytest
from picture_readers import read_exr

from skyfit import cli
from skyfit.constants import EARTH_RADIUS, SUN_SOLID_ANGLE
from skyfit.render import (
    ModelSource,
    Perspective,
    air_before,
    horizontal_irradiance,
    load_source,
)
from skyfit.render.cameras import direction_of
from skyfit.render.elevation import Elevation
from skyfit.render.elevation_files import sample_elevation
from skyfit.render.horizon_scan import meet, scan
from skyfit.render.land_light import horizon_rise, sky_view, sun_share
from skyfit.render.terrain import render_terrain


@pytest.fixture(scope="module")
def published():
    return load_source(None, 3.0)


@pytest.fixture(scope="module")
def hills():
    rows, columns = np.mgrid[0:40, 0:50]
    heights = 200 * np.sin(rows / 4) * np.cos(columns / 5) + 3.0 * rows
    return Elevation(heights, 90.0, 70.0)


@pytest.fixture(scope="module")
def plain():
    return Elevation(np.zeros((5, 5)), 1000.0, 1000.0)


def test_heights_are_the_grids_and_continue_mirrored(hills):
    heights = np.asarray(hills.height)
    east, north = jnp.float32(70.0 * 7), jnp.float32(90.0 * 11)
    assert float(hills.at(east, north)) == pytest.approx(heights[11, 7])
    assert float(hills.at(east + 35.0, north)) == pytest.approx(heights[11, 7:9].mean(), abs=1e-3)
    # 49 columns and 39 rows away stand the mirrors.
    assert float(hills.at(-east, north)) == pytest.approx(heights[11, 7])
    assert float(hills.at(2 * 49 * 70 - east, 2 * 39 * 90 - north)) == pytest.approx(
        heights[11, 7], abs=0.05
    )
    assert hills.signs(-east, north)[0] == -1


def test_the_sample_is_the_land_near_jacksboro():
    land = sample_elevation()
    east, north = land.size
    # 0.335 degrees of longitude at 36.6° north, 0.286 of latitude.
    assert (east, north) == (pytest.approx(29.9e3, rel=0.01), pytest.approx(31.7e3, rel=0.01))
    assert (float(land.height.min()), float(land.height.max())) == (236, 1076)


def plain_march(land, eye, direction, step=5.0, farthest=30e3):
    """Walk along the ray until it is below the land; the slow twin."""
    run = math.hypot(direction[0], direction[1])
    ground = np.arange(step, farthest, step)
    height = eye[2] + ground * direction[2] / run + ground**2 / (2 * EARTH_RADIUS)
    x, y = eye[0] + ground * direction[0] / run, eye[1] + ground * direction[1] / run
    land_there = np.asarray(land.at(jnp.asarray(x, jnp.float32), jnp.asarray(y, jnp.float32)))
    below = np.flatnonzero(height < land_there)
    return ground[below[0]] if below.size else math.inf


@pytest.mark.slow
def test_rays_meet_the_land_where_a_plain_march_does(hills):
    eye = (1500.0, 1800.0, 420.0)
    azimuths = np.linspace(0.0, 6.0, 25).astype(np.float32)
    found = scan(hills, *(jnp.float32(x) for x in eye), jnp.asarray(azimuths))
    elevation = np.radians(np.linspace(-40, 4, 25))
    rise = np.tan(np.random.default_rng(0).permutation(elevation)).astype(np.float32)
    distance = np.asarray(meet(found, jnp.arange(25, dtype=jnp.float32), jnp.asarray(rise)))
    for azimuth, slope, got in zip(azimuths, rise, distance, strict=True):
        direction = (math.sin(azimuth), math.cos(azimuth), float(slope))
        expected = plain_march(hills, eye, direction)
        if math.isinf(expected):
            assert math.isinf(got)
        else:
            # Steps grow by 0.34 %, and the twin's are 5 m.
            assert got == pytest.approx(expected, rel=0.006, abs=8.0)


def test_the_sea_has_a_horizon(plain):
    # From 100 m: √(2 R h) away and √(2 h / R) below the level.
    eye = [jnp.float32(x) for x in (0.0, 0.0, 100.0)]
    found = scan(plain, *eye, jnp.zeros(1, jnp.float32))
    dip = -math.sqrt(2 * 100 / EARTH_RADIUS)
    assert float(found.steepest.max()) == pytest.approx(dip, rel=1e-3)
    just_below = jnp.asarray([dip * 1.0005], jnp.float32)
    far = float(meet(found, jnp.zeros(1, jnp.float32), just_below)[0])
    assert far == pytest.approx(math.sqrt(2 * EARTH_RADIUS * 100), rel=0.05)


def test_a_walls_shadow_is_as_long_as_its_height_over_the_suns_slope():
    heights = np.zeros((3, 81))
    heights[:, 40] = 300.0  # a ridge from south to north
    land = Elevation(heights, 100.0, 100.0)
    zenith = math.radians(60)
    share = np.asarray(sun_share(land, zenith, math.pi / 2))[1]  # sun in the east
    lit = share > 0.5
    # 300 m times tan 60° is 520 m west of the ridge, whose side faces fall off over one cell.
    assert lit[41:].all()
    assert not lit[36:40].any()
    assert lit[:34].all()
    assert np.asarray(sun_share(land, math.radians(91), 1.0)).max() < 0


def test_the_horizon_of_a_place_is_the_ridge_beside_it():
    heights = np.zeros((3, 81))
    heights[:, 40] = 300.0
    land = Elevation(heights, 100.0, 100.0)
    rise = np.asarray(horizon_rise(land, math.pi / 2))[1, 30]
    # Steps of 17 m here may miss the crest of a ridge 200 m wide.
    assert rise == pytest.approx(300 / 1000, rel=0.1)
    # A trench's floor sees less sky than its rim; a plain sees all.
    view = np.asarray(sky_view(land))
    assert view[1, 39] < view[1, 20] < 1.001
    flat = np.asarray(sky_view(Elevation(np.zeros((4, 4)), 500.0, 500.0)))
    assert flat == pytest.approx(1, abs=1e-3)


@pytest.mark.slow
def test_level_land_has_the_light_that_falls_on_it(published, plain):
    camera = Perspective(8, 6, elevation=-0.5, field_of_view=0.4, altitude=50.0)
    sun, albedo = 0.7, 0.3
    picture = render_terrain(
        published, plain, camera, (1e3, 1e3), sun, 2.0, None, ground_albedo=albedo, samples=1
    )
    falling = horizontal_irradiance(published, sun, 2.0)
    falling = falling + published.sun_xyz(sun) * SUN_SOLID_ANGLE * math.cos(sun)
    luminance = picture.rgb @ np.array([0.2126, 0.7152, 0.0722], np.float32)
    assert luminance == pytest.approx(albedo / math.pi * falling[1], rel=2e-3)


@pytest.mark.slow
def test_a_slope_towards_the_sun_is_brighter(published):
    heights = np.abs(np.arange(41) - 20.0)[None, :] * -30.0 + np.zeros((5, 1))
    ridge = Elevation(heights, 100.0, 100.0)
    eye, down = (2000.0, 200.0), Perspective(9, 9, azimuth=0.0, elevation=-1.5, altitude=900.0)
    picture = render_terrain(published, ridge, down, eye, 0.8, math.pi / 2, None, samples=1)
    luminance = picture.rgb @ np.array([0.2126, 0.7152, 0.0722], np.float32)
    # The camera looks straight down, north up: east is on the right.
    slope, sun = math.atan(0.3), published.sun_xyz(0.8)[1] * SUN_SOLID_ANGLE
    gain = 0.2 / math.pi * sun * (math.cos(0.8 - slope) - math.cos(0.8 + slope))
    assert luminance[4, 7] - luminance[4, 1] == pytest.approx(gain, rel=0.2)


class Fog:
    """A twentieth gets through, and a constant glow is added."""

    def split(self, distance, view_zenith, relative_azimuth, observer_altitude):
        one = jnp.ones((*distance.shape, 3), distance.dtype)
        return 0.05 * one, 100.0 * one


@pytest.mark.slow
def test_air_stands_before_land_and_not_before_the_sky(published, plain):
    camera = Perspective(8, 8, field_of_view=0.4, altitude=50.0)
    bare, foggy = (
        render_terrain(published, plain, camera, (0.0, 0.0), 0.7, 2.0, air, samples=1).rgb
        for air in (None, Fog())
    )
    assert foggy[:4] == pytest.approx(bare[:4])
    assert foggy[5:] == pytest.approx(0.05 * bare[5:] + 100, rel=1e-4)


def test_the_sky_above_the_land_is_the_sources(published, plain):
    camera = Perspective(8, 8, azimuth=1.0, elevation=0.5, field_of_view=0.2)
    picture = render_terrain(
        published, plain, camera, (0.0, 0.0), 0.7, 3.0, None, samples=4, sun_disc=False
    )
    expected = published.model.rgb(0.7, math.pi / 2 - 0.5, 1.0 - 3.0)
    assert picture.rgb[3:5, 3:5].mean(axis=(0, 1)) == pytest.approx(np.asarray(expected), rel=2e-3)


def test_impossible_samples_are_refused(published, plain):
    with pytest.raises(ValueError, match=r"expected 1, 4, 9, 16, ..., 1024; got 5"):
        render_terrain(published, plain, Perspective(4, 4), (0.0, 0.0), 0.5, 0.0, None, samples=5)
    assert direction_of(0.0, 0.0)[2] == 1


@pytest.mark.slow
def test_the_command_renders_the_sample_terrain(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["render", "--turbidity", "3", "--view", "perspective", "--terrain", "sample",
             "--altitude-m", "300", "--height", "9", "--samples", "1", "--json"]  # fmt: skip
    light = {}
    for kind in ("none", "ward-larson"):
        assert (
            cli.run([*words, "--aerial", kind, "--out", f"{kind}.exr", "--precision", "float"]) == 0
        )
        assert "land of albedo 0.2" in json.loads(capsys.readouterr().out)["sky"]
        found, _ = read_exr(tmp_path / f"{kind}.exr")
        light[kind] = np.stack([found[name] for name in "RGB"], axis=-1)
    # Land below the horizon, sky above it; air makes the land bluer.
    assert np.array_equal(light["none"][0], light["ward-larson"][0])
    blue = {kind: (one[-1, :, 2] / one[-1, :, 0]).mean() for kind, one in light.items()}
    assert blue["ward-larson"] > 1.02 * blue["none"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--terrain", "sample"], "--terrain: only for --view perspective"),
        (["--terrain", "x.npz", "--view", "perspective"], "x.npz: No such file or directory"),
        (["--terrain", "x.bmp", "--view", "perspective"], "x.bmp: expected a name ending in .npz"),
    ],
)
def test_mistakes_are_answered_with_one_line(tmp_path, monkeypatch, capsys, words, message):
    monkeypatch.chdir(tmp_path)
    assert cli.run(["render", "--turbidity", "3", *words, "--out", "a.png"]) == 2
    assert message in capsys.readouterr().err


def test_a_sky_of_unknown_air_has_no_aerial_perspective(published):
    unknown = ModelSource(published.model, None, "a fit")
    with pytest.raises(ValueError, match="a fit: its air is unknown"):
        air_before(unknown, 0.5)
    assert air_before(unknown, 0.5, "none") is None
    shaded = air_before(published, 0.5, sunlight=False)
    assert float(jnp.abs(shaded.source.sun).max()) == 0
    with pytest.raises(ValueError, match="expected one of paper, ward-larson, none"):
        air_before(published, 0.5, "fog")
