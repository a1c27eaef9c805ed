"""Pictures of whole skies: fisheye domes in false colour and in sRGB, and maps of errors."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..colour import xyY_to_xyz, xyz_to_rgb
from . import style
from .skies import Source, fisheye_directions


PIXELS = 240


def dome_gallery(sources: Mapping[str, Source], turbidity: float, suns: Sequence[float]) -> Figure:
    """Skies side by side: luminance in false colour, and as an eye might see them.

    Args:
        sources: A row each, by name.
        turbidity: Turbidity of all of them.
        suns: Zenith angles, two columns each [rad].
    """
    figure = style.new_figure(2.0 * 2 * len(suns) + 0.6, 2.15 * len(sources) + 0.8)
    figure.suptitle(f"turbidity {turbidity:g}", fontsize=11)
    panels = figure.subplots(len(sources), 2 * len(suns), squeeze=False)
    for number, sun in enumerate(suns):
        colours = {name: fisheye(source, sun) for name, source in sources.items()}
        skies = np.stack(list(colours.values()))
        low, high = (float(end) for end in np.nanpercentile(skies[..., 2] / 1e3, [0.5, 99.5]))
        norm = LogNorm(low, high)
        white = float(np.nanpercentile(skies[..., 2], 97))
        false, real = panels[:, 2 * number], panels[:, 2 * number + 1]
        for row, (name, sky) in enumerate(colours.items()):
            false[row].imshow(
                sky[..., 2] / 1e3, norm=norm, cmap=style.LUMINANCE_MAP, extent=(-1, 1, -1, 1)
            )
            real[row].imshow(displayed(sky, white), extent=(-1, 1, -1, 1))
            for panel in (false[row], real[row]):
                _as_dome(panel, sun)
            if number == 0:
                false[row].set_ylabel(name)
        where = style.sun_at(sun)
        false[0].set_title(f"{where}\nluminance")
        real[0].set_title(f"{where}\nsRGB")
        shown = ScalarMappable(norm, style.LUMINANCE_MAP)
        bar = figure.colorbar(shown, ax=list(false), location="bottom", shrink=0.9, extend="both")
        bar.set_label("luminance [kcd m$^{-2}$]")
        style.plain_log(bar.ax.xaxis)
    return figure


def error_maps(
    truth: Source,
    models: Mapping[str, Source],
    turbidity: float,
    suns: Sequence[float],
    bound: float,
) -> Figure:
    """How far models are from the simulated luminance, over the dome.

    Args:
        truth: The simulation.
        models: A row each, by name.
        turbidity: Turbidity of all of them.
        suns: Zenith angles, a column each [rad].
        bound: Upper end of the colour scale; its inverse is the lower end [1].
    """
    figure = style.new_figure(2.1 * len(suns) + 1.0, 2.2 * len(models) + 0.5)
    figure.suptitle(f"turbidity {turbidity:g}", fontsize=11)
    panels = figure.subplots(len(models), len(suns), squeeze=False)
    norm = LogNorm(1 / bound, bound)
    for column, sun in enumerate(suns):
        reference = fisheye(truth, sun)[..., 2]
        for row, (name, model) in enumerate(models.items()):
            panel = panels[row, column]
            ratio = fisheye(model, sun)[..., 2] / reference
            panel.imshow(ratio, norm=norm, cmap=style.ERROR_MAP, extent=(-1, 1, -1, 1))
            _as_dome(panel, sun)
            rms = np.sqrt(np.nanmean((ratio - 1) ** 2))
            panel.set_xlabel(f"RMS {100 * rms:.0f} %")
            if row == 0:
                panel.set_title(style.sun_at(sun))
            if column == 0:
                panel.set_ylabel(name)
    shown = ScalarMappable(norm, style.ERROR_MAP)
    bar = figure.colorbar(shown, ax=list(panels.ravel()), extend="both", shrink=0.8)
    bar.set_label("luminance, model over simulation [1]")
    style.plain_log(bar.ax.yaxis)
    return figure


def fisheye(source: Source, sun: float) -> np.ndarray:
    """x, y, Y of an equidistant fisheye picture; NaN around the sky."""
    view, azimuth, inside = fisheye_directions(PIXELS)
    picture = np.full((*view.shape, 3), np.nan)
    picture[inside] = source(sun, view[inside], azimuth[inside])
    return picture


def displayed(sky: np.ndarray, white: float) -> np.ndarray:
    """Pixels in sRGB, exposed so that `white` [cd m⁻²] is bright, with highlights rolled off."""
    inside = np.isfinite(sky[..., 2])
    linear = np.asarray(xyz_to_rgb(xyY_to_xyz(np.nan_to_num(sky, nan=0.0))))
    exposed = 1 - np.exp(-1.8 * np.maximum(linear, 0) / white)
    low, high = 12.92 * exposed, 1.055 * np.maximum(exposed, 0.0031308) ** (1 / 2.4) - 0.055
    encoded = np.where(exposed <= 0.0031308, low, high)
    return np.where(inside[..., None], encoded, 1.0)


def _as_dome(panel: Axes, sun: float) -> None:
    panel.set_xticks([])
    panel.set_yticks([])
    panel.grid(visible=False)
    for spine in panel.spines.values():
        spine.set_visible(False)
    height = sun / (np.pi / 2)
    panel.plot([0], [height], marker="o", markersize=5, markerfacecolor="none", color="w")
    panel.plot([0], [height], marker="o", markersize=6.5, markerfacecolor="none", color="k", lw=0.5)
    panel.set_xlim(-1.02, 1.02)
    panel.set_ylim(-1.02, 1.02)
