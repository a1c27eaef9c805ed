"""Fit files: there and back, and what is refused."""

import json

import numpy as np
import pytest
from model_skies import model_skies

from skyfit.fitting import fit_sky, load_fit


@pytest.fixture(scope="module")
def fit():
    return fit_sky(model_skies())


@pytest.fixture
def saved(fit, tmp_path):
    path = tmp_path / "fit.json"
    fit.save(path)
    return path


def zenith(document):
    return document["formula"]["scale"]["numbers"]


def edited(path, change):
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))
    return path


@pytest.mark.slow
def test_a_fit_comes_back_equal(fit, saved):
    back = load_fit(saved)
    for name in ("x", "y", "Y"):
        np.testing.assert_array_equal(back.coefficients[name], fit.coefficients[name])
        np.testing.assert_array_equal(back.standard_errors[name], fit.standard_errors[name])
        np.testing.assert_array_equal(back.two_stage[name].line, fit.two_stage[name].line)
        for key, numbers in fit.zenith[name].items():
            np.testing.assert_array_equal(back.zenith[name][key], numbers)
    for name in ("diagnostics", "settings", "provenance", "parameter_range", "sun_zenith_range"):
        assert getattr(back, name) == getattr(fit, name)
    angles = (0.4, 0.7, 1.0)
    np.testing.assert_array_equal(
        back.sky(turbidity=3.0).xyY(*angles), fit.sky(turbidity=3.0).xyY(*angles)
    )


def test_a_file_says_what_it_is_and_where_it_is_from(saved):
    document = json.loads(saved.read_text())
    assert document["schema"] == "skyfit/fit/3"
    assert document["provenance"]["data"] == {"title": "skies of a model"}
    assert "jax" in document["provenance"]["versions"]
    assert document["formula"]["ranges"] == {"turbidity": [2.0, 6.0]}
    assert document["settings"]["weights"] == "equal"


def test_a_saved_fit_may_be_replaced_but_nothing_else(fit, saved, tmp_path):
    fit.save(saved)
    for content in ('{"schema": "other/1"}', "[1, 2]", "not json at all"):
        other = tmp_path / "notes.json"
        other.write_text(content)
        with pytest.raises(ValueError, match=r"notes\.json: "):
            fit.save(other)
        assert other.read_text() == content


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.update(schema="skyfit/fit/9"), "schema is 'skyfit/fit/9', expected"),
        (lambda d: d.pop("schema"), "schema is 'missing', expected"),
        (lambda d: d["formula"].pop("scale"), "key 'scale' is missing"),
        (lambda d: d.update(formula="x"), "formula: expected an object; got 'x'"),
        (lambda d: d["formula"]["ranges"].update(turbidity=[6, 2]), "expected low, high; got 6"),
        (lambda d: d["formula"]["basis"][0].update(quantity="x"), r"expected quantities of .*'x'"),
        (lambda d: d["formula"]["scale"].update(quantity="x"), r"expected quantities of .*'x'"),
        (lambda d: d["formula"]["numbers"].pop("x"), "key 'x' is missing"),
        (lambda d: d["formula"]["numbers"]["Y"].pop(), r"numbers.Y: expected \(5, 2\) numbers"),
        (lambda d: zenith(d)["Y"].update(angle=[1.0]), r"Y.angle: expected \(2,\) numbers"),
        (lambda d: d["formula"]["numbers"].update(y=[["a", 1]]), "y.0.0: expected a number; got"),
    ],
)  # fmt: skip
def test_a_broken_file_is_refused_by_name_and_key(saved, change, message):
    with pytest.raises(ValueError, match=message) as error:
        load_fit(edited(saved, change))
    assert str(error.value).startswith(str(saved))


def test_what_is_no_json_is_refused(tmp_path):
    path = tmp_path / "fit.json"
    path.write_text("PK\x03\x04")
    with pytest.raises(ValueError, match=r"fit\.json: expected a fit in JSON"):
        load_fit(path)


@pytest.mark.parametrize(
    ("swept", "message"),
    [
        ({}, r"expected the parameters \['turbidity'\]; got \[\]"),
        ({"albedo": 0.1}, r"expected the parameters \['turbidity'\]; got \['albedo'\]"),
        ({"turbidity": np.nan}, r"SkyFit.sky\(turbidity=...\) must be a number; got nan"),
    ],
)
def test_a_sky_is_asked_for_by_its_parameter(fit, swept, message):
    with pytest.raises(ValueError, match=message):
        fit.sky(**swept)
