"""Plots show the numbers they are given, with units, and belong to no global state."""

import math
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest
from model_skies import model_skies

import skyfit
from skyfit import plots
from skyfit.plots import style
from skyfit.plots.chromaticity import daylight_locus
from skyfit.render import load_source


SUN = 0.9


@pytest.fixture(scope="module")
def published():
    return skyfit.preetham_sky(3.0)


def words(figure):
    """All labels of a figure."""
    panels = figure.axes
    return " ".join(
        text
        for panel in panels
        for text in (panel.get_xlabel(), panel.get_ylabel(), panel.get_title())
    )


def test_a_model_and_its_source_of_pictures_are_the_same_sky(published):
    view, azimuth = np.array([0.2, 1.0, 1.4]), np.array([0.0, 2.0, 4.0])
    expected = np.asarray(published.xyY(SUN, view, azimuth))
    for sky in (published, load_source(None, 3.0), lambda *at: np.asarray(published.xyY(*at))):
        assert plots.colours_of(sky)(SUN, view, azimuth) == pytest.approx(expected, rel=1e-5)


def test_the_luminance_map_has_the_models_values_and_the_sun(published):
    figure = plots.luminance_map(published, SUN)
    panel, bar = figure.axes
    mesh = panel.collections[0].get_array().reshape(91, 181)
    # Ring 30 is 30° from the zenith, spoke 45 is 90° from the sun.
    expected = published.xyY(SUN, math.radians(30), math.radians(90))[2] / 1e3
    assert mesh[30, 45] == pytest.approx(float(expected), rel=1e-6)
    assert panel.lines[0].get_xydata().tolist() == [[0.0, pytest.approx(math.degrees(SUN))]]
    assert bar.get_ylabel() == "luminance [kcd m$^{-2}$]"
    assert "view zenith" in words(figure)


def test_the_error_map_is_white_where_skies_agree(published):
    twice = plots.colours_of(published)
    brighter = lambda *at: twice(*at) * [1, 1, 1.5]  # noqa: E731
    figure = plots.error_map(published, brighter, SUN, "one and a half")
    mesh = figure.axes[0].collections[0].get_array()
    assert np.asarray(mesh) == pytest.approx(1.5)
    assert figure.axes[0].get_title() == "one and a half"
    with pytest.raises(ValueError, match=r"bound=...\): expected a value above 1; got 0.5"):
        plots.error_map(published, published, SUN, bound=0.5)


def test_a_section_goes_through_the_sun(published):
    figure = plots.meridian_section(
        {"published": published, "other": published, "third": published}, SUN
    )
    line = figure.axes[0].lines[0]
    angle, values = line.get_xydata().T
    assert angle[[0, -1]].tolist() == [-90, 90]
    at = int(np.argmin(np.abs(angle - 60)))
    expected = published.xyY(SUN, math.radians(angle[at]), 0.0)[2] / 1e3
    assert values[at] == pytest.approx(float(expected))
    assert line.get_color() == style.PUBLISHED["color"]
    assert len({one.get_color() for one in figure.axes[0].lines[:3]}) == 3
    for unit in ("[kcd m$^{-2}$]", "chromaticity x [1]", "[°]"):
        assert unit in words(figure)


def test_daylight_of_6504_kelvin_is_d65():
    near = np.abs(daylight_locus() - [0.3127, 0.3290]).sum(axis=1)
    # The table steps by 105 K, 1e-3 here.
    assert near.min() < 1e-3


def test_the_diagram_shows_the_tracks(published):
    view = np.linspace(0, 1.5, 20)
    track = np.asarray(published.xyY(SUN, view, 0.0))[:, :2]
    figure = plots.chromaticity_diagram({"towards the sun": track})
    (panel,) = figure.axes
    shown = [line.get_xydata() for line in panel.lines if line.get_label() == "towards the sun"]
    assert np.array_equal(shown[0], track)
    low, high = panel.get_xlim()
    assert low < track[:, 0].min() < track[:, 0].max() < high
    whole = plots.chromaticity_diagram({}, whole=True).axes[0]
    assert whole.get_xlim() == (0, 0.8)
    # The locus' green corner: 520 nm at (0.0743, 0.8338), CIE 1931.
    corner = whole.lines[0].get_xydata()
    assert np.abs(corner - [0.0743, 0.8338]).sum(axis=1).min() < 2e-3


def test_spectra_have_units():
    wavelengths = np.linspace(400.0, 700.0, 4)
    figure = plots.spectrum_chart({"sun": wavelengths * 0 + 2}, wavelengths, quantity="irradiance")
    assert figure.axes[0].lines[0].get_ydata().tolist() == [2, 2, 2, 2]
    assert "irradiance [W m$^{-2}$ sr$^{-1}$ nm$^{-1}$]" in words(figure)
    assert "wavelength [nm]" in words(figure)


def test_the_sun_path_culminates_in_the_south():
    figure = plots.sun_path(math.radians(50))
    lines = {line.get_label(): line.get_xydata() for line in figure.axes[0].lines}
    for name, declination in (("21 Jun", 23.45), ("21 Dec", -23.45), ("21 Mar", 0.0)):
        azimuth, zenith = lines[name].T
        noon = int(np.nanargmin(zenith))
        assert zenith[noon] == pytest.approx(50 - declination, abs=0.7)
        assert np.degrees(azimuth[noon]) == pytest.approx(180, abs=1.5)
    assert "clock" in words(figure)


@pytest.mark.slow
def test_the_coefficients_chart_has_a_band_for_every_coefficient():
    fit = skyfit.fit_sky(model_skies())
    figure = plots.coefficient_chart(fit)
    assert len(figure.axes) == 15
    line = figure.axes[0].lines[0]
    slope, intercept = fit.coefficients["Y"][0]
    turbidity, values = line.get_xydata().T
    assert values == pytest.approx(slope * turbidity + intercept)
    assert all(len(panel.collections) == 1 for panel in figure.axes)


@pytest.mark.slow
def test_figures_are_nobodys_but_the_callers(published):
    before = plt.get_fignums()
    plots.luminance_map(published, SUN)
    assert plt.get_fignums() == before
    code = "import sys, skyfit; print('matplotlib' in sys.modules); skyfit.plots.sun_path"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
