"""Every sky in sims/ gives a picture, and one of its planet."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from picture_readers import read_exr

from skyfit import cli, load_campaign
from skyfit.render import Fisheye
from skyfit.render.cameras import direction_of


SIMS = Path(__file__).parent.parent / "sims"
FILES = sorted(SIMS.glob("*.toml"))
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
SUN = np.radians(40.0)


def drafted(file, folder):
    """The same sky in draft quality at nine wavelengths."""
    text = re.sub(r"(?m)^(quality|wavelengths_nm) = .*\n", "", file.read_text())
    text = text.replace("[simulation]\n", '[simulation]\nquality = "draft"\n')
    grid = "wavelengths_nm = { first = 380, last = 780, step = 50 }"
    text = text.replace("[sampling]\n", f"[sampling]\n{grid}\n")
    for table in SIMS.glob("*.csv"):
        (folder / table.name).write_bytes(table.read_bytes())
    (folder / file.name).write_text(text)
    return folder / file.name


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_shipped_sky_gives_a_picture_of_its_planet(file, tmp_path, capsys):
    swept = load_campaign(file).swept.items()
    middle = [f"{name}={values[len(values) // 2]:g}" for name, values in swept]
    words = [word for one in middle for word in ("--set", one)]
    out = tmp_path / "sky.exr"
    options = ["--height", "48", "--sun-zenith-deg", "40", "--no-sun", "--precision", "float"]
    command = ["render", str(drafted(file, tmp_path)), *words, *options, "--gamut", "keep"]
    assert cli.run([*command, "--out", str(out), "--json"]) == 0
    assert file.name in json.loads(capsys.readouterr().out)["sky"]
    found, _ = read_exr(out)
    rgb, rays = np.stack([found[name] for name in "RGB"], axis=-1), Fisheye(48).rays()
    light = (rgb @ LUMINANCE)[rays.inside]
    assert np.isfinite(rgb).all()
    # By day luminances are hundreds to ten thousands of cd/m², brightest near the sun or horizon;
    # a degree from the sun dust of 1 to 2 µm sends hundreds of thousands.
    assert 100 < light.min() < light.max() < 1e6
    # On Mars, 320 times as bright as the darkest part of the sky.
    assert 2 < light.max() / light.min() < 500
    # Half way up on the side away from the sun.
    gamma = np.arccos(np.clip(rays.direction @ direction_of(SUN, np.pi), -1, 1))
    up = rays.direction[..., 2]
    away = (gamma > np.radians(75)) & (up > 0.5) & (up < 0.9) & rays.inside
    red, green, blue = rgb[away].mean(axis=0)
    if file.stem == "mars":  # butterscotch
        assert red > 1.5 * green
        assert green > 1.5 * blue
    elif file.stem == "alien_dense":  # its haze swallows blue
        assert green > blue
    elif file.stem == "desert_dust":  # pale
        assert 0.6 < blue / red < 1.5
    else:
        assert blue > 1.5 * red
