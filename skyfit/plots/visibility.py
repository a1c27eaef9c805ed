"""How far one sees at a turbidity: figure 3 of the paper, redrawn from the formulas."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from ..turbidity import meteorological_range
from . import style


# Upper ends of the international visibility code [km]; McCartney (1976), "Optics of the
# Atmosphere", table 1.1
VISIBILITY_CODE = {
    "light fog": 1.0,
    "thin fog": 2.0,
    "haze": 4.0,
    "light haze": 10.0,
    "clear": 20.0,
    "very clear": 50.0,
    "exceptionally clear": np.inf,
}
TURBIDITY = (1.0, 64.0)
RANGE = (0.5, 512.0)  # km
_LOOKS: dict[str, Any] = {
    "by optical thickness": style.REFIT,
    "by the paper's coefficients": style.PUBLISHED,
}


def meteorological_range_chart() -> Figure:
    """Meteorological range over turbidity, with the names of the international visibility code."""
    turbidity = np.geomspace(*TURBIDITY, 400)
    with style.house_style():
        figure = style.new_figure(5.6, 3.7)
        axes = figure.subplots()
        axes.set_xscale("log", base=2)
        axes.set_yscale("log", base=2)
        _draw_code(axes)
        for label, distance in _ranges(turbidity).items():
            axes.plot(turbidity, np.asarray(distance) / 1e3, label=label, **_LOOKS[label])
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(FixedLocator([2.0**k for k in range(-1, 10)]))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_locator(NullLocator())
        axes.set_xlim(*TURBIDITY)
        axes.set_ylim(*RANGE)
        axes.set_xlabel("turbidity")
        axes.set_ylabel("meteorological range at 550 nm [km]")
        axes.legend(loc="lower left", title="haze of turbidity T")
    return figure


def _ranges(turbidity):
    by_coefficients = meteorological_range(turbidity, turbidity_means="coefficients")
    return dict(zip(_LOOKS, (meteorological_range(turbidity), by_coefficients), strict=True))


def _draw_code(axes):
    low = RANGE[0]
    for number, (name, end) in enumerate(VISIBILITY_CODE.items()):
        high = min(end, RANGE[1])
        axes.axhspan(low, high, color="#000000", alpha=0.05 * (number % 2), lw=0)
        middle = np.sqrt(low * high)
        axes.text(60.0, middle, name, ha="right", va="center", fontsize=7.5, color="#444444")
        low = high
