"""Where the sun stands at a place over the hours and the year."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

from ..sun import sun_position
from . import style


# Solstices, equinoxes and the months' 21sts between them
_DAYS = {21: "21 Jan", 52: "21 Feb", 80: "21 Mar", 111: "21 Apr", 141: "21 May", 172: "21 Jun"}
_DAYS |= {355: "21 Dec"}


def sun_path(latitude: float, *, longitude: float = 0.0, standard_meridian: float = 0.0) -> Figure:
    """The sun's paths over the dome: a line for each day, a loop for each hour of the clock.

    Args:
        latitude: Positive north [rad].
        longitude: Positive east [rad].
        standard_meridian: Longitude that the clock is set to [rad].
    """
    place = (latitude, longitude)
    with style.house_style():
        figure = style.new_figure(5.2, 5.2)
        panel = figure.add_subplot(projection="polar")
        assert isinstance(panel, PolarAxes)
        panel.set_theta_zero_location("N")
        panel.set_theta_direction(-1)
        hours = np.linspace(0, 24, 577)
        for number, (day, name) in enumerate(_DAYS.items()):
            azimuth, zenith = _seen(sun_position(*place, day, hours, standard_meridian))
            panel.plot(azimuth, zenith, label=name, **style.cycle(number))
        days = np.arange(1, 366)
        for hour in range(24):
            azimuth, zenith = _seen(sun_position(*place, days, float(hour), standard_meridian))
            panel.plot(azimuth, zenith, color="0.6", linewidth=0.6, zorder=0)
            if np.isfinite(zenith).any():
                at = int(np.nanargmin(zenith))
                panel.annotate(f"{hour} h", (azimuth[at], zenith[at]), fontsize=6.5, color="0.35",
                               ha="center", va="bottom")  # fmt: skip
        panel.set_ylim(0, 90)
        panel.set_yticks([30, 60, 90], ["30°", "60°", "90°"], fontsize=7)
        panel.set_thetagrids(np.arange(0, 360, 45), ["N", "NE", "E", "SE", "S", "SW", "W", "NW"])
        panel.set_xlabel("rings: sun zenith angle; hours of the clock without daylight saving")
        panel.set_title(f"the sun at latitude {np.degrees(latitude):.1f}°")
        figure.legend(*panel.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _seen(position) -> tuple[np.ndarray, np.ndarray]:
    """Compass azimuth [rad] and zenith angle [degree], NaN where the sun is down."""
    zenith = np.degrees(np.asarray(position.zenith))
    azimuth = np.asarray(position.azimuth) + np.pi
    return azimuth, np.where(zenith <= 90, zenith, np.nan)
