"""The estimated error of a campaign: its numbers, its place on record, and what is warned of."""

import dataclasses
import json

import numpy as np
import pytest
import xarray as xr
from stand_in import stand_in

import skyfit
from skyfit import cli
from skyfit.dataset import runner
from skyfit.error_estimate import estimate_of, sampled_skies
from skyfit.transfer.trust import AccuracyWarning, estimated_error


pytestmark = pytest.mark.any_precision


SMALL = skyfit.Campaign(
    turbidity=[2.0, 3.0, 4.0],
    sun_zenith=np.radians([10.0, 30.0, 50.0, 70.0]),
    view_zenith=np.radians([0.0, 30.0, 60.0, 60.0]),
    relative_azimuth=np.radians([0.0, 0.0, 0.0, 90.0]),
    wavelengths=[450.0, 550.0, 650.0],
    orders=1,
    quality="draft",
)
FILE = """
schema = "skyfit/campaign/1"
[sweep]
turbidity = [2, 4]
[sampling]
sun_zenith_deg = [10, 40, 70]
view_zenith_deg = [30, 60, 85]
relative_azimuth_deg = [0, 90, 180]
wavelengths_nm = [450, 550, 650]
"""


class Interrupted(Exception):
    """Stands for the user's Ctrl-C."""


class Simulator:
    """Costs nothing; at coarser sizes everything is brighter by a share."""

    def __init__(self):
        self.fine, self.coarse, self.off = 0, 0, 0.01

    def simulate(self, atmosphere, sun_zenith, **rest):
        self.fine += np.unique(sun_zenith).size
        return stand_in(atmosphere, sun_zenith, **rest)

    def coarser_radiance(self, atmosphere, sun_zenith, **rest):
        self.coarse += np.unique(sun_zenith).size
        light = np.asarray(stand_in(atmosphere, sun_zenith, **rest).radiance)
        return light * (1 + self.off)


@pytest.fixture
def simulator(monkeypatch):
    """In place of the real one, counting suns."""
    pretended = Simulator()
    monkeypatch.setattr(runner, "simulate", pretended.simulate)
    monkeypatch.setattr(runner, "coarser_radiance", pretended.coarser_radiance)
    return pretended


@pytest.fixture
def file(tmp_path, simulator):
    path = tmp_path / "small.toml"
    path.write_text(FILE)
    return path


@pytest.mark.slow
def test_a_campaigns_estimates_are_those_of_the_single_skies():
    record = skyfit.run_campaign(SMALL, estimate_error="all")
    atmosphere = SMALL.build_atmosphere(turbidity=4.0)
    alone = [
        skyfit.simulate(
            atmosphere, sun, np.array(SMALL.view_zenith), np.array(SMALL.relative_azimuth),
            orders=1, quality="draft", estimate_error=True,
        ).error_estimate
        for sun in SMALL.sun_zenith
    ]  # fmt: skip
    found = record["error_estimate"]
    assert found.dims == record["radiance"].dims
    # On record in single precision.
    np.testing.assert_allclose(found.sel(turbidity=4.0), np.stack(alone), rtol=1e-6, atol=1e-9)
    summary = estimate_of(record)
    assert summary.worst == pytest.approx(float(found.max()), rel=1e-6)
    assert summary.rms == pytest.approx(float(np.sqrt((found**2).mean())), rel=1e-6)
    assert summary.median == pytest.approx(float(found.median()), rel=1e-6)
    assert (summary.checked, summary.total) == (12, 12)
    # And of a sample those of its skies.
    sample = skyfit.run_campaign(SMALL, estimate_error="sample")
    assert "error_estimate" not in sample
    chosen = found.values[sampled_skies(SMALL)]
    assert estimate_of(sample).worst == pytest.approx(chosen.max(), rel=1e-6)
    assert estimate_of(sample).median == pytest.approx(np.median(chosen), rel=1e-6)


def test_the_sample_is_the_ends_of_the_sweep_under_high_middle_and_low_suns():
    assert sampled_skies(SMALL).astype(int).tolist() == [[1, 0, 1, 1], [0] * 4, [1, 0, 1, 1]]
    one = dataclasses.replace(SMALL, turbidity=[3.0], sun_zenith=[0.5])
    assert sampled_skies(one).tolist() == [[True]]


@pytest.mark.slow
def test_the_worst_is_named_by_its_place(simulator, monkeypatch):
    def off_at_one_place(**given):
        light = np.array(stand_in(**given).radiance)
        low = np.asarray(given["sun_zenith"]).ravel() > np.radians(60)
        light[low, 2, 0] *= 1.03
        return light

    monkeypatch.setattr(runner, "coarser_radiance", off_at_one_place)
    found = estimate_of(skyfit.run_campaign(SMALL, estimate_error="sample"))
    assert found.worst == pytest.approx(0.015)
    assert found.median == 0
    at = found.worst_at
    assert at["turbidity"] in (2.0, 4.0)
    assert np.degrees([at["sun_zenith"], at["view_zenith"], at["relative_azimuth"]]) == (
        pytest.approx([70, 60, 0])
    )
    assert at["wavelength"] == 450
    assert "sun zenith 70°, view zenith 60°, relative azimuth 0°, wavelength 450 nm" in str(found)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sky.zarr", "sky.nc"])
@pytest.mark.parametrize("skies", ["sample", "all"])
def test_an_estimate_is_read_back_equal(simulator, tmp_path, name, skies):
    record = skyfit.run_campaign(SMALL, store=tmp_path / name, estimate_error=skies)
    again = skyfit.load_dataset(tmp_path / name)
    xr.testing.assert_identical(again, record)
    assert estimate_of(again).worst == pytest.approx(0.005)
    assert ("error_estimate" in again) == (skies == "all")
    assert json.loads(again.attrs["error_estimate"])["compared_with"].startswith("two thirds")
    skyfit.fit_sky(again)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sky.zarr", "sky.nc"])
def test_a_finished_store_gains_an_estimate_and_keeps_it(simulator, tmp_path, name):
    store = tmp_path / name
    plain = skyfit.run_campaign(SMALL, store=store)
    assert estimate_of(plain) is None
    simulator.fine = 0
    skyfit.run_campaign(SMALL, store=store, estimate_error="sample")
    assert (simulator.fine, simulator.coarse) == (0, 6)
    whole = skyfit.run_campaign(SMALL, store=store, estimate_error="all")
    assert (simulator.fine, simulator.coarse) == (0, 6 + 12)
    for asked in ("none", "sample", "all"):
        xr.testing.assert_identical(
            skyfit.run_campaign(SMALL, store=store, estimate_error=asked), whole
        )
    assert (simulator.fine, simulator.coarse) == (0, 6 + 12)
    xr.testing.assert_allclose(skyfit.load_dataset(store).drop_vars("error_estimate"), plain)


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_an_interrupted_estimate_goes_on_where_it_stopped(simulator, tmp_path, workers):
    store, seen = tmp_path / "sky.zarr", []

    def stop(stage, done, total):
        if stage == "error estimate" and done >= 3:
            raise Interrupted

    with pytest.raises(Interrupted):
        skyfit.run_campaign(
            SMALL, stop, store, suns_per_call=1, workers=workers, estimate_error="all"
        )
    # The skies are whole.
    assert "error_estimate" not in skyfit.load_dataset(store)
    simulator.fine = simulator.coarse = 0
    record = skyfit.run_campaign(
        SMALL, lambda *counts: seen.append(counts), store, suns_per_call=1, estimate_error="all"
    )
    assert (simulator.fine, simulator.coarse) == (0, 9)
    first, *later = seen
    assert first == ("skies", 12, 12)
    assert later == [("error estimate", done, 12) for done in range(3, 13)]
    xr.testing.assert_identical(skyfit.load_dataset(store), record)
    assert estimate_of(record).checked == 12


@pytest.mark.slow
def test_a_record_without_a_sweep_has_an_estimate_too(simulator, tmp_path):
    file = tmp_path / "plain.toml"
    constituents = '[[constituents]]\nname = "air"\nkind = "air"\n'
    file.write_text(FILE.replace("[sweep]\nturbidity = [2, 4]\n", constituents))
    record = skyfit.run_campaign(skyfit.load_campaign(file), estimate_error="all")
    assert record["error_estimate"].dims == ("sun_zenith", "direction", "wavelength")
    assert set(estimate_of(record).worst_at) == {
        *("sun_zenith", "view_zenith", "relative_azimuth", "wavelength"),
    }


def test_a_large_estimate_is_warned_of_where_it_is(simulator):
    simulator.off = 0.1
    with pytest.warns(
        AccuracyWarning,
        match=r"up to 5\.0% \(turbidity .*nm\) and exceeds 2% in .* 6 skies; a higher quality",
    ):
        skyfit.run_campaign(SMALL, estimate_error="sample")
    finest = dataclasses.replace(SMALL, quality="high", turbidity=[2.0], sun_zenith=[0.5])
    with pytest.warns(AccuracyWarning) as warned:
        skyfit.run_campaign(finest, estimate_error="sample")
    assert "a higher quality" not in str(warned[0].message)


@pytest.mark.filterwarnings("always")
def test_the_command_prints_the_estimate_and_warns_in_one_line(file, simulator, tmp_path, capsys):
    simulator.off = 0.1
    command = ["simulate", str(file), "--out", str(tmp_path / "sky.zarr")]
    assert cli.run(command) == 0
    printed = capsys.readouterr()
    assert "not estimated; --estimate-error sample" in printed.out
    assert printed.err == ""
    assert cli.run([*command, "--estimate-error", "sample"]) == 0
    printed = capsys.readouterr()
    line = next(line for line in printed.out.splitlines() if line.startswith("error"))
    assert "up to 5.00%, RMS 5.00%, median 5.00%, estimated from 6 of 6 skies" in line
    assert "by comparison with quality 'draft'" in line
    assert printed.err.startswith("skyfit: warning: the estimated error of the skies is up to 5.0%")
    assert printed.err.count("\n") == 1
    # What is on record is shown without being asked for again.
    assert cli.run([*command, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["error_estimate"]
    assert found["worst"] == pytest.approx(0.05)
    assert found["skies"] == "sample"
    assert found["share_above"] == 1.0
    assert {"turbidity", "sun_zenith_deg", "wavelength_nm"} < set(found["worst_at"])


def test_an_interruption_of_the_estimate_says_that_the_skies_are_whole(
    file, simulator, tmp_path, capsys, monkeypatch
):
    def stopped(**_):
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "coarser_radiance", stopped)
    store = tmp_path / "sky.zarr"
    command = ["simulate", str(file), "--out", str(store), "--estimate-error", "all"]
    assert cli.run(command) == 130
    assert f"6 of 6 skies are in {store}; the same command continues" in capsys.readouterr().err


def test_a_choice_that_is_none_says_what_was_expected(file, simulator, tmp_path, capsys):
    with pytest.raises(ValueError, match=r"\(estimate_error=...\): expected one of 'none', 'sampl"):
        skyfit.run_campaign(SMALL, estimate_error="most")
    out = str(tmp_path / "sky.nc")
    assert cli.run(["simulate", str(file), "--out", out, "--estimate-error", "most"]) == 2
    assert "'--estimate-error': 'most' is not one of 'none', 'sample', 'all'" in (
        capsys.readouterr().err
    )
    assert simulator.fine == 0


def test_coarser_light_that_is_not_finite_gives_no_estimate(simulator, tmp_path):
    simulator.off = np.nan
    store = tmp_path / "sky.nc"
    with pytest.raises(ValueError, match=r"at the coarser sizes are not finite; the error cannot"):
        skyfit.run_campaign(SMALL, store=store, estimate_error="sample")
    assert estimate_of(skyfit.load_dataset(store)) is None


def test_a_black_sky_is_off_by_all_or_nothing():
    black, faint = np.zeros((3, 2)), np.array([[0.0, 0.0], [1e-20, 0.0], [0.0, 0.0]])
    half = np.array([[0.0, 0.0], [0.5, 0.0], [0.0, 0.0]])
    assert np.array_equal(estimated_error(black, faint), half)


def test_an_estimate_of_another_version_is_named(simulator):
    record = skyfit.run_campaign(SMALL, estimate_error="sample")
    found = json.loads(record.attrs["error_estimate"])
    changed = record.assign_attrs(error_estimate=json.dumps(found | {"bias": 0.0}))
    with pytest.raises(ValueError, match=r"'error_estimate' is of another version; .* in bias"):
        estimate_of(changed)


@pytest.mark.parametrize(
    ("wrong", "message"), [(-1e-3, "negative, down to -0.001"), (np.inf, "are not finite")]
)
@pytest.mark.parametrize("name", ["sky.zarr", "sky.nc"])
def test_a_campaign_never_ends_well_with_impossible_light(
    file, tmp_path, capsys, monkeypatch, name, wrong, message
):
    def broken(*given, **named):
        sky = stand_in(*given, **named)
        return dataclasses.replace(
            sky, tail=sky.tail.at[0, 0, 0].set(wrong - sky.radiance[0, 0, 0])
        )

    monkeypatch.setattr(runner, "simulate", broken)
    store = tmp_path / name
    assert cli.run(["simulate", str(file), "--out", str(store)]) == 2
    line = capsys.readouterr().err
    assert message in line
    assert line.count("\n") == 1
    assert not store.exists() or not skyfit_done(store)


def test_a_store_with_impossible_light_is_refused_by_its_name(file, simulator, tmp_path, capsys):
    store = tmp_path / "sky.zarr"
    command = ["simulate", str(file), "--out", str(store)]
    assert cli.run(command) == 0
    import zarr

    zarr.open_group(store, mode="r+")["radiance"][0, 0, 0, 0] = -1.0
    capsys.readouterr()
    assert cli.run(command) == 2
    line = capsys.readouterr().err
    assert f"{store}: 1 of 180 radiances are negative" in line
    assert line.count("\n") == 1


def skyfit_done(store):
    """Whether any sky of a store counts as done."""
    return bool(xr.open_zarr(store, consolidated=False)["done"].any())
