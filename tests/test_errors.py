"""How mistakes are answered in Python: files that are not there, values that cannot be."""

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
