"""Picture of the reality check."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure, SubFigure

from ..colour import luminance
from ..plots import style
from ..plots.charts import LINES
from .reality import COMPARED, WAVELENGTHS, Reality


def reality_chart(reality: Reality) -> Figure:
    """Measured and modelled domes at one time, mean spectra, and errors over the day."""
    skies = {"measured": reality.measured} | reality.modelled
    time = int(np.argmax(reality.skies["sun_zenith"].values))
    figure = style.new_figure(2.5 * len(skies), 6.0)
    upper, lower = (figure.add_subfigure(row) for row in figure.add_gridspec(2, 1))
    _domes(upper, reality, skies, time)
    spectra, errors = lower.subplots(1, 2)
    for name, light in skies.items():
        mean = 1e3 * light[..., COMPARED].mean(axis=(0, 1))
        spectra.plot(WAVELENGTHS[COMPARED], mean, label=name, **_line(name))
    spectra.set_xlabel("wavelength [nm]")
    spectra.set_ylabel("mean radiance [mW m$^{-2}$ sr$^{-1}$ nm$^{-1}$]")
    spectra.set_ylim(bottom=0)
    spectra.legend()
    hours = reality.skies["local_time"].values / 60
    for name, error in reality.rmse_over_time().items():
        errors.plot(hours, error, label=name, marker="o", markersize=3, **_line(name))
    errors.set_xlabel("local daylight time [h]")
    errors.set_ylabel("RMSE [mW m$^{-2}$ sr$^{-1}$ nm$^{-1}$]")
    errors.set_ylim(bottom=0)
    errors.legend()
    return figure


def _domes(figure: SubFigure, reality: Reality, skies: dict[str, np.ndarray], time: int) -> None:
    panels = figure.subplots(1, len(skies), subplot_kw={"projection": "polar"})
    colours = {name: np.asarray(luminance(s[time], WAVELENGTHS)) / 1e3 for name, s in skies.items()}
    everything = np.concatenate(list(colours.values()))
    norm = LogNorm(everything.min(), everything.max())
    zenith = np.degrees(reality.skies["view_zenith"].values)
    azimuth = reality.skies["relative_azimuth"].values[time]
    sun = float(reality.skies["sun_zenith"].values[time])
    minutes = int(reality.skies["local_time"].values[time])
    clock = f"{minutes // 60}:{minutes % 60:02d}"
    figure.suptitle(f"Ithaca, 27 May 2013, {clock}, {style.sun_at(sun)}", fontsize=11)
    for panel, (name, values) in zip(panels, colours.items(), strict=True):
        panel.scatter(
            azimuth, zenith, c=values, norm=norm, cmap=style.LUMINANCE_MAP, s=42, linewidths=0
        )
        panel.plot(
            [0], [np.degrees(sun)], marker="o", markersize=7, markerfacecolor="none", color="k"
        )
        panel.set_axisbelow(True)
        panel.set_theta_zero_location("N")
        panel.set_rlim(0, 90)
        panel.set_xticklabels([])
        panel.set_yticks([30, 60, 90], labels=["30°", "60°", "90°"], fontsize=6.5)
        panel.set_rlabel_position(-75)  # where no direction was measured
        panel.set_title(name)
    bar = figure.colorbar(
        ScalarMappable(norm, style.LUMINANCE_MAP), ax=list(panels), shrink=0.8, pad=0.02
    )
    bar.set_label("luminance [kcd m$^{-2}$]")
    style.plain_log(bar.ax.yaxis)


def _line(name: str) -> dict[str, Any]:
    """Of a curve: a simulation is a curve here, not points."""
    look = {key: value for key, value in LINES[name].items() if "marker" not in key}
    return look | ({"linestyle": ":"} if name == "simulated" else {})
