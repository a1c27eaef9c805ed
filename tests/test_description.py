"""Atmospheres in the words of campaign files: what is built of them, against known numbers."""

import dataclasses
import json
from pathlib import Path

import colour
import jax.numpy as jnp
import miepython
import numpy as np
import pytest

import skyfit
from skyfit.campaign.description.gases import (
    air_cross_section,
    air_depolarisation,
    nitrogen_dioxide_cross_section,
    oxygen_dimer_cross_section,
)
from skyfit.campaign.description.mie import angular_functions, mie_optics, number_density
from skyfit.campaign.description.spectra import planck, spectrum_at, sunlight_above
from skyfit.constants import ASTRONOMICAL_UNIT, SUN_RADIUS


pytestmark = pytest.mark.any_precision


SIMS = Path(__file__).parent.parent / "sims"
LAM = np.array([450.0, 550.0, 650.0])
HEAD = 'schema = "skyfit/campaign/1"\n'
AIR = '[[constituents]]\nname = "air"\nkind = "preetham_air"\n'
HAZE = '[[constituents]]\nname = "haze"\nkind = "preetham_haze"\n'
ANGSTROM = (
    '[[constituents]]\nname = "haze"\nkind = "angstrom_aerosol"\nangstrom_exponent = 1.3\n'
    "asymmetry = 0.7\nprofile = {kind = 'exponential', scale_height_m = 1200}\n"
)


def atmosphere(tmp_path, text, wavelengths=LAM, **swept):
    file = tmp_path / "own.toml"
    file.write_text(HEAD + text)
    return skyfit.load_atmosphere(file, wavelengths, **swept)


@pytest.mark.slow
def test_the_papers_air_and_haze_in_words_are_the_papers_atmosphere(tmp_path):
    described = atmosphere(tmp_path, AIR + HAZE + "turbidity = 3.5\n")
    built_in = skyfit.preetham_atmosphere(3.5, wavelengths=LAM)
    np.testing.assert_allclose(described.scattering, built_in.scattering, rtol=1e-12)
    np.testing.assert_allclose(described.extinction, built_in.extinction, rtol=1e-12)
    np.testing.assert_allclose(described.solar_irradiance, built_in.solar_irradiance, rtol=1e-12)
    altitudes = jnp.linspace(0.0, 59e3, 50)
    np.testing.assert_array_equal(described.density(altitudes), built_in.density(altitudes))
    mu = np.linspace(-1, 1, 20)
    one, other = (sky.constituents[1].phase(mu) for sky in (described, built_in))
    np.testing.assert_allclose(one, other, rtol=1e-12)


def test_air_scatters_as_bodhaine_tabulates():
    # Bodhaine et al. (1999), table 3: cross-sections in 1e-27 cm² at 0.40, 0.55 and 0.70 µm.
    found = air_cross_section(np.array([400.0, 550.0, 700.0]))
    np.testing.assert_allclose(found, [1.674e-30, 4.513e-31, 1.694e-31], rtol=3e-3)


def test_air_of_the_standard_atmosphere_has_the_known_rayleigh_optical_depth(tmp_path):
    # 0.0970 to 0.0975 at 550 nm and sea level in the literature (Bodhaine et al. 1999, Bucholtz
    # 1995); what lies above 60 km is 2e-4 of it.
    air = atmosphere(tmp_path, AIR.replace("preetham_air", "air"))
    np.testing.assert_allclose(air.optical_depth()[0, 1], 0.0972, rtol=5e-3)


@pytest.mark.parametrize(
    ("amount", "at", "depth"),
    [
        ("optical_depth = 0.2", 550.0, 0.2),
        ("optical_depth = 0.2\nreference_wavelength_nm = 650", 650.0, 0.2),
        ("angstrom_beta = 0.05", 450.0, 0.05 * 0.45**-1.3),
        ("extinction_per_m = 1e-4", 550.0, 0.12),
    ],
)
def test_an_aerosols_amount_is_what_was_asked_for(tmp_path, amount, at, depth):
    sky = atmosphere(tmp_path, AIR + ANGSTROM + amount)
    found = sky.optical_depth()[1, LAM.tolist().index(at)]
    np.testing.assert_allclose(found, depth, rtol=1e-9)


def test_turbidity_and_visibility_are_those_of_air_and_aerosol_together(tmp_path):
    sky = atmosphere(tmp_path, AIR + ANGSTROM + "turbidity = 4")
    depth = sky.optical_depth()[:, 1]
    np.testing.assert_allclose(depth.sum() / depth[0], 4, rtol=1e-9)
    sky = atmosphere(tmp_path, AIR + ANGSTROM + "visibility_m = 23e3")
    np.testing.assert_allclose(3.912 / sky.extinction[:, 1].sum(), 23e3, rtol=1e-9)


def test_an_angstrom_aerosol_splits_its_extinction_by_its_albedo(tmp_path):
    albedo = "single_scattering_albedo = {wavelength_nm = [450, 650], value = [0.8, 1]}"
    haze = atmosphere(tmp_path, AIR + ANGSTROM + f"optical_depth = 0.2\n{albedo}").constituents[1]
    share = np.asarray(haze.scattering) / np.asarray(haze.extinction)
    np.testing.assert_allclose(share, [0.8, 0.9, 1.0], rtol=1e-12)
    np.testing.assert_allclose(haze.phase.mean_cosine, 0.7, rtol=1e-12)


def test_a_gas_scatters_by_the_fourth_power_and_its_tables_are_met(tmp_path):
    gas = (
        '[[constituents]]\nname = "gas"\nkind = "gas"\nnumber_density_per_m3 = 2e25\n'
        "profile = {kind = 'exponential', scale_height_m = 8000}\n"
        "absorption_cross_section_m2 = {wavelength_nm = [450, 650], value = [0, 4e-31]}\n"
    )
    one = atmosphere(tmp_path, gas + "scattering_cross_section_m2 = 5e-31").constituents[0]
    np.testing.assert_allclose(one.scattering, 1e-5 * (550 / LAM) ** 4, rtol=1e-12)
    np.testing.assert_allclose(one.absorption, [0, 4e-6, 8e-6], rtol=1e-12)
    table = "scattering_cross_section_m2 = {wavelength_nm = [450, 650], value = [1e-30, 3e-31]}"
    two = atmosphere(tmp_path, gas + table).constituents[0]
    np.testing.assert_allclose(np.asarray(two.scattering)[[0, 2]], [2e-5, 6e-6], rtol=1e-12)


OZONE = AIR + '[[constituents]]\nname = "ozone"\nkind = "ozone"\ndobson_units = 300\n'


def test_three_hundred_dobson_units_of_ozone_have_their_known_optical_depth(tmp_path):
    # 300 DU are 8.06e18 per cm²; cross-sections of Malicet et al. (1995), 228 K, and Brion et al.
    # (1998), 218 K, means over 1 nm at 300 to 330 and over 10 nm at 500 to 640 nm, in cm².
    others = {300: 3.536e-19, 310: 8.576e-20, 320: 2.440e-20, 330: 3.815e-21,
              500: 1.219e-21, 540: 2.972e-21, 600: 5.153e-21, 640: 2.987e-21}  # fmt: skip
    found = atmosphere(tmp_path, OZONE, np.array(list(others), float)).optical_depth()[1]
    np.testing.assert_allclose(found, 8.06e18 * np.array(list(others.values())), rtol=0.025)


def test_the_papers_ozone_can_be_asked_for_and_is_that_of_older_records(tmp_path):
    built_in = skyfit.preetham_atmosphere(2.0, wavelengths=LAM, ozone=True).optical_depth()[2]
    papers = OZONE.replace("300", "350") + 'cross_section = "preetham1999"\n'
    found = atmosphere(tmp_path, papers).optical_depth()[1]
    np.testing.assert_allclose(found, built_in, rtol=1e-12)
    record = skyfit.load_campaign(tmp_path / "own.toml").to_dict()
    del record["atmosphere"]["constituents"][1]["cross_section"]
    old = skyfit.Campaign.from_dict(record).atmosphere.build(LAM)
    np.testing.assert_array_equal(old.optical_depth()[1], found)


def test_air_depolarises_by_the_king_factor_of_its_cross_section(tmp_path):
    lam = np.array([300.0, 400.0, 550.0, 700.0])
    king = colour.phenomena.rayleigh.F_air_Bodhaine1999(1e-3 * lam, 360)  # µm, ppm
    delta = air_depolarisation(lam)
    np.testing.assert_allclose((6 + 3 * delta) / (6 - 7 * delta), king, rtol=1e-6)
    np.testing.assert_allclose(delta[2], 0.0279, rtol=0.02)  # Young (1980): grey, F = 1.048
    air = AIR.replace("preetham_air", "air")
    phase = atmosphere(tmp_path, air).constituents[0].phase
    np.testing.assert_allclose(phase(0.0)[1], 3 / (8 * np.pi) * 1.02833 / 2.02833, rtol=1e-5)
    for plain in (AIR, air + "depolarised = false\n"):
        phase = atmosphere(tmp_path, plain).constituents[0].phase
        np.testing.assert_allclose(phase(0.0), 3 / (16 * np.pi), rtol=1e-12)


def test_a_gas_depolarises_as_its_table_says(tmp_path):
    gas = (
        '[[constituents]]\nname = "gas"\nkind = "gas"\nscattering_per_m = 1e-5\n'
        "profile = {kind = 'exponential', scale_height_m = 8000}\n"
    )
    one = atmosphere(tmp_path, gas + "depolarisation = 0.08\n").constituents[0]
    np.testing.assert_allclose(one.phase(1.0), 3 / (8 * np.pi) * 2 / 2.08, rtol=1e-12)
    table = "depolarisation = {wavelength_nm = [450, 650], value = [0.08, 0.04]}\n"
    two = atmosphere(tmp_path, gas + table).constituents[0]
    np.testing.assert_allclose(two.phase.depolarisation, [0.08, 0.06, 0.04], rtol=1e-12)


NITROGEN_DIOXIDE = AIR + '[[constituents]]\nname = "no2"\nkind = "nitrogen_dioxide"\n'


def test_nitrogen_dioxide_has_the_column_that_it_is_given(tmp_path):
    # Bogumil et al. (2003), means over 5 nm in cm², at 294 K; 1e16 per cm² in smog.
    others = {360: 5.170e-19, 400: 6.485e-19, 450: 4.968e-19, 500: 1.841e-19, 550: 1.126e-19}
    lam = np.array(list(others), float)
    smog = "temperature_K = 294\nprofile = {kind = 'exponential', scale_height_m = 1000}\n"
    found = atmosphere(tmp_path, NITROGEN_DIOXIDE + "column_per_m2 = 1e20\n" + smog, lam)
    found = found.optical_depth()[1]
    np.testing.assert_allclose(found, 1e16 * np.array(list(others.values())), rtol=0.03)
    amount = "dobson_units = 0.37219\n"  # of 2.68678e20 per m²
    same = atmosphere(tmp_path, NITROGEN_DIOXIDE + amount + smog, lam).optical_depth()[1]
    np.testing.assert_allclose(same, found, rtol=1e-5)
    cold = atmosphere(tmp_path, NITROGEN_DIOXIDE + amount, lam).optical_depth()[1]
    # AFGL's U.S. Standard Atmosphere (Anderson et al. 1986): 26.0 km on average, above 12 km.
    layer = atmosphere(tmp_path, NITROGEN_DIOXIDE + amount, lam).constituents[1].density
    height = jnp.linspace(0.0, 60e3, 601)
    np.testing.assert_allclose(jnp.average(height, weights=layer(height)), 26e3, rtol=0.02)
    middle = nitrogen_dioxide_cross_section(lam, 257.0)
    np.testing.assert_allclose(middle * 1e20, (cold + found) / 2, rtol=1e-5)


def test_pairs_of_oxygen_molecules_absorb_as_measured(tmp_path):
    # Greenblatt et al. (1990), table 1: peaks at 296 K in cm⁵, and what a mean over 2 nm leaves of
    # them, by the width of each band; colder pairs absorb up to 5 % more at the peak.
    lam = np.array([360.0, 380.0, 477.0, 532.0, 577.0, 630.0])
    peaks = np.array([4.1, 2.4, 6.3, 1.0, 11.0, 7.2]) * 1e-46
    found = oxygen_dimer_cross_section(lam) * 1e10
    assert (found > 0.88 * peaks).all()
    assert (found < 1.12 * peaks).all()
    assert (oxygen_dimer_cross_section(np.array([300.0, 410.0, 660.0, 800.0])) == 0).all()
    pairs = AIR + '[[constituents]]\nname = "pairs"\nkind = "oxygen_dimer"\n'
    sky = atmosphere(tmp_path, pairs, lam)
    # 0.20946 of 2.547e19 molecules per cm³, and printed densities of the U.S. Standard Atmosphere
    # 1976, which fall exponentially in between: 1.3e43 pairs per cm⁵.
    height = np.array([0, 1e3, 2e3, 5e3, 8e3, 10e3, 15e3, 20e3, 30e3])
    printed = [1.2250, 1.1117, 1.0066, 0.73643, 0.52579, 0.41351, 0.19476, 0.08891, 0.01841]
    squares = (np.array(printed) / 1.2250) ** 2
    panels = np.diff(height) * np.diff(squares) / np.diff(np.log(squares))
    pairs_per_cm5 = (0.20946 * 2.547e19) ** 2 * 1e2 * panels.sum()
    np.testing.assert_allclose(pairs_per_cm5, 1.3e43, rtol=0.03)
    np.testing.assert_allclose(sky.optical_depth()[1], pairs_per_cm5 * found, rtol=5e-3)
    thin = atmosphere(tmp_path, pairs + "pressure_ratio = 0.5\n", lam)
    np.testing.assert_allclose(4 * thin.extinction[1], sky.extinction[1], rtol=1e-12)
    heights = jnp.array([0.0, 5e3, 20e3])
    density = sky.density(heights)
    np.testing.assert_allclose(density[:, 1], density[:, 0] ** 2, rtol=1e-12)


def test_a_table_next_to_the_file_is_read_and_kept(tmp_path):
    (tmp_path / "ground.csv").write_text("# falling\nwavelength_nm;albedo\n650;0,3\n450;0,1\n")
    text = AIR + '[ground]\nalbedo = {csv = "ground.csv", column = "albedo"}\n'
    np.testing.assert_allclose(atmosphere(tmp_path, text).ground_albedo, [0.1, 0.2, 0.3])
    campaign = skyfit.load_campaign(tmp_path / "own.toml")
    (tmp_path / "ground.csv").unlink()
    again = skyfit.Campaign.from_dict(json.loads(json.dumps(campaign.to_dict())))
    assert again == campaign
    np.testing.assert_allclose(again.build_atmosphere().ground_albedo[20], 0.23)  # 580 nm


def test_a_black_body_of_the_suns_size_gives_the_solar_constant():
    # Stefan and Boltzmann: σ T⁴ (R / d)² = 1361 W/m² at 5772 K.
    lam = np.geomspace(50.0, 2e5, 20000)
    power = np.trapezoid(np.pi * planck(5772.0, lam), lam) * (SUN_RADIUS / ASTRONOMICAL_UNIT) ** 2
    np.testing.assert_allclose(power, 1361, rtol=1e-3)
    sun = {"spectrum": "blackbody", "temperature_K": 5772.0, "radius_solar": 1, "distance_au": 2}
    near = sunlight_above(sun | {"distance_au": 1}, LAM)
    np.testing.assert_allclose(sunlight_above(sun, LAM), near / 4, rtol=1e-12)


def test_the_standard_sun_is_averaged_over_its_band():
    sun = {"spectrum": "astm_g173", "distance_au": 1.0}
    fine = sunlight_above(sun | {"bandwidth_nm": 0.0}, np.arange(540.0, 561.0))
    mean = sunlight_above(sun | {"bandwidth_nm": 20.0}, np.array([550.0]))
    trapezoid = (fine.sum() - 0.5 * (fine[0] + fine[-1])) / 20
    np.testing.assert_allclose(mean, [trapezoid], rtol=1e-12)
    assert spectrum_at({"wavelength_nm": [400, 500], "value": [1, 3]}, LAM)[0] == 2


MONO = {"kind": "lognormal", "median_radius_nm": 500.0, "geometric_deviation": 1.0001,
        "smallest_radius_nm": 499.9, "largest_radius_nm": 500.1}  # fmt: skip


@pytest.mark.slow
def test_spheres_of_one_size_extinguish_as_miepython_says():
    part = {"size": MONO, "refractive_index": 1.5, "absorption_index": 0.01}
    found = mie_optics(part, np.array([550.0]))
    x = 2 * np.pi * 500 / 550
    extinction, scattering, _, asymmetry = miepython.efficiencies_mx(1.5 - 0.01j, x)
    area = np.pi * 500e-9**2
    np.testing.assert_allclose(found.extinction, [extinction * area], rtol=1e-3)
    np.testing.assert_allclose(found.albedo, [scattering / extinction], rtol=1e-4)
    phase = skyfit.phase.Tabulated(found.angle, found.phase)
    # Log-linear between 93 angles: what an interpolated lobe loses.
    np.testing.assert_allclose(phase.mean_cosine, [asymmetry], rtol=5e-3)


def test_amplitudes_are_those_of_miepython():
    mu = np.cos(np.radians([0.0, 20.0, 90.0, 180.0]))
    a, b = miepython.coefficients(1.5 - 0.01j, 6.0)
    pi_n, tau_n = angular_functions(mu, len(a))
    n = np.arange(1, len(a) + 1)
    scale = (2 * n + 1) / (n * (n + 1))
    ours = abs((scale * a) @ pi_n + (scale * b) @ tau_n)
    theirs, _ = miepython.S1_S2(1.5 - 0.01j, 6.0, mu, norm="wiscombe")
    np.testing.assert_allclose(ours / ours[0], abs(theirs) / abs(theirs[0]), rtol=1e-10)


@pytest.mark.parametrize(
    ("size", "effective"),
    [
        # Hansen & Travis (1974): a itself; lognormal: r exp(5/2 ln² s).
        ({"kind": "gamma", "effective_radius_nm": 800.0, "effective_variance": 0.1}, 800.0),
        (
            {"kind": "lognormal", "median_radius_nm": 300.0, "geometric_deviation": 1.5},
            300 * np.exp(2.5 * np.log(1.5) ** 2),
        ),
        ({"kind": "power_law", "exponent": 2.0}, 49.9e3 / np.log(500)),
    ],
)
def test_size_distributions_have_the_effective_radius_of_their_formulas(size, effective):
    # ∫ r³ n dr / ∫ r² n dr, with dr = r d ln r in both. The power law spans 100 to 50000 nm, where
    # ∫ r d ln r = 49900 nm and ∫ d ln r = ln 500.
    radius = np.geomspace(100e-9, 50e-6, 4000)
    if size["kind"] == "lognormal":
        radius = np.geomspace(1e-9, 50e-6, 4000)
    count = number_density(size, radius)
    log_r = np.log(radius)
    found = np.trapezoid(count * radius**3, log_r) / np.trapezoid(count * radius**2, log_r)
    np.testing.assert_allclose(found, 1e-9 * effective, rtol=5e-3)


@pytest.mark.slow
def test_a_mie_aerosol_in_a_file_has_its_optical_depth_and_conserves_light(tmp_path):
    dust = (
        '[[constituents]]\nname = "dust"\nkind = "mie_aerosol"\noptical_depth = 0.3\n'
        "refractive_index = 1.5\n"
        "absorption_index = {wavelength_nm = [450, 650], value = [0.02, 0]}\n"
        'size = {kind = "gamma", effective_radius_nm = 400, effective_variance = 0.1, '
        "smallest_radius_nm = 50, largest_radius_nm = 2000}\n"
    )
    sky = atmosphere(tmp_path, AIR + dust)
    np.testing.assert_allclose(sky.optical_depth()[1, 1], 0.3, rtol=1e-9)
    share = np.asarray(sky.scattering[1] / sky.extinction[1])
    assert share[0] < share[1] < share[2]
    np.testing.assert_allclose(share[2], 1, atol=1e-9)
    assert (np.asarray(sky.constituents[1].phase.mean_cosine) > 0.5).all()


def test_a_record_of_a_described_campaign_alone_can_be_simulated_again(tmp_path):
    (tmp_path / "own.toml").write_text(HEAD + AIR + ANGSTROM + "optical_depth = 0.1\n"
        '[sweep]\nkey = "constituents.haze.optical_depth"\nvalues = [0.1, 0.3]\n')  # fmt: skip
    campaign = dataclasses.replace(
        skyfit.load_campaign(tmp_path / "own.toml"), wavelengths=(500.0, 600.0)
    )
    assert campaign.swept == {"optical_depth": (0.1, 0.3)}
    again = skyfit.Campaign.from_dict(json.loads(json.dumps(campaign.to_dict())))
    assert again == campaign
    for place in campaign.places:
        one, other = campaign.build_atmosphere(**place), again.build_atmosphere(**place)
        np.testing.assert_array_equal(one.extinction, other.extinction)
        expected = place["optical_depth"] * 1.1**1.3
        np.testing.assert_allclose(one.optical_depth()[1].max(), expected, rtol=0.03)


def test_a_forward_peak_can_be_counted_as_light_that_goes_on():
    part = {"size": MONO | {"median_radius_nm": 2000.0, "smallest_radius_nm": 1500.0,
            "largest_radius_nm": 2500.0, "geometric_deviation": 1.2}, "refractive_index": 1.5,
            "absorption_index": 0.01}  # fmt: skip
    lam = np.array([550.0])
    whole, cut = mie_optics(part, lam), mie_optics(part | {"forward_peak_deg": 12.0}, lam)
    outside = whole.angle > np.radians(12.0)
    # Outside the peak as much light as before, and the same absorbed.
    scattered, before = (one.extinction * one.albedo for one in (cut, whole))
    np.testing.assert_allclose(cut.extinction - scattered, whole.extinction - before, rtol=1e-9)
    ring = 2 * np.pi * np.sin(whole.angle)
    norms = [np.trapezoid(one.phase[:, 0] * ring, one.angle) for one in (cut, whole)]
    np.testing.assert_allclose(
        scattered * cut.phase[outside, 0] / norms[0],
        before * whole.phase[outside, 0] / norms[1],
        rtol=1e-6,
    )
    assert 0.3 < scattered[0] / before[0] < 0.7  # diffraction is about half of it
    level = np.interp(np.radians(12.0), whole.angle, whole.phase[:, 0])
    np.testing.assert_allclose(cut.phase[~outside].max(), level, rtol=1e-9)


PHASES = {
    "lists": "{wavelength_nm = [450, 650], angle_deg = [0, 90, 180], "
    "value = [[4, 1, 2], [30, 10, 10]]}",
    "file": '{wavelength_nm = [450, 650], csv = "phase.csv", column = ["blue", "red"]}',
}


@pytest.mark.slow
@pytest.mark.parametrize("phase", PHASES.values(), ids=PHASES)
def test_a_phase_function_may_differ_by_wavelength(phase, tmp_path):
    (tmp_path / "phase.csv").write_text("angle_deg,blue,red\n0,4,30\n90,1,10\n180,2,10\n")
    table = '[[constituents]]\nname = "dust"\nkind = "table_aerosol"\nextinction = 1e-5\nphase = '
    built = atmosphere(tmp_path, AIR + table + phase + "\n", [450.0, 550.0, 650.0])
    got = np.asarray(
        built.constituents[1].phase.spectral(jnp.cos(jnp.radians(jnp.array([0.0, 90.0, 180.0]))))
    )
    # The red one is 30 e^(-b θ) forward of 90° and 10 behind; by hand, 2π ∫ p sin θ dθ.
    b = 2 * np.log(3) / np.pi
    red = 2 * np.pi * (10 * 1 + 10 * (3 - b) / (1 + b**2))
    np.testing.assert_allclose(got[:, 2], np.array([30, 10, 10]) / red, rtol=1e-6)
    np.testing.assert_allclose(got[[0, 2], 0] / got[1, 0], [4.0, 2.0], rtol=1e-6)
    np.testing.assert_allclose(got[:, 1], (got[:, 0] + got[:, 2]) / 2, rtol=0.02)
    campaign = skyfit.load_campaign(tmp_path / "own.toml")
    assert skyfit.Campaign.from_dict(json.loads(json.dumps(campaign.to_dict()))) == campaign


@pytest.mark.parametrize(
    ("nodes", "value", "message"),
    [
        ("[450]", "[1, 2]", "expected a value for each wavelength_nm"),
        ("[450, 650]", "[[1, 2]]", "expected a value for each wavelength_nm"),
        ("[450]", "[[1, 2, 3]]", "expected as many value as angle_deg"),
        ("[650, 450]", "[[1, 2], [1, 2]]", "650 before 450"),
        ("[450]", "[[1, 0]]", "values above 0"),
    ],
)
def test_phase_functions_that_are_none_are_refused_in_one_line(nodes, value, message, tmp_path):
    phase = f"{{wavelength_nm = {nodes}, angle_deg = [0, 180], value = {value}}}"
    table = '[[constituents]]\nname = "dust"\nkind = "table_aerosol"\nextinction = 1e-5\nphase = '
    with pytest.raises(skyfit.InputError, match=message) as error:
        atmosphere(tmp_path, AIR + table + phase + "\n")
    assert "phase" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_byte_order_mark_is_passed_over(tmp_path):
    file = tmp_path / "own.toml"
    file.write_text("\ufeff" + HEAD + AIR, encoding="utf-8")
    assert len(skyfit.load_atmosphere(file).constituents) == 1
