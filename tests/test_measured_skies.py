"""Skies from sky scanners and fisheye photographs: directions, units, gaps, and fits of them."""

import inspect

import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit.angles import azimuth_from_south, compass_azimuth
from skyfit.render import (
    Fisheye,
    ModelSource,
    RecordedSource,
    read_fisheye,
    read_picture,
    render,
)
from skyfit.sun import SunPosition
from skyfit.surfaces import plane_light, sampled_dome, sky_dome


SUN = SunPosition(jnp.asarray(0.8), azimuth_from_south(np.radians(135.0)))  # in the southeast
# Tregenza's dome: altitude and number of patches of each ring.
RINGS = ((6, 30), (18, 30), (30, 24), (42, 24), (54, 18), (66, 12), (78, 6), (90, 1))
PATCHES = np.array([(alt, 360 * k / n) for alt, n in RINGS for k in range(n)], float)
CLEAR = skyfit.cie_clear_sky(3.0)


def scan(path, rows=PATCHES, gaps=(), head="azimuth_deg,altitude_deg,luminance", south=False):
    view = np.radians(90 - rows[:, 0])
    relative = np.radians(rows[:, 1]) - np.radians(135.0)
    light = np.array(CLEAR.xyY(0.8, view, relative)[:, 2])
    light[list(gaps)] = -1.0
    turn = (rows[:, 1] - 180.0 * south) % 360
    table = np.stack([turn, rows[:, 0], light / 1000], axis=1)
    np.savetxt(path, table, delimiter=",", header=f"# a scan\n{head}", comments="", fmt="%.8g")
    return path


@pytest.mark.parametrize("zero", ["north", "south"])
def test_a_scan_of_145_patches_is_a_sky(tmp_path, zero):
    path = scan(tmp_path / "scan.csv", gaps=[3, 50], south=zero == "south")
    sky = skyfit.read_sky_scanner(path, SUN, unit=1000.0, zero=zero)
    assert sky.sizes == {"direction": 145}
    assert np.flatnonzero(np.isnan(sky["luminance"])).tolist() == [3, 50]
    # A patch in the direction of the sun, 42° above the southeast, has relative azimuth 0.
    southeast = np.flatnonzero((PATCHES == (42, 135)).all(axis=1))
    np.testing.assert_allclose(sky["relative_azimuth"][southeast], 0.0, atol=1e-6)
    want = CLEAR.xyY(0.8, sky["view_zenith"].values, sky["relative_azimuth"].values)[:, 2]
    known = ~np.isnan(sky["luminance"].values)
    np.testing.assert_allclose(sky["luminance"][known], want[known], rtol=1e-5)
    skyfit.save_dataset(sky, tmp_path / "scan.nc")
    assert skyfit.load_dataset(tmp_path / "scan.nc").identical(
        sky.assign_attrs(schema="skyfit/dataset/1")
    )


@pytest.mark.slow
def test_a_scan_with_gaps_is_fitted_lights_planes_and_is_shown(tmp_path):
    sky = skyfit.read_sky_scanner(scan(tmp_path / "a.csv", gaps=range(5, 145, 9)), SUN, unit=1e3)
    # The CIE's clear sky is of the CIE's form.
    fit = skyfit.fit_sky(sky.expand_dims("time"), distribution="cie")
    view, azimuth = np.array([0.3, 0.9, 1.3]), np.array([0.2, 2.0, 3.0])
    want = np.asarray(CLEAR.xyY(0.8, view, azimuth)[:, 2])
    np.testing.assert_allclose(fit.sky().xyY(0.8, view, azimuth)[:, 2], want, rtol=5e-3)
    parts = (sky[name].values for name in ("view_zenith", "relative_azimuth"))
    dome = sampled_dome(0.8, *parts, sky["luminance"].values[:, None])
    ground = plane_light(sky_dome(CLEAR, 0.8)).sky[1]
    # Triangles between 129 patches of 12°.
    np.testing.assert_allclose(plane_light(dome).sky[0], ground, rtol=0.02)
    source = RecordedSource(sky, "a scan")
    seen = source.xyz(np.array([[0.0, 0.0, 1.0]]), 0.8, np.radians(135.0))[0, 1]
    np.testing.assert_allclose(seen, CLEAR.xyY(0.8, 0.0, 0.0)[2], rtol=0.02)


@pytest.mark.parametrize(
    ("rows", "head", "options", "message"),
    [
        (PATCHES, "az,alt,lum", {}, "expected a column azimuth_deg; there is az, alt, lum"),
        (PATCHES + 1, "azimuth_deg,altitude_deg,luminance", {}, "altitude_deg from 0 to 90"),
        (PATCHES, "azimuth_deg,altitude_deg,luminance", {"zero": "east"}, "'north' or 'south'"),
    ],
)
def test_a_scan_that_is_none_is_refused(tmp_path, rows, head, options, message):
    path = scan(tmp_path / "a.csv", rows, head=head)
    with pytest.raises(skyfit.InputError, match=message):
        inspect.unwrap(skyfit.read_sky_scanner)(path, SUN, **options)


@pytest.fixture(scope="module")
def picture():
    source = ModelSource(skyfit.preetham_sky(3.0), 3.0, "published")
    sun = float(SUN.zenith), float(compass_azimuth(SUN.azimuth))
    return lambda **look: render(source, Fisheye(128, **look), *sun, sun_disc=False)


LOOKS = [{"projection": "equidistant"}, {"projection": "equal-area", "top": 1.0}]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["exr", "hdr"])
@pytest.mark.parametrize("look", LOOKS)
def test_a_fisheye_picture_is_the_sky_it_shows(picture, kind, look, tmp_path):
    picture(**look).save(tmp_path / f"sky.{kind}")
    sky = read_fisheye(tmp_path / f"sky.{kind}", SUN, **look)
    model = skyfit.preetham_sky(3.0)
    want = model.xyY(0.8, sky["view_zenith"].values, sky["relative_azimuth"].values)
    angles = sky["view_zenith"].values, np.full(sky.sizes["direction"], 0.8)
    angles = *map(jnp.asarray, angles), jnp.asarray(sky["relative_azimuth"].values)
    near = np.asarray(skyfit.angles.view_sun_angle(*angles)) < 0.3
    away = ~near & (sky["view_zenith"].values < 1.4)
    assert away.sum() > 150
    # Means over patches of 6°; a Radiance file keeps 8 bits, and cuts off colours below 0.
    for name, column in (("luminance", 2), ("x", 0), ("y", 1)):
        np.testing.assert_allclose(sky[name][away], want[away, column], rtol=0.03)


def test_a_circle_within_a_picture_and_pixels_that_are_no_numbers(picture, tmp_path):
    import OpenEXR

    whole = np.zeros((160, 200, 3), np.float32)
    whole[20:148, 50:178] = picture(projection="equidistant").rgb
    whole[20:40] = np.nan
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGB": whole}) as file:
        file.write(str(tmp_path / "a.exr"))
    circle = {"projection": "equidistant", "centre": (114.0, 84.0), "radius": 64.0}
    sky = read_fisheye(tmp_path / "a.exr", SUN, **circle)
    gone = np.isnan(sky["luminance"].values)
    assert 0 < gone.sum() < 0.2 * gone.size
    zenith = float(sky["luminance"][0])
    np.testing.assert_allclose(zenith, skyfit.preetham_sky(3.0).xyY(0.8, 0.0, 0.0)[2], rtol=0.02)
    brighter = read_fisheye(tmp_path / "a.exr", SUN, white=2.0, **circle)
    np.testing.assert_allclose(brighter["luminance"][0], 2 * zenith, rtol=1e-6)
    with pytest.raises(skyfit.InputError, match="expected a circle of 1 to 76 pixels"):
        read_fisheye(tmp_path / "a.exr", SUN, **circle | {"radius": 90.0})


def test_packed_scan_lines_of_radiance_are_unpacked(tmp_path):
    # Sixteen pixels of 1, 2, 4 (times 2^(136 - 136)) by a run, then a row one by one, and EXPOSURE.
    run = b"".join(bytes([128 + 16, value]) for value in (1, 2, 4, 136))
    plain = b"".join(bytes([16]) + bytes([value] * 16) for value in (3, 3, 3, 136))
    start = b"\x02\x02\x00\x10"
    head = b"#?RADIANCE\nEXPOSURE=0.5\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 16\n"
    (tmp_path / "a.hdr").write_bytes(head + start + run + start + plain)
    rgb, white = read_picture(tmp_path / "a.hdr")
    np.testing.assert_allclose(rgb[0], np.broadcast_to([3.0, 5.0, 9.0], (16, 3)))
    np.testing.assert_allclose(rgb[1], 7.0)
    assert white == 179.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.png", b"", "expected a picture ending in .exr or .hdr"),
        ("a.hdr", b"", "expected a Radiance picture; it does not begin"),
        ("a.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "its format is 32-bit"),
        ("a.hdr", b"#?RADIANCE\n\n+X 1 -Y 1\n", "its size is"),
        ("a.hdr", b"#?RADIANCE\n\n-Y 9 +X 9\n123", "it has 3 bytes of 324"),
        ("a.hdr", b"#?RADIANCE\n\n-Y 9 +X 9\n\x02\x02\x00\x09\x02", "expected a Radiance picture"),
        ("a.exr", b"nothing", "expected an OpenEXR picture"),
    ],
)  # fmt: skip
def test_a_picture_that_is_none_is_refused(name, content, message, tmp_path):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(skyfit.InputError, match=message):
        read_picture(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        read_picture(tmp_path / "b.hdr")
