"""One look for every picture: readable in print and by the colour-blind."""

import base64
import io
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter


# After Okabe & Ito (2008): told apart by the colour-blind, and in grey by the line styles.
SIMULATED = {"color": "#000000", "linestyle": "none", "marker": "o", "markersize": 2.6}
REFIT = {"color": "#0072B2", "linestyle": "-"}
PUBLISHED = {"color": "#D55E00", "linestyle": "--"}
MEASURED = {"color": "#009E73", "linestyle": "-.", "marker": "s", "markersize": 3.5}
# More lines than those, in an order that keeps neighbours apart.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
_DASHES = ("-", "--", "-.", ":")
LUMINANCE_MAP = "viridis"
ERROR_MAP = "RdBu_r"

_SETTINGS: dict[Any, Any] = {
    "font.size": 8.5,
    "axes.titlesize": 9,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "savefig.dpi": 130,
    "image.interpolation": "nearest",
}


def cycle(number: int) -> dict[str, Any]:
    """Colour and line style of the n-th line of a chart."""
    return {"color": _COLOURS[number % 7], "linestyle": _DASHES[number % 4]}


def house_style() -> AbstractContextManager[None]:
    """Within this context figures have the look of the report."""
    return mpl.rc_context(_SETTINGS)


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [inch] that belongs to no global state."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def sun_at(sun_zenith: float) -> str:
    """Where the sun is, for titles; from its zenith angle [rad]."""
    return f"sun {np.degrees(sun_zenith):.0f}° from the zenith"


def plain_log(axis: Axis) -> None:
    """Label a logarithmic axis with plain numbers at 1, 2 and 5 of each decade."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def png(figure: Figure) -> bytes:
    """The figure as a PNG file."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()


def data_uri(path: Path) -> str:
    """A PNG file as text that a page can hold."""
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")
