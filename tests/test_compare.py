"""The table of models: its figures, its rows, and that README shows what the command prints."""

import json
import re
import shlex
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from model_skies import model_skies

import skyfit
from skyfit import cli
from skyfit.compare import compare_skies
from skyfit.compare.figures import VIEWS
from skyfit.compare.models import MODELS, Entry
from skyfit.fitting import paper_refit


SUN = np.radians(50.0)
PUBLISHED = [entry for entry in MODELS if entry.name == "Preetham 1999, published"]
README = Path(__file__).parent.parent / "README.md"


class UniformSky:
    """Of 1000 cd/m² everywhere, for suns up to 60° from the zenith."""

    valid_range = {"sun_zenith": (0.0, np.pi / 3), "turbidity": (2.0, 4.0)}  # noqa: RUF012

    def xyY(self, sun_zenith, view_zenith, relative_azimuth):
        return np.stack([0 * view_zenith + 0.3, 0 * view_zenith + 0.32, 0 * view_zenith + 1000], -1)


UNIFORM = (Entry("uniform", lambda at: UniformSky()),)


def test_luminances_and_chromaticities_are_those_of_the_model():
    (row,) = compare_skies(SUN, 3.0, models=PUBLISHED)
    sky = skyfit.preetham_sky(3.0)
    x, y, zenith = np.asarray(sky.xyY(SUN, 0.0, 0.0))
    assert row["luminance"]["zenith"] == pytest.approx(zenith, rel=1e-12)
    np.testing.assert_allclose(row["chromaticity"]["zenith"], [x, y], rtol=1e-12)
    sides = np.asarray(sky.xyY(SUN, np.radians(45.0), np.array([0.0, np.pi])))[:, 2]
    assert row["sun_side_ratio"] == pytest.approx(sides[0] / sides[1], rel=1e-12)
    horizon = sky.xyY(SUN, np.radians(85.0), np.pi / 2)
    np.testing.assert_allclose(row["chromaticity"]["horizon"], horizon[:2], rtol=1e-12)
    assert row["outside"] == []


def test_a_uniform_sky_lights_the_ground_with_pi_times_its_luminance():
    (row,) = compare_skies(SUN, 3.0, models=UNIFORM)
    assert row["diffuse_illuminance"] == pytest.approx(np.pi * 1000, rel=1e-12)


@pytest.mark.parametrize("sun_deg", [0.0, 50.0, 88.0])
def test_the_light_on_the_ground_is_that_of_many_directions(sun_deg):
    sun = np.radians(sun_deg)
    (row,) = compare_skies(sun, 3.0, models=PUBLISHED)
    # One million small pieces of the dome, each by its cosine and its solid angle
    view = (np.arange(1000) + 0.5)[:, None] * np.pi / 2000
    azimuth = (np.arange(1000) + 0.5) * np.pi / 500
    luminance = np.asarray(skyfit.preetham_sky(3.0).xyY(sun, view, azimuth))[..., 2]
    slow = np.sum(luminance * np.cos(view) * np.sin(view)) * (np.pi / 2000) * (np.pi / 500)
    assert row["diffuse_illuminance"] == pytest.approx(slow, rel=5e-4)


def test_conditions_out_of_a_models_range_are_named():
    (row,) = compare_skies(1.2, 5.0, models=UNIFORM)
    assert row["outside"] == [
        "turbidity is valid from 2 to 4",
        "sun is valid from 0 to 60 degrees",
    ]
    assert compare_skies(np.pi / 3, 4.0, models=UNIFORM)[0]["outside"] == []


def test_a_black_sky_has_no_ratio():
    (row,) = compare_skies(np.pi, 3.0, models=PUBLISHED)
    assert row["luminance"]["opposite"] < 1e-30
    assert row["sun_side_ratio"] is None or row["sun_side_ratio"] > 0


def test_a_model_whose_package_is_missing_is_left_out():
    missing = Entry("of a package", lambda at: UniformSky(), package="not_installed_anywhere")
    assert compare_skies(SUN, 3.0, models=[missing, *UNIFORM])[0]["model"] == "uniform"


@pytest.mark.slow
def test_fits_are_rows():
    fit = skyfit.fit_sky(model_skies())
    rows = compare_skies(SUN, 3.0, fits={"mine": fit}, models=PUBLISHED)
    assert [row["model"] for row in rows] == ["Preetham 1999, published", "mine"]
    # A fit of the published model's skies is that model.
    for name, value in rows[0]["luminance"].items():
        assert rows[1]["luminance"][name] == pytest.approx(value, rel=1e-4)


def test_suns_and_turbidities_out_of_range_are_refused():
    with pytest.raises(ValueError, match=r"sun_zenith=...\) must lie in \[0, pi\]; got -1"):
        compare_skies(-1.0, 3.0, models=UNIFORM)
    with pytest.raises(ValueError, match=r"turbidity=...\) must be 1 or more; got 0.5"):
        compare_skies(SUN, 0.5, models=UNIFORM)


@pytest.mark.slow
def test_orders_of_a_simulation_add_up():
    rows = {row["model"]: row["luminance"] for row in compare_skies(SUN, 3.0)}
    orders = [
        rows[f"simulated, {name}"] for name in ("single scattering", "two orders", "all orders")
    ]
    for view in VIEWS:
        assert 0 < orders[0][view] < orders[1][view] < orders[2][view]
    # 550 nm in the paper's haze away from the sun: one order has 0.5 to 0.75 of all light, two
    # have 0.75 to 0.97.
    assert 0.4 < orders[0]["opposite"] / orders[2]["opposite"] < 0.75
    assert 0.75 < orders[1]["opposite"] / orders[2]["opposite"] < 0.97


@pytest.mark.slow
def test_the_refit_is_near_the_simulation_it_was_made_from():
    rows = {row["model"]: row for row in compare_skies(SUN, 3.0)}
    refit, simulated = rows["refit of the paper's form"], rows["simulated, two orders"]
    # The form follows the shape of this sky within some percent, the zenith within some more.
    for view in VIEWS:
        assert refit["luminance"][view] == pytest.approx(simulated["luminance"][view], rel=0.15)
    for place, chromaticity in refit["chromaticity"].items():
        np.testing.assert_allclose(chromaticity, simulated["chromaticity"][place], atol=0.012)


def test_the_refit_that_is_shipped_is_of_the_papers_campaign():
    fit = paper_refit()
    campaign = json.loads(fit.provenance["data"]["campaign"])
    for name in ("turbidity", "sun_zenith", "view_zenith", "relative_azimuth", "wavelengths"):
        np.testing.assert_allclose(campaign[name], getattr(skyfit.Campaign(), name), rtol=1e-12)
    assert (campaign["orders"], campaign["quality"]) == (2, "default")


def run(capsys, *arguments):
    assert cli.run(["compare", *map(str, arguments)]) == 0
    return capsys.readouterr().out


def test_the_readme_shows_what_the_command_prints(capsys):
    (command, shown) = re.search(
        r"```sh\nskyfit (compare [^\n]*)\n```\n+```text\n(.*?)```", README.read_text(), re.DOTALL
    ).groups()
    printed = run(capsys, *shlex.split(command)[1:])
    number = r"\d+\.\d+"
    assert re.sub(rf" *{number}", " N", printed) == re.sub(rf" *{number}", " N", shown)
    # Other machines round the last digit otherwise.
    found, want = (np.array(re.findall(number, text), float) for text in (printed, shown))
    np.testing.assert_allclose(found, want, rtol=0.011)


def test_json_has_the_rows(capsys):
    printed = json.loads(run(capsys, "--sun-zenith-deg", 50, "--turbidity", 3, "--json"))
    assert printed["turbidity"] == 3.0
    assert [row["model"] for row in printed["skies"]] == [
        entry.name for entry in MODELS if not entry.package or find_spec(entry.package)
    ]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--turbidity", "3"], "Missing option '--sun-zenith-deg'"),
        (["--sun-zenith-deg", "200", "--turbidity", "3"], "'--sun-zenith-deg': 200"),
        (["--sun-zenith-deg", "20", "--turbidity", "0.5"], "'--turbidity': 0.5"),
        (["--sun-zenith-deg", "20", "--turbidity", "3", "--fit", "no.json"], "no.json"),
    ],
)
def test_mistakes_are_named(arguments, message, capsys):
    assert cli.run(["compare", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
