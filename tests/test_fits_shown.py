"""Fits of any parameters, and skies by a word, where the command line shows them."""

import json
from pathlib import Path

import numpy as np
import pytest

import skyfit
from skyfit import cli
from skyfit.compare import compare_skies
from skyfit.fitting import paper_refit
from skyfit.render import load_source
from skyfit.render.cameras import direction_of


OVER_TWO = Path(__file__).parent / "files" / "fit_over_two.json"  # cover 0 to 0.5, turbidity 2 to 6
VIEW, SUN = direction_of(0.8, 0.3), (0.9, 0.0)


def seen(source):
    return source.xyz(VIEW[None], *SUN)[0]


def test_a_source_takes_every_parameter_of_a_fit():
    both = load_source(OVER_TWO, parameters={"cover": 0.25, "turbidity": 3.0})
    want = skyfit.load_fit(OVER_TWO).sky(cover=0.25, turbidity=3.0)
    np.testing.assert_allclose(seen(both), want.xyz(VIEW, direction_of(*SUN)), rtol=1e-6)
    assert both.name == "fit_over_two.json, cover 0.25, turbidity 3"
    # Its turbidity is that of the air before the sun, and may be said as such.
    mixed = load_source(OVER_TWO, 3.0, parameters={"cover": 0.25})
    np.testing.assert_array_equal(seen(mixed), seen(both))
    light = skyfit.sun_xyY(3.0, SUN[0])
    assert both.sun_xyz(SUN[0])[1] == pytest.approx(float(light[2]), rel=1e-6)


def test_words_are_skies():
    refit = paper_refit().sky(turbidity=3.0).xyz(VIEW, direction_of(*SUN))
    for words in ({"turbidity": 3.0}, {"parameters": {"turbidity": 3.0}}):
        np.testing.assert_allclose(seen(load_source("refit", **words)), refit, rtol=1e-6)
        published = seen(load_source("published", **words))
        np.testing.assert_array_equal(published, seen(load_source(None, 3.0)))


@pytest.mark.parametrize(
    ("path", "words", "message"),
    [
        (OVER_TWO, {"turbidity": 3.0}, "over cover, turbidity; expected cover=VALUE"),
        (OVER_TWO, {}, "expected cover=VALUE, turbidity=VALUE"),
        (OVER_TWO, {"parameters": {"haze": 1.0}}, "values of cover, turbidity alone.*; got haze"),
        ("refit", {"turbidity": 3.0, "parameters": {"turbidity": 3.0}}, "one turbidity; got two"),
        (None, {"turbidity": 3.0, "parameters": {"haze": 3.0}}, "values of turbidity alone"),
        ("cornell", {"parameters": {"haze": 3.0}}, "cornell: expected no parameters"),
    ],
)
def test_a_source_refuses_other_parameters(path, words, message):
    with pytest.raises(skyfit.InputError, match=message):
        load_source(path, **words)


def test_fits_of_any_parameters_are_compared():
    rows = compare_skies(
        SUN[0], 3.0, fits={"mine": skyfit.load_fit(OVER_TWO)}, parameters={"cover": 0.6}, models=()
    )
    with pytest.warns(UserWarning, match="cover"):
        sky = skyfit.load_fit(OVER_TWO).sky(cover=0.6, turbidity=3.0)
    zenith = float(sky.xyY(SUN[0], 0.0, 0.0)[2])
    assert rows[0]["luminance"]["zenith"] == pytest.approx(zenith, rel=1e-9)
    assert rows[0]["outside"] == ["cover is valid from 0 to 0.5"]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (None, "mine is a fit over cover, turbidity; expected cover=VALUE"),
        ({"cover": 0.1, "haze": 1.0}, "turbidity apart; got haze"),
        ({"cover": 0.1, "turbidity": 3.0}, "turbidity apart; got turbidity"),
    ],
)
def test_a_comparison_refuses_other_parameters(parameters, message):
    fits = {"mine": skyfit.load_fit(OVER_TWO)}
    with pytest.raises(skyfit.InputError, match=message):
        compare_skies(SUN[0], 3.0, fits=fits, parameters=parameters, models=())


def test_the_commands_take_settings_and_words(tmp_path, capsys):
    out = str(tmp_path / "sky.exr")
    two = ["--set", "cover=0.2", "--set", "turbidity=4"]
    assert cli.run(["render", str(OVER_TWO), *two, "--height", "8", "--out", out, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["sky"].startswith("fit_over_two.json, cover 0.2, turbidity 4")
    out = str(tmp_path / "refit.exr")
    assert cli.run(["render", "refit", "--turbidity", "3", "--height", "8", "--out", out]) == 0
    assert "refit, turbidity 3" in capsys.readouterr().out
    for wrong in ("cover", "cover=", "=1", "cover=much", "cover=nan"):
        assert cli.run(["render", str(OVER_TWO), "--set", wrong, "--out", "s.png"]) == 2
        assert "expected NAME=VALUE with a number" in capsys.readouterr().err


def test_compare_takes_the_word_and_settings(monkeypatch):
    rows = []
    monkeypatch.setattr(
        skyfit, "compare_skies", lambda *at, **more: rows.append((at, more)) or [], raising=False
    )
    words = ["--fit", "refit", "--fit", str(OVER_TWO), "--set", "cover=0.2", "--json"]
    assert cli.run(["compare", "--sun-zenith-deg", "50", "--turbidity", "3", *words]) == 0
    ((_, more),) = rows
    assert list(more["fits"]) == ["refit", "fit_over_two.json"]
    assert more["fits"]["refit"] is paper_refit()
    assert more["parameters"] == {"cover": 0.2}
