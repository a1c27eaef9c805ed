"""Colours in the CIE 1931 chromaticity diagram."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from ..colour import D65_WHITE, SRGB_PRIMARIES, matching_functions
from . import style


_MARKED = (450, 480, 500, 520, 540, 560, 580, 600, 620)  # nm
_VISIBLE = (380, 700)  # nm


def chromaticity_diagram(
    tracks: Mapping[str, Float[np.ndarray, "point 2"]], *, whole: bool = False
) -> Figure:
    """Tracks of x, y with the spectral locus, daylight and sRGB; a ring marks where each begins.

    Args:
        tracks: Chromaticities x and y, by name.
        whole: Show the whole diagram; else the surroundings of the tracks.
    """
    nodes, curves = matching_functions()
    locus = curves[:, :2] / curves.sum(axis=1, keepdims=True)
    seen = (nodes >= _VISIBLE[0]) & (nodes <= _VISIBLE[1])
    with style.house_style():
        figure = style.new_figure(5.4, 5.2)
        panel = figure.subplots()
        edge = np.concatenate([locus[seen], locus[seen][:1]])
        panel.plot(*edge.T, color="0.3", linewidth=1.0)
        for wavelength in _MARKED:
            x, y = locus[np.searchsorted(nodes, wavelength)]
            panel.annotate(
                f"{wavelength} nm", (x, y), xytext=(2, 2), textcoords="offset points",
                fontsize=6.5, color="0.3", annotation_clip=True,
            )  # fmt: skip
        panel.plot(*daylight_locus().T, color="0.55", linewidth=1.0, label="CIE daylight")
        triangle = np.array([*SRGB_PRIMARIES, SRGB_PRIMARIES[0]])
        panel.plot(*triangle.T, color="0.55", linewidth=0.8, linestyle=":", label="sRGB")
        panel.plot(*D65_WHITE, marker="+", color="k", linestyle="none", label="D65")
        for number, (name, track) in enumerate(tracks.items()):
            look = style.cycle(number)
            panel.plot(track[:, 0], track[:, 1], label=name, **look)
            panel.plot(
                *track[0], marker="o", markerfacecolor="w", color=look["color"], markersize=4
            )
        panel.set_xlabel("chromaticity x [1]")
        panel.set_ylabel("chromaticity y [1]")
        panel.set_aspect("equal")
        if whole or not tracks:
            panel.set_xlim(0, 0.8)
            panel.set_ylim(0, 0.9)
        else:
            points = np.concatenate(list(tracks.values()))
            middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
            reach = max(0.04, 0.62 * float(np.ptp(points, axis=0).max()))
            panel.set_xlim(middle[0] - reach, middle[0] + reach)
            panel.set_ylim(middle[1] - reach, middle[1] + reach)
        panel.legend(loc="best", fontsize=7)
    return figure


def daylight_locus() -> Float[np.ndarray, "point 2"]:
    """Chromaticities of CIE daylight from 4000 K to 25 000 K.

    Source: CIE 015:2018, equations 4.2 to 4.4.
    """
    temperature = np.linspace(4000, 25000, 200)
    t = 1e3 / temperature
    x = np.where(
        temperature <= 7000,
        0.244063 + 0.09911 * t + 2.9678 * t**2 - 4.6070 * t**3,
        0.237040 + 0.24748 * t + 1.9018 * t**2 - 2.0064 * t**3,
    )
    return np.stack([x, -3.0 * x**2 + 2.870 * x - 0.275], axis=1)
