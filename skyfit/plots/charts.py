"""Line charts of the report: skies through the sun, zeniths."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from . import style
from .skies import Source


LINES = {
    "simulated": style.SIMULATED,
    "refit": style.REFIT,
    "published": style.PUBLISHED,
    "measured": style.MEASURED,
}


def luminance_sections(
    sources: Mapping[float, Mapping[str, Source]], suns: Sequence[float], step: float
) -> Figure:
    """Luminance through the solar meridian.

    Args:
        sources: Skies by turbidity and by name; one row of panels for each turbidity.
        suns: Zenith angles, one column of panels each [rad].
        step: Angle between the simulated directions [rad].
    """
    figure = style.new_figure(2.6 * len(suns), 2.2 * len(sources))
    panels = figure.subplots(len(sources), len(suns), sharex=True, sharey=True, squeeze=False)
    for row, (turbidity, kinds) in zip(panels, sources.items(), strict=True):
        for panel, sun in zip(row, suns, strict=True):
            for name, source in kinds.items():
                degrees, colours = _meridian(source, sun, step if name == "simulated" else None)
                panel.semilogy(degrees, colours[:, 2] / 1e3, label=name, **LINES[name])
            panel.axvline(np.degrees(sun), color="0.6", linewidth=0.8, zorder=0)
            panel.set_title(f"turbidity {turbidity:g}, {style.sun_at(sun)}")
    style.plain_log(panels[0, 0].yaxis)
    _label_meridian(panels, "luminance [kcd m$^{-2}$]")
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def chromaticity_sections(
    sources: Mapping[str, Source], turbidity: float, suns: Sequence[float], step: float
) -> Figure:
    """Chromaticity x and y through the solar meridian at one turbidity; see the above."""
    figure = style.new_figure(2.6 * len(suns), 4.2)
    panels = figure.subplots(2, len(suns), sharex=True, sharey="row", squeeze=False)
    for number, sun in enumerate(suns):
        for name, source in sources.items():
            degrees, colours = _meridian(source, sun, step if name == "simulated" else None)
            for row in range(2):
                panels[row, number].plot(degrees, colours[:, row], label=name, **LINES[name])
        panels[0, number].set_title(f"turbidity {turbidity:g}, {style.sun_at(sun)}")
        for row in range(2):
            panels[row, number].axvline(np.degrees(sun), color="0.6", linewidth=0.8, zorder=0)
    _label_meridian(panels, None)
    panels[0, 0].set_ylabel("chromaticity x [1]")
    panels[1, 0].set_ylabel("chromaticity y [1]")
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def zenith_chart(
    sources: Mapping[float, Mapping[str, Source]], suns: np.ndarray, fine: np.ndarray
) -> Figure:
    """Zenith luminance and chromaticity over the sun's zenith angle.

    Args:
        sources: Skies by turbidity, one column each, and by name.
        suns: Simulated zenith angles of the sun [rad].
        fine: Those at which models are drawn [rad].
    """
    figure = style.new_figure(2.5 * len(sources), 6.0)
    panels = figure.subplots(3, len(sources), sharex=True, sharey="row", squeeze=False)
    up = np.zeros(1)
    for column, (turbidity, kinds) in enumerate(sources.items()):
        for name, source in kinds.items():
            at = suns if name == "simulated" else fine
            colours = np.array([source(float(sun), up, up)[0] for sun in at])
            for row, channel in enumerate((2, 0, 1)):
                values = colours[:, channel] / (1e3 if channel == 2 else 1)
                panels[row, column].plot(np.degrees(at), values, label=name, **LINES[name])
        panels[0, column].set_title(f"turbidity {turbidity:g}")
        panels[2, column].set_xlabel("sun zenith angle [°]")
    panels[0, 0].set_yscale("log")
    style.plain_log(panels[0, 0].yaxis)
    panels[0, 0].set_ylabel("zenith luminance [kcd m$^{-2}$]")
    panels[1, 0].set_ylabel("zenith chromaticity x [1]")
    panels[2, 0].set_ylabel("zenith chromaticity y [1]")
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _meridian(source: Source, sun: float, step: float | None) -> tuple[np.ndarray, np.ndarray]:
    """View zenith in degrees, positive on the sun's side, and x, y, Y along it."""
    count = 181 if step is None else 2 * round(np.pi / 2 / step) + 1
    signed = np.linspace(-np.pi / 2, np.pi / 2, count)
    colours = source(sun, np.abs(signed), np.where(signed < 0, np.pi, 0.0))
    return np.degrees(signed), colours


def _label_meridian(panels: np.ndarray, left: str | None) -> None:
    for panel in panels[-1]:
        panel.set_xlabel("view zenith [°], sun side positive")
        panel.set_xticks([-90, -45, 0, 45, 90])
    if left is not None:
        for panel in panels[:, 0]:
            panel.set_ylabel(left)
