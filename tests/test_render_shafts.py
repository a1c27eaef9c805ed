"""Shadows of the land in the air before an eye."""

import functools
import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit import cli
from skyfit.constants import EARTH_RADIUS
from skyfit.render import Perspective, air_before, load_source
from skyfit.render.elevation import Elevation
from skyfit.render.shafts import cast_shadow, lost_light
from skyfit.render.terrain import render_terrain


SUN, AZIMUTH = math.radians(80.0), math.radians(70.0)


@pytest.fixture(scope="module")
def published():
    return load_source(None, 4.0)


@pytest.fixture(scope="module")
def air(published):
    return jax.tree.map(lambda a: a.astype(jnp.float32), air_before(published, SUN))


@pytest.fixture(scope="module")
def hills():
    rows, columns = np.mgrid[0:60, 0:70]
    return Elevation(300 * np.sin(rows / 5) * np.cos(columns / 6) + 350, 120.0, 100.0)


# One program for all tests.
lost_in_400_steps = eqx.filter_jit(functools.partial(lost_light, steps=400))


def land_at(land, x, y):
    return np.asarray(land.at(jnp.asarray(x, jnp.float32), jnp.asarray(y, jnp.float32)), float)


def seen_by_walking(land, x, y, altitude, edges):
    """Walk from points in the air towards the sun: how much of its disc stands above all land."""
    way = np.arange(20.0, 12e3, 20.0)
    ahead = land_at(
        land, x[:, None] + way * math.sin(AZIMUTH), y[:, None] + way * math.cos(AZIMUTH)
    )
    horizon = ((ahead - way**2 / (2 * EARTH_RADIUS) - altitude[:, None]) / way).max(axis=1)
    upper, lower = edges
    return np.clip((upper - horizon) / (upper - lower), 0, 1)


# Edges of the disc, 0.2666° from its middle.
DISC = [1 / math.tan(SUN - sign * 0.00465) for sign in (1, -1)]


@pytest.mark.slow
def test_points_in_the_air_see_the_sun_where_a_plain_walk_does(hills):
    rng = np.random.default_rng(1)
    # Also among the mirror images that continue the grid of 6.9 by 7.1 km.
    x, y = rng.uniform(-7e3, 14e3, (2, 400))
    altitude = land_at(hills, x, y) + rng.uniform(0, 200, 400)
    shadow = cast_shadow(hills, SUN, AZIMUTH)
    given = [jnp.asarray(a, jnp.float32) for a in (x, y, altitude)]
    got, expected = np.asarray(shadow.light(*given)), seen_by_walking(hills, x, y, altitude, DISC)
    assert 0.2 < expected.mean() < 0.8
    # The shadow's top is taken as linear between nodes 100 m apart, half of its penumbra here.
    assert np.abs(got - expected).mean() < 0.003
    assert np.abs(got - expected).max() < 0.3


@pytest.mark.slow
def test_lost_light_is_what_a_plain_march_through_the_shadows_finds(hills, air):
    eye = 300.0, 6700.0, 150.0  # in the shade of a hill
    zenith, azimuth = np.radians([80.0, 88.0, 93.0, 100.0]), AZIMUTH + np.radians([5, -20, 60, 150])
    direction = np.stack(
        [np.sin(zenith) * np.sin(azimuth), np.sin(zenith) * np.cos(azimuth), np.cos(zenith)], -1
    )
    ground = np.array([np.inf, 9e3, 4e3, 1.5e3])
    got = lost_in_400_steps(
        air, cast_shadow(hills, SUN, AZIMUTH), tuple(jnp.float32(e) for e in eye),
        jnp.asarray(direction, jnp.float32), jnp.asarray(ground, jnp.float32),
        jnp.float32(AZIMUTH), jnp.float32(0.5),
    )  # fmt: skip
    scale, beta = np.asarray(air.layers.scale_height), np.asarray(air.layers.extinction)
    for ray, end, found in zip(direction, ground, got, strict=True):
        run = math.hypot(ray[0], ray[1])
        step = min(end, 12e3) / run / 1200
        s = (np.arange(1200) + 0.5) * step
        up = eye[2] + s * ray[2]
        density = np.exp(-up / scale[:, None])
        before = np.cumsum(density, axis=1) * step - density * step / 2
        seen = np.exp(-beta.T @ before)
        dark = 1 - seen_by_walking(
            hills, eye[0] + s * ray[0], eye[1] + s * ray[1],
            up + (s * run) ** 2 / (2 * EARTH_RADIUS), DISC,
        )  # fmt: skip
        turn = math.atan2(ray[0], ray[1]) - AZIMUTH
        glow = np.asarray(air.source.sunlight(*(jnp.float32(a) for a in (math.acos(ray[2]), turn))))
        expected = step * np.einsum("ic,is,cs,s->c", glow, density, seen, dark)
        assert (expected > 0).all()
        # Crests may lie between the 400 steps, each 1.6 % farther, of the shadow's march.
        assert np.asarray(found) == pytest.approx(expected, rel=0.03)


def test_an_eye_in_full_shadow_loses_all_sunlight_of_the_air_before_near_land(air):
    heights = np.zeros((60, 70))
    heights[:, 40] = 900.0
    wall = Elevation(heights, 120.0, 100.0)
    shadow = cast_shadow(wall, SUN, math.pi / 2)  # it stands in the east
    west = jnp.tile(jnp.asarray([-1.0, 0.0, 0.0], jnp.float32), (4, 1))
    eye = jnp.float32(3700.0), jnp.float32(3000.0), jnp.float32(2.0)
    lost = lost_in_400_steps(
        air, shadow, eye, west, jnp.full(4, 1500.0, jnp.float32), jnp.float32(math.pi / 2),
        jnp.float32(0.5),
    )  # fmt: skip
    sunless = eqx.tree_at(lambda a: a.source.sun, air, 0 * air.source.sun)
    args = [jnp.full(4, a, jnp.float32) for a in (1500.0, math.pi / 2, math.pi, 2.0)]
    # What is left is the light of sky and ground.
    assert np.asarray(air.inscatter(*args) - lost) == pytest.approx(
        np.asarray(sunless.inscatter(*args)), rel=2e-3
    )


@pytest.mark.slow
def test_shafts_darken_air_and_sky_and_change_nothing_where_no_land_shades(published, air, hills):
    camera = Perspective(12, 9, AZIMUTH, 0.1, 1.0, 30.0)
    flat = Elevation(np.zeros((60, 70)), 120.0, 100.0)
    for land, eye in ((flat, (3e3, 3e3)), (hills, (300.0, 6700.0))):
        plain, shaded = (
            render_terrain(
                published, land, camera, eye, SUN, AZIMUTH, air, samples=1, shafts=shafts
            ).rgb
            for shafts in (False, True)
        )
        assert (shaded > 0).all()
        assert (shaded <= plain * 1.0001).all()
        if land is flat:
            assert shaded == pytest.approx(plain, rel=1e-6)
        else:
            assert (shaded / plain).min() < 0.9


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--shafts"], "--shafts: only with --terrain"),
        (["--terrain", "sample", "--view", "perspective", "--aerial", "none", "--shafts"],
         "--shafts: only with --aerial paper"),
    ],
)  # fmt: skip
def test_mistakes_are_answered_with_one_line(tmp_path, capsys, words, message):
    out = str(tmp_path / "a.png")
    assert cli.run(["render", "--turbidity", "3", *words, "--out", out]) == 2
    assert message in capsys.readouterr().err


def test_shafts_need_the_papers_air(published, hills):
    with pytest.raises(ValueError, match="expected an AerialPerspective; got NoneType"):
        render_terrain(published, hills, Perspective(4, 4), (0.0, 0.0), SUN, 0.0, None, shafts=True)
