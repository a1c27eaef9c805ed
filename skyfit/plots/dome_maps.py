"""One sky over the whole dome, on polar axes: luminance, and how far one sky is from another."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

from ..errors import InputError
from ..models import AbstractSkyModel
from ..render.sources import AbstractSource
from . import style
from .skies import Source, colours_of


_RINGS, _SPOKES = 91, 181
Sky = AbstractSkyModel | AbstractSource | Source


def luminance_map(sky: Sky, sun_zenith: float, title: str = "") -> Figure:
    """Luminance over view zenith and azimuth from the sun, the sun marked.

    Args:
        sky: Sky whose luminance is shown.
        sun_zenith: Zenith angle of the sun [rad].
        title: Title above the map.
    """
    view, turn, values = _on_grid(sky, sun_zenith)
    brightness = values / 1e3
    low, high = np.percentile(brightness[brightness > 0], [0.5, 99.5])
    return _map(
        view, turn, brightness, LogNorm(low, high), style.LUMINANCE_MAP, sun_zenith, title,
        "luminance [kcd m$^{-2}$]",
    )  # fmt: skip


def error_map(
    truth: Sky, model: Sky, sun_zenith: float, title: str = "", bound: float = 2.0
) -> Figure:
    """Luminance of a model over the true one; white where they agree.

    Args:
        truth: Sky that is divided by.
        model: Sky that is divided.
        sun_zenith: Zenith angle of the sun [rad].
        title: Title above the map.
        bound: Upper end of the colours, above 1; its inverse is the lower end.
    """
    if not bound > 1:
        raise InputError(f"error_map(bound=...): expected a value above 1; got {bound}")
    view, turn, right = _on_grid(truth, sun_zenith)
    ratio = _on_grid(model, sun_zenith)[2] / right
    return _map(
        view, turn, ratio, LogNorm(1 / bound, bound), style.ERROR_MAP, sun_zenith, title,
        "luminance, model over truth [1]",
    )  # fmt: skip


def _on_grid(sky: Sky, sun_zenith: float):
    view = np.linspace(0, np.pi / 2, _RINGS)
    turn = np.linspace(0, 2 * np.pi, _SPOKES)
    rings, spokes = np.meshgrid(view, turn, indexing="ij")
    return view, turn, colours_of(sky)(sun_zenith, rings, spokes)[..., 2]


def _map(view, turn, values, norm, colours, sun_zenith, title, label) -> Figure:
    with style.house_style():
        figure = style.new_figure(4.6, 4.0)
        panel = figure.add_subplot(projection="polar")
        assert isinstance(panel, PolarAxes)
        panel.set_theta_zero_location("N")
        panel.set_theta_direction(-1)
        panel.grid(visible=False)
        panel.pcolormesh(
            turn, np.degrees(view), values, norm=norm, cmap=colours, shading="gouraud",
            rasterized=True,
        )  # fmt: skip
        panel.grid(color="k", alpha=0.25, linewidth=0.5)
        panel.set_yticks([30, 60, 90], ["30°", "60°", "90°"], color="0.15", fontsize=7)
        panel.set_thetagrids(np.arange(0, 360, 45))
        if sun_zenith <= np.pi / 2:
            where = ([0.0], [np.degrees(sun_zenith)])
            panel.plot(*where, "o", markersize=7, markerfacecolor="none", color="w", mew=2.2)
            panel.plot(*where, "o", markersize=7, markerfacecolor="none", color="k", mew=1.0)
        panel.set_title(title or style.sun_at(sun_zenith))
        bar = figure.colorbar(ScalarMappable(norm, colours), ax=panel, shrink=0.85, pad=0.1)
        bar.set_label(label)
        style.plain_log(bar.ax.yaxis)
        panel.set_xlabel("azimuth from the sun; rings: view zenith angle")
    return figure
