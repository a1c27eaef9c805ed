"""Weather files and tables: the sun and the sky's light, hour by hour.

Rows that have no light are dark and rows that are missing are NaN: a year comes back as long as it
was. Perez's sky of every row is `skyfit.perez_all_weather_sky` of its irradiances.
"""

import io
import warnings
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np

from ._typing import as_float
from .errors import InputError, not_found
from .models.all_weather import (
    LARGEST_OFFSET,
    SOLAR_CONSTANT,
    diffuse_efficacy,
    direct_efficacy,
    sky_conditions,
)
from .models.twilight import daytime_sun, dimming
from .sun import Irradiance, sun_table
from .sun.light import visible_fraction
from .sun.times import universal_time


if TYPE_CHECKING:
    import pandas as pd

# Names of the columns, and those that pvlib gives them.
DIRECT, DIFFUSE = ("direct_normal", "dni"), ("diffuse_horizontal", "dhi")
_MISSING = 9900.0  # of both kinds of files, and beyond


def read_weather(path: str | PathLike[str]) -> "pd.DataFrame":
    """Direct and diffuse irradiance of a weather file, for `weather_table`.

    Args:
        path: An EnergyPlus file (.epw), or a TMY3 file (.csv).

    Returns:
        A row for each row of the file, in its order, the index being the middle of the time over
        which it is a mean; `direct_normal` and `diffuse_horizontal`, NaN where the file says that
        they are missing [W m⁻²]. Its `attrs` have `latitude` and `longitude` [rad] and `altitude`
        [m].

    Raises:
        FileNotFoundError: There is no such file.
        InputError: Another ending; a file that is not what its ending says; pvlib, which reads
            them, is not installed.
    """
    path = Path(path)
    if path.suffix.lower() not in (".epw", ".csv"):
        raise InputError(f"{path}: expected an EnergyPlus file (.epw) or TMY3 file (.csv)")
    if not path.exists():
        raise not_found(path)
    try:
        from pvlib import iotools
    except ImportError:
        raise InputError(
            f"{path}: weather files need pvlib: pip install 'skyfit[weather]'"
        ) from None
    import pandas as pd

    raw = path.read_bytes()
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    epw = path.suffix.lower() == ".epw"
    try:
        if epw:
            rows, place = iotools.read_epw(io.StringIO(text))
            index = _middle_of_epw(rows)
        else:
            rows, place = iotools.read_tmy3(io.StringIO(text))
            index = pd.DatetimeIndex(rows.index)
            index = index - _step(index) / 2
        columns = {ours: pd.to_numeric(rows[theirs]) for ours, theirs in (DIRECT, DIFFUSE)}
    except (AttributeError, LookupError, TypeError, ValueError) as error:
        kind = "an EnergyPlus file" if epw else "a TMY3 file"
        raise InputError(f"{path}: expected {kind}; {error}") from None
    table = pd.DataFrame(columns).set_axis(index.rename("time"))
    table = table.astype(float).where(table.abs() < _MISSING)
    angles = {name: float(np.radians(place[name])) for name in ("latitude", "longitude")}
    table.attrs.update(angles, altitude=float(place["altitude"]))
    return table


def _middle_of_epw(rows):
    """Middle of each row's time: the hour counts from 1, and rows within one share it evenly."""
    import pandas as pd

    hour = [rows[name].to_numpy() for name in ("year", "month", "day", "hour")]
    number = rows.groupby(hour).cumcount().to_numpy()
    minutes = 60 / (number.max() + 1) * (number + 0.5)
    return pd.DatetimeIndex(rows.index) + pd.to_timedelta(minutes, unit="min")


def _step(index):
    """The time between rows, that which most of them have."""
    import pandas as pd

    steps = pd.Series(index).diff().dropna()
    if steps.empty:
        raise InputError("two rows or more")
    return steps.mode()[0]


def weather_table(
    weather: "pd.DataFrame",
    latitude: float | None = None,
    longitude: float | None = None,
    *,
    time_zone: Any = None,
) -> "pd.DataFrame":
    """The sun and the light of the sky for every row of a table of irradiance.

    Offsets of instruments, down to -30 W/m², count as 0. A row without diffuse light is dark, and
    one whose sun has set dims as the sky models do. Where an irradiance is NaN, or cannot be one,
    so is what follows from it, and a warning says how many of the latter there were.

    Args:
        weather: As `read_weather` returns it; or any with times in its index and columns
            `direct_normal` and `diffuse_horizontal`, or `dni` and `dhi` as pvlib has them [W m⁻²].
        latitude: Positive north; the table's `attrs` have it if not given [rad].
        longitude: Positive east, likewise [rad].
        time_zone: Zone of times that have none, as for `skyfit.sun_at`.

    Returns:
        A row for each row: `sun_zenith` without refraction and the compass's `sun_azimuth` [rad],
        `direct_normal`, `diffuse_horizontal` and `extraterrestrial` [W m⁻²] as
        `skyfit.perez_all_weather_sky` takes them, `clearness` ε and `brightness` Δ of Perez et al.
        (1990), and what sun and sky put on the ground, `direct_illuminance` and
        `diffuse_illuminance` [lx].

    Raises:
        InputError: No place, a column that is missing or holds no numbers, an index without times.
    """
    latitude = weather.attrs.get("latitude") if latitude is None else latitude
    longitude = weather.attrs.get("longitude") if longitude is None else longitude
    if latitude is None or longitude is None:
        raise InputError("weather_table(latitude=..., longitude=...): expected a place; got none")
    found = sun_table(weather.index, latitude, longitude, time_zone=time_zone)
    direct, diffuse = (_column(weather, names) for names in (DIRECT, DIFFUSE))
    impossible = sum(int(np.isinf(column).sum()) for column in (direct, diffuse))
    if impossible:
        warnings.warn(
            f"weather_table: {impossible} irradiances below -{LARGEST_OFFSET:.0f} or above "
            f"{SOLAR_CONSTANT:.0f} W/m² are taken for missing",
            stacklevel=2,
        )
    direct, diffuse = (np.where(np.isinf(c), np.nan, np.maximum(c, 0)) for c in (direct, diffuse))
    top = SOLAR_CONSTANT * sun_distance_factor(_day_angle(found.index, time_zone))
    sun = found["sun_zenith"].to_numpy()
    light = _light(*map(as_float, (sun, direct, diffuse, top)))
    columns = {"direct_normal": direct, "diffuse_horizontal": diffuse, "extraterrestrial": top}
    columns |= {name: np.asarray(value, float) for name, value in light.items()}
    return found.drop(columns="apparent_zenith").assign(**columns)


def sun_distance_factor(day_angle: np.ndarray) -> np.ndarray:
    """Sunlight above the air over its mean of the year; Spencer (1971), Search 2(5), 172.

    Args:
        day_angle: 2π (d - 1) / 365, d being the day of the year [rad].
    """
    x = day_angle
    first = 1.00011 + 0.034221 * np.cos(x) + 0.00128 * np.sin(x)
    return first + 0.000719 * np.cos(2 * x) + 0.000077 * np.sin(2 * x)


def _day_angle(index, time_zone):
    return 2 * np.pi * (universal_time(index, time_zone).day_of_year - 1) / 365


def _column(weather, names):
    """Irradiance; infinite where it cannot be one."""
    name = next((name for name in names if name in weather.columns), None)
    if name is None:
        known = ", ".join(map(str, weather.columns)) or "none"
        raise InputError(f"weather_table: expected a column {' or '.join(names)}; there is {known}")
    try:
        values = weather[name].to_numpy(float, na_value=np.nan)
    except (TypeError, ValueError) as error:
        raise InputError(f"weather_table: column {name}: expected numbers; {error}") from None
    return np.where((values < -LARGEST_OFFSET) | (values > SOLAR_CONSTANT), np.inf, values)


@jax.jit
def _light(sun, direct, diffuse, top):
    day = daytime_sun(sun)
    missing = jnp.isnan(direct + diffuse)
    clearness, brightness = sky_conditions(Irradiance(direct, diffuse), day, top)
    of_sky = diffuse * diffuse_efficacy(clearness, brightness, day) * dimming(sun)
    of_sun = direct * direct_efficacy(clearness, brightness, day) * jnp.maximum(jnp.cos(sun), 0.0)
    found = {
        "clearness": clearness,
        "brightness": brightness,
        "direct_illuminance": of_sun * visible_fraction(sun),
        "diffuse_illuminance": jnp.maximum(of_sky, 0.0),
    }
    return {name: jnp.where(missing, jnp.nan, value) for name, value in found.items()}
