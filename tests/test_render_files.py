"""What is written is what was rendered: files read back, tone curves, colours no screen has."""

import json
import math
import struct

import numpy as np
import pytest
from peers import peer
from picture_readers import read_exr, read_hdr
from PIL import Image

from skyfit import cli
from skyfit.colour import srgb_matrix
from skyfit.render import Fisheye, Panorama, load_source, render
from skyfit.render.cameras import direction_of
from skyfit.render.files import to_rgbe
from skyfit.render.tone import (
    automatic_exposure,
    display,
    encode,
    into_gamut,
    luminance_at,
    tone_curve,
)


@pytest.fixture(scope="module")
def picture():
    return render(load_source(None, 3.0), Panorama(40), 0.9)


def channels(found):
    return np.stack([found[name] for name in "RGB"], axis=-1)


def test_a_half_exr_is_the_picture_to_half_precision(picture, tmp_path):
    record = picture.save(tmp_path / "sky.exr", gamut="keep")
    found, header = read_exr(tmp_path / "sky.exr")
    white = record["cd_m2_of_1"]
    assert channels(found).dtype == np.float16
    expected = (picture.rgb / white).astype(np.float16)
    assert np.array_equal(channels(found), expected)
    # The sun is far beyond the largest half: the scale makes room and is in the header.
    assert picture.rgb.max() > 65504
    assert np.isfinite(channels(found)).all()
    assert struct.unpack("<f", header["whiteLuminance"][1]) == (white,)
    assert header["envmap"][1] == b"\x00"  # latitude-longitude
    primaries = struct.unpack("<8f", header["chromaticities"][1])
    assert primaries == pytest.approx([0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290])
    assert b"turbidity 3" in header["comments"][1]


def test_a_float_exr_is_the_picture_in_candela(picture, tmp_path):
    record = picture.save(tmp_path / "sky.exr", gamut="keep", precision="float")
    found, _ = read_exr(tmp_path / "sky.exr")
    assert record["cd_m2_of_1"] == 1
    assert np.array_equal(channels(found), picture.rgb)


def test_mitsuba_sees_a_panorama_where_the_documentation_says(tmp_path):
    drjit, mitsuba = peer("drjit"), peer("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    where = drjit.zeros(mitsuba.SurfaceInteraction3f)
    sky, sun = load_source(None, 3.0), (0.9, 2.4)
    shown = render(sky, Panorama(128, math.pi), *sun, sun_disc=False)
    shown.save(tmp_path / "sky.exr", precision="float", gamut="keep")
    light = mitsuba.load_dict({"type": "envmap", "filename": str(tmp_path / "sky.exr")})
    for zenith, azimuth in ((0.5, 0.0), (1.2, 1.5), (1.0, 3.5), (1.3, 5.0)):
        direction = direction_of(zenith, azimuth)
        east, north, up = direction
        where.wi = mitsuba.Vector3f(-east, -up, north)  # back from x = east, y = up, z = south
        seen = np.array(light.eval(where)).ravel()
        rgb = sky.xyz(direction[None].astype(np.float32), *sun)[0] @ srgb_matrix().T
        # It interpolates between pixels 1.4° wide; a quarter turn or a mirror is off by a half.
        assert seen == pytest.approx(rgb, rel=0.01)


def test_an_hdr_is_the_picture_in_radiances_unit(picture, tmp_path):
    picture.save(tmp_path / "sky.hdr")
    values, header = read_hdr(tmp_path / "sky.hdr")
    assert "PRIMARIES= 0.6400 0.3300 0.3000 0.6000 0.1500 0.0600 0.3127 0.3290" in header
    # Half a step of 8 bits of the brightest channel, at worst.
    error = np.abs(values * 179 - picture.rgb) / picture.rgb.max(axis=-1, keepdims=True)
    assert error.max() < 1 / 256 + 1e-6


def test_rgbe_bytes_are_wards():
    # Real Pixels: 1 is 128, 128, 128, 129; black is four zeros; negative channels are 0.
    assert to_rgbe(np.array([1.0, 1.0, 1.0])).tolist() == [128, 128, 128, 129]
    assert to_rgbe(np.zeros(3)).tolist() == [0, 0, 0, 0]
    assert to_rgbe(np.array([-1.0, 0.25, 0.125])).tolist() == [0, 128, 64, 127]


def test_a_png_is_what_display_made(picture, tmp_path):
    record = picture.save(tmp_path / "sky.png", ev=14.0, tone="reinhard")
    with Image.open(tmp_path / "sky.png") as file:
        assert np.array_equal(np.asarray(file), picture.pixels(14.0, "reinhard"))
        assert "EV 14.00, tone curve reinhard" in file.info["Exposure"]
    assert record["ev"] == 14.0
    # Only the sun's pixels are above white.
    assert 0 < record["overexposed"] < 10


@pytest.mark.parametrize(
    ("tone", "light", "shown"),
    [
        ("linear", 0.5, 0.735357),  # IEC 61966-2-1: 1.055 · 0.5^(1/2.4) - 0.055
        ("linear", 0.001, 0.01292),
        ("scs", 1.0, 0.38317 ** (1 / 2.2)),
        ("scs", 2.0, 1 - math.exp(-2)),
        ("reinhard", 1.0, 0.735357),  # 1 / (1 + 1) = 0.5
        ("aces", 1.0, 0.908230),  # 2.54 / 3.16 = 0.80380
    ],
)
def test_tone_curves_have_their_published_values(tone, light, shown):
    grey = np.full((1, 3), light)
    assert np.asarray(tone_curve(grey, tone)) == pytest.approx(shown, abs=2e-5)


def test_the_tutorials_curve_is_continuous_at_its_joint():
    below, above = (np.asarray(tone_curve(np.full(3, x), "scs")) for x in (1.41299, 1.41301))
    assert above == pytest.approx(below, abs=2e-4)


def test_tone_curves_rise_and_are_finite():
    light = np.geomspace(1e-9, 1e9, 400)[:, None] * np.ones(3)
    for tone in ("linear", "scs", "reinhard", "aces"):
        curve = np.asarray(tone_curve(light, tone))
        assert np.isfinite(curve).all()
        assert (np.diff(curve, axis=0) >= 0).all()


def test_exposure_values_are_those_of_photography():
    # EV 15 is bright sunlight: grass and skin near 4000 cd/m² fall below white, snow at it.
    assert luminance_at(15.0) == pytest.approx(39321.6)
    flat = np.full((4, 4, 3), 3000.0)
    ev = automatic_exposure(flat, np.ones((4, 4)))
    assert 3000 / luminance_at(ev) == pytest.approx(0.25)
    assert automatic_exposure(0 * flat, np.ones((4, 4))) == 0.0


def test_colours_outside_srgb_are_counted_and_brought_in():
    rgb = np.array([[1.0, 0.5, -0.25], [0.2, 0.3, 0.4], [0.0, 0.0, 0.0]])
    weights = np.array([0.2126, 0.7152, 0.0722])
    kept, count = into_gamut(rgb, "keep")
    assert count == 1
    assert np.array_equal(kept, rgb)
    clipped, _ = into_gamut(rgb, "clip")
    assert clipped.tolist() == [[1.0, 0.5, 0.0], [0.2, 0.3, 0.4], [0.0, 0.0, 0.0]]
    pale, _ = into_gamut(rgb, "desaturate")
    assert pale[0].min() == 0
    assert pale @ weights == pytest.approx(rgb @ weights)
    assert pale[1:].tolist() == clipped[1:].tolist()
    # Along the line to white: differences between channels keep their ratio.
    assert (pale[0, 0] - pale[0, 1]) / (pale[0, 1] - pale[0, 2]) == pytest.approx(0.5 / 0.75)


def test_encoding_is_srgbs():
    # IEC 61966-2-1: middle grey 0.214 is 127.5 of 255.
    assert float(encode(np.array(0.21404))) == pytest.approx(0.5, abs=1e-5)
    assert display(np.full((1, 1, 3), 1e9), 0.0, "linear").pixels.max() == 255


def test_nothing_is_overwritten_unasked(picture, tmp_path):
    file = tmp_path / "sky.png"
    file.write_text("precious")
    with pytest.raises(ValueError, match="exists already"):
        picture.save(file)
    assert file.read_text() == "precious"
    picture.save(file, overwrite=True)
    assert file.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["sky.jpg", "sky", "file/sky.png"])
def test_impossible_files_are_refused(picture, tmp_path, name):
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match=r"expected a name ending|cannot be written"):
        picture.save(tmp_path / name)


def test_the_command_renders_the_published_model(tmp_path, capsys):
    out = tmp_path / "sky.png"
    words = ["render", "--turbidity", "3", "--height", "32", "--out", str(out), "--json"]
    assert cli.run(words) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["outside_srgb"] == 0
    expected = render(load_source(None, 3.0), Fisheye(32), math.radians(45)).pixels()
    with Image.open(out) as file:
        assert np.array_equal(np.asarray(file), expected)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["--out", "sky.png", "--samples", "8"],
            "--samples: expected 1, 4, 9, 16, ..., 1024; got 8",
        ),
        (["--out", "sky.gif", "--seconds", "-1"], "'--seconds': -1.0 is not in the range"),
        (["--out", "sky.png", "--ev", "nan"], "'--ev': expected a number; got nan"),
        (["--out", "sky.tif"], "sky.tif: expected a name ending in .exr, .hdr"),
        (["none.json", "--out", "sky.png"], "none.json"),
        (["fit.txt", "--out", "sky.png"], "fit.txt: expected a fit (.json)"),
        (["--out", "s.png", "--turbidity", "0.5"], "must be 1 or more; got 0.5"),
        (["--out", "s.png", "--view", "mirror"], "'--view': 'mirror' is not one of"),
        (["--out", "s.png", "--altitude-m", "9"], "--altitude-m: only for --view perspective"),
    ],
)
def test_mistakes_are_answered_with_one_line(tmp_path, monkeypatch, capsys, words, message):
    monkeypatch.chdir(tmp_path)
    assert cli.run(["render", *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
