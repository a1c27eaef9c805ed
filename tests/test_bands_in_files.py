"""Water vapour and oxygen in campaign files."""

import dataclasses

import numpy as np
import pytest

import skyfit


pytestmark = pytest.mark.any_precision


LAM = np.array([550.0, 690.0, 720.0])
FILE = """
schema = "skyfit/campaign/1"

[[constituents]]
name = "air"
kind = "air"

[[constituents]]
name = "vapour"
kind = "water_vapour"
precipitable_water_cm = 2

[[constituents]]
name = "oxygen"
kind = "oxygen"

[sweep]
key = "constituents.vapour.precipitable_water_cm"
values = [1, 2]

[sampling]
sun_zenith_deg = 60
view_zenith_deg = 40
relative_azimuth_deg = 90
wavelengths_nm = [550, 690, 720]

[simulation]
orders = 1
quality = "draft"
"""


@pytest.mark.slow
def test_a_campaign_file_has_water_vapour_and_oxygen(tmp_path):
    (tmp_path / "wet.toml").write_text(FILE)
    air = skyfit.load_atmosphere(tmp_path / "wet.toml")
    gases = skyfit.water_vapour(LAM, 0.02), skyfit.oxygen(LAM)
    for got, want in zip(air.constituents[1:], gases, strict=True):
        np.testing.assert_allclose(got.bands.absorption, want.bands.absorption, rtol=1e-12)
        assert got.density(1e3) == want.density(1e3)
    campaign = skyfit.load_campaign(tmp_path / "wet.toml")
    assert skyfit.Campaign.from_dict(campaign.to_dict()) == campaign
    skies = skyfit.run_campaign(campaign)
    assert skies["precipitable_water"].attrs["units"] == "cm"
    light = skies["radiance"].isel(sun_zenith=0).values
    assert (light[0, :, 2] > light[1, :, 2]).all()
    np.testing.assert_allclose(light[0, :, 0], light[1, :, 0], rtol=1e-5)


@pytest.mark.parametrize(
    ("line", "wrong", "message"),
    [
        ("precipitable_water_cm = 2\n", "", "vapour|precipitable_water_cm: is missing"),
        ("water_cm = 2", "water_cm = -1", "precipitable_water_cm: expected .*greater.* -1"),
        ("720]", "820]", "known up to 800 nm; got 820"),
    ],
)
def test_what_a_file_says_wrong_of_bands_is_named(tmp_path, line, wrong, message):
    assert line in FILE
    (tmp_path / "wet.toml").write_text(FILE.replace(line, wrong))
    with pytest.raises(ValueError, match=message):
        skyfit.load_campaign(tmp_path / "wet.toml")


def test_the_papers_atmosphere_has_no_bands():
    campaign = dataclasses.replace(skyfit.Campaign(), wavelengths=(720.0,))
    air = campaign.build_atmosphere(**campaign.places[0])
    assert all(one.bands is None for one in air.constituents)
