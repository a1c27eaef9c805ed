"""The sun of a command: by its angles in degrees, or by place and time."""

import math
from datetime import time
from typing import Any

import click
import numpy as np

import skyfit
from skyfit._typing import as_float
from skyfit.angles import compass_azimuth
from skyfit.sun.position import equation_of_time


STILL = (
    "a picture by place needs --latitude-deg, --longitude-deg and --time 2024-06-21T12:00+02:00, "
    "or --latitude-deg, --day-of-year and --time 12:00, which is solar time"
)
DAY = "a day needs --latitude-deg and --day-of-year, or --to-sun-zenith-deg"


def hint_at_radians(context: click.Context, parameter: click.Parameter, value: float | None):
    """Callback of an option: say in one line where a zenith angle in degrees looks like radians."""
    if value is not None and 0 < value <= math.pi / 2:
        hint = f"in degrees; {value:g} rad is {np.degrees(value):.4g}"
        click.echo(f"skyfit: hint: {parameter.opts[0]} {value:g} is {hint}", err=True)
    return value


def sun_of_still(options: dict[str, Any]) -> tuple[float, float] | None:
    """Zenith angle and compass azimuth of the sun by place and time [rad]; None without a place.

    Raises:
        UsageError: What tells place and time is incomplete, or told twice.
    """
    latitude, longitude, day, at = (
        options[name] for name in ("latitude_deg", "longitude_deg", "day_of_year", "time")
    )
    if options["to_sun_zenith_deg"] is not None:
        raise click.UsageError("--to-sun-zenith-deg: only for a day, .gif or .apng")
    if latitude is None and longitude is None and day is None and at is None:
        return None
    for name in ("sun_zenith_deg", "sun_azimuth_deg"):
        if options[name] is not None:
            option = "--" + name.replace("_", "-")
            raise click.UsageError(f"{option}: not beside --latitude-deg and --time, which say it")
    if latitude is None or at is None or (day is None) == (longitude is None):
        raise click.UsageError(STILL)
    north = np.radians(latitude)
    if longitude is not None:
        try:
            sun = skyfit.sun_at(at, north, np.radians(options["longitude_deg"]))
        except skyfit.InputError as error:
            said = str(error).removeprefix("times: ").replace(", or time_zone=...", "")
            raise click.UsageError(f"--time: {said}") from None
    else:
        clock = _clock(at) - _ahead(options["day_of_year"])
        sun = skyfit.sun_position(north, 0.0, options["day_of_year"], clock, 0.0)
    return float(sun.zenith), float(compass_azimuth(sun.azimuth))


def refuse_still(options: dict[str, Any]) -> None:
    """Refuse for a day what is only for a still.

    Raises:
        UsageError: Such an option is there.
    """
    for name in ("longitude_deg", "time"):
        if options[name] is not None:
            option = "--" + name.replace("_", "-")
            raise click.UsageError(f"{option}: only for one picture; {DAY}")


def _ahead(day: int) -> float:
    """How far solar time is ahead of a clock's by the paper [h]."""
    return float(equation_of_time(as_float(float(day))))


def _clock(text: str) -> float:
    try:
        at = time.fromisoformat(text)
    except ValueError:
        raise click.UsageError(f"--time: expected one like 12:00; got {text!r}; {STILL}") from None
    return at.hour + at.minute / 60 + at.second / 3600
