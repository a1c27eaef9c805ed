"""Skies cut through the sun and the zenith."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from . import style
from .charts import LINES
from .dome_maps import Sky
from .skies import colours_of


def meridian_section(skies: Mapping[str, Sky], sun_zenith: float) -> Figure:
    """Luminance and chromaticity from one horizon to the other, through the sun.

    Args:
        skies: Skies by name, which the legend shows; "simulated", "refit", "published" and
            "measured" have the look of the report.
        sun_zenith: Zenith angle of the sun [rad].
    """
    signed = np.linspace(-np.pi / 2, np.pi / 2, 241)
    with style.house_style():
        figure = style.new_figure(6.4, 5.6)
        panels = figure.subplots(3, 1, sharex=True, height_ratios=[1.6, 1, 1])
        taken = {LINES[name]["color"] for name in skies if name in LINES}
        free = iter(style.cycle(k) for k in range(7) if style.cycle(k)["color"] not in taken)
        for name, sky in skies.items():
            colours = colours_of(sky)(sun_zenith, np.abs(signed), np.where(signed < 0, np.pi, 0.0))
            look = LINES[name] if name in LINES else next(free, style.cycle(len(taken)))
            dash = "-" if look["linestyle"] == "none" else look["linestyle"]
            look = {"color": look["color"], "linestyle": dash}
            for panel, channel, scale in zip(panels, (2, 0, 1), (1e3, 1, 1), strict=True):
                panel.plot(np.degrees(signed), colours[:, channel] / scale, label=name, **look)
        panels[0].set_yscale("log")
        style.plain_log(panels[0].yaxis)
        for panel, label in zip(
            panels, ("luminance [kcd m$^{-2}$]", "chromaticity x [1]", "chromaticity y [1]"),
            strict=True,
        ):  # fmt: skip
            panel.axvline(np.degrees(sun_zenith), color="0.6", linewidth=0.8, zorder=0)
            panel.set_ylabel(label)
        panels[0].annotate(
            "sun", (np.degrees(sun_zenith), 1.0), xycoords=("data", "axes fraction"),
            ha="center", va="bottom", color="0.4",
        )  # fmt: skip
        panels[2].set_xlabel("view zenith angle [°], sun side positive")
        panels[2].set_xticks(np.arange(-90, 91, 30))
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure
