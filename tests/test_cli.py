"""The command line: exit status, one line for a mistake, JSON on request, interruptions."""

import json
import re
import subprocess
import sys
from pathlib import Path

import click
import numpy as np
import pytest
from stand_in import stand_in

import skyfit
from skyfit import cli
from skyfit.dataset import runner


pytestmark = pytest.mark.any_precision


CAMPAIGN = """
schema = "skyfit/campaign/1"
[sweep]
turbidity = [2, 4]
[sampling]
sun_zenith_deg = [10, 40, 70]
view_zenith_deg = [30, 60, 85]
relative_azimuth_deg = [0, 90, 180]
wavelengths_nm = [450, 550, 650]
"""


@pytest.fixture
def campaign(tmp_path, monkeypatch):
    """A small campaign file, and a simulator that costs nothing."""
    monkeypatch.setattr(runner, "simulate", stand_in)
    file = tmp_path / "small.toml"
    file.write_text(CAMPAIGN)
    return file


def mistake(capsys, *arguments):
    """Run what must be refused; return the one line on standard error."""
    assert cli.run([str(argument) for argument in arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("skyfit: ")
    assert printed.err.count("\n") == 1
    return printed.err


@pytest.mark.slow
def test_simulate_writes_the_campaign_of_the_file(campaign, tmp_path, capsys):
    store = tmp_path / "sky.zarr"
    assert cli.run(["simulate", str(campaign), "--out", str(store)]) == 0
    assert "skies        6" in capsys.readouterr().out
    assert skyfit.load_dataset(store).sizes["direction"] == 10


def test_simulate_prints_json_on_request(campaign, tmp_path, capsys):
    store = tmp_path / "sky.nc"
    assert cli.run(["simulate", str(campaign), "--out", str(store), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    counted = {"skies": 6, "directions": 10, "wavelengths": 3}
    assert printed == {"out": str(store), **counted, "error_estimate": None}


def test_an_interrupted_simulation_says_how_to_go_on_and_does(
    campaign, tmp_path, capsys, monkeypatch
):
    store = tmp_path / "sky.zarr"
    calls = []

    def stopped(*arguments, **options):
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return stand_in(*arguments, **options)

    monkeypatch.setattr(runner, "simulate", stopped)
    assert cli.run(["simulate", str(campaign), "--out", str(store)]) == 130
    error = capsys.readouterr().err
    assert f"interrupted: 3 of 6 skies are in {store}; the same command continues" in error
    assert cli.run(["simulate", str(campaign), "--out", str(store)]) == 0
    assert len(calls) == 3
    assert skyfit.load_dataset(store).sizes["turbidity"] == 2


@pytest.mark.slow
def test_fit_prints_the_refit_beside_the_published_coefficients(campaign, tmp_path, capsys):
    store, out = tmp_path / "sky.nc", tmp_path / "fit.json"
    assert cli.run(["simulate", str(campaign), "--out", str(store)]) == 0
    capsys.readouterr()
    assert cli.run(["fit", str(store), "--out", str(out), "--json"]) == 0
    table = json.loads(capsys.readouterr().out)["coefficients"]
    # Preetham et al. (1999), appendix A.2.
    assert table["Y"]["A"]["intercept"]["published"] == -1.4630
    fit = skyfit.load_fit(out)
    assert table["x"]["D"]["slope"]["refit"] == fit.coefficients["x"][3, 0]
    out.unlink()
    assert cli.run(["fit", str(store), "--out", str(out), "--compare-weights"]) == 0
    printed = capsys.readouterr().out
    assert "published" in printed
    assert "-1.463" in printed
    assert "Weights equal, residuals relative:" in printed
    for channel, found in fit.diagnostics.items():
        line = next(line for line in printed.splitlines() if line.startswith(f"{channel}  "))
        assert f"RMS {found.rms:.2%}, worst {found.worst:.0%}, condition number" in line
        for combination in found.unidentified:
            assert f"not determined by the skies: {combination}" in printed
    # What each choice of weights does, with no number cut.
    weights = printed[printed.index("Coefficients by weights") :]
    slope, intercept = fit.coefficients["Y"][1]
    assert re.search(rf"Y B +{slope:.3g}, {intercept:.3g} ", weights)
    assert "Y RMS solid angle " in weights
    assert "…" not in weights


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["simulate", "{campaign}"], "Missing option '--out'"),
        (["simulate", "--out", "s.zarr"], "Missing argument 'CAMPAIGN'"),
        (["simulate", "none.toml", "--out", "s.zarr"], "none.toml: No such file or directory"),
        (["simulate", "{campaign}", "--out", "s.txt"], "s.txt: expected a name ending in .zarr"),
        (["simulate", "{campaign}", "--out", "s.nc", "--workers", "0"], "'--workers': 0 is not"),
        (["simulate", "{campaign}", "--out", "s.nc", "--wokers", "2"], "No such option"),
        (["fit", "none.zarr", "--out", "fit.json"], "none.zarr: No such file or directory"),
        (["fit", "{campaign}", "--out", "fit.json"], "expected a name ending in .zarr or .nc"),
        (
            ["fit", "none.zarr", "--out", "{campaign}"],
            "small.toml: exists already; give another name or --overwrite",
        ),
        (["reproduce", "--out", "{campaign}"], "small.toml: exists and is not a directory"),
        (["paint"], "No such command 'paint'"),
    ],
)
def test_a_mistake_is_answered_with_status_2_and_one_line(
    campaign, capsys, arguments, message, monkeypatch
):
    monkeypatch.chdir(campaign.parent)
    filled = [word.format(campaign=campaign) for word in arguments]
    assert message in mistake(capsys, *filled)


def test_a_wrong_key_is_answered_with_the_file_and_the_key(campaign, tmp_path, capsys):
    campaign.write_text(CAMPAIGN.replace("sun_zenith_deg", "sun_elevation_deg"))
    line = mistake(capsys, "simulate", campaign, "--out", tmp_path / "sky.zarr")
    assert f"{campaign}: sampling.sun_elevation_deg: unknown key" in line


def test_a_store_of_another_campaign_is_refused(campaign, tmp_path, capsys):
    store = tmp_path / "sky.zarr"
    assert cli.run(["simulate", str(campaign), "--out", str(store)]) == 0
    capsys.readouterr()
    campaign.write_text(CAMPAIGN.replace("[2, 4]", "[2, 5]"))
    line = mistake(capsys, "simulate", campaign, "--out", store)
    assert "was made by another campaign; give another name" in line


def test_a_foreign_directory_is_not_taken_for_a_report(tmp_path, capsys):
    (tmp_path / "thesis.tex").write_text("precious")
    line = mistake(capsys, "reproduce", "--out", tmp_path)
    assert "holds something else" in line
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_bug_is_admitted_with_status_1_and_no_traceback(campaign, tmp_path, capsys, monkeypatch):
    def broken(*_, **__):
        raise TypeError("unsupported operand")

    monkeypatch.setattr(runner, "simulate", broken)
    assert cli.run(["simulate", str(campaign), "--out", str(tmp_path / "sky.nc")]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "internal error: TypeError: unsupported operand (test_cli.py:" in error
    assert error.endswith("; set SKYFIT_TRACEBACK=1 for the traceback\n")
    monkeypatch.setenv("SKYFIT_TRACEBACK", "1")
    assert cli.run(["simulate", str(campaign), "--out", str(tmp_path / "sky.nc")]) == 1
    error = capsys.readouterr().err
    assert error.startswith("Traceback (most recent call last)")
    assert 'raise TypeError("unsupported operand")' in error


def test_an_error_of_numpy_inside_is_no_mistake_of_the_users(
    campaign, tmp_path, capsys, monkeypatch
):
    def broken(*_, **__):
        return np.zeros(2) + np.zeros(3)  # a ValueError

    monkeypatch.setattr(runner, "sky_variables", broken)
    assert cli.run(["simulate", str(campaign), "--out", str(tmp_path / "sky.nc")]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "internal error: ValueError: operands could not be broadcast together" in error


def test_every_command_explains_itself(capsys):
    for command in ("simulate", "fit", "export", "reproduce"):
        assert cli.run([command, "--help"]) == 0
        assert "--json" in capsys.readouterr().out


@pytest.mark.slow
def test_the_installed_program_runs():
    program = Path(sys.executable).with_name("skyfit")
    start = [str(program)] if program.exists() else [sys.executable, "-c", "from skyfit.cli import "
             "main; main()"]  # fmt: skip
    done = subprocess.run([*start, "fit", "--out", "f"], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == "skyfit: Missing argument 'SKY'.\n"


def test_without_a_command_the_help_is_printed_whole(capsys):
    assert cli.run([]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("Usage: skyfit")
    assert all(f"\n  {name} " in printed for name in cli.commands.commands)


@pytest.mark.slow
def test_the_package_runs_as_a_module():
    run = subprocess.run(
        [sys.executable, "-m", "skyfit", "--version"], capture_output=True, text=True, check=True
    )
    assert run.stdout.strip().endswith(skyfit.__version__)


@pytest.mark.parametrize("name", sorted(cli.commands.commands))
def test_help_has_a_sentence_for_each_option_and_an_example(name, capsys):
    command = cli.commands.commands[name]
    options = [one for one in command.params if isinstance(one, click.Option)]
    for option in options:
        # A noun or a verb first, not "of a", "as for"; and a full stop.
        assert re.match(r"[A-Z]", option.help or ""), option.name
        assert not re.match(r"(Of|As|For|In) ", option.help), option.name
        assert option.help.endswith("."), option.name
    assert cli.run([name, "--help"]) == 0
    printed = capsys.readouterr().out
    assert f"\n  skyfit {name} " in printed
    # The short help beside the command's name is not cut.
    assert len(command.get_short_help_str(200)) <= 60
