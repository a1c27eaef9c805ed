"""Hosek and Wilkie's sky against values of another implementation.

`reference/hosek_wilkie_skies.csv` is from E. Bruneton's clear-sky-models (see the README
there), turbidity 2.53; that code puts the spectrum of another sun in place of the tables' own, so
that absolute values differ by a factor of the wavelength alone.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from peers import peer

from skyfit.colour import luminance
from skyfit.compare import compare_skies
from skyfit.compare.models import MODELS
from skyfit.compare.peers import HosekWilkieSky
from skyfit.report.reality import COMPARED, TURBIDITY, WAVELENGTHS, compare_with_cornell


peer("mitsuba")

TABLE = np.genfromtxt(
    Path(__file__).parent / "reference" / "hosek_wilkie_skies.csv", delimiter=",", skip_header=1
)
SUN = np.radians(40.0)
README = Path(__file__).parent.parent / "README.md"


@pytest.mark.parametrize("wavelength", np.unique(TABLE[:, 0]))
def test_skies_are_those_of_another_implementation(wavelength):
    rows = TABLE[TABLE[:, 0] == wavelength]
    sky = HosekWilkieSky(2.53, ground_albedo=rows[0, 1])
    ratios = []
    for _, _, sun, view, azimuth, radiance in rows:
        found = sky.radiance(*np.radians([sun, view, azimuth]), [wavelength])
        ratios.append(float(found[0]) / radiance)
    # The factor between the two suns; over directions and suns nothing else is left.
    assert np.mean(ratios) == pytest.approx(1, abs=0.07)
    np.testing.assert_allclose(ratios, np.mean(ratios), rtol=0.003)


def test_wavelengths_are_asked_for_four_by_four():
    sky = HosekWilkieSky(3.0)
    lam = np.linspace(400.0, 700.0, 7)
    together = sky.radiance(SUN, 0.3, 0.2, lam)
    one_by_one = [sky.radiance(SUN, 0.3, 0.2, [wavelength])[0] for wavelength in lam]
    np.testing.assert_allclose(together, one_by_one, rtol=1e-6)


def test_the_longest_wavelength_is_the_end_of_the_tables():
    # They have 680 and 720 nm, with straight lines between.
    for _ in range(5):
        values = np.asarray(HosekWilkieSky(3.0).radiance(SUN, 0.3, 0.2, [680.0, 700.0, 720.0]))
        assert values[2] == pytest.approx(2 * values[1] - values[0], rel=1e-4)


def test_the_sky_is_black_at_night_and_turbidity_is_held():
    assert not np.any(HosekWilkieSky(3.0).xyY(np.radians(91.0), 0.3, 0.2)[2])
    held = HosekWilkieSky(12.0).xyY(SUN, 0.3, 0.2), HosekWilkieSky(10.0).xyY(SUN, 0.3, 0.2)
    np.testing.assert_allclose(*held, rtol=1e-12)


def test_it_is_a_row_of_the_table():
    (entry,) = [entry for entry in MODELS if entry.package == "mitsuba"]
    (row,) = compare_skies(SUN, 11.0, models=[entry])
    assert row["model"] == "Hosek–Wilkie 2012"
    assert row["outside"] == ["turbidity is valid from 1 to 10"]
    assert 3e3 < row["diffuse_illuminance"] < 1e5


@pytest.mark.slow
def test_the_readme_has_its_errors_on_the_measured_day():
    reality = compare_with_cornell({})
    shown = WAVELENGTHS[COMPARED]
    inside = np.minimum(shown, 719.9)
    sky = HosekWilkieSky(TURBIDITY)
    found = np.stack([
        sky.radiance(
            float(one["sun_zenith"]), one["view_zenith"].values, one["relative_azimuth"].values,
            inside,
        )
        for one in (reality.skies.isel(time=time) for time in range(8))
    ])  # fmt: skip
    measured = reality.measured[..., COMPARED]
    rmse = 1e3 * np.sqrt(np.mean((found - measured) ** 2))
    ratio = np.mean(luminance(found, shown)) / np.mean(luminance(measured, shown))
    (row,) = re.findall(r"\| Hosek.*?\| (\d+), ([\d.]+) × \|", README.read_text())
    assert rmse == pytest.approx(float(row[0]), rel=0.02)
    assert ratio == pytest.approx(float(row[1]), rel=0.01)
