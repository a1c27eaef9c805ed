"""Plots of skies, models and fits, in one style: readable in print and by the colour-blind.

Each function returns a `matplotlib.figure.Figure` that belongs to no global state; `figure.savefig`
writes it. What is called a sky is a model, a source of `skyfit.render`, or a function of the sun's
zenith angle, view zenith and relative azimuth [rad] that returns x, y, Y.
"""

from .airlight import path_error_chart as path_error_chart, sunset_chart as sunset_chart
from .chromaticity import chromaticity_diagram as chromaticity_diagram
from .coefficients import coefficient_chart as coefficient_chart
from .dome_maps import error_map as error_map, luminance_map as luminance_map
from .meridian import meridian_section as meridian_section
from .skies import colours_of as colours_of
from .spectra import spectrum_chart as spectrum_chart
from .style import house_style as house_style
from .sun_path import sun_path as sun_path
from .visibility import meteorological_range_chart as meteorological_range_chart
