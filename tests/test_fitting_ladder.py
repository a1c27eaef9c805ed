"""The ladder: what is left out is not seen, and errors are what they say."""

import json

import jax
import numpy as np
import pytest
from model_skies import model_skies, noisy

from skyfit.cli import run
from skyfit.dataset import SCHEMA, save_dataset
from skyfit.fitting import Dependence
from skyfit.fitting.channels import read_channels
from skyfit.fitting.choices import chosen_formula
from skyfit.fitting.fit import fit_formula
from skyfit.fitting.skies import read_skies
from skyfit.judging import colour_claim, ladder
from skyfit.judging.ladder import leave_out
from skyfit.models.domes import Series


SMALL = Series((0.5,), (0, 2), (1.0,), (0.6,))
LOW = Dependence(parameter_degree=1, sun_degree=1)
SUNS = np.radians([5.0, 25.0, 45.0, 60.0, 75.0])


@pytest.fixture(scope="module")
def skies():
    return noisy(model_skies(suns=SUNS), 0.01)


@pytest.fixture(scope="module")
def others():
    return model_skies(turbidities=(2.5, 5.0), suns=SUNS[1:3] + 0.1)


def test_every_inner_sun_and_value_is_left_out_once_and_no_end(skies):
    table = read_skies(skies)
    folds = np.array(list(leave_out(table)))
    at_end = np.isin(table.swept["turbidity"], (2.0, 6.0))
    ends = at_end & np.isin(table.sun_zenith, SUNS[[0, -1]])
    assert not folds[:, ends].any()
    inner_sun = np.isin(table.sun_zenith, SUNS[1:-1]) & np.isin(
        table.swept["turbidity"], (2.0, 6.0)
    )
    np.testing.assert_array_equal(folds[:, inner_sun].sum(0), 1)
    assert folds.any(0)[table.swept["turbidity"] == 3.5].all()
    with pytest.raises(ValueError, match="nothing to leave out"):
        list(leave_out(table.subset(ends)))


@pytest.mark.slow
def test_a_fit_does_not_see_what_is_left_out(skies):
    table = read_skies(skies)
    away = next(iter(leave_out(table)))
    spoiled = read_skies(skies)
    spoiled.values[:, away] *= np.linspace(0.5, 2.0, away.sum())[:, None]
    for shape, dependence in ((SMALL, LOW), ("perez", LOW), ("perez", "linear"), ("cie", "linear")):
        formula = chosen_formula(shape, dependence)
        fits = [fit_formula(data, formula, use=~away) for data in (table, spoiled)]
        for one, other in zip(*map(jax.tree.leaves, fits), strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9)


@pytest.mark.slow
def test_errors_are_those_of_a_loop_over_skies(skies, others):
    (rung,) = ladder(
        skies, held_out=others, distributions=(SMALL,), dependences=(LOW,), channels=("XYZ",)
    )
    fit = fit_formula(read_channels(skies, "XYZ"), chosen_formula(SMALL, LOW))
    inside = others["view_zenith"].values < np.radians(85.1)
    light, colour = [], []
    for turbidity in (2.5, 5.0):
        for sun in SUNS[1:3] + 0.1:
            one = others.sel(turbidity=turbidity, sun_zenith=sun).isel(direction=inside)
            at = sun, one["view_zenith"].values, one["relative_azimuth"].values
            x, _, luminance = np.moveaxis(np.asarray(fit.sky(turbidity=turbidity).xyY(*at)), -1, 0)
            light.append(luminance / one["luminance"].values - 1)
            colour.append(x - one["x"].values)
    assert rung.held_out["Y"].rms == pytest.approx(np.sqrt(np.mean(np.square(light))), rel=1e-6)
    assert rung.held_out["Y"].worst == pytest.approx(np.abs(light).max(), rel=1e-6)
    assert rung.held_out["x"].rms == pytest.approx(np.sqrt(np.mean(np.square(colour))), rel=1e-6)
    by_sun = np.sqrt([np.mean(np.square(light[k::2])) for k in (0, 1)])
    np.testing.assert_allclose([rms for _, rms in rung.held_out["Y"].by_sun], by_sun, rtol=1e-6)


@pytest.mark.slow
def test_unseen_skies_fit_worse_than_seen_ones(skies):
    (rung,) = ladder(skies, distributions=(SMALL,), dependences=(LOW,), channels=("RGB",))
    assert 0 < rung.fitted["Y"].rms < rung.held_out["Y"].rms < 0.5
    assert rung.held_out["Y"].worst >= rung.held_out["Y"].rms
    assert rung.coefficients == 8 * 4 + 3 * 5
    assert set(rung.held_out) == {"x", "y", "Y", "R", "G", "B"}


@pytest.mark.slow
def test_the_claim_about_colours_comes_with_numbers(skies, others):
    rungs = ladder(skies, held_out=others, distributions=("perez",), dependences=("linear",))
    claim = colour_claim(rungs)
    assert claim is not None
    assert f"X {100 * rungs[1].held_out['X'].rms:.1f} %" in claim
    assert claim.count("%") == 4
    assert colour_claim(rungs[:1]) is None


@pytest.mark.slow
def test_the_command_prints_the_ladder(skies, tmp_path, capsys):
    skies = skies.assign_attrs(schema=SCHEMA)
    save_dataset(skies, tmp_path / "sky.nc")
    words = ["ladder", str(tmp_path / "sky.nc"), "--distribution", "cie", "--channels", "Yxy"]
    assert run([*words, "--dependence", "linear", "--json"]) == 0
    (rung,) = json.loads(capsys.readouterr().out)["rungs"]
    assert rung["held_out"]["Y"]["rms"] < 0.5
    assert run([*words, "--dependence", "cubic"]) == 2
    assert "'--dependence': 'cubic' is not one of" in capsys.readouterr().err
