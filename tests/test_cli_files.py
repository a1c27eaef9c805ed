"""Where results go: checked before the work, whole or not at all, and never lost."""

import io
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import pytest
import zarr
from model_skies import model_skies
from PIL import Image
from stand_in import stand_in

import skyfit
from skyfit import cli
from skyfit._files import alone, whole
from skyfit.dataset import runner


CAMPAIGN = """
schema = "skyfit/campaign/1"
[sweep]
turbidity = [2.0, 4.0]
[sampling]
sun_zenith_deg = [0.0, 40.0]
view_zenith_deg = [30.0]
relative_azimuth_deg = [0.0]
wavelengths_nm = [450.0, 600.0]
[simulation]
quality = "draft"
orders = 1
"""
FIT = str(Path(__file__).parent / "files" / "fit_schema_1.json")


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A home folder with a campaign in it; the simulator is fast and wrong."""
    monkeypatch.setattr(runner, "simulate", stand_in)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    (tmp_path / "other.toml").write_text(CAMPAIGN.replace("4.0", "5.0"))
    return tmp_path


def simulate(out, *more, campaign="c.toml"):
    return cli.run(["simulate", campaign, "--out", str(out), *more])


COMMANDS = {
    "simulate.nc": ["simulate", "c.toml"],
    "simulate.zarr": ["simulate", "c.toml"],
    "sky.h": ["export", "published", "--format", "c"],
    "sky.png": ["render", "--height", "8", "--view", "fisheye"],
    "sky.exr": ["render", "--height", "8"],
    "sky.hdr": ["render", "--height", "8"],
    "day.gif": ["render", "--height", "8", "--frames", "2", "--to-sun-zenith-deg", "50"],
}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_missing_folder_is_made_and_a_tilde_is_the_home_folder(home, name):
    assert cli.run([*COMMANDS[name], "--out", f"~/new/er/{name}"]) == 0
    assert [path.name for path in (home / "new" / "er").iterdir()] == [name]
    assert not (home / "~").exists()


@pytest.mark.parametrize("name", [name for name in COMMANDS if not name.startswith("simulate")])
def test_what_is_there_is_replaced_only_on_demand(home, name, capsys):
    file = home / name
    file.write_text("precious")
    assert cli.run([*COMMANDS[name], "--out", name]) == 2
    assert capsys.readouterr().err.endswith("exists already; give another name or --overwrite\n")
    assert file.read_text() == "precious"
    assert cli.run([*COMMANDS[name], "--out", name, "--overwrite"]) == 0
    assert file.read_bytes() != b"precious"
    # What a full disk has left is nothing to lose.
    file.write_bytes(b"")
    assert cli.run([*COMMANDS[name], "--out", name]) == 0
    assert file.stat().st_size > 100


@pytest.mark.parametrize("name", ["sky.nc", "sky.zarr"])
def test_another_campaigns_skies_are_replaced_only_on_demand(home, name, capsys):
    assert simulate(name, campaign="other.toml") == 0
    assert simulate(name) == 2
    assert "by another campaign; give another name or --overwrite" in capsys.readouterr().err
    assert skyfit.load_dataset(name)["turbidity"].values.tolist() == [2, 5]
    assert simulate(name, "--overwrite") == 0
    assert skyfit.load_dataset(name)["turbidity"].values.tolist() == [2, 4]
    there = {path.name for path in home.iterdir()} - {".cache"}  # of libraries
    assert there == {"c.toml", "other.toml", name}


def test_a_finished_file_that_has_lost_its_radiance_is_refused(home, capsys):
    assert simulate("sky.nc") == 0
    skyfit.load_dataset("sky.nc").drop_vars("radiance").to_netcdf("less.nc", engine="netcdf4")
    assert simulate("less.nc") == 2
    assert "less.nc: radiance: is missing, or not of the campaign's" in capsys.readouterr().err


@pytest.mark.filterwarnings("ignore:The data type")  # words in zarr 3
def test_a_store_whose_radiance_is_no_number_is_refused(home, capsys):
    assert simulate("sky.zarr") == 0
    group = zarr.open_group(home / "sky.zarr")
    shape, dims = group["radiance"].shape, group["radiance"].metadata.dimension_names
    group.create_array("radiance", shape=shape, dimension_names=dims, dtype="<U4", overwrite=True)
    assert simulate("sky.zarr") == 2
    error = capsys.readouterr().err
    assert error.startswith("skyfit: ")
    assert error.count("\n") == 1
    assert "sky.zarr: radiance: expected numbers; got <U4" in error


@pytest.mark.parametrize("name", ["c.nc", "c.zarr"])
def test_what_is_no_sky_dataset_is_never_replaced(home, name):
    (home / name).write_text("precious")
    assert simulate(name) == 2
    assert simulate(name, "--overwrite") == 2
    assert (home / name).read_text() == "precious"


def test_fits_are_replaced_only_on_demand(home, capsys, monkeypatch):
    fit = skyfit.load_fit(FIT)
    monkeypatch.setattr(skyfit, "fit_sky", lambda *_, **__: fit)
    skyfit.dataset.save_dataset(model_skies().assign_attrs(schema=skyfit.dataset.SCHEMA), "s.nc")
    command = ["fit", "s.nc", "--out", "new/fit.json"]
    assert cli.run(command) == 0
    assert cli.run(command) == 2
    assert "fit.json: exists already; give another name or --overwrite" in capsys.readouterr().err
    assert cli.run([*command, "--overwrite"]) == 0
    assert skyfit.load_fit("new/fit.json").channels == fit.channels


def test_what_is_no_fit_is_never_replaced_and_known_before_the_work(home, capsys, monkeypatch):
    monkeypatch.setattr(skyfit, "fit_sky", lambda *_, **__: pytest.fail("was fitted"))
    (home / "a.json").write_text("precious")
    assert cli.run(["fit", "s.nc", "--out", "a.json", "--overwrite"]) == 2
    assert "a.json: expected a fit in JSON" in capsys.readouterr().err
    assert (home / "a.json").read_text() == "precious"


def test_nothing_is_simulated_for_a_result_that_cannot_be_written(home, monkeypatch, capsys):
    monkeypatch.setattr(runner, "simulate", lambda **_: pytest.fail("was simulated"))
    (home / "file").write_text("a file")
    assert simulate("file/sky.nc") == 2
    assert "file/sky.nc: cannot be written; " in capsys.readouterr().err
    assert simulate("sky.txt", campaign="none.toml") == 2
    assert "sky.txt: expected a name ending in" in capsys.readouterr().err


def test_writing_that_fails_leaves_what_was_there(tmp_path):
    file = tmp_path / "a.json"
    file.write_text("whole")

    def half():
        with whole(file) as begun:
            begun.write_text("ha")
            raise OSError("no space")

    with pytest.raises(OSError, match="no space"):
        half()
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
    assert file.read_text() == "whole"


@pytest.mark.parametrize("name", ["sky.nc", "sky.zarr"])
def test_two_runs_into_one_store_are_told_so(home, name, capsys):
    with alone(home / name):
        assert simulate(name) == 2
    error = capsys.readouterr().err
    assert error == (
        f"skyfit: {home / name}: another run is writing to it; wait for it or give another name\n"
    )
    assert simulate(name) == 0


def test_a_run_that_was_killed_blocks_nobody(tmp_path):
    lock = f"with alone({str(tmp_path / 'a')!r}): print(1, flush=True); input()"
    words = f"from skyfit._files import alone\n{lock}"
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", words], stdin=pipe, stdout=pipe) as other:
        assert other.stdout is not None
        other.stdout.readline()
        with pytest.raises(ValueError, match="another run"), alone(tmp_path / "a"):
            pass
        other.kill()
    with alone(tmp_path / "a"):
        pass


# What drops the exception as a callback of the garbage collector does, and what hears nothing.
DEAF = {
    "collected": "import gc\ngc.callbacks.append(lambda *_: time.sleep(0.01))\n"
    "while True: gc.collect()",
    "dropped": "while True:\n try: time.sleep(9)\n except KeyboardInterrupt: pass",
    "heard": "time.sleep(99)",
    "in a thread": "t = threading.Thread(target=time.sleep, args=(99,)); t.start(); t.join()",
    "twice": "try: time.sleep(99)\nfinally: time.sleep(99)",
}


@pytest.mark.slow
@pytest.mark.parametrize("work", DEAF)
def test_an_interruption_ends_the_process_within_two_seconds(work):
    words = f"""
import threading, time
from skyfit.cli.interrupt import interrupted, leaving_at_once, on_interrupt
with leaving_at_once():
    try:
        with on_interrupt(lambda: "go on"):
            print(1, flush=True)
            {DEAF[work].replace(chr(10), chr(10) + 12 * " ")}
    except KeyboardInterrupt:
        interrupted()
"""
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", words], stdout=pipe, stderr=pipe) as run:
        assert run.stdout is not None
        run.stdout.readline()
        run.send_signal(signal.SIGINT)
        begun = time.monotonic()
        _, error = run.communicate(timeout=20)
        assert time.monotonic() - begun < 2
        assert run.returncode == 130
        assert error == b"skyfit: interrupted: go on\n"


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_no_terminal_costs_the_result(encoding, monkeypatch):
    for name in ("stdout", "stderr"):
        monkeypatch.setattr(sys, name, io.TextIOWrapper(io.BytesIO(), encoding=encoding))
    words = ["compare", "--sun-zenith-deg", "30", "--turbidity", "3", "--fit", FIT]
    monkeypatch.setattr(skyfit, "compare_skies", lambda *_, **__: ROWS)
    assert cli.run(words) == 0
    sys.stdout.flush()
    printed = sys.stdout.buffer.getvalue()  # type: ignore[attr-defined]
    assert b"5.41e-05" in printed


PLACES = ("zenith", "45 sun", "aside", "opposite", "85 aside")
ROWS = [
    {
        "model": "θ ≥ [/] 雲",
        "luminance": dict.fromkeys(PLACES, 5.41e-2),
        "sun_side_ratio": 2.0,
        "diffuse_illuminance": 5.41e-2,
        "chromaticity": {"zenith": (0.3, 0.3), "85 aside": (0.3, 0.3)},
        "white": "",
        "outside": [],
    }
]


@pytest.mark.parametrize("columns", ["20", "40", "80"])
def test_numbers_are_whole_however_narrow_the_terminal(columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setattr(skyfit, "compare_skies", lambda *_, **__: ROWS)
    assert cli.run(["compare", "--sun-zenith-deg", "90", "--turbidity", "3"]) == 0
    printed = capsys.readouterr().out
    assert printed.count("5.41e-05") == 6
    assert "…" not in printed
    assert "θ ≥ [/] 雲" in printed


def test_a_turbidity_that_is_not_used_is_said(home, capsys):
    warnings.simplefilter("always")
    assert cli.run(["render", "--turbidity", "60", "--height", "8", "--out", "s.png"]) == 0
    said = capsys.readouterr()
    assert said.err == (
        "skyfit: warning: --turbidity is valid from 1.9 to 10 and held there; got 60, and 10 is "
        "used\n"
    )
    assert "turbidity 60 taken as 10; sun" in said.out
    with Image.open("s.png") as picture:
        assert "turbidity 60 taken as 10; sun" in str(picture.info["Description"])
    assert cli.run(["render", "--help"]) == 0
    assert "3 where there is no SKY" in " ".join(capsys.readouterr().out.split())


def test_warnings_of_libraries_do_not_reach_users(capsys):
    cli.run(["--version"])  # shows warnings from now on
    for category in (RuntimeWarning, DeprecationWarning, FutureWarning):
        warnings.showwarning("overflow in exp", category, "a.py", 1)
    assert capsys.readouterr().err == ""
    warnings.showwarning("light is\nlost", UserWarning, "a.py", 1)
    assert capsys.readouterr().err == "skyfit: warning: light is lost\n"
