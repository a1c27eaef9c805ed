"""The record of simulated skies: what it holds, how it is kept, how a campaign goes on."""

import json
import shutil

import numpy as np
import pytest
import xarray as xr
from stand_in import stand_in

import skyfit
from skyfit.dataset import campaign_of, runner


pytestmark = pytest.mark.any_precision


SMALL = skyfit.Campaign(
    turbidity=[2.0, 4.0],
    sun_zenith=np.radians([10.0, 40.0, 70.0]),
    view_zenith=np.radians([0.0, 30.0, 60.0, 60.0]),
    relative_azimuth=np.radians([0.0, 0.0, 0.0, 90.0]),
    wavelengths=[450.0, 550.0, 650.0],
    quality="draft",
)


class Interrupted(Exception):
    """Stands for the user's Ctrl-C."""


@pytest.fixture
def calls(monkeypatch):
    """Replace the simulator, and count the suns it is asked for."""
    asked = []

    def counted(atmosphere, sun_zenith, *rest, **options):
        asked.append(np.unique(sun_zenith).size)
        return stand_in(atmosphere, sun_zenith, *rest, **options)

    monkeypatch.setattr(runner, "simulate", counted)
    return asked


def stop_after(skies):
    def progress(stage, done, total):
        if done >= skies:
            raise Interrupted

    return progress


@pytest.mark.slow
def test_a_record_names_its_dimensions_units_and_makers(calls):
    record = skyfit.run_campaign(SMALL)
    assert record["radiance"].dims == ("turbidity", "sun_zenith", "direction", "wavelength")
    assert record["luminance"].dims == ("turbidity", "sun_zenith", "direction")
    units = {name: record[name].attrs["units"] for name in record.variables}
    assert units["radiance"] == "W m-2 sr-1 nm-1"
    assert units["luminance"] == "cd m-2"
    assert {units[name] for name in ("sun_zenith", "view_zenith", "relative_azimuth")} == {"rad"}
    assert record["sun_zenith"].attrs["standard_name"] == "solar_zenith_angle"
    assert {"skyfit", "jax", "python"} <= set(json.loads(record.attrs["versions"]))
    atmospheres = json.loads(record.attrs["atmosphere"])
    assert len(atmospheres) == 2
    assert atmospheres[0]["constituents"][1]["phase"]["type"] == "Tabulated"


@pytest.mark.slow
def test_luminance_of_a_record_is_its_radiance_weighed_by_the_eye(calls):
    # At 555 nm the eye's weight is 1 (CIE 1931 tabulates 1.0000): a spectrum that is a triangle of
    # 2 nm around it, of height L, has the luminance 683 L nm, but for the curvature of the weight.
    campaign = skyfit.Campaign(
        turbidity=2, sun_zenith=0.5, view_zenith=[0.0], relative_azimuth=[0.0],
        wavelengths=[554.0, 555.0, 556.0],
    )  # fmt: skip
    sky = skyfit.run_campaign(campaign).isel(turbidity=0, sun_zenith=0, direction=0)
    first, middle, last = sky["radiance"].values
    expected = 683.002 * (0.5 * first + middle + 0.5 * last)
    np.testing.assert_allclose(sky["luminance"], expected, rtol=1e-4)


def test_a_record_alone_can_be_simulated_again(calls, tmp_path):
    skyfit.run_campaign(SMALL, store=tmp_path / "sky.nc")
    record = skyfit.load_dataset(tmp_path / "sky.nc")
    assert campaign_of(record) == SMALL
    xr.testing.assert_identical(skyfit.run_campaign(campaign_of(record)), record)


@pytest.mark.parametrize("name", ["sky.zarr", "sky.nc"])
def test_a_record_is_read_back_equal(calls, tmp_path, name):
    record = skyfit.run_campaign(SMALL)
    skyfit.save_dataset(record, tmp_path / name)
    xr.testing.assert_identical(skyfit.load_dataset(tmp_path / name), record)


@pytest.mark.parametrize("name", ["sky.zarr", "sky.nc"])
def test_a_campaign_that_is_on_record_is_not_simulated_again(calls, tmp_path, name):
    record = skyfit.run_campaign(SMALL, store=tmp_path / name)
    calls.clear()
    xr.testing.assert_identical(skyfit.run_campaign(SMALL, store=tmp_path / name), record)
    assert calls == []


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_an_interrupted_campaign_goes_on_where_it_stopped(calls, tmp_path, workers):
    whole = skyfit.run_campaign(SMALL)
    store = tmp_path / "sky.zarr"
    with pytest.raises(Interrupted):
        skyfit.run_campaign(SMALL, stop_after(2), store, suns_per_call=1, workers=workers)
    with pytest.raises(ValueError, match=r"sky.zarr: 2 of 6 skies are done; run the same"):
        skyfit.load_dataset(store)
    calls.clear()
    seen = []
    resumed = skyfit.run_campaign(SMALL, lambda *at: seen.append(at), store, suns_per_call=1)
    assert seen == [("skies", done, 6) for done in range(2, 7)]
    assert sum(calls) == 4
    # A product of matrices rounds differently with its size, and a call here has one sun.
    xr.testing.assert_allclose(resumed, whole, rtol=1e-13)
    assert resumed.attrs == whole.attrs
    xr.testing.assert_identical(skyfit.load_dataset(store), resumed)


@pytest.mark.slow
@pytest.mark.float64
@pytest.mark.parametrize(("workers", "suns_per_call"), [(1, 2), (2, 1), (2, 3), (3, 2)])
def test_how_the_work_is_cut_does_not_change_the_skies(calls, workers, suns_per_call):
    cut = skyfit.run_campaign(SMALL, workers=workers, suns_per_call=suns_per_call)
    xr.testing.assert_allclose(cut, skyfit.run_campaign(SMALL), rtol=1e-13)


def test_orders_of_scattering_on_record_add_up_to_the_radiance(calls):
    campaign = skyfit.Campaign.from_dict(SMALL.to_dict() | {"keep_orders": True, "orders": 3})
    record = skyfit.run_campaign(campaign)
    assert record["order"].values.tolist() == [1, 2, 3]
    total = record["radiance_by_order"].sum("order")
    np.testing.assert_allclose(total, record["radiance"].transpose(*total.dims), rtol=1e-14)


@pytest.mark.parametrize("name", ["sky.zarr", "sky.nc"])
def test_a_store_of_another_campaign_is_refused_and_left_alone(calls, tmp_path, name):
    record = skyfit.run_campaign(SMALL, store=tmp_path / name)
    other = skyfit.Campaign.from_dict(SMALL.to_dict() | {"turbidity": [2.0, 5.0]})
    with pytest.raises(ValueError, match=f"{name}: was made by another campaign; give another"):
        skyfit.run_campaign(other, store=tmp_path / name)
    xr.testing.assert_identical(skyfit.load_dataset(tmp_path / name), record)


def test_a_record_is_replaced_only_on_request(calls, tmp_path):
    record = skyfit.run_campaign(SMALL)
    skyfit.save_dataset(record, tmp_path / "sky.nc")
    with pytest.raises(ValueError, match="exists already; give another name or overwrite=True"):
        skyfit.save_dataset(record, tmp_path / "sky.nc")
    skyfit.save_dataset(record, tmp_path / "sky.nc", overwrite=True)


@pytest.mark.parametrize("name", ["mine.zarr", "mine.nc"])
def test_what_is_not_a_record_is_never_touched(calls, tmp_path, name):
    theirs = tmp_path / name
    theirs.write_text("precious") if theirs.suffix == ".nc" else theirs.mkdir()
    record = skyfit.run_campaign(SMALL)
    for attempt in (
        lambda: skyfit.run_campaign(SMALL, store=theirs),
        lambda: skyfit.save_dataset(record, theirs, overwrite=True),
        lambda: skyfit.load_dataset(theirs),
    ):
        with pytest.raises(ValueError, match=f"{name}: exists and is not a sky dataset"):
            attempt()
    assert list(theirs.iterdir()) == [] if theirs.is_dir() else theirs.read_text() == "precious"


def test_another_programs_dataset_is_refused_by_its_schema(tmp_path):
    xr.Dataset({"radiance": ("x", np.zeros(2))}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(ValueError, match=r"other.nc: schema is 'missing', expected 'skyfit/dat"):
        skyfit.load_dataset(tmp_path / "other.nc")


def test_a_record_with_a_hole_is_refused(calls, tmp_path):
    record = skyfit.run_campaign(SMALL)
    record["radiance"][0, 1, 2, 0] = np.nan
    record.to_netcdf(tmp_path / "sky.nc")
    with pytest.raises(ValueError, match="radiance has 1 non-finite values of 72"):
        skyfit.load_dataset(tmp_path / "sky.nc")
    with pytest.raises(ValueError, match=r"save_dataset.*radiance has 1 non-finite values of 72"):
        skyfit.save_dataset(record, tmp_path / "other.nc")


@pytest.mark.parametrize("name", ["sky.nc", "sky.zarr"])
def test_what_is_saved_of_a_measured_sky_is_read(name, tmp_path):
    skies = skyfit.cornell_skies().isel(wavelength=slice(0, 4), time=[0, 1])
    skies["luminance"][0, 3] = np.nan
    skyfit.save_dataset(skies, tmp_path / name)
    xr.testing.assert_equal(skyfit.load_dataset(tmp_path / name), skies)


def test_what_is_no_sky_is_not_saved(tmp_path):
    skies = skyfit.cornell_skies()
    with pytest.raises(skyfit.InputError, match="expected skies; there is no view_zenith"):
        skyfit.save_dataset(skies.drop_vars("view_zenith"), tmp_path / "sky.nc")
    with pytest.raises(skyfit.InputError, match="expected skies; there is no radiance or lum"):
        skyfit.save_dataset(skies.drop_vars(["radiance", "luminance"]), tmp_path / "sky.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_name_without_a_known_ending_is_refused(calls, tmp_path):
    with pytest.raises(ValueError, match=r"sky.csv: expected a name ending in .zarr or .nc"):
        skyfit.run_campaign(SMALL, store=tmp_path / "sky.csv")
    assert calls == []


def test_a_missing_record_is_named(tmp_path):
    for name in ("sky.zarr", "sky.nc"):
        with pytest.raises(FileNotFoundError, match=name):
            skyfit.load_dataset(str(tmp_path / name))


@pytest.mark.slow
def test_skies_on_record_are_those_of_the_simulator():
    record = skyfit.run_campaign(SMALL, suns_per_call=2)
    sky = skyfit.simulate(
        skyfit.preetham_atmosphere(4.0, wavelengths=list(SMALL.wavelengths)),
        np.array(SMALL.sun_zenith[1:])[:, None],
        np.array(SMALL.view_zenith)[None, :],
        np.array(SMALL.relative_azimuth)[None, :],
        quality="draft",
    )
    kept = record["radiance"].sel(turbidity=4.0).values[1:]
    # The atmosphere is built compiled in one case and op by op in the other.
    np.testing.assert_allclose(kept, sky.radiance, rtol=1e-10)
    assert np.all(kept > 0)


def test_measured_skies_have_the_form_of_simulated_ones():
    skies = skyfit.cornell_skies()
    assert skies["radiance"].dims == ("time", "direction", "wavelength")
    assert skies["radiance"].shape == (8, 81, 471)
    assert int((~skies["reliable"]).sum()) == 1
    # 13:30 daylight time at 76.48° W is 6.7° past noon (equation of time +2.8 min); with the
    # sun's declination of 21.3° its zenith angle over 42.44° N is 21.87°.
    last = skies.isel(time=-1)
    assert float(last["local_time"]) == 13.5 * 60
    np.testing.assert_allclose(np.degrees(last["sun_zenith"]), 21.87, atol=0.15)
    assert np.all(skies["luminance"] > 500)
    assert np.all(np.abs(skies["x"] - 0.27) < 0.06)


@pytest.fixture(autouse=True)
def no_leftovers(tmp_path):
    """A half-written store is never left beside the finished one."""
    yield
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []
    shutil.rmtree(tmp_path)
