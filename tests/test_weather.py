"""Weather years: every row comes back, the sun is pvlib's, the dome has its irradiance's light."""

import sys

import numpy as np
import pandas as pd
import pytest
from weather_years import YEARS, irradiance, write_epw, write_tmy3

import skyfit
from skyfit.surfaces.dome import dome_grid


EVERY_OTHER_MONTH = range(15, 365, 61)


@pytest.fixture(params=YEARS)
def year(request, tmp_path):
    made = YEARS[request.param]
    rows = irradiance(made, EVERY_OTHER_MONTH)
    write_epw(tmp_path / "year.epw", made, rows)
    return made, rows, skyfit.weather_table(skyfit.read_weather(tmp_path / "year.epw"))


@pytest.mark.slow
def test_every_row_of_a_year_comes_back_with_the_sun_and_the_sky_of_pvlib(year):
    made, rows, table = year
    assert table.index.equals(rows.index.rename("time"))
    np.testing.assert_allclose(table["sun_zenith"], rows["zenith"], atol=np.radians(0.007))
    gone = rows["dhi"].isna()
    assert gone.any() == (made.gaps > 0)
    np.testing.assert_array_equal(table["diffuse_illuminance"].isna(), gone)
    np.testing.assert_array_equal(table["direct_normal"], rows["dni"].clip(lower=0))
    dark = ~gone & (rows["dhi"] <= 0)
    assert dark.sum() > 20
    np.testing.assert_array_equal(table["diffuse_illuminance"][dark], 0.0)
    # Perez et al. (1990), equations 1 and 2, with pvlib's sun, air mass and sunlight above the air.
    day = (rows["dhi"] > 0) & (rows["zenith"] < np.radians(85))
    bend = 1.041 * rows["zenith"] ** 3
    clearness = 1 + rows["dni"] / rows["dhi"] / (1 + bend)
    brightness = (rows["mass"] * rows["dhi"] / rows["top"]).clip(0.01, 0.6)
    np.testing.assert_allclose(table["clearness"][day], clearness[day].clip(1, 12), rtol=1e-3)
    np.testing.assert_allclose(table["brightness"][day], brightness[day], rtol=2e-3)


def test_the_dome_of_every_hour_by_day_has_the_light_of_its_irradiance(year):
    _, rows, table = year
    zenith, azimuth, solid_angle = dome_grid(48, 64)
    sky = skyfit.perez_all_weather_sky(
        *(table[name].to_numpy()[:, None, None] for name in (
            "direct_normal", "diffuse_horizontal"
        )),
        extraterrestrial=table["extraterrestrial"].to_numpy()[:, None, None],
    )  # fmt: skip
    sun = table["sun_zenith"].to_numpy()[:, None, None]
    light = np.asarray(sky.xyY(sun, zenith[:, None], azimuth[None])[..., 2])
    ground = np.einsum("rza,z->r", light, np.cos(zenith) * solid_angle)
    np.testing.assert_allclose(ground, table["diffuse_illuminance"], rtol=1e-3, atol=1e-6)
    # 80 to 170 lm/W is what the sky's light has; Perez et al. (1990), table 4.
    bright = (rows["dhi"] > 30) & (rows["zenith"] < np.radians(85))
    efficacy = (ground / rows["dhi"])[bright]
    assert efficacy.between(80, 170).all()


def test_a_tmy3_file_is_the_same_year(tmp_path):
    made = YEARS["gaps"]
    rows = irradiance(made, [10, 190])
    write_tmy3(tmp_path / "year.csv", made, rows)
    write_epw(tmp_path / "year.epw", made, rows)
    tmy, epw = (skyfit.read_weather(tmp_path / f"year.{kind}") for kind in ("csv", "epw"))
    pd.testing.assert_frame_equal(tmy, epw)
    assert tmy.attrs == epw.attrs
    assert tmy.attrs["latitude"] == np.radians(48.2)
    assert tmy["diffuse_horizontal"].isna().any()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.epw", b"", "a.epw: expected an EnergyPlus file"),
        ("a.epw", b"wavelength,value\n1,2\n", "a.epw: expected an EnergyPlus file"),
        ("a.csv", b"a,b\n1,2\n", "a.csv: expected a TMY3 file"),
        ("a.csv", b"", "a.csv: expected a TMY3 file"),
        ("a.txt", b"", "a.txt: expected an EnergyPlus file"),
    ],
)
def test_another_file_is_refused(name, content, message, tmp_path):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(skyfit.InputError, match=message):
        skyfit.read_weather(tmp_path / name)


def test_without_pvlib_the_way_to_it_is_told(tmp_path, monkeypatch):
    (tmp_path / "a.epw").write_text("")
    monkeypatch.setitem(sys.modules, "pvlib", None)
    with pytest.raises(skyfit.InputError, match=r"pip install 'skyfit\[weather\]'"):
        skyfit.read_weather(tmp_path / "a.epw")
    with pytest.raises(FileNotFoundError):
        skyfit.read_weather(tmp_path / "b.epw")


NOON = pd.DatetimeIndex(["2024-06-21T12:00", "2024-06-21T13:00"], tz="Europe/Vienna")


def test_what_cannot_be_irradiance_is_missing_and_counted():
    weather = pd.DataFrame({"dni": [700.0, 700.0], "dhi": [-9999.0, 100.0]}, NOON)
    with pytest.warns(UserWarning, match="1 irradiances below -30 or above 1367"):
        table = skyfit.weather_table(weather, *np.radians([48.2, 16.4]))
    assert table["diffuse_illuminance"].isna().tolist() == [True, False]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.rename(columns={"dni": "x"}), "expected a column direct_normal or dni"),
        (lambda t: t.assign(dhi=["a", "b"]), "column dhi: expected numbers"),
        (lambda t: t.reset_index(drop=True), "expected ISO strings, datetime or pandas times"),
        (lambda t: t.tz_localize(None), "expected a time zone"),
    ],
)
def test_a_table_that_is_none_is_refused(change, message):
    weather = pd.DataFrame({"dni": [700.0, 700.0], "dhi": [90.0, 100.0]}, NOON)
    with pytest.raises(skyfit.InputError, match=message):
        skyfit.weather_table(change(weather), *np.radians([48.2, 16.4]))
    with pytest.raises(skyfit.InputError, match="expected a place"):
        skyfit.weather_table(weather)
