"""Campaigns of atmospheres that a program makes: one, or a function of what is swept."""

import dataclasses
import inspect
import json
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from stand_in import stand_in

import skyfit
from skyfit.campaign.plain import from_plain, to_plain
from skyfit.dataset import campaign_of, runner


SIMS = sorted((Path(__file__).parent.parent / "sims").glob("*.toml"))
LAM = np.array([450.0, 550.0, 650.0])
SUN = skyfit.preetham_atmosphere(2.0, wavelengths=LAM).solar_irradiance
FEW = {
    "sun_zenith": np.radians([10.0, 60.0]),
    "view_zenith": np.radians([0.0, 60.0]),
    "relative_azimuth": np.radians([0.0, 90.0]),
    "quality": "draft",
}


def dusty(dust, albedo=0.1):
    """Air and dust of an optical depth."""
    return skyfit.Atmosphere(
        LAM,
        SUN,
        (
            skyfit.preetham_atmosphere(2.0, wavelengths=LAM).constituents[0],
            skyfit.Constituent(
                skyfit.profile.Exponential(2000.0),
                scattering=dust / 2000.0,
                phase=skyfit.phase.HenyeyGreenstein(0.7),
            ),
        ),
        ground_albedo=albedo,
    )


def turbid(turbidity):
    return skyfit.preetham_atmosphere(turbidity, wavelengths=LAM)


@pytest.fixture
def quick(monkeypatch):
    """A stand-in for the simulator."""
    monkeypatch.setattr(runner, "simulate", stand_in)


@pytest.mark.slow
def test_skies_of_an_atmosphere_are_those_of_the_simulator():
    air = dusty(0.2)
    skies = skyfit.run_campaign(skyfit.Campaign(atmosphere=air, **FEW))
    assert skies["radiance"].dims == ("sun_zenith", "direction", "wavelength")
    assert skies["wavelength"].values.tolist() == LAM.tolist()
    sun, view = FEW["sun_zenith"][:, None], FEW["view_zenith"][None]
    direct = skyfit.simulate(air, sun, view, FEW["relative_azimuth"][None], quality="draft")
    np.testing.assert_allclose(skies["radiance"], direct.radiance, rtol=1e-10)


def test_a_function_of_turbidity_is_swept_like_the_papers_atmosphere(quick):
    ours = skyfit.run_campaign(skyfit.Campaign([2, 4], atmosphere=turbid, **FEW))
    papers = skyfit.run_campaign(skyfit.Campaign([2, 4], wavelengths=LAM, **FEW))
    assert ours["turbidity"].values.tolist() == [2, 4]
    xr.testing.assert_equal(ours, papers)
    assert ours.attrs["atmosphere"] == papers.attrs["atmosphere"]
    assert skyfit.Campaign(atmosphere=turbid, **FEW).turbidity == (2, 3, 4, 5, 6)


def test_a_function_of_another_parameter_gives_the_dataset_its_dimension(quick):
    campaign = skyfit.Campaign(atmosphere=dusty, sweep={"dust": [0.1, 0.4]}, **FEW)
    skies = skyfit.run_campaign(campaign)
    assert skies["radiance"].dims == ("dust", "sun_zenith", "direction", "wavelength")
    assert skies["dust"].values.tolist() == [0.1, 0.4]
    first = skyfit.run_campaign(skyfit.Campaign(atmosphere=dusty(0.1), **FEW))
    np.testing.assert_allclose(skies["radiance"].sel(dust=0.1), first["radiance"], rtol=1e-13)
    later = campaign.build_atmosphere(dust=0.2)  # a value between those that were swept
    np.testing.assert_allclose(later.constituents[1].scattering, 1e-4)


def test_the_observer_of_an_atmosphere_can_be_swept():
    sweep = {"observer_altitude": [0.0, 5e3]}
    campaign = skyfit.Campaign(atmosphere=dusty(0.1), sweep=sweep, **FEW)
    assert campaign.sky_dims == ("observer_altitude", "sun_zenith")
    assert [campaign.observer_altitude_at(**place) for place in campaign.places] == [0.0, 5e3]
    assert campaign.build_atmosphere(observer_altitude=5e3) is campaign.atmosphere


@pytest.mark.parametrize("swept", [{}, {"sweep": {"dust": [0.1, 0.4]}}])
def test_the_record_says_what_the_atmosphere_was_and_can_be_simulated_again(quick, swept):
    air = dusty if swept else dusty(0.1)
    campaign = skyfit.Campaign(atmosphere=air, **swept, **FEW)
    record = skyfit.run_campaign(campaign)
    first = json.loads(record.attrs["atmosphere"])[0]
    assert first["constituents"][1]["density"] == {"type": "Exponential", "scale_height": 2000.0}
    assert first["ground_albedo"] == [0.1] * 3
    assert "references" not in record.attrs
    found = campaign_of(record)
    assert found == campaign
    assert hash(found) == hash(campaign)
    xr.testing.assert_identical(skyfit.run_campaign(found), record)
    if swept:
        with pytest.raises(ValueError, match=r"at dust = 0.1; dust = 0.4; not at dust = 0.2"):
            found.build_atmosphere(dust=0.2)


def test_a_campaign_survives_json_and_replacement():
    campaign = skyfit.Campaign(atmosphere=dusty, sweep={"dust": [0.1, 0.4]}, **FEW)
    assert skyfit.Campaign.from_dict(json.loads(json.dumps(campaign.to_dict()))) == campaign
    other = dataclasses.replace(campaign, orders=3)
    assert other.orders == 3
    assert other.atmosphere is dusty
    assert other != campaign


@pytest.mark.parametrize("name", ["sky.zarr", "sky.nc"])
def test_a_store_of_another_atmosphere_is_refused(quick, tmp_path, name):
    store = tmp_path / name
    record = skyfit.run_campaign(skyfit.Campaign(atmosphere=dusty(0.1), **FEW), store=store)
    again = skyfit.run_campaign(skyfit.Campaign(atmosphere=dusty(0.1), **FEW), store=store)
    xr.testing.assert_identical(again, record)
    for other in (dusty(0.1, albedo=0.1001), dusty(0.2), turbid(2.0)):
        with pytest.raises(ValueError, match="was made by another campaign; give another name"):
            skyfit.run_campaign(skyfit.Campaign(atmosphere=other, **FEW), store=store)


def test_a_store_of_another_function_is_refused(quick, tmp_path):
    store, sweep = tmp_path / "sky.zarr", {"dust": [0.1, 0.4]}
    skyfit.run_campaign(skyfit.Campaign(atmosphere=dusty, sweep=sweep, **FEW), store=store)
    # Of the same name and parameter, and the same at the first value.
    changed = skyfit.Campaign(
        atmosphere=lambda dust: dusty(dust if dust < 0.2 else 0.3), sweep=sweep, **FEW
    )
    with pytest.raises(ValueError, match="was made by another campaign"):
        skyfit.run_campaign(changed, store=store)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"atmosphere": "air.toml"}, r"Campaign\(atmosphere=...\): expected an Atmosphere, .* str"),
        ({"atmosphere": 3.0}, "expected an Atmosphere, a function .* got float"),
        ({"atmosphere": lambda turbidity: 2.0}, "at turbidity = 2 it returned float"),
        ({"atmosphere": dusty}, "is called with the swept turbidity alone; dusty cannot be"),
        ({"atmosphere": turbid, "sweep": {"dust": [1.0]}}, "the swept dust alone; turbid cannot"),
        ({"atmosphere": dusty(0.1), "turbidity": [2.0]}, r"turbidity=...\): an Atmosphere stays"),
        ({"atmosphere": dusty(0.1), "sweep": {"dust": [1.0]}}, r"sweep=...\): an Atmosphere stays"),
        (
            {"atmosphere": dusty, "sweep": {"dust": [1.0], "soot": [1.0]}},
            "the swept dust, soot alone; dusty can",
        ),
        ({"atmosphere": dusty, "sweep": {}}, "a parameter or more; got none"),
        ({"atmosphere": dusty, "sweep": {"wavelength": [1.0]}}, "wavelength is taken"),
        ({"atmosphere": dusty, "sweep": {"dust": [2.0, 1.0]}}, "increasing values; got 2 before 1"),
        (
            {"atmosphere": dusty, "turbidity": [2.0], "sweep": {"dust": [1.0]}},
            "is called with the swept turbidity, dust alone; dusty cannot be",
        ),
        (
            {"atmosphere": dusty(0.1), "wavelengths": [450.0, 550.0]},
            "those of the atmosphere, 3 from 450 to 650 nm; got 2 from 450 to 550 nm",
        ),
        (
            {
                "atmosphere": lambda dust: skyfit.preetham_atmosphere(2.0, wavelengths=[1e2, dust]),
                "sweep": {"dust": [200.0, 300.0]},
            },
            "same wavelengths everywhere; those at dust = 300 are not those at dust = 200",
        ),
        ({"sweep": {"dust": [1.0]}}, "the paper's atmosphere is swept over turbidity"),
    ],
)
def test_what_a_campaign_cannot_take_is_refused_by_name(given, message):
    make = inspect.unwrap(skyfit.Campaign.__init__)  # without the tests' own check of types
    with pytest.raises(ValueError, match=message):
        make(object.__new__(skyfit.Campaign), **given)


def test_a_campaign_of_traced_numbers_is_refused():
    def skies(dust):
        return skyfit.Campaign(atmosphere=dusty(dust), **FEW).num_skies * dust

    with pytest.raises(ValueError, match="expected known numbers; a campaign is ordinary Python"):
        jax.grad(skies)(0.1)


@pytest.mark.slow
@pytest.mark.parametrize("path", SIMS, ids=lambda path: path.stem)
def test_every_shipped_atmosphere_comes_back_from_names_and_numbers(path):
    air = skyfit.load_atmosphere(path)
    assert eqx.tree_equal(from_plain(json.loads(json.dumps(to_plain(air)))), air)


@pytest.mark.slow
def test_bands_and_refraction_come_back_too():
    vapour = skyfit.water_vapour(LAM, 0.02)
    bent = skyfit.Refraction(2.8e-4, skyfit.profile.StandardAtmosphere())
    air = skyfit.Atmosphere(LAM, SUN, (dusty(0.1).constituents[0], vapour), refraction=bent)
    assert eqx.tree_equal(from_plain(json.loads(json.dumps(to_plain(air)))), air)


class Slab(skyfit.profile.AbstractProfile):
    """A user's own profile."""

    top: jax.Array

    def __call__(self, altitude):
        return jnp.where(altitude < self.top, 1.0, 0.0)

    def column(self, top):
        return jnp.minimum(self.top, top)

    def knots(self):
        return self.top[None]


def test_a_class_of_the_users_own_is_on_record_by_its_full_name():
    one = skyfit.Constituent(Slab(jnp.asarray(1e3)), scattering=1e-5, phase=skyfit.phase.Rayleigh())
    plain = to_plain(skyfit.Atmosphere(LAM, SUN, (one,)))
    density = plain["constituents"][0]["density"]
    assert density["type"].endswith("test_campaign_given.Slab")
    with pytest.raises(ValueError, match=r"Slab is no class of skyfit's"):
        from_plain(plain)
