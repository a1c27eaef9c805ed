"""Pictures that cannot be: refused in one line, and nothing that is there is touched."""

import math

import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit import cli
from skyfit.atmosphere import Atmosphere, Constituent
from skyfit.phase import Rayleigh
from skyfit.profile import Exponential
from skyfit.render import (
    AbstractSource,
    Fisheye,
    Panorama,
    Perspective,
    Picture,
    SimulatedSource,
    animate,
    frames_directory,
    render,
    render_terrain,
    sample_elevation,
    simulated,
)
from skyfit.render.frames import Frame, FrameStore
from skyfit.transfer.simulate_sky import Sky


DAY, NIGHT = 0.7, 1.8
CAMERA = Panorama(8)
WRONG = [
    (math.nan, "expected finite light; got NaN or infinity in 128 of 128 pixels"),
    (math.inf, "expected finite light; got NaN or infinity in 128 of 128 pixels"),
    (-1.0, r"expected a luminance of 0 cd/m2 or more; got -1 at worst, below 0 in 128 of 128"),
    (0.0, "one light: expected a bright sky under a sun 49.89 deg high; got a black one"),
]


class Even(AbstractSource):
    """One light everywhere by day, another at night."""

    def __init__(self, by_day, at_night=1.0):
        self.name, self.has_ground = "one light", True
        self.by_day, self.at_night = by_day, at_night

    def xyz(self, direction, sun_zenith, sun_azimuth):
        light = self.by_day if sun_zenith < math.pi / 2 else self.at_night
        return np.full((len(direction), 3), light) * np.array([0.9505, 1.0, 1.089])

    def sun_xyz(self, sun_zenith):
        return np.full(3, 1e9)

    def identity(self):
        return self.by_day, self.at_night


@pytest.mark.parametrize(("light", "message"), WRONG)
def test_impossible_light_makes_no_picture(light, message):
    with pytest.raises(ValueError, match=message):
        render(Even(light), CAMERA, DAY, sun_disc=False)


@pytest.mark.parametrize("light", [math.nan, -1.0, 0.0])
def test_the_suns_disc_hides_nothing(light):
    with pytest.raises(ValueError, match="expected"):
        render(Even(light), CAMERA, DAY)


def test_one_wrong_pixel_is_enough():
    rgb, weight = np.ones((4, 4, 3), np.float32), np.ones((4, 4))
    rgb[1, 2, 0] = np.nan
    with pytest.raises(ValueError, match=r"a sky: expected finite light; got .* in 1 of 16 pixels"):
        Picture(rgb, np.ones((4, 4), bool), weight, CAMERA, "a sky")


def test_what_srgb_does_not_have_and_rounding_are_no_mistakes():
    rgb, weight = np.ones((4, 4, 3), np.float32), np.ones((4, 4))
    rgb[0, 0] = [-0.5, 1.0, 1.0]  # a cyan
    rgb[0, 1] = -1e-6
    rgb[0, 2], weight[0, 2] = 1e9, 0.0  # the sun
    assert Picture(rgb, np.ones((4, 4), bool), weight, CAMERA, "a sky").rgb is rgb
    rgb[0, 1] = -1e-3
    with pytest.raises(ValueError, match=r"got -0.001 at worst, below 0 in 1 of 16 pixels"):
        Picture(rgb, np.ones((4, 4), bool), weight, CAMERA, "a sky")


def test_nights_may_be_black_and_so_may_what_is_no_sky():
    assert render(Even(1.0, 0.0), CAMERA, NIGHT, sun_disc=False).rgb.max() == 0
    down = Perspective(8, 8, elevation=-1.2, field_of_view=0.3)
    assert render(Even(0.0), down, DAY, sun_disc=False).rgb.max() == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scattering", "altitude", "day"),
    [
        (1e-5, 0.0, True),
        (1e-5, 59e3, True),
        (1e-5, 61e3, False),  # above the air
        (0.0, 0.0, False),
    ],
)
def test_only_air_that_scatters_around_the_eye_must_be_bright(scattering, altitude, day):
    gas = Constituent(Exponential(8e3), scattering, 1e-6, phase=Rayleigh())
    air = Atmosphere([500.0, 600.0], 1.9, [gas], top_altitude=60e3)
    source = SimulatedSource(air, "air", observer_altitude=altitude)
    assert source.is_day(DAY) is day
    assert not source.is_day(NIGHT)


@pytest.mark.parametrize(("wavelengths", "sunlight"), [([1e3, 2e3], 1.0), ([500.0, 600.0], 0.0)])
def test_sunlight_that_nobody_sees_makes_no_sky(wavelengths, sunlight):
    gas = Constituent(Exponential(8e3), 1e-5, phase=Rayleigh())
    air = Atmosphere(wavelengths, sunlight, [gas])
    with pytest.raises(ValueError, match=r"air: expected sunlight that eyes see; got none from"):
        SimulatedSource(air, "air")


def simulate(later):
    """A simulator of 1 in the first order, and so much in all others."""

    def simulated(atmosphere, sun, view, azimuth, orders, **_):
        shape = (*np.broadcast_shapes(view.shape, azimuth.shape), atmosphere.wavelengths.size)
        orders = [1.0] if orders == 1 else [1.0, later]
        by_order = jnp.stack([jnp.full(shape, one) for one in orders])
        return Sky(by_order, jnp.zeros(shape))

    return simulated


@pytest.mark.parametrize(
    ("later", "message"),
    [
        (-0.2, "air: expected light of 0 or more beyond the first order; simulated -.* where all"),
        (math.nan, "expected finite light; got NaN"),
        (1.0, None),
    ],
)
def test_what_the_simulator_makes_of_a_sky_is_not_covered_up(monkeypatch, later, message):
    monkeypatch.setattr(simulated, "simulate", simulate(later))
    gas = Constituent(Exponential(8e3), 1e-5, phase=Rayleigh())
    air = Atmosphere([450.0, 550.0, 650.0], 1.9, [gas])
    source = SimulatedSource(air, "air", orders=None)
    if message is None:
        assert render(source, CAMERA, DAY, sun_disc=False).rgb[:4].min() > 0
        return
    with pytest.raises(ValueError, match=message):
        render(source, CAMERA, DAY, sun_disc=False)


@pytest.mark.slow
@pytest.mark.parametrize("light", [math.nan, -1.0, 0.0])
def test_land_under_impossible_light_makes_no_picture(light):
    camera = Perspective(16, 12, elevation=0.3)
    land = sample_elevation()
    eye = tuple(side / 2 for side in land.size)
    with pytest.raises(ValueError, match=r"expected (finite|a luminance|a bright)"):
        render_terrain(Even(light), land, camera, eye, DAY, 0.0, None, samples=1, sun_disc=False)


@pytest.mark.parametrize("name", ["day.gif", "day.apng"])
def test_every_frame_is_looked_at(tmp_path, name):
    path, camera = tmp_path / name, Fisheye(8)
    path.write_text("precious")
    suns = [(NIGHT, 2.0), (DAY, 3.0)]
    for light, _ in WRONG:
        with pytest.raises(ValueError, match=r"one light.*: expected"):
            animate(path, Even(light, 0.0), camera, suns, overwrite=True, sun_disc=False)
        assert path.read_text() == "precious"
        kept = sorted(file.name for file in frames_directory(path).iterdir())
        assert kept == ["frame-0001.light", "record.json"]
        for file in frames_directory(path).iterdir():
            file.unlink()
    # Dark nights are no mistake.
    animate(path, Even(1.0, 0.0), camera, suns, overwrite=True, sun_disc=False)
    assert path.read_bytes() != b"precious"


def test_a_frame_that_is_not_finite_does_not_count(tmp_path):
    record = dict.fromkeys(("schema", "skyfit", "precision", "source", "camera", "suns", "options"))
    store = FrameStore(tmp_path / "frames", record, (2, 2))
    for light in (1.0, math.nan):
        store.keep(0, Frame(np.full((2, 2, 3), light, np.float32), 1.0))
        assert (store.load(0) is None) == math.isnan(light)


@pytest.mark.parametrize(("light", "message"), WRONG)
@pytest.mark.parametrize("words", [["sky.png"], ["sky.gif", "--to-sun-zenith-deg", "30"]], ids=str)
def test_the_command_says_so_in_one_line(tmp_path, monkeypatch, capsys, light, message, words):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(skyfit.render, "load_source", lambda *_: Even(light))
    file = tmp_path / words[0]
    file.write_text("precious")
    options = ["--view", "panorama", "--height", "8", "--no-sun", "--frames", "2", "--overwrite"]
    assert cli.run(["render", "--sun-zenith-deg", "40.107", *options, "--out", *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("skyfit: one light")
    assert error.count("\n") == 1
    assert file.read_text() == "precious"
    assert [found.name for found in tmp_path.iterdir()] == [words[0]]
