"""Fits of every rung of the ladder: known numbers back, held-out skies, files, refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
from model_skies import model_skies

from skyfit.cli import run
from skyfit.dataset import SCHEMA, save_dataset
from skyfit.fitting import Dependence, SkyFit, fit_sky, load_fit
from skyfit.judging import shape_error
from skyfit.models import preetham_sky
from skyfit.models.domes import Series


FILES = Path(__file__).parent / "files"
SMALL = Series((0.5,), (0, 2), (1.0,), (0.6,))
SUNS = np.radians([5.0, 25.0, 45.0, 60.0, 75.0])


@pytest.fixture(scope="module")
def skies():
    return model_skies(suns=SUNS)


@pytest.fixture(scope="module")
def series(skies):
    return fit_sky(skies, distribution=SMALL, dependence=Dependence(sun_degree=3))


@pytest.mark.slow
def test_a_fitted_sky_is_the_data(skies, series):
    for turbidity in (2.0, 6.0):
        one = skies.sel(turbidity=turbidity)
        view, azimuth = one["view_zenith"].values, one["relative_azimuth"].values
        sky = series.sky(turbidity=turbidity).xyY(SUNS[:, None], view, azimuth)
        inside = view < np.radians(85.1)
        error = (np.asarray(sky)[..., 2] / one["luminance"].values - 1)[:, inside]
        assert np.sqrt(np.mean(error**2)) < 2 * series.diagnostics["Y"].rms < 0.1


def test_its_shape_is_compared_like_any_sky(skies, series):
    error = shape_error(series, skies)
    assert 0 < error["Y"] < 0.1


@pytest.mark.slow
def test_the_command_fits_a_formula_and_says_how_sound_it_is(skies, tmp_path, capsys):
    save_dataset(skies.assign_attrs(schema=SCHEMA), tmp_path / "sky.nc")
    words = ["fit", str(tmp_path / "sky.nc"), "--distribution", "series", "--json"]
    out = tmp_path / "fit.json"
    assert run([*words, "--out", str(out)]) == 0
    record = json.loads(capsys.readouterr().out)
    fit = load_fit(out)
    assert not fit.linked
    assert fit.basis.num_terms == 2
    assert record["fit"]["Y"] == fit.diagnostics["Y"].rms
    assert record["positivity"]["locus_margin"] == fit.positivity.locus_margin


def test_a_file_brings_the_formula_back(series, tmp_path):
    series.save(tmp_path / "fit.json")
    back = load_fit(tmp_path / "fit.json")
    assert isinstance(back, SkyFit)
    np.testing.assert_array_equal(back.scale.numbers, series.scale.numbers)
    for name in ("x", "y", "Y"):
        for field in ("numbers", "standard_errors"):
            np.testing.assert_array_equal(getattr(back, field)[name], getattr(series, field)[name])
    for field in ("diagnostics", "positivity", "settings", "provenance", "parameter_range"):
        assert getattr(back, field) == getattr(series, field)
    at = (0.5, 0.9, 1.0)
    np.testing.assert_array_equal(
        back.sky(turbidity=4.0).rgb(*at), series.sky(turbidity=4.0).rgb(*at)
    )
    assert back.describe() == series.describe()


def test_a_file_of_the_first_schema_still_loads():
    fit = load_fit(FILES / "fit_schema_1.json")
    document = json.loads((FILES / "fit_schema_1.json").read_text())
    assert document["schema"] == "skyfit/fit/1"
    assert isinstance(fit, SkyFit)
    assert fit.positivity is None
    np.testing.assert_array_equal(fit.coefficients["Y"], document["coefficients"]["Y"])
    # It was made from the published model with noise of 1 %.
    at = (0.6, 0.5, 1.0)
    np.testing.assert_allclose(
        fit.sky(turbidity=3.0).xyY(*at), preetham_sky(3.0).xyY(*at), rtol=0.03
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d["formula"].pop("kind"), "key 'kind' is missing"),
        (lambda d: d["formula"].update(kind="HSV"), "formula.kind: expected a kind"),
        (lambda d: d["formula"]["distribution"].update(name="x"), "expected a distribution of"),
        (lambda d: d["formula"]["numbers"]["x"].pop(), r"formula.numbers.x: expected \(8, 12\)"),
        (lambda d: d["formula"]["scale"].update(numbers=["a"]), "formula.scale: numbers: "),
    ],
)  # fmt: skip
def test_a_broken_file_is_refused_by_name_and_key(series, tmp_path, change, message):
    path = tmp_path / "fit.json"
    series.save(path)
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))
    with pytest.raises(ValueError, match=message) as error:
        load_fit(path)
    assert str(error.value).startswith(str(path))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ({"distribution": "lambert"}, r"fit_sky\(distribution=...\): expected one of .*'lambert'"),
        ({"dependence": "cubic"}, r"fit_sky\(dependence=...\): expected one of .*'cubic'"),
        ({"channels": "HSV"}, r"fit_sky\(channels=...\): expected one of .*'HSV'"),
        ({"channels": "spectrum"}, "spectral bands need 'radiance'"),
        ({"distribution": 3}, r"fit_sky\(distribution=...\): expected a name or a distribution"),
        ({"dependence": 3}, r"fit_sky\(dependence=...\): expected a name or a Dependence"),
    ],
)
def test_what_is_no_choice_is_refused(skies, choice, message):
    with pytest.raises(ValueError, match=message):
        fit_sky(skies, **choice)
