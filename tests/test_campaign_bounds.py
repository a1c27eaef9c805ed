"""What a stranger's campaign file may ask for: bounded before memory is taken, and plausible."""

import os
import re

import numpy as np
import pytest

import skyfit
from skyfit.campaign import Campaign
from skyfit.profile import Exponential, Raised, StandardAtmosphere, Tabulated


HEAD = 'schema = "skyfit/campaign/1"\n'
AIR = '[[constituents]]\nname = "air"\nkind = "air"\n'
HAZE = (
    '[[constituents]]\nname = "haze"\nkind = "angstrom_aerosol"\noptical_depth = 0.2\n'
    "angstrom_exponent = 1.3\nasymmetry = 0.7\n"
)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("[sampling]\nsun_zenith_deg = {first = 0, last = 90, count = 999999999}",
         "sampling.sun_zenith_deg: count: expected a whole number, 1 to 100000; got 999999999"),
        ("[sampling]\nrelative_azimuth_deg = {first = 0, last = 180, step = 1e-5}",
         "sampling.relative_azimuth_deg: expected at most 100000 values; steps of 1e-05 make 1.8"),
        ("[sampling]\nview_zenith_deg = {first = 0, last = 90, count = 2000}\n"
         "relative_azimuth_deg = {first = 0, last = 180, count = 2000}",
         "sampling: expected at most 100000 directions; got 4000000"),
        ("[sampling]\nview_zenith_deg = {first = 0, last = 90, count = 90}\n"
         "relative_azimuth_deg = {first = 0, last = 180, count = 1000}",
         "expected at most 200000000 radiances; 60 skies of 90001 directions"),
        ("[simulation]\norders = 1000000", "simulation.orders: expected less than or equal to 100"),
        (AIR + "[planet]\ntop_altitude_m = 1", "planet.top_altitude_m: .*or equal to 1000; got 1"),
        (AIR + "[planet]\nradius_m = 3.39", "planet.radius_m: .*equal to 100000; got 3.39"),
        (AIR + "[planet]\nradius_m = 1e30", "planet.radius_m: .*less than or equal to 1000000000"),
        (AIR + "[sun]\ndistance_au = 1e-300", "sun.distance_au: .*or equal to 0.001"),
        (AIR + "[ground]\naltitude_m = 30e3", "ground.altitude_m: .*or equal to 20000"),
        (AIR + "[planet]\ntop_altitude_m = 5e3\n[ground]\naltitude_m = 5e3",
         "ground.altitude_m: expected less than planet.top_altitude_m; got 5000"),
        (AIR + HAZE.replace("0.2", "9" * 400), "constituents.1..optical_depth"),
        (AIR + HAZE + 'profile = {kind = "table", density = {altitude_m = [0, 9], value = [0, 0]}}',
         "constituents.haze.profile: expected some density below top_altitude_m; got"),
        (AIR + HAZE + 'profile = {kind = "tent", bottom_m = 7e4, peak_m = 8e4, top_m = 9e4}',
         "constituents.haze.profile: expected some density below top_altitude_m"),
        (AIR + '[ground]\nalbedo = {csv = "/dev/zero", column = "a"}', "zero: expected a file;"),
        (AIR + '[ground]\nalbedo = {csv = "fifo", column = "a"}', "fifo: expected a file; this is"),
        (AIR + '[ground]\nalbedo = {csv = ".", column = "a"}', "expected a file; this is a folder"),
        (AIR + '[ground]\nalbedo = {csv = "../a.csv", column = "a"}',
         "csv: expected a file beside the campaign's, or its whole name; got '../a.csv'"),
        (AIR + '[ground]\nalbedo = {csv = "a.csv", column = "b"}', "column b: expected a number"),
        (AIR + '[sweep]\nkey = "ground.scale"\nvalues = [0, 1]\nname = "lambda"', "lambda is"),
        (AIR + '[sweep]\nkey = "ground.scale"\nvalues = [0, 1]\nname = "path"', "path is taken"),
    ],
)  # fmt: skip
def test_what_no_machine_or_sky_can_have_is_refused(tmp_path, content, message):
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "a.csv").write_text("wavelength_nm,a,b\n400,0.1,0.1\n500,0.1,inf\n")
    file = tmp_path / "c.toml"
    file.write_text(HEAD + content)
    with pytest.raises(skyfit.InputError, match=message) as refusal:
        skyfit.load_campaign(file)
    assert "\n" not in str(refusal.value)


def test_a_table_is_taken_from_beside_the_campaign_and_by_its_whole_name(tmp_path):
    (tmp_path / "in").mkdir()
    table = tmp_path / "in" / "a.csv"
    table.write_text("wavelength_nm,a\n400,0.1\n800,0.1\n")
    for name in ("in/a.csv", str(table)):
        file = tmp_path / "c.toml"
        file.write_text(f'{HEAD}{AIR}[ground]\nalbedo = {{csv = "{name}", column = "a"}}\n')
        assert skyfit.load_atmosphere(file, [500.0]).ground_albedo[0] == pytest.approx(0.1)


@pytest.mark.parametrize("name", ["time", "lambda", "class", "x", "self", "path", "2b", "a b"])
def test_names_that_no_call_can_have_are_refused_in_programs_too(name):
    air = skyfit.preetham_atmosphere(3.0, wavelengths=[500.0])
    with pytest.raises(ValueError, match=re.escape(name)):
        Campaign(atmosphere=lambda **_: air, sweep={name: [1.0, 2.0]})


def test_campaigns_of_programs_are_bounded_too():
    many = np.zeros(100_001)
    with pytest.raises(ValueError, match="at most 100000 directions; got 100001"):
        Campaign(view_zenith=many, relative_azimuth=many)


# By hand: a triangle from 1000 over 1010 to 1100 m whose top is a step of 90 m, and its flanks.
@pytest.mark.parametrize(
    ("altitude", "density", "column"),
    [
        ([0, 1000, 1000.001, 1090, 1090.001], [0, 0, 1, 1, 0], 90.0),
        ([0, 10, 10.001], [1, 1, 0], 10.0),
        ([0, 1000, 1010, 1100, 1110], [0, 0, 1, 1, 0], 100.0),
        ([0, 59000, 61000], [0, 0, 2], 500.0),
    ],
)
def test_the_column_of_a_sharp_layer_is_its_area(altitude, density, column):
    assert float(Tabulated(altitude, density).column(60e3)) == pytest.approx(column, rel=1e-4)


def test_the_column_of_a_thin_exponential_is_its_scale_height():
    assert float(Exponential(3.0).column(60e3)) == pytest.approx(3.0, rel=1e-12)


def high(tmp_path, altitude, more=""):
    file = tmp_path / "high.toml"
    ozone = '[[constituents]]\nname = "ozone"\nkind = "ozone"\ndobson_units = 300\n'
    file.write_text(f"{HEAD}[ground]\naltitude_m = {altitude}\n{AIR}{HAZE}{ozone}{more}")
    return skyfit.load_atmosphere(file, [550.0])


def test_a_high_plateau_has_less_air_above_it_and_a_larger_radius(tmp_path):
    sea, plateau = high(tmp_path, 0), high(tmp_path, 5000)
    depth = np.asarray(plateau.optical_depth() / sea.optical_depth())[:, 0]
    # U.S. Standard Atmosphere 1976, table I: 54019.9 Pa at 5 km of 101325 Pa; gravity, which
    # falls by 0.16 %, is all that tells columns from pressures.
    assert depth[0] == pytest.approx(54019.9 / 101325, rel=2e-3)
    # The haze lies on the ground, and 300 Dobson units are above it.
    assert depth[1:] == pytest.approx(1.0, rel=1e-6)
    assert float(plateau.planet_radius - sea.planet_radius) == 5000
    assert float(sea.top_altitude - plateau.top_altitude) == 5000
    # The layer of ozone has its peak 25 km above the sea.
    ozone = plateau.constituents[2].density
    assert float(ozone(20e3)) == pytest.approx(1.0)


def test_the_ground_can_be_swept_and_oxygen_falls_with_the_pressure(tmp_path):
    oxygen = '[[constituents]]\nname = "oxygen"\nkind = "oxygen"\n'
    sweep = '[sweep]\nkey = "ground.altitude_m"\nvalues = [0, 5000]\n'
    high(tmp_path, 0, oxygen + sweep)
    file = tmp_path / "high.toml"
    sea, plateau = (skyfit.load_atmosphere(file, [760.0], altitude=a) for a in (0.0, 5000.0))
    share = plateau.constituents[3].density.column(55e3) / sea.constituents[3].density.column(60e3)
    bands = [air.constituents[3].bands for air in (sea, plateau)]
    assert all(one is not None for one in bands)
    assert float(share) == pytest.approx(54019.9 / 101325, rel=2e-3)
    # As much per metre of air of one density: the line strengths do not change.
    np.testing.assert_allclose(bands[0].strength, bands[1].strength, rtol=1e-6)


def test_a_raised_profile_is_the_same_one_from_higher_up():
    profile = Raised(StandardAtmosphere(), 5000.0)
    # Table I: 0.73643 kg/m3 at 5 km and 0.41351 at 10 km, of 1.2250 at the sea.
    assert float(profile(0.0)) == pytest.approx(0.73643 / 1.2250, rel=1e-4)
    assert float(profile(5000.0)) == pytest.approx(0.41351 / 1.2250, rel=1e-4)
    assert float(profile.knots()[0]) == pytest.approx(11019.1 - 5000, abs=0.1)
    with pytest.raises(ValueError, match="must be 0 m or more"):
        Raised(StandardAtmosphere(), -1.0)
