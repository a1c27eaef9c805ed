"""The benchmarks: that they measure what they say. No figure of speed is tested."""

import json

import numpy as np
import pytest

import skyfit
from skyfit import cli
from skyfit.benchmark import run
from skyfit.benchmark.case import Case, measure


TINY = Case(1, quality="draft", suns=2, rings=2, spokes=3, wavelengths=4, repeats=2)


def pretend(case):
    """A record as of a process; the radiance 1, and 1 % off at the horizon side."""
    if case.keep:
        light = np.ones((case.suns, 1 + case.rings * case.spokes, case.wavelengths))
        if case.quality != "high":
            light[:, np.degrees(case.directions()[0]) > 80] = 1.01
        np.save(case.keep, light)
    record = {"compile_s": 3.0, "run_s": 1.2, "processor_s": 2.4, "peak_mib": 500.0}
    return record | {f"gradient_{name}": 2 * value for name, value in record.items()}


def test_a_case_counts_its_values_and_keeps_its_radiance(tmp_path):
    file = str(tmp_path / "light.npy")
    record = measure(TINY._replace(keep=file))
    light = np.load(file)
    assert light.size == TINY.values == 2 * 7 * 4
    assert record["compile_s"] > record["run_s"] > 0
    atmosphere = skyfit.preetham_atmosphere(
        4.0, wavelengths=np.linspace(380.0, 780.0, 4), ground_albedo=0.2
    )
    view, azimuth = TINY.directions()
    suns = np.radians([0.0, 85.0])[:, None]
    sky = skyfit.simulate(atmosphere, suns, view, azimuth, orders=1, quality="draft")
    np.testing.assert_allclose(light, sky.radiance, rtol=1e-12)


def test_a_case_runs_in_a_process_of_its_own_precision():
    record = run._in_fresh_process(TINY._replace(precision=32, repeats=1))
    assert record["run_s"] > 0


def test_a_case_that_fails_says_why():
    with pytest.raises(RuntimeError, match="quality"):
        run._in_fresh_process(TINY._replace(quality="perfect"))


def test_rows_are_per_sky_and_per_value_with_errors_against_high_quality(monkeypatch):
    monkeypatch.setattr(run, "_in_fresh_process", pretend)
    record = skyfit.run_benchmarks([2, None], [64], gradient=True, scaling=True)
    two, every = record["skies"]
    assert (two["orders"], every["orders"]) == (2, "all")
    assert two["s_per_sky"] == pytest.approx(0.1)
    assert two["ns_per_value"] == pytest.approx(1e9 * 1.2 / (12 * 343 * 41))
    assert two["error_to_75_deg"] == 0.0
    assert two["error_at_85_deg"] == pytest.approx(0.01)
    assert record["gradient"][0]["ratio"] == pytest.approx(2.0)
    assert {row["axis"] for row in record["scaling"]} == {"wavelengths", "rings", "suns", "orders"}


def test_the_command_prints_tables_or_json(monkeypatch, capsys):
    monkeypatch.setattr(run, "_in_fresh_process", pretend)
    arguments = ["benchmarks", "--orders", "2", "--precision", "64", "--gradient", "--scaling"]
    assert cli.run(arguments) == 0
    printed = capsys.readouterr().out
    for title in ("343 directions", "Gradient by every number", "Growth"):
        assert title in printed
    assert "processor s / sky" in printed  # a head in one line, though this is no terminal
    assert cli.run([*arguments, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["skies"][0]["orders"] == 2
