"""The shipped campaign files: each runs, fits and gives a sky, at a fraction of its size."""

import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pytest

import skyfit
from skyfit.campaign import half_dome


SIMS = Path(__file__).parent.parent / "sims"
FILES = sorted(SIMS.glob("*.toml"))
VIEW, AZIMUTH = half_dome(np.radians([30.0, 60.0, 80.0]), np.radians([0.0, 45.0, 90.0, 180.0]))


def reduced(campaign):
    """Two values of the sweep, three suns, a few directions: one program fits them all."""
    ends = [
        dataclasses.replace(one, values=(one.values[0], one.values[-1])) for one in campaign.sweep
    ]
    return dataclasses.replace(
        campaign,
        turbidity=(2.0, 6.0) if campaign.turbidity else None,
        sweep=ends,
        sun_zenith=np.radians([20.0, 50.0, 75.0]),
        view_zenith=VIEW,
        relative_azimuth=AZIMUTH,
        wavelengths=[430.0, 490.0, 550.0, 610.0, 670.0],
        orders=1,
        quality="draft",
    )


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_shipped_campaign_runs_and_fits_and_gives_a_sky(file):
    campaign = reduced(skyfit.load_campaign(file))
    skies = skyfit.run_campaign(campaign)
    assert skies["radiance"].dims == (*campaign.sky_dims, "direction", "wavelength")
    fit = skyfit.fit_sky(skies)
    sky = fit.sky(**campaign.places[0])
    found = np.asarray(sky.xyY(campaign.sun_zenith[1], VIEW, AZIMUTH))
    first = skies.isel(dict.fromkeys(campaign.swept, 0))
    truth = first["luminance"].isel(sun_zenith=1).values
    # Within a factor of two and a half in the middle of the range: dust is the hardest.
    assert (abs(np.log(found[:, 2] / truth)) < np.log(2.5)).mean() > 0.9
    assert ((found[:, :2] > 0.1) & (found[:, :2] < 0.6)).all()


def test_every_campaign_has_its_thumbnail_and_its_place_in_the_readme():
    text = (SIMS / "README.md").read_text()
    assert set(re.findall(r"\((\w+\.toml)\)", text)) == {file.name for file in FILES}
    shown = re.findall(r"!\[[^]]*\]\((thumbnails/\w+\.png)\)", text)
    assert {Path(name).stem for name in shown} == {file.stem for file in FILES}
    assert all((SIMS / name).exists() for name in shown)


@pytest.mark.slow
def test_on_a_higher_plateau_the_zenith_is_darker():
    campaign = reduced(skyfit.load_campaign(SIMS / "high_altitude.toml"))
    zenith = skyfit.run_campaign(campaign).isel(direction=0, sun_zenith=1)
    assert (np.diff(zenith["luminance"]) < 0).all()


def test_the_shipped_fit_of_cornells_day_is_as_close_to_the_measured_skies_as_recorded():
    record = json.loads((SIMS / "cornell_2013.json").read_text())["rmse_mW_m-2_sr-1_nm-1"]
    skies = skyfit.cornell_skies()
    skies = skies.isel(direction=skies["reliable"].values)
    lam = 360 + 11.75 * np.arange(31)
    sun, view = skies["sun_zenith"].values[:, None], skies["view_zenith"].values[None]
    sky = skyfit.load_fit(SIMS / "cornell_2013.fit.json").sky()
    found = np.asarray(sky.radiance(sun, view, skies["relative_azimuth"].values, lam))
    error = found - skies["radiance"].interp(wavelength=lam).values
    rmse = 1e3 * np.sqrt(np.mean(error**2))
    # The same numbers from the same file: nothing but rounding may differ.
    assert rmse == pytest.approx(record["best of the ladder, fitted to the simulation"]["day"])
    assert rmse < 12
