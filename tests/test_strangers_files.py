"""Fits and datasets that no skyfit has written are refused, with the key and in one line."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from model_skies import model_skies

import skyfit
from skyfit.dataset import SCHEMA, load_dataset, save_dataset


FITS = Path(__file__).parent / "files"


@pytest.fixture(scope="module")
def documents(tmp_path_factory):
    """Fit files of this version, as they are in JSON: nodes, and the published form."""
    folder = tmp_path_factory.mktemp("fits")
    found = {}
    for name in ("fit_schema_2_nodes", "fit_schema_1"):
        skyfit.load_fit(FITS / f"{name}.json").save(folder / f"{name}.json")
        found[name] = (folder / f"{name}.json").read_text()
    return found


def changed(place, value):
    def change(document):
        *path, last = place
        for step in path:
            document = document[step]
        document[last] = value

    return change


@pytest.mark.parametrize(
    ("name", "place", "value", "message"),
    [
        ("nodes", ("ranges", "turbidity"), [6.0, 2.0], "turbidity: expected low, high; got 6, 2"),
        ("nodes", ("ranges", "turbidity"), [2.0, np.inf], "turbidity.1: "),
        ("nodes", ("ranges", "sun_zenith"), [0.0, 1.0], "sun_zenith is the sun's"),
        ("nodes", ("ranges", ""), [0.0, 1.0], "formula.ranges..*at least 1 character"),
        ("nodes", ("sun_zenith_range",), [0.1, 4.0], "sun_zenith_range.1: .*or equal to 3.14"),
        ("nodes", ("kind",), "XYZ", "expected .*'X', 'Y', 'Z'.*; got R, G, B"),
        ("nodes", ("kind",), "bands", "wavelengths: expected those of bands"),
        ("nodes", ("basis", 0, "nodes"), [4.0, 3.0, 2.0], "basis.0.nodes: expected increasing"),
        ("nodes", ("basis", 0, "kind"), "chebyshev", "basis.0"),
        ("nodes", ("basis", 0, "quantity"), "sun_zenith", "one axis for a quantity"),
        ("nodes", ("numbers", "R", 0, 0), np.nan, "numbers.R.0.0: "),
        ("nodes", ("numbers", "R", 0, 0), 10**400, "numbers.R.0.0: "),
        ("nodes", ("numbers", "R", 0, 0), True, "numbers.R.0.0: expected a number; got True"),
        ("nodes", ("scale", "numbers", 0), [[1.0]], "scale.numbers.0.0: expected a number"),
        ("nodes", ("scale", "night"), [True], "scale.night: expected 3; got 1"),
        ("nodes", ("linked",), "yes", "linked: expected a boolean; got 'yes'"),
        ("1", ("kind",), "RGB", "expected .*'R', 'G', 'B'.*; got x, y, Y"),
        ("1", ("scale", "kind"), "logarithm", "key 'basis' is missing"),
        ("1", ("distribution", "name"), "hosek", "expected 'perez', 'cie', 'hosek-wilkie' or"),
        ("1", ("basis", 0, "high"), -5.0, "expected low, high; got 2, -5"),
    ],
)  # fmt: skip
def test_a_fit_that_cannot_be_is_refused(documents, tmp_path, name, place, value, message):
    document = json.loads(documents[f"fit_schema_{'2_nodes' if name == 'nodes' else '1'}"])
    changed(("formula", *place), value)(document)
    file = tmp_path / "fit.json"
    file.write_text(json.dumps(document))
    with pytest.raises(skyfit.InputError, match=message) as refusal:
        skyfit.load_fit(file)
    assert str(refusal.value).startswith(f"{file}: ")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("text", ["", "[" * 100_000, '{"schema": ' + "9" * 5000 + "}", "\x00"])
def test_what_is_no_json_is_refused(tmp_path, text):
    (tmp_path / "fit.json").write_text(text)
    with pytest.raises(skyfit.InputError, match=r"fit\.json: "):
        skyfit.load_fit(tmp_path / "fit.json")


SKIES = model_skies().assign_attrs(schema=SCHEMA)


def one(name, value):
    """The skies with one number changed."""
    values = SKIES[name].values.copy()
    values.flat[1] = value
    return SKIES.assign({name: (SKIES[name].dims, values)})


@pytest.mark.parametrize(
    ("skies", "message"),
    [
        (one("x", 7.0), "x: expected -1 to 2; got 7"),
        (one("luminance", 1e30), "luminance: expected -1e+12 to 1e+12; got 1e+30"),
        (one("view_zenith", 4.0), "view_zenith: expected 0 to 3.14159; got 4"),
        (one("turbidity", 9.0), "turbidity: expected increasing values"),
        (SKIES.drop_vars("view_zenith"), "view_zenith is missing"),
        (SKIES.drop_vars("turbidity"), "turbidity: expected its values; got none"),
        (SKIES.drop_vars("luminance"), "expected a radiance or a luminance; got none"),
        (SKIES.isel(direction=slice(0)), "expected numbers; got float64 of shape"),
        (SKIES.assign(x=SKIES["x"].astype(str)), "x: expected numbers; got"),
        (SKIES.transpose("direction", ...), "expected dimensions that end in ('direction',)"),
        (SKIES.assign_attrs(versions="{"), "attribute 'versions': expected JSON; got '{'"),
        (SKIES.assign_attrs(schema=[1, 2]), "schema is array([1, 2]), expected"),
    ],
)
def test_skies_that_cannot_be_are_refused(tmp_path, skies, message):
    skies.to_netcdf(tmp_path / "skies.nc", engine="netcdf4")
    with pytest.raises(skyfit.InputError, match=re.escape(message)):
        load_dataset(tmp_path / "skies.nc")


@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_a_damaged_dataset_is_refused_in_one_line(tmp_path, suffix):
    path = tmp_path / f"skies{suffix}"
    save_dataset(SKIES, path)
    assert load_dataset(path).sizes["direction"] == SKIES.sizes["direction"]
    for file in [path] if suffix == ".nc" else sorted(path.rglob("x/zarr.json")):
        file.write_bytes(file.read_bytes()[:100])
    with pytest.raises(skyfit.InputError, match="is not a sky dataset, or is damaged") as refusal:
        load_dataset(path)
    assert "\n" not in str(refusal.value)


def test_a_dataset_is_measured_before_it_is_read(tmp_path):
    path = tmp_path / "skies.zarr"
    save_dataset(SKIES, path)
    for file in path.rglob("zarr.json"):
        record = json.loads(file.read_text())
        if record.get("dimension_names", [None])[-1] == "direction":
            record["shape"][-1] = 10**12
            file.write_text(json.dumps(record))
    with pytest.raises(skyfit.InputError, match=r"expected at most \d+ bytes; its arrays have"):
        load_dataset(path)
