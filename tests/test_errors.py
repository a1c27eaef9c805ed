"""How mistakes are answered in Python: files that are not there, values that cannot be."""

import re
from pathlib import Path

import numpy as np
import pytest

import skyfit


SIMS = Path(__file__).parent.parent / "sims"
LOADERS = {
    "load_campaign": (skyfit.load_campaign, "none.toml"),
    "load_atmosphere": (skyfit.load_atmosphere, "none.toml"),
    "load_dataset, zarr": (skyfit.load_dataset, "none.zarr"),
    "load_dataset, nc": (skyfit.load_dataset, "none.nc"),
    "load_fit": (skyfit.load_fit, "none.json"),
    "load_elevation, npz": (skyfit.render.load_elevation, "none.npz"),
    "load_elevation, tif": (skyfit.render.load_elevation, "none.tif"),
    "load_source, toml": (skyfit.render.load_source, "none.toml"),
    "load_source, json": (skyfit.render.load_source, "none.json"),
    "load_source, nc": (skyfit.render.load_source, "none.nc"),
}


@pytest.mark.parametrize("kind", [str, Path])
@pytest.mark.parametrize(("load", "name"), LOADERS.values(), ids=LOADERS)
def test_a_missing_file_is_file_not_found_everywhere(tmp_path, load, name, kind):
    with pytest.raises(FileNotFoundError) as caught:
        load(kind(tmp_path / name))
    assert str(caught.value.filename) == str(tmp_path / name)


def test_loaders_take_names_as_strings():
    fit = str(SIMS / "cornell_2013.fit.json")
    assert skyfit.load_fit(fit).sky() is not None
    assert skyfit.load_campaign(str(SIMS / "mars.toml")) == skyfit.load_campaign(SIMS / "mars.toml")
    assert skyfit.load_atmosphere(str(SIMS / "preetham1999.toml")).wavelengths.size == 41
    assert skyfit.render.load_source("cornell", sun_zenith=np.radians(48.9379)).name.startswith(
        "Ithaca"
    )


def air(**changes):
    return skyfit.Atmosphere(**{"wavelengths": [500.0], "solar_irradiance": 1.0} | changes)


MISTAKES = {
    "atmosphere": lambda: air(constituents=()),
    "campaign": lambda: skyfit.Campaign(orders=0),
    "directions": lambda: skyfit.Campaign(view_zenith=[9.0], relative_azimuth=[0.0]),
    "ending": lambda: skyfit.load_dataset("skies.csv"),
    "air of too low a turbidity": lambda: skyfit.preetham_atmosphere(0.5),
    "turbidity": lambda: skyfit.turbidity.meteorological_range(0.5),
    "profile": lambda: skyfit.profile.Exponential(-1.0),
    "camera": lambda: skyfit.render.Fisheye(4, "round"),
    "aerial": lambda: skyfit.aerial_perspective(0.5, None, 0.5),
}


@pytest.mark.parametrize("mistake", MISTAKES.values(), ids=MISTAKES)
def test_what_skyfit_refuses_is_an_input_error_and_a_value_error(mistake):
    with pytest.raises(skyfit.InputError):
        mistake()
    assert issubclass(skyfit.InputError, ValueError)


def test_a_mistake_in_a_campaign_file_names_the_file(tmp_path):
    (tmp_path / "wrong.toml").write_text('schema = "skyfit/campaign/1"\n[sweep]\nturbidity = 0.5\n')
    with pytest.raises(skyfit.InputError, match=r"wrong.toml: sweep.turbidity\[0\]: .* 1; got 0.5"):
        skyfit.load_campaign(tmp_path / "wrong.toml")


def test_an_error_inside_a_loader_is_not_passed_off_as_the_files(tmp_path, monkeypatch):
    def broken(*_, **__):
        raise ValueError("inside")

    monkeypatch.setattr(skyfit.Campaign, "build_atmosphere", broken)
    with pytest.raises(ValueError, match=r"^inside$"):
        skyfit.load_campaign(SIMS / "mars.toml")


def test_every_check_of_skyfits_own_raises_an_input_error():
    root = Path(skyfit.__file__).parent
    # A table of skyfit's own that cannot be read is no user's mistake.
    files = [path for path in root.rglob("*.py") if path.name != "tables.py"]
    assert len(files) > 100
    plain = re.compile(r"^\s+raise ValueError\(", re.MULTILINE)
    assert [path.name for path in files if plain.search(path.read_text())] == []
