"""The benchmarks: that they measure what they say. No figure of speed is tested."""

import json
import re

import numpy as np
import pytest

import skyfit
from skyfit import cli
from skyfit.benchmark import run
from skyfit.benchmark.case import Case, measure


pytestmark = pytest.mark.any_precision


TINY = Case(1, quality="draft", suns=2, rings=2, spokes=3, wavelengths=4, repeats=2)


def pretend(case):
    """A record as of a process; the radiance 1, and 1 % off at the horizon side."""
    if case.keep:
        light = np.ones((case.suns, 1 + case.rings * case.spokes, case.wavelengths))
        if case.quality != "high":
            light[:, np.degrees(case.directions()[0]) > 80] = 1.01
        np.save(case.keep, light)
    record = {"compile_s": 3.0, "run_s": 1.2, "processor_s": 2.4, "peak_mib": 500.0}
    if case.estimate:
        # As if each quality were ten times as good as the one before.
        error = {"draft": 1e-2, "default": 1e-3, "high": 1e-4}[case.quality]
        record |= {"estimated_error": error, "estimated_error_rms": error / 5}
    return record | {f"gradient_{name}": 2 * value for name, value in record.items()}


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_case_estimates_its_error_as_the_simulator_does():
    record = measure(TINY._replace(estimate=True, repeats=1))
    atmosphere = skyfit.preetham_atmosphere(
        4.0, wavelengths=np.linspace(380.0, 780.0, 4), ground_albedo=0.2
    )
    view, azimuth = TINY.directions()
    estimates = [
        skyfit.simulate(
            atmosphere, sun, view, azimuth, orders=1, quality="draft", estimate_error=True
        ).error_estimate
        for sun in np.radians([0.0, 85.0])
    ]
    assert record["estimated_error"] == pytest.approx(np.max(estimates), rel=1e-6)
    rms = np.sqrt(np.mean(np.square(estimates)))
    assert record["estimated_error_rms"] == pytest.approx(rms, rel=1e-6)


@pytest.mark.slow
def test_a_case_runs_in_a_process_of_its_own_precision():
    record = run._in_fresh_process(TINY._replace(precision=32, repeats=1))
    assert record["run_s"] > 0


@pytest.mark.slow
def test_a_case_that_fails_says_why():
    with pytest.raises(RuntimeError, match="quality"):
        run._in_fresh_process(TINY._replace(quality="perfect"))


def test_rows_are_per_sky_and_per_value_with_errors_against_high_quality(monkeypatch):
    monkeypatch.setattr(run, "_in_fresh_process", pretend)
    record = skyfit.run_benchmarks([2, None], [64], qualities=True, gradient=True, scaling=True)
    two, every = record["skies"]
    assert (two["orders"], every["orders"]) == (2, "all")
    assert two["s_per_sky"] == pytest.approx(0.1)
    assert two["ns_per_value"] == pytest.approx(1e9 * 1.2 / (12 * 343 * 41))
    assert two["error_to_75_deg"] == 0.0
    assert two["error_at_85_deg"] == pytest.approx(0.01)
    assert two["estimated_error"] == 1e-3
    found = [(row["quality"], row["estimated_error"]) for row in record["qualities"]]
    assert found == [("draft", 1e-2), ("default", 1e-3), ("high", 1e-4)]
    assert record["qualities"][0]["s_per_sky"] == pytest.approx(0.1)
    assert record["gradient"][0]["ratio"] == pytest.approx(2.0)
    assert {row["axis"] for row in record["scaling"]} == {"wavelengths", "rings", "suns", "orders"}


def test_the_command_prints_tables_or_json(monkeypatch, capsys):
    monkeypatch.setattr(run, "_in_fresh_process", pretend)
    arguments = ["benchmarks", "--orders", "2", "--precision", "64", "--gradient", "--scaling"]
    arguments += ["--qualities"]
    assert cli.run(arguments) == 0
    printed = capsys.readouterr().out
    for title in ("343 directions", "Every quality", "Gradient by every number", "Growth"):
        assert title in printed
    assert re.search(r"draft .* 1.0e-02 .* 2.0e-03", printed)
    assert "processor s / sky" in printed  # a head in one line, though this is no terminal
    assert cli.run([*arguments, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["skies"][0]["orders"] == 2
    assert record["qualities"][2]["estimated_error"] == 1e-4
    assert cli.run(["benchmarks", "--orders", "2", "--precision", "64", "--no-accuracy"]) == 0
    assert "estimated" not in capsys.readouterr().out
