"""Fits of every rung of the ladder: known numbers back, held-out skies, files, refusals."""

import dataclasses
import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from model_skies import model_skies

from skyfit.cli import run
from skyfit.dataset import SCHEMA, save_dataset
from skyfit.export import export_fit
from skyfit.fitting import Dependence, SkyFit, fit_sky, load_fit, positivity
from skyfit.judging import compare_weights, shape_error
from skyfit.models import preetham_sky
from skyfit.models.domes import Series
from skyfit.models.perez import Perez
from skyfit.models.preetham import published_coefficients
from skyfit.plots.coefficients import coefficient_chart
from skyfit.report.coefficients import coefficient_table


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
        (lambda d: d["formula"].update(kind="HSV"), "kind: expected .*'RGB' or 'bands'; got"),
        (lambda d: d["formula"]["distribution"].update(name="x"), "name: expected 'perez', 'cie'"),
        (lambda d: d["formula"]["numbers"]["x"].pop(), r"formula.numbers.x: expected \(8, 12\)"),
        (lambda d: d["formula"]["scale"].update(numbers=["a"]), "scale.numbers.0: expected a list"),
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
    ],
)
def test_what_is_no_choice_is_refused(skies, choice, message):
    with pytest.raises(ValueError, match=message):
        fit_sky(skies, **choice)


@pytest.fixture(scope="module")
def over_two():
    """Skies over turbidity and a cover that takes light away and flattens the dome."""
    covers = [0.0, 0.5]
    one = model_skies(suns=SUNS[1:4])
    parts = [one.assign(luminance=one["luminance"] * (1 - cover)) for cover in covers]
    parts[1]["luminance"] = parts[1]["luminance"] * (1 + 0.1 * np.sin(one["view_zenith"]))
    return xr.concat(parts, xr.DataArray(covers, dims="cover", name="cover"))


@pytest.mark.slow
def test_a_fit_over_two_parameters_has_a_plane_of_coefficients(over_two, tmp_path):
    fit = fit_sky(over_two)
    assert fit.swept == {"cover": (0.0, 0.5), "turbidity": (2.0, 6.0)}
    assert fit.coefficients["Y"].shape == (5, 4)
    # Chromaticities do not depend on the cover: its product with turbidity, and itself, come first.
    want = published_coefficients()[0]
    np.testing.assert_allclose(fit.coefficients["x"][:, 2:], want, atol=1e-7)
    np.testing.assert_allclose(fit.coefficients["x"][:, :2], 0, atol=1e-7)
    dim = over_two.sel(cover=0.5, turbidity=3.5).isel(sun_zenith=1)
    view, azimuth = dim["view_zenith"].values, dim["relative_azimuth"].values
    inside = view < np.radians(85.1)
    got = np.asarray(fit.sky(turbidity=3.5, cover=0.5).xyY(SUNS[2], view, azimuth))[inside, 2]
    np.testing.assert_allclose(got, dim["luminance"].values[inside], rtol=0.05)
    assert fit.positivity.holds
    fit.save(tmp_path / "fit.json")
    back = load_fit(tmp_path / "fit.json")
    at = (0.5, 0.9, 1.0)
    np.testing.assert_array_equal(
        back.sky(turbidity=4.0, cover=0.1).rgb(*at), fit.sky(cover=0.1, turbidity=4.0).rgb(*at)
    )
    with pytest.raises(ValueError, match=r"expected the parameters \['cover', 'turbidity'\]; got"):
        fit.sky(turbidity=4.0)


def test_what_is_made_for_one_parameter_refuses_two(over_two):
    fit = fit_sky(over_two)
    with pytest.raises(ValueError, match="this one is over cover, turbidity"):
        _ = fit.parameter_name
    with pytest.raises(ValueError, match=r"coefficient_table\(fit=...\): expected Perez's form"):
        coefficient_table(fit)
    with pytest.raises(ValueError, match="expected a fit over one parameter"):
        coefficient_chart(fit)
    with pytest.raises(ValueError, match=r"expected one swept parameter; got \['cover', 'turb"):
        compare_weights(over_two)
    with pytest.raises(ValueError, match=r"\(parameter_range=...\): expected a fit over one"):
        positivity(fit, parameter_range=(0.0, 1.0))


def test_an_exported_sky_takes_both_parameters(over_two, tmp_path):
    fit = fit_sky(over_two)
    code = export_fit(fit, "python")
    names = {}
    exec(compile(code, "sky.py", "exec"), names)
    angles = np.cos(0.7), 0.5, 0.9
    got = names["sky_xyY_of_angles"](*angles, 0.3, 4.0)
    sky = fit.sky(cover=0.3, turbidity=4.0)
    azimuth = np.arccos((np.cos(0.5) - np.cos(0.7) * np.cos(0.9)) / (np.sin(0.7) * np.sin(0.9)))
    np.testing.assert_allclose(np.stack(got, -1), sky.xyY(0.9, 0.7, azimuth), rtol=1e-9)


@pytest.mark.slow
def test_a_fit_is_a_pytree_of_its_numbers(skies):
    fit = fit_sky(skies)

    @jax.jit
    def luminance(fit, turbidity):
        return fit.sky(turbidity=turbidity).xyY(0.5, 0.9, 1.0)[2]

    want = fit.sky(turbidity=3.0).xyY(0.5, 0.9, 1.0)[2]
    np.testing.assert_allclose(luminance(fit, 3.0), want, rtol=1e-12)
    slope = jax.grad(lambda fit: luminance(fit, 3.0))(jax.tree.map(jnp.asarray, fit))
    assert np.isfinite(slope.numbers["Y"]).all()
    assert np.abs(slope.numbers["Y"]).max() > 0
    with pytest.raises(AttributeError, match=r"sky\(...\).coefficients\(sun_zenith\)"):
        _ = dataclasses.replace(fit, linked=True).coefficients


def test_choices_are_values_not_spellings(skies):
    words = fit_sky(skies, distribution="perez", dependence="linear")
    values = fit_sky(skies, distribution=Perez(), dependence=Dependence("linear"))
    for one, other in zip(jax.tree.leaves(words), jax.tree.leaves(values), strict=True):
        np.testing.assert_array_equal(one, other)
    assert words.notes == values.notes


# What skies of the program that wrote the files were: suns, views and azimuths, and x, y, Y.
PLACES = ((0.6, 0.9, 1.0), (1.6, 1.2, 2.0))
OLD = {
    "polynomial": (
        {"turbidity": 3.0},
        [
            [0.25928470779765095, 0.26683900604926775, 10434.827120434942],
            [0.2774481922614479, 0.29583197917544823, 862.3646273754208],
        ],
    ),
    "nodes": (
        {"turbidity": 3.0},
        [
            [0.26067428658012565, 0.2900672796718434, 9844.70884006511],
            [0.3056698797285834, 0.3860216411501417, 991.2449875836412],
        ],
    ),
    "one": (
        {},
        [
            [0.2559475205936095, 0.264683566381738, 10482.98186956971],
            [0.30786629026081835, 0.33684833253787017, 650.1270481426101],
        ],
    ),
}


@pytest.mark.parametrize("name", OLD)
def test_formulas_of_the_second_schema_are_the_skies_they_were(name, tmp_path):
    fit = load_fit(FILES / f"fit_schema_2_{name}.json")
    swept, want = OLD[name]
    for place, colour in zip(PLACES, want, strict=True):
        np.testing.assert_allclose(fit.sky(**swept).xyY(*place), colour, rtol=1e-12)
    assert fit.positivity is not None
    fit.save(tmp_path / "new.json")
    assert load_fit(tmp_path / "new.json").describe() == fit.describe()


def test_a_broken_file_of_the_second_schema_is_refused_by_name_and_key(tmp_path):
    document = json.loads((FILES / "fit_schema_2_nodes.json").read_text())
    path = tmp_path / "fit.json"
    for change, message in (
        (
            lambda d: d.update(form="spline"),
            "form: expected 'published' or 'formula'; got 'spline'",
        ),
        (lambda d: d["formula"].pop("kind"), "key 'kind' is missing"),
        (lambda d: d["formula"]["dependence"].update(kind="x"), "expected a dependence of kind"),
        (lambda d: d["formula"]["numbers"]["R"].pop(), r"formula.numbers.R: expected \(5, 8\)"),
    ):
        broken = json.loads(json.dumps(document))
        change(broken)
        path.write_text(json.dumps(broken))
        with pytest.raises(ValueError, match=message) as error:
            load_fit(path)
        assert str(error.value).startswith(str(path))


@pytest.mark.slow
def test_bands_may_be_given_as_an_array():
    lam = np.arange(400.0, 701.0, 50.0)
    one = model_skies(turbidities=(3.0,)).isel(turbidity=0, drop=True)
    at = (
        one["sun_zenith"].values[:, None],
        one["view_zenith"].values,
        one["relative_azimuth"].values,
    )
    light = np.asarray(preetham_sky(3.0).radiance(*at, lam))
    data = xr.Dataset(
        {"radiance": (("sun_zenith", "direction", "wavelength"), light)},
        {**one.drop_vars(["x", "y", "luminance"]).coords, "wavelength": lam},
    )
    low = Dependence(sun_degree=1)
    fits = [
        fit_sky(data, distribution=SMALL, dependence=low, channels=bands)
        for bands in (np.array([450.0, 550.0]), [450.0, 550.0])
    ]
    assert fits[0].channels == ("450 nm", "550 nm")
    np.testing.assert_array_equal(fits[0].numbers["450 nm"], fits[1].numbers["450 nm"])
