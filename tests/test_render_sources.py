"""Skies that are not formulas: simulated on few directions, recorded, seen from space; days."""

import contextlib
import json
import math
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest
from model_skies import model_skies
from PIL import Image

import skyfit
from skyfit import cli
from skyfit.campaign import paper_directions
from skyfit.colour import spectrum_to_xyz, xyY_to_xyz
from skyfit.render import (
    Fisheye,
    Perspective,
    RecordedSource,
    SimulatedSource,
    animate,
    day_of_suns,
    load_source,
    render,
    select_sky,
)
from skyfit.render.cameras import direction_of
from skyfit.render.dome_table import DomeTable, Zone, spokes


SIMS = Path(__file__).parent.parent / "sims"
GRID = (20, 13)
SUN = 0.9


@pytest.fixture(scope="module")
def air():
    return skyfit.preetham_atmosphere(4.0, wavelengths=[450.0, 600.0])


@pytest.fixture(scope="module")
def from_ground(air):
    return SimulatedSource(air, "air", orders=1, quality="draft", grid=GRID)


@pytest.fixture(scope="module")
def from_space(air):
    return SimulatedSource(air, "air", orders=1, quality="draft", observer_altitude=4e5, grid=GRID)


def between(source):
    """Directions half a step off the source's grid, and their light by the simulator itself.

    As many as the grid has, so that no other program is compiled for them.
    """
    rings = np.stack([zone.rings(2 * GRID[0])[1::2] for zone in source.zones()])
    rings[:, -1] = rings[:, -2]  # the horizon itself
    view, azimuth = rings[:, :, None], (spokes(GRID[1]) + 0.5 * math.pi / GRID[1])[None, None, :]
    sky = skyfit.simulate(
        source.atmosphere, SUN, view, azimuth, orders=1, quality="draft",
        observer_altitude=source.observer_altitude,
    )  # fmt: skip
    light = np.asarray(spectrum_to_xyz(sky.radiance, source.atmosphere.wavelengths))
    found = source.xyz(direction_of(view, azimuth + 0.4).reshape(-1, 3), SUN, 0.4)
    return found.reshape(light.shape), light


@pytest.mark.slow
def test_pixels_between_the_grids_directions_are_the_simulations(from_ground):
    found, light = between(from_ground)
    # Measured: 0.32 % at worst on this grid, 0.08 % on the default one.
    assert found == pytest.approx(light, rel=4e-3)


@pytest.mark.slow
def test_beside_the_sun_the_phase_function_keeps_its_cusp(from_ground):
    # The table of the haze begins at 1°; rings are several degrees apart.
    near = np.stack([direction_of(SUN, 0.0), direction_of(SUN, math.radians(5.0))])
    light = from_ground.xyz(near, SUN, 0.0)
    gamma = np.arccos(np.clip(near @ direction_of(SUN, 0.0), -1, 1))
    haze = from_ground.atmosphere.constituents[1].phase.spectral(jnp.cos(gamma))
    assert light[1, 1] / light[0, 1] < 1
    # Haze is most of the light there, and everything else is even.
    ratio = float(haze[1].mean() / haze[0].mean())
    assert ratio < light[1, 1] / light[0, 1] < 1


@pytest.mark.slow
def test_from_space_pixels_are_the_simulations_too(from_space):
    found, light = between(from_space)
    brightest = light.max(axis=(1, 2), keepdims=True)
    # 4 % of the brightest at the limb on so coarse a grid.
    assert np.abs(found - light).max() < 0.05 * brightest.max()
    # The ground is smooth.
    assert found[1] == pytest.approx(light[1], rel=5e-3)


@pytest.mark.slow
def test_from_space_the_planet_ends_at_its_horizon_and_the_air_at_its_limb(from_space):
    source = from_space
    horizon = math.asin(6360 / 6760)
    assert math.degrees(math.asin(-source.horizon())) == pytest.approx(90 - math.degrees(horizon))
    over = math.pi - math.asin(6420 / 6760) - 1e-4
    limb, ground = math.pi - horizon - 1e-3, math.pi
    light = source.xyz(direction_of(np.array([0.5, over, limb, ground]), np.zeros(4)), SUN, 0.0)
    assert light[0].tolist() == light[1].tolist() == [0, 0, 0]
    assert light[2:, 1].min() > 100
    # The sun's disc is not dimmed up here, and set only below the planet's edge.
    top = source.atmosphere.solar_irradiance / 6.80e-5
    space = np.asarray(spectrum_to_xyz(top, source.atmosphere.wavelengths))
    assert source.sun_xyz(1.5) == pytest.approx(space)
    assert source.sun_xyz(math.pi - horizon + 0.01)[1] == 0


@pytest.mark.slow
def test_rendering_from_space_shows_the_planet_below(from_space):
    tilt = math.asin(from_space.horizon())
    camera = Perspective(32, 24, azimuth=0.4, elevation=tilt, altitude=4e5)
    picture = render(from_space, camera, SUN, 0.4, sun_disc=False)
    assert picture.rgb[:8].max() == 0
    assert picture.rgb[-8:, :, 1].min() > 0


def smooth(view, azimuth):
    """Unlike on both sides of the zenith, alike on both sides of the sun's plane."""
    x, y, z = np.moveaxis(direction_of(view, azimuth), -1, 0)
    return np.exp(0.5 * y) * (1 + 0.3 * z) + 0.2 * x**2


@pytest.mark.parametrize("zone", [Zone(0.0, 1.57), Zone(math.pi, 1.9), Zone(1.2, 1.6)], ids=str)
def test_a_table_reads_smooth_functions_between_its_rings(zone):
    table = DomeTable(zone, smooth(zone.rings(28)[:, None], spokes(21)[None, :]))
    rng = np.random.default_rng(0)
    view, azimuth = rng.uniform(*sorted((zone.start, zone.end)), 500), rng.uniform(-9, 9, 500)
    assert table(view, azimuth) == pytest.approx(smooth(view, azimuth), rel=2e-4)


@pytest.fixture(scope="module")
def dataset():
    return model_skies(turbidities=(2.0, 4.0), suns=(0.3, 1.0), directions=paper_directions())


def test_a_recorded_sky_is_its_model_between_the_directions(dataset):
    sky = select_sky(dataset, "data", 4.0, 1.0)
    source = RecordedSource(sky, "data", 4.0)
    view, azimuth = np.array([0.1, 0.7, 1.4]), np.array([2.0, 1.1, 5.0])
    expected = skyfit.preetham_sky(4.0).xyY(1.0, view, azimuth)
    found = source.xyz(direction_of(view, azimuth + 0.2), 1.0, 0.2)
    assert found == pytest.approx(np.asarray(xyY_to_xyz(expected)), rel=5e-3)


def test_measured_skies_come_back_where_they_were_measured():
    data = skyfit.cornell_skies().isel(time=0)
    source = RecordedSource(data, "cornell")
    kept = data.isel(direction=np.flatnonzero(data["reliable"].values))
    view, azimuth = kept["view_zenith"].values, kept["relative_azimuth"].values
    found = source.xyz(direction_of(view, azimuth), float(data["sun_zenith"]), 0.0)[:, 1]
    # Two sides of the sun were measured, and are made alike: 5 % apart on the average.
    ratio = found / kept["luminance"].values
    assert np.sqrt(np.mean((ratio - 1) ** 2)) < 0.1
    assert np.median(ratio) == pytest.approx(1, abs=0.02)
    # Each side alone passes through its directions.
    side = kept.isel(direction=slice(0, 40)).assign_coords(
        relative_azimuth=("direction", np.linspace(-2.0, 3.0, 40))
    )
    direction = direction_of(side["view_zenith"].values, side["relative_azimuth"].values)
    found = RecordedSource(side, "side").xyz(direction, float(data["sun_zenith"]), 0.0)[:, 1]
    assert found == pytest.approx(side["luminance"].values, rel=0.05)


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        ((None, 1.0), "data: expected a turbidity of one of 2, 4; got none"),
        ((3.0, 1.0), "data: expected a turbidity of one of 2, 4; got 3"),
        ((4.0, None), "data: expected a sun at one of 17.1887, 57.2958; got none"),
        ((4.0, 0.9), "data: expected a sun at one of 17.1887, 57.2958; got 51.5662"),
    ],
)
def test_skies_that_are_not_there_are_refused(dataset, chosen, message):
    with pytest.raises(ValueError, match=message):
        select_sky(dataset, "data", *chosen)


def test_a_recorded_sky_has_only_its_own_sun(dataset):
    source = RecordedSource(select_sky(dataset, "data", 4.0, 1.0), "data")
    with pytest.raises(ValueError, match=r"its sun is at 57.30 degrees from the zenith; got 28.65"):
        render(source, Fisheye(8), 0.5, sun_disc=False)
    with pytest.raises(ValueError, match="what dims the sun is unknown"):
        render(source, Fisheye(8), 1.0)
    with pytest.raises(ValueError, match="expected one sky"):
        RecordedSource(dataset, "data")
    with pytest.raises(ValueError, match="data: x is missing"):
        RecordedSource(dataset.drop_vars("x"), "data")


def test_a_day_goes_from_dawn_to_dusk_through_the_south():
    suns = day_of_suns(math.radians(45), 80, 25)
    zenith, azimuth = suns.T
    assert np.degrees(zenith[[0, -1]]) == pytest.approx(96, abs=0.3)
    # At the equinox the noon sun is the latitude away from the zenith, and rises in the east.
    assert np.degrees(zenith.min()) == pytest.approx(45, abs=0.7)
    assert np.degrees(azimuth[zenith.argmin()]) == pytest.approx(180, abs=5)
    rising = int(np.argmin(np.abs(zenith[:12] - math.pi / 2)))
    assert np.degrees(azimuth[rising]) == pytest.approx(90, abs=10)
    with pytest.raises(ValueError, match=r"got latitude 89, day 355"):
        day_of_suns(math.radians(89), 355, 5)


@pytest.mark.parametrize("name", ["day.gif", "day.apng"])
def test_a_day_is_written_frame_by_frame(tmp_path, name):
    source, camera = load_source(None, 3.0), Fisheye(24)
    suns = np.array([[1.2, 2.0], [0.8, math.pi], [1.2, 4.0]])
    seen = []
    record = animate(
        tmp_path / name, source, camera, suns, ev=14.0, progress=lambda *at: seen.append(at)
    )
    assert seen == [("frames", done, 3) for done in range(1, 4)]
    assert record["frames"] == 3
    assert record["ev"] == [14.0, 14.0]
    with Image.open(tmp_path / name) as file:
        assert file.n_frames == 3
        for k, (zenith, azimuth) in enumerate(suns):
            file.seek(k)
            expected = render(source, camera, zenith, azimuth).pixels(14.0)
            error = np.abs(np.asarray(file.convert("RGB"), int) - expected)
            # A GIF has 256 colours for all frames.
            assert error.mean() < (0.01 if name.endswith("apng") else 12)
    with pytest.raises(ValueError, match="exists already"):
        animate(tmp_path / name, source, camera, suns)


def test_the_command_shows_days_datasets_and_measurements(dataset, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    skies = dataset.assign_attrs(schema="skyfit/dataset/1")
    skyfit.save_dataset(skies, "sky.nc")
    sizes = ["--height", "16", "--json"]
    runs = [
        ["sky.nc", "--turbidity", "2", "--sun-zenith-deg", "57.29578", "--out", "a.png"],
        ["cornell", "--sun-zenith-deg", "48.938", "--no-sun", "--out", "b.png"],
        ["--turbidity", "3", "--latitude-deg", "45", "--day-of-year", "172", "--frames", "3",
         "--out", "c.gif"],
        ["--turbidity", "3", "--to-sun-zenith-deg", "90", "--frames", "2", "--out", "d.apng"],
    ]  # fmt: skip
    names = []
    for words in runs:
        assert cli.run(["render", *words, *sizes]) == 0
        names.append(json.loads(capsys.readouterr().out)["sky"])
    assert names[0].startswith("sky.nc; sun zenith 57.3 deg")
    assert "measured by Kider et al. (2014)" in names[1]
    assert sorted(path.name for path in tmp_path.glob("?.*")) == [
        "a.png",
        "b.png",
        "c.gif",
        "d.apng",
    ]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["cornell", "--no-sun", "--out", "a.png"], "cornell: expected a sun at one of 48.9379"),
        (["--turbidity", "3", "--out", "a.gif"], "--out: a day needs --latitude-deg and"),
        (["--turbidity", "3", "--view", "perspective", "--terrain", "sample",
          "--to-sun-zenith-deg", "90", "--out", "a.gif"], "--terrain: only for one picture"),
        (["--turbidity", "3", "--view", "perspective", "--altitude-m", "9", "--out", "a.png"],
         "the published model: only simulated skies (.toml) can be seen from an altitude; got 9 m"),
        (["sims.toml", "--out", "a.png"], "sims.toml"),
    ],
)  # fmt: skip
def test_mistakes_are_answered_with_one_line(tmp_path, monkeypatch, capsys, words, message):
    monkeypatch.chdir(tmp_path)
    assert cli.run(["render", *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("sun_deg", "warned"), [(30.0, False), (65.0, True), (10.0, True)])
def test_a_formula_beyond_the_suns_it_was_fitted_to_is_warned_of(sun_deg, warned):
    source = load_source(SIMS / "cornell_2013.fit.json", 2.53)  # suns of 15 to 60 degrees
    said = pytest.warns(UserWarning, match="was fitted to suns 15 to 60 degrees")
    with said if warned else contextlib.nullcontext():
        render(source, Fisheye(8), np.radians(sun_deg))


def test_the_published_night_is_part_of_the_model():
    assert load_source(None).sun_range() == (0.0, np.pi)
    render(load_source(None), Fisheye(8), np.radians(95.0))
