"""Scenes for Radiance, through its own programs."""

import os
import subprocess
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest
from peers import peer
from test_export import PUBLISHED
from test_export_formula import sky

import skyfit
from skyfit import cli
from skyfit.constants import SUN_SOLID_ANGLE
from skyfit.export import export_fit, radiance_scene
from skyfit.fitting import paper_refit
from skyfit.render.cameras import direction_of


# Tregenza (1987): rows of patches by elevation, in degrees, from the horizon up
ROWS = ((6, 30), (18, 30), (30, 24), (42, 24), (54, 18), (66, 12), (78, 6), (90, 1))
PATCHES = np.radians(
    [(90 - height, 360 / count * k) for height, count in ROWS for k in range(count)]
)
# Lumens of a watt of Radiance's red, green and blue: its manual's CIE_rf, CIE_gf, CIE_bf by 179
LUMINANCE = 179 * np.array([0.265074126, 0.670114631, 0.064811243])


def traced(where, direction, *options):
    """Luminance that `rtrace` finds along directions from the scene `sky.rad`."""
    package = Path(peer("pyradiance").__file__).parent
    environment = os.environ | {"RAYPATH": f".{os.pathsep}{package / 'lib'}"}

    def call(program, *arguments, given=b""):
        done = subprocess.run(
            [package / "bin" / program, *arguments],
            cwd=where, env=environment, input=given, capture_output=True,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert done.stderr in (b"", b"rtrace: warning - no light sources found\n")  # at night
        return done.stdout

    (where / "sky.oct").write_bytes(call("oconv", "sky.rad"))
    rays = "\n".join("0 0 0 " + " ".join(map(str, ray)) for ray in direction.tolist())
    found = call("rtrace", "-h", *options, "sky.oct", given=rays.encode()).decode()
    return np.array([line.split() for line in found.splitlines()], float) @ LUMINANCE


def written(where, model, sun, **swept):
    (where / "sky.cal").write_text(export_fit(model, "radiance"))
    (where / "sky.rad").write_text(radiance_scene(model, *sun, **swept))


def dome(model, sun):
    return np.asarray(model.xyz(direction_of(*PATCHES.T), direction_of(*sun)))[:, 1]


@pytest.mark.slow
@pytest.mark.parametrize("sun_deg", [(50.0, 200.0), (0.0, 0.0), (89.0, 75.0), (94.0, 310.0)])
@pytest.mark.parametrize("turbidity", [2.0, 6.0])
def test_the_patches_of_the_dome_are_the_models(sun_deg, turbidity, tmp_path):
    model, sun = skyfit.preetham_sky(turbidity), np.radians(sun_deg)
    written(tmp_path, model, sun)
    found = traced(tmp_path, direction_of(*PATCHES.T))
    near = np.sum(direction_of(*PATCHES.T) * direction_of(*sun), axis=1) > np.cos(np.radians(0.3))
    assert near.sum() == (sun_deg[0] == 0)  # the sun covers a patch's middle
    # Half a per cent is wanted; colours go through 32 bits and the octree.
    np.testing.assert_allclose(found[~near], dome(model, sun)[~near], rtol=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [("hosek-wilkie", "root", "RGB"), ("series", "polynomial", "bands")]
)
def test_other_formulas_are_theirs_too(case, tmp_path):
    model, sun = sky(*case), np.radians([50.0, 200.0])
    written(tmp_path, model, sun)
    np.testing.assert_allclose(
        traced(tmp_path, direction_of(*PATCHES.T)), dome(model, sun), rtol=2e-4
    )


def test_the_sun_lights_the_ground_as_sunlight_does(tmp_path):
    sun = np.radians([60.0, 120.0])
    written(tmp_path, PUBLISHED, sun)
    direct = float(skyfit.sun_xyY(3.0, sun[0])[2]) * SUN_SOLID_ANGLE * np.cos(sun[0])
    lines = (tmp_path / "sky.rad").read_text()
    (tmp_path / "sky.rad").write_text(lines[: lines.index("void colorfunc")])
    up = np.array([[0.0, 0.0, 1.0]])
    assert traced(tmp_path, up, "-I+", "-ab", "0")[0] == pytest.approx(direct, rel=2e-3)


def test_the_ground_gets_the_diffuse_light_of_the_sky(tmp_path):
    """Radiance's own sum over the dome, about half a per cent of noise."""
    sun = np.radians([94.0, 0.0])  # no sun in the scene
    written(tmp_path, PUBLISHED, sun)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    view, azimuth = np.meshgrid(
        np.arccos(np.sqrt((nodes + 1) / 2)), np.radians(np.arange(0, 360, 5))
    )
    light = np.asarray(PUBLISHED.xyz(direction_of(view, azimuth), direction_of(*sun)))[..., 1]
    whole = np.pi * np.mean(light @ (weights / 2))
    up = np.array([[0.0, 0.0, 1.0]])
    found = traced(tmp_path, up, "-I+", "-ab", "1", "-ad", "65536", "-aa", "0")
    assert found[0] == pytest.approx(whole, rel=0.01)


def test_the_command_writes_a_pair_that_runs(tmp_path):
    out = tmp_path / "sky.rad"
    command = ["export", "refit", "--target", "radiance", "--out", str(out), "--set", "turbidity=4"]
    assert cli.run([*command, "--sun-zenith-deg", "30", "--sun-azimuth-deg", "90"]) == 0
    sun = np.radians([30.0, 90.0])
    model = paper_refit().sky(turbidity=4.0)
    np.testing.assert_allclose(
        traced(tmp_path, direction_of(*PATCHES.T)), dome(model, sun), rtol=2e-4
    )


def test_what_a_scene_cannot_be_is_refused(tmp_path, capsys):
    for sun in (-0.1, 3.2, np.nan):
        with pytest.raises(skyfit.InputError, match=r"sun_zenith=...\) must lie in \[0, pi\]"):
            radiance_scene(PUBLISHED, sun)
    with pytest.raises(skyfit.InputError, match=r"expected no blanks; got 'my sky\.cal'"):
        radiance_scene(PUBLISHED, 1.0, function_file="my sky.cal")
    with pytest.raises(skyfit.InputError, match="expected the parameters"):
        radiance_scene(paper_refit(), 1.0)
    command = ["export", "published", "--target"]
    cases = {
        "ends in .rad": ["radiance", "--out", str(tmp_path / "sky.cal"), "--set", "turbidity=3"],
        "expected turbidity=VALUE": ["radiance", "--out", str(tmp_path / "sky.rad")],
        "only for radiance": ["unity", "--out", str(tmp_path / "a"), "--sun-zenith-deg", "3"],
        "NAME=VALUE": ["radiance", "--out", str(tmp_path / "sky.rad"), "--set", "turbidity"],
    }
    for message, more in cases.items():
        assert cli.run([*command, *more]) == 2
        assert message in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_frames_numbers_are_those_of_the_export():
    """The scene's, from the model, against the exported Python's, from its code."""
    space: dict = {}
    exec(export_fit(PUBLISHED, "python"), space)
    for zenith in (0.3, 1.5, 1.65):
        frame = space["sky_frame_of_angle"](zenith, 3.0)
        numbers = radiance_scene(PUBLISHED, zenith).split("colorfunc")[1].split("\n")[3].split()
        np.testing.assert_allclose(np.array(numbers[1:19], float), list(frame.values()), rtol=1e-8)
        assert jnp.allclose(np.array(numbers[19:], float), direction_of(zenith, np.pi), atol=1e-9)
