"""Campaigns over several swept parameters: grids and samples, from Python and from files."""

import dataclasses
import itertools
import json

import jax
import numpy as np
import pytest
import xarray as xr
from stand_in import stand_in

import skyfit
from skyfit import cli
from skyfit.campaign.places import grid, sample
from skyfit.dataset import campaign_of, runner
from skyfit.error_estimate import sampled_skies
from skyfit.fitting.skies import read_skies
from skyfit.render import load_source


LAM = np.array([450.0, 550.0, 650.0])
FEW = {
    "sun_zenith": np.radians([10.0, 40.0, 60.0]),
    "view_zenith": np.radians([0.0, 30.0, 60.0, 60.0]),
    "relative_azimuth": np.radians([0.0, 90.0, 0.0, 180.0]),
    "wavelengths": LAM,
    "quality": "draft",
    "orders": 1,
}
SWEEP = {"ground_albedo": [0.0, 0.4], "observer_altitude": [0.0, 1000.0, 3000.0]}
FILE = """schema = "skyfit/campaign/1"
[[sweep]]
turbidity = [2, 4]
[[sweep]]
key = "atmosphere.ground_albedo"
values = [0, 0.4]
[[sweep]]
key = "simulation.observer_altitude_m"
values = [0, 1000, 3000]
[sampling]
sun_zenith_deg = [10, 40, 60]
view_zenith_deg = [30, 60]
relative_azimuth_deg = [0, 180]
wavelengths_nm = [450, 550, 650]
[simulation]
quality = "draft"
orders = 1
"""
HAZE = """schema = "skyfit/campaign/1"
[[constituents]]
name = "air"
kind = "air"
[[constituents]]
name = "haze"
kind = "angstrom_aerosol"
angstrom_exponent = 1.3
asymmetry = 0.7
optical_depth = 0.1
[[sweep]]
key = "constituents.haze.optical_depth"
values = [0.1, 0.5]
name = "haze"
[[sweep]]
key = "ground.albedo"
values = [0.1, 0.6]
"""


def over_three(**changed):
    return skyfit.Campaign([2.0, 4.0], sweep=SWEEP, **(FEW | changed))


@pytest.fixture
def quick(monkeypatch):
    """A stand-in for the simulator."""
    monkeypatch.setattr(runner, "simulate", stand_in)


def test_a_grid_is_every_combination_with_the_last_fastest():
    places = grid({"a": (1.0, 2.0), "b": (3.0, 4.0)})
    assert [tuple(one.values()) for one in places] == [(1, 3), (1, 4), (2, 3), (2, 4)]
    assert grid({}) == ({},)


def test_a_sample_has_the_corners_and_fills_the_box_evenly():
    places = sample({"a": (0.0, 1.0), "b": (2.0, 3.0, 10.0)}, 260)
    table = np.array([list(one.values()) for one in places])
    assert table[:4].tolist() == [[0, 2], [0, 10], [1, 2], [1, 10]]
    inside = (table[4:] - [0, 2]) / [1, 8]
    assert ((inside > 0) & (inside < 1)).all()
    # Halton's first places in bases 2 and 3, by hand.
    np.testing.assert_allclose(inside[:4], [[1 / 2, 1 / 3], [1 / 4, 2 / 3], [3 / 4, 1 / 9],
                                            [1 / 8, 4 / 9]])  # fmt: skip
    # Of 16 equal boxes each has its sixteenth of the 256 places, give or take three.
    counts, _, _ = np.histogram2d(*inside.T, bins=4, range=[[0, 1], [0, 1]])
    assert abs(counts - 16).max() <= 3
    assert sample({"a": (0.0, 1.0), "b": (2.0, 10.0)}, 20) == places[:20]


def test_every_sky_of_a_grid_is_the_one_of_its_own_campaign(quick):
    skies = skyfit.run_campaign(over_three())
    assert skies["radiance"].dims == (
        "turbidity", "ground_albedo", "observer_altitude", "sun_zenith", "direction", "wavelength",
    )  # fmt: skip
    assert skies["observer_altitude"].attrs["units"] == "m"
    for turbidity, albedo, altitude in itertools.product((2.0, 4.0), (0.0, 0.4), (0.0, 1e3, 3e3)):
        alone = skyfit.run_campaign(
            skyfit.Campaign(
                [turbidity],
                atmosphere=skyfit.PaperAtmosphere(ground_albedo=albedo),
                observer_altitude=altitude,
                **FEW,
            )
        )
        found = skies.sel(turbidity=turbidity, ground_albedo=albedo, observer_altitude=altitude)
        np.testing.assert_array_equal(found["radiance"], alone["radiance"].isel(turbidity=0))


@pytest.mark.slow
def test_every_sky_is_the_simulators():
    campaign = dataclasses.replace(over_three(), turbidity=[3.0], sweep={"ground_albedo": [0, 0.5]})
    skies = skyfit.run_campaign(dataclasses.replace(campaign, orders=2))
    sun = FEW["sun_zenith"][:, None]
    for albedo in (0.0, 0.5):
        air = skyfit.preetham_atmosphere(3.0, wavelengths=LAM, ground_albedo=albedo)
        views = FEW["view_zenith"], FEW["relative_azimuth"]
        direct = skyfit.simulate(air, sun, *views, quality="draft").radiance
        found = skies["radiance"].sel(turbidity=3.0, ground_albedo=albedo)
        np.testing.assert_allclose(found, direct, rtol=1e-10)


def test_a_file_says_the_same(tmp_path, quick):
    (tmp_path / "a.toml").write_text(FILE)
    campaign = skyfit.load_campaign(tmp_path / "a.toml")
    assert campaign.swept == {"turbidity": (2, 4)} | {k: tuple(v) for k, v in SWEEP.items()}
    views = {"view_zenith": campaign.view_zenith, "relative_azimuth": campaign.relative_azimuth}
    assert campaign == over_three(**views)
    assert skyfit.Campaign.from_dict(json.loads(json.dumps(campaign.to_dict()))) == campaign
    record = skyfit.run_campaign(campaign)
    again = campaign_of(record)
    assert again == campaign
    xr.testing.assert_identical(skyfit.run_campaign(again), record)
    air = skyfit.load_atmosphere(tmp_path / "a.toml", turbidity=5.0, ground_albedo=0.3)
    assert float(air.ground_albedo[0]) == 0.3


def test_any_numbers_of_a_file_can_be_swept_together(tmp_path, quick):
    (tmp_path / "a.toml").write_text(HAZE)
    campaign = dataclasses.replace(skyfit.load_campaign(tmp_path / "a.toml"), **FEW)
    assert campaign.sky_dims == ("haze", "albedo", "sun_zenith")
    thin, thick = (campaign.build_atmosphere(haze=h, albedo=0.6) for h in (0.1, 0.5))
    np.testing.assert_allclose(thick.scattering[1], 5 * thin.scattering[1])
    assert float(thin.ground_albedo[0]) == 0.6
    assert skyfit.run_campaign(campaign)["luminance"].shape == (2, 2, 3, 4)


def test_a_function_takes_all_that_is_swept_but_the_observers_altitude(quick):
    seen = []

    def air(turbidity, ground_albedo):
        seen.append((turbidity, ground_albedo))
        return skyfit.preetham_atmosphere(turbidity, wavelengths=LAM, ground_albedo=ground_albedo)

    campaign = skyfit.Campaign([2.0, 4.0], atmosphere=air, sweep=SWEEP, **FEW)
    assert seen == [(2, 0), (2, 0.4), (4, 0), (4, 0.4)]
    ours = skyfit.run_campaign(campaign)
    papers = skyfit.run_campaign(over_three())
    np.testing.assert_array_equal(ours["radiance"], papers["radiance"])
    again = campaign_of(ours)
    assert again == campaign
    xr.testing.assert_identical(skyfit.run_campaign(again), ours)


def test_a_sample_has_a_dimension_of_its_own_and_fits_like_a_grid(tmp_path, quick):
    (tmp_path / "a.toml").write_text(FILE.replace("[sampling]", "[sampling]\nsamples = 30"))
    campaign = skyfit.load_campaign(tmp_path / "a.toml")
    assert campaign.sky_shape == (30, 3)
    skies = skyfit.run_campaign(campaign)
    assert skies["radiance"].dims == ("sample", "sun_zenith", "direction", "wavelength")
    assert skies["ground_albedo"].dims == ("sample",)
    assert campaign_of(skies) == campaign
    read = read_skies(skies)
    assert list(read.swept) == ["turbidity", "ground_albedo", "observer_altitude"]
    assert read.ranges["observer_altitude"] == (0.0, 3000.0)
    place = campaign.places[17]
    np.testing.assert_array_equal(read.swept["turbidity"][17 * 3 : 18 * 3], place["turbidity"])
    skyfit.save_dataset(skies, tmp_path / "sky.nc")
    xr.testing.assert_identical(skyfit.load_dataset(tmp_path / "sky.nc"), skies)


def test_a_store_is_resumed_where_it_was_left(tmp_path, monkeypatch):
    calls = []

    def failing(**arguments):
        calls.append(1)
        if len(calls) == 6:
            raise KeyboardInterrupt
        return stand_in(**arguments)

    monkeypatch.setattr(runner, "simulate", failing)
    store = tmp_path / "sky.zarr"
    with pytest.raises(KeyboardInterrupt):
        skyfit.run_campaign(over_three(), store=store)
    found = skyfit.run_campaign(over_three(), store=store)
    assert len(calls) == 6 + 12 - 5  # a call for each of the 2 x 2 x 3 atmospheres
    monkeypatch.setattr(runner, "simulate", stand_in)
    xr.testing.assert_equal(found, skyfit.run_campaign(over_three()))
    with pytest.raises(ValueError, match="was made by another campaign"):
        skyfit.run_campaign(over_three(samples=20), store=store)


def test_the_error_is_estimated_at_the_corners():
    chosen = sampled_skies(over_three())
    assert chosen.shape == (2, 2, 3, 3)
    assert chosen[:, :, [0, 2]].all()
    assert not chosen[:, :, 1].any()
    assert sampled_skies(over_three(samples=40)).all(axis=1).tolist() == [True] * 8 + [False] * 32


def test_a_picture_shows_a_sky_of_several_parameters(tmp_path, quick):
    (tmp_path / "a.toml").write_text(FILE)
    file = tmp_path / "a.toml"
    given = {"ground_albedo": 0.2, "observer_altitude": 1000.0}
    source = load_source(file, 3.0, parameters=given)
    assert source.name == (
        "a.toml, simulated, turbidity 3, ground_albedo 0.2, observer_altitude 1000"
    )
    with pytest.raises(ValueError, match=r"expected one ground_albedo .--set.*0, 0.4; got none"):
        load_source(file, 3.0, parameters={"observer_altitude": 0.0})
    with pytest.raises(ValueError, match=r"values of turbidity, ground_albedo.* alone .* got dust"):
        load_source(file, 3.0, parameters={"dust": 0.0})
    skyfit.run_campaign(skyfit.load_campaign(file), store=tmp_path / "sky.nc")
    shown = {"ground_albedo": 0.4, "observer_altitude": 1000.0}
    record = load_source(tmp_path / "sky.nc", 4.0, np.radians(40.0), parameters=shown)
    assert record.sun_zenith == pytest.approx(np.radians(40.0))


def test_simulate_and_fit_take_several_parameters_on_the_command_line(tmp_path, quick, capsys):
    dense = FILE.replace("view_zenith_deg = [30, 60]", "view_zenith_deg = [20, 40, 60, 80]")
    (tmp_path / "a.toml").write_text(dense.replace("[0, 180]", "[0, 45, 90, 135, 180]"))
    store, out = str(tmp_path / "sky.zarr"), str(tmp_path / "fit.json")
    assert cli.run(["simulate", str(tmp_path / "a.toml"), "--out", store]) == 0
    assert cli.run(["fit", store, "--distribution", "series", "--dependence", "nodes",
                    "--out", out]) == 0  # fmt: skip
    fit = skyfit.load_fit(out)
    assert list(fit.swept) == ["turbidity", "ground_albedo", "observer_altitude"]
    sky = fit.sky(turbidity=4, ground_albedo=0.4, observer_altitude=3000)
    data = skyfit.load_dataset(store).sel(turbidity=4, ground_albedo=0.4, observer_altitude=3000)
    found = sky.xyY(data["sun_zenith"].values[:, None], data["view_zenith"].values,
                    data["relative_azimuth"].values)[..., 2]  # fmt: skip
    np.testing.assert_allclose(found, data["luminance"], rtol=0.1)
    assert "ground_albedo" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sweep": {"dust": [1.0]}}, "turbidity, ground_albedo and observer_altitude; not over"),
        ({"sweep": {"ground_albedo": [0.5, 1.5]}}, r"ground_albedo'=.* within \[0, 1\]; got 1.5"),
        ({"turbidity": [2.0], "sweep": {"turbidity": [3.0]}}, "turbidity is swept twice"),
        ({"samples": 4, "sweep": SWEEP}, "more than the 8 corners of what is swept; got 4"),
        ({"samples": 9, "turbidity": [2.0]}, "a range to fill; got the single value of turbidity"),
    ],
)
def test_what_cannot_be_swept_is_refused(changed, message):
    with pytest.raises(ValueError, match=message):
        skyfit.Campaign(**(FEW | changed))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[2, 4]", "[4, 2]", r"sweep\[0\].turbidity: .* increasing values; got 4 before 2"),
        ("[0, 0.4]", "[0, 1.4]", r"sweep\[1\].values\[1\]: atmosphere.ground_albedo: .* 1; got"),
        ("values = [0, 0.4]", "", r"sweep\[1\]: key and values are expected together"),
        ("atmosphere.ground", "atmosphere.rground", r"sweep\[1\].key: the paper's atmosphere is"),
        ("values = [0, 0.4]", "value = 3", r"sweep\[1\].value: unknown key; did you mean values"),
        ('key = "atmosphere.ground_albedo"\nvalues', "turbidity", r"sweep\[1\].turb.* 1; got 0"),
        ("[sampling]", "[sampling]\nsamples = 5", "more than the 8 corners .* got 5"),
        ("[sampling]", "[sampling]\nsamples = 5.5", "samples: expected a whole number; got 5.5"),
        (
            "[sampling]",
            '[[sweep]]\nkey = "simulation.observer_altitude_m"\nvalues = [0, 1]\n[sampling]',
            r"sweep\[3\].name: observer_altitude is swept already",
        ),
    ],
)
def test_a_wrong_table_is_named_by_its_number(tmp_path, old, new, message):
    assert old in FILE
    (tmp_path / "wrong.toml").write_text(FILE.replace(old, new))
    with pytest.raises(ValueError, match=message):
        skyfit.load_campaign(tmp_path / "wrong.toml")


def test_a_missing_value_is_named():
    with pytest.raises(
        ValueError, match=r"expected values of turbidity, ground_albedo, .* got tur"
    ):
        over_three().build_atmosphere(turbidity=2.0)


def test_values_are_given_in_the_dataset_s_order_or_by_name():
    campaign = over_three()
    by_name = campaign.build_atmosphere(turbidity=4.0, ground_albedo=0.4, observer_altitude=1e3)
    mixed = campaign.build_atmosphere(4.0, 0.4, observer_altitude=1e3)
    for one, other in zip(jax.tree.leaves(by_name), jax.tree.leaves(mixed), strict=True):
        np.testing.assert_array_equal(one, other)
    assert campaign.observer_altitude_at(4.0, 0.4, 1e3) == 1e3
    for values, names in [((4.0, 0.4), {}), ((4.0,) * 4, {}), ((4.0, 0.4), {"turbidity": 2.0})]:
        with pytest.raises(skyfit.InputError, match="expected values of turbidity, ground_albedo"):
            campaign.build_atmosphere(*values, **names)
