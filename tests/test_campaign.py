"""Which skies are simulated: the paper's by default, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest

import skyfit
from skyfit.campaign import half_dome


pytestmark = pytest.mark.any_precision


SIMS = Path(__file__).parent.parent / "sims"
HEAD = 'schema = "skyfit/campaign/1"\n'


def test_the_default_campaign_is_as_large_as_the_papers():
    campaign = skyfit.Campaign()
    assert campaign.turbidity == (2, 3, 4, 5, 6)
    assert len(campaign.sun_zenith) == 12
    assert len(campaign.view_zenith) == len(campaign.relative_azimuth) == 343
    assert len(campaign.wavelengths) == 41
    assert campaign.num_skies == 60
    assert (campaign.orders, campaign.geometry) == (2, "spherical")


def test_suns_of_the_default_campaign_run_evenly_from_overhead_to_5_degrees_of_elevation():
    suns = np.degrees(skyfit.Campaign().sun_zenith)
    np.testing.assert_allclose([suns[0], suns[-1]], [0, 85], atol=1e-12)
    np.testing.assert_allclose(np.diff(suns), 85 / 11, rtol=1e-12)


def test_directions_of_the_default_campaign_cover_the_half_dome_with_the_zenith_once():
    campaign = skyfit.Campaign()
    view, azimuth = np.degrees(campaign.view_zenith), np.degrees(campaign.relative_azimuth)
    assert np.count_nonzero(view == 0) == 1
    np.testing.assert_allclose(np.unique(np.round(view, 9)), np.arange(0, 91, 5), atol=1e-9)
    np.testing.assert_allclose(np.unique(np.round(azimuth, 9)), np.arange(0, 181, 10), atol=1e-9)
    assert len({*zip(view.round(9), azimuth.round(9), strict=True)}) == 343


def test_the_shipped_campaign_file_is_the_default():
    assert skyfit.load_campaign(SIMS / "preetham1999.toml") == skyfit.Campaign()


def test_a_file_that_says_nothing_but_its_schema_is_the_default(tmp_path):
    (tmp_path / "empty.toml").write_text(HEAD)
    assert skyfit.load_campaign(tmp_path / "empty.toml") == skyfit.Campaign()


def test_a_campaign_file_speaks_degrees_and_the_library_radians(tmp_path):
    file = tmp_path / "one.toml"
    file.write_text(
        HEAD
        + "[sweep]\nturbidity = 3\n[sampling]\nsun_zenith_deg = [30, 90]\nzenith = false\n"
        + "view_zenith_deg = 45\nrelative_azimuth_deg = {first = 0, last = 180, count = 3}\n"
        + "wavelengths_nm = {first = 400, last = 700, step = 100}\n"
        + '[simulation]\norders = "all"\nobserver_altitude_m = 1500\n'
    )
    campaign = skyfit.load_campaign(file)
    np.testing.assert_allclose(campaign.sun_zenith, [np.pi / 6, np.pi / 2], rtol=1e-15)
    np.testing.assert_allclose(campaign.view_zenith, [np.pi / 4] * 3, rtol=1e-15)
    np.testing.assert_allclose(campaign.relative_azimuth, [0, np.pi / 2, np.pi], rtol=1e-15)
    assert campaign.wavelengths == (400, 500, 600, 700)
    assert campaign.orders is None
    assert campaign.observer_altitude == 1500


def test_a_campaign_survives_json():
    campaign = skyfit.Campaign(
        turbidity=[2.5], orders=None, atmosphere=skyfit.PaperAtmosphere(ozone=True)
    )
    assert skyfit.Campaign.from_dict(json.loads(json.dumps(campaign.to_dict()))) == campaign


@pytest.mark.slow
def test_the_campaigns_atmosphere_is_the_papers_of_that_turbidity():
    campaign = skyfit.Campaign(wavelengths=[450.0, 550.0, 650.0])
    depth = campaign.build_atmosphere(turbidity=3.0).optical_depth()
    # The definition: T is the optical thickness of air and haze over that of air at 550 nm.
    np.testing.assert_allclose(depth[:, 1].sum() / depth[0, 1], 3, rtol=1e-12)


def test_a_half_dome_runs_through_the_azimuths_of_each_ring_in_turn():
    view, azimuth = half_dome([1.0, 2.0], [0.0, 3.0])
    assert view.tolist() == [0, 1, 1, 2, 2]
    assert azimuth.tolist() == [0, 0, 3, 0, 3]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"turbidity": [0.5]}, r"Campaign\(turbidity=...\): expected .* 1 or more; got 0.5"),
        ({"turbidity": [3, 2]}, "turbidity=.* expected increasing values; got 3 before 2"),
        ({"turbidity": float("nan")}, "turbidity=.* got nan"),
        ({"sun_zenith": [1.0, 4.0]}, r"sun_zenith=.* within \[0, 3.14159\]; got 4"),
        ({"wavelengths": []}, r"wavelengths=.* expected one axis; got shape \(0,\)"),
        ({"view_zenith": [1.0]}, "view_zenith and relative_azimuth .* got only one"),
        (
            {"view_zenith": [1.0], "relative_azimuth": [0.0, 1.0]},
            "as many relative_azimuth as view_zenith, .* got 2 and 1",
        ),
        (
            {"view_zenith": [1.0], "relative_azimuth": [np.inf]},
            "relative_azimuth=.* finite values within .*12.5664.; got inf",
        ),
        (
            {"view_zenith": [1.0], "relative_azimuth": [90.0]},
            "relative_azimuth=.* finite values within .*12.5664.; got 90",
        ),
        ({"orders": 0}, "orders=.* expected 1 to 100, or None for all; got 0"),
        ({"observer_altitude": -1.0}, "observer_altitude=.* expected 0 m or more; got -1.0"),
        ({"geometry": "round"}, "geometry=.* expected one of 'spherical', .* got 'round'"),
        ({"quality": "best"}, "quality=.* expected one of 'draft', .* got 'best'"),
    ],
)
def test_an_impossible_campaign_is_refused_by_the_name_of_its_argument(wrong, message):
    with pytest.raises(ValueError, match=message):
        skyfit.Campaign(**wrong)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "schema is missing"),
        ("x", "not a TOML file"),
        ('schema = "other/1"', "schema: expected 'skyfit/campaign/1'; got 'other/1'"),
        (HEAD + "[swep]\nturbidity = 2", "swep: unknown key; did you mean sweep?"),
        (HEAD + "colour = 3", "colour: unknown key; expected one of schema, title, atmosphere"),
        (HEAD + "[sampling]\nsun_zenith = 3", "sampling.sun_zenith: .* did you mean sun_zenith_d"),
        (HEAD + "[sampling]\nsun_zenith_deg = [3, 200]", r"sun_zenith_deg\[1\]: .*180; got 200"),
        (HEAD + "[sampling]\nsun_zenith_deg = [3, 2]", "increasing values; got 3 before 2"),
        (HEAD + '[sampling]\nsun_zenith_deg = "3"', "sun_zenith_deg: expected numbers or"),
        (HEAD + "[sampling]\nview_zenith_deg = {first = 0, last = 9}", "one of count, step"),
        (HEAD + "[sampling]\nwavelengths_nm = {first = 1, last = 5, step = 3}", "do not end at 5"),
        (HEAD + "[sampling]\nwavelengths_nm = []", "wavelengths_nm: expected one number or more"),
        (HEAD + "[sweep]\nturbidity = [0.9]", r"sweep.turbidity\[0\]: .* 1; got 0.9"),
        (HEAD + "[sweep]\nturbidity = nan", "sweep.turbidity: expected numbers .* got nan"),
        (HEAD + "[simulation]\norders = 0", "simulation.orders: .* 1; got 0"),
        (HEAD + '[simulation]\ngeometry = "round"', "simulation.geometry: expected 'spherical'"),
        (HEAD + "[atmosphere]\nozone = 1", "atmosphere.ozone: expected a boolean; got 1"),
        (HEAD + "atmosphere = 3", "atmosphere: expected a table; got 3"),
    ],
)
def test_a_wrong_campaign_file_is_refused_with_one_line_naming_file_and_key(
    tmp_path, content, message
):
    file = tmp_path / "wrong.toml"
    file.write_text(content)
    with pytest.raises(ValueError, match=message) as refusal:
        skyfit.load_campaign(file)
    assert str(refusal.value).startswith(f"{file}: ")
    assert "\n" not in str(refusal.value)


AIR = """[[constituents]]
name = "air"
kind = "air"
"""
HAZE = """[[constituents]]
name = "haze"
kind = "angstrom_aerosol"
angstrom_exponent = 1.3
asymmetry = 0.7
"""
SWEEP = """[sweep]
key = "constituents.haze.optical_depth"
"""


def test_any_number_of_a_file_can_be_swept(tmp_path):
    for key, name, units in (
        ("constituents.haze.optical_depth", "optical_depth", "1"),
        ("constituents.haze.profile.scale_height_m", "scale_height", "m"),
        ("ground.albedo", "albedo", "1"),
        ("sun.distance_au", "distance", "au"),
        ("simulation.observer_altitude_m", "observer_altitude", "m"),
    ):
        profile = "profile = {kind = 'exponential', scale_height_m = 2000}\n"
        sweep = f'[sweep]\nkey = "{key}"\nvalues = [0.1, 0.2]\n'
        (tmp_path / "a.toml").write_text(
            HEAD + AIR + HAZE + "optical_depth = 0.1\n" + profile + sweep
        )
        campaign = skyfit.load_campaign(tmp_path / "a.toml")
        assert campaign.swept == {name: (0.1, 0.2)}
        assert campaign.sweep[0].units == units
        assert campaign.sky_dims == (name, "sun_zenith")
        assert campaign.num_skies == 24


def test_an_altitude_is_swept_by_moving_the_observer(tmp_path):
    sweep = '[sweep]\nkey = "simulation.observer_altitude_m"\nvalues = [100, 2000]\n'
    (tmp_path / "a.toml").write_text(HEAD + AIR + sweep)
    campaign = skyfit.load_campaign(tmp_path / "a.toml")
    assert [campaign.observer_altitude_at(**place) for place in campaign.places] == [100, 2000]
    low, high = (campaign.build_atmosphere(**place) for place in campaign.places)
    np.testing.assert_array_equal(low.extinction, high.extinction)


def test_a_campaign_without_a_sweep_has_only_suns(tmp_path):
    (tmp_path / "a.toml").write_text(HEAD + AIR)
    campaign = skyfit.load_campaign(tmp_path / "a.toml")
    assert campaign.sky_dims == ("sun_zenith",)
    assert campaign.num_skies == 12


def test_what_is_swept_can_be_given_when_an_atmosphere_is_loaded(tmp_path):
    (tmp_path / "a.toml").write_text(
        HEAD + AIR + HAZE + "optical_depth = 0.1\n" + SWEEP + "values = [0.2, 0.4]\n"
    )
    found = [
        float(skyfit.load_atmosphere(tmp_path / "a.toml", [550.0], **swept).optical_depth()[1, 0])
        for swept in ({}, {"optical_depth": 0.3})
    ]
    np.testing.assert_allclose(found, [0.1, 0.3], rtol=1e-9)
    with pytest.raises(ValueError, match="expected the parameter optical_depth; got turbidity"):
        skyfit.load_atmosphere(tmp_path / "a.toml", turbidity=3)


def test_the_papers_atmosphere_is_loaded_at_the_turbidity_asked_for():
    depth = skyfit.load_atmosphere(SIMS / "preetham1999.toml", [550.0], turbidity=5).optical_depth()
    np.testing.assert_allclose(depth.sum() / depth[0, 0], 5, rtol=1e-9)


DEEP = "optical_depth = 0.1\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (AIR + "radius = 3", r"constituents\[0\].radius: unknown key; expected one of name, kind"),
        ("[planet]\nradius_km = 6371", "planet.radius_km: unknown key; did you mean radius_m?"),
        ("[planet]\nradius_m = -1", "planet.radius_m: .*or equal to 100000; got -1"),
        ("[planet]\nradius_m = 6e6", "constituents: planet is given, but nothing that scatters"),
        ("[atmosphere]\nozone = true\n" + AIR, "constituents: the .atmosphere. of kind preeth"),
        (AIR + AIR, r"constituents\[1\].name: air is taken"),
        (AIR.replace('"air"\n', '"ether"\n', 2), r"constituents\[0\].kind: expected one of 'air'"),
        (AIR.replace('kind = "air"', ""), r"constituents\[0\].kind: is missing"),
        (AIR + HAZE, r"constituents\[1\]: expected exactly one of optical_depth, .*; got none"),
        (AIR + HAZE + DEEP + "turbidity = 2", "exactly one of .*; got optical_depth and turbidity"),
        (AIR + HAZE + "turbidity = 0.5", r"constituents\[1\].turbidity: .* 1; got 0.5"),
        (AIR + HAZE + DEEP + "single_scattering_albedo = 1.2", "albedo: .* values from 0 to 1"),
        (AIR + HAZE + DEEP + "profile = {kind = 'exponential'}", "scale_height_m: is missing"),
        (AIR + HAZE + DEEP + "profile = {kind = 'tent', bottom_m = 9, peak_m = 5, top_m = 7}",
         r"constituents\[1\].profile: expected bottom_m < peak_m < top_m; got 9, 5, 7"),
        (AIR + HAZE + "visibility_m = 900e3",
         "constituents.haze.visibility_m: expected at most .* gases alone; got 900000"),
        (AIR + '[ground]\nalbedo = {csv = "none.csv", column = "a"}', "none.csv: No such file"),
        (AIR + "[ground]\nalbedo = {wavelength_nm = [400, 500], value = [0.1]}", "many value as"),
        (AIR + "[ground]\nalbedo = {wavelength_nm = [500, 500], value = [0, 1]}", "500 before 500"),
        (AIR + "[ground]\nalbedo = {nm = [500, 400], value = [0, 1]}", "keys wavelength_nm and"),
        (AIR + "depolarised = 1", r"constituents\[0\].depolarised: expected a boolean; got 1"),
        (AIR + '[[constituents]]\nname = "o"\nkind = "ozone"\ndobson_units=3\ncross_section="x"',
         r"constituents\[1\].cross_section: expected 'bogumil2003' or 'preetham1999'; got 'x'"),
        (AIR + '[[constituents]]\nname = "n"\nkind = "nitrogen_dioxide"',
         r"constituents\[1\]: expected exactly one of dobson_units, column_per_m2; got none"),
        (AIR + '[sweep]\nkey = "constituents.air.depolarised"\nvalues = [0, 1]',
         "depolarised is none, but pressure_ratio is"),
        (AIR + '[sun]\nspectrum = "blackbody"', "sun: temperature_K is expected where spectrum"),
        (AIR + "[sweep]\nturbidity = [2, 3]", "sweep.turbidity: is for the paper's atmosphere"),
        (AIR + '[sweep]\nkey = "ground.albedo"', "sweep: key and values are expected together"),
        ('[sweep]\nkey = "ground.albedo"\nvalues = [0, 1]', "the paper's atmosphere is swept over"),
        (AIR + '[sweep]\nkey = "ground.albido"\nvalues = [0, 1]', "albido is none, but albedo"),
        (AIR + '[sweep]\nkey = "constituents.fog.g"\nvalues = [0, 1]', "has air, not fog"),
        (AIR + '[sweep]\nkey = "ground.albedo"\nvalues = [0.5, 1.5]',
         r"sweep.values\[1\]: ground.albedo: expected values from 0 to 1"),
        (AIR + '[sweep]\nkey = "ground.albedo"\nvalues = [0, 1]\nname = "time"', "time is taken"),
    ],
)  # fmt: skip
def test_a_wrong_description_is_refused_with_one_line_naming_file_and_key(
    tmp_path, content, message
):
    file = tmp_path / "wrong.toml"
    file.write_text(HEAD + content)
    with pytest.raises(ValueError, match=message) as refusal:
        skyfit.load_campaign(file)
    assert str(refusal.value).startswith(f"{file}: ")
    assert "\n" not in str(refusal.value)
