"""Where the sun stands at times of the calendar: ISO strings, `datetime`, pandas, NumPy."""

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta, timezone, tzinfo
from typing import TYPE_CHECKING, Any, NamedTuple
from zoneinfo import ZoneInfo

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike
from ..angles import compass_azimuth
from ..errors import InputError
from .position import SunPosition, sun_position


if TYPE_CHECKING:
    import pandas as pd

# Where the upper limb of a refracted sun touches the horizon; below, refraction is held.
_LOWEST = np.radians(-0.8333)


class UniversalTime(NamedTuple):
    """Times as `sun_position` takes them, for a clock set to universal time.

    Attributes:
        year: Calendar year.
        day_of_year: 1 on January 1.
        hour: Time of the day [h].
    """

    year: Float[np.ndarray, "*time"]
    day_of_year: Float[np.ndarray, "*time"]
    hour: Float[np.ndarray, "*time"]


def sun_at(
    times: Any,
    latitude: ArrayLike,
    longitude: ArrayLike,
    *,
    time_zone: str | float | int | tzinfo | None = None,
    refraction: bool = False,
) -> SunPosition:
    """Direction of the sun at times of the calendar, by the almanac of `sun_position`.

    Args:
        times: One time or several: ISO 8601 strings, `datetime`, a pandas `DatetimeIndex`, `Series`
            or `Timestamp`, NumPy's `datetime64`.
        latitude: Positive north [rad]; broadcasts against the times, as the longitude does.
        longitude: Positive east [rad].
        time_zone: Zone of times that have none: a name such as "Europe/Vienna", hours ahead of
            universal time, or a `tzinfo`.
        refraction: Whether the zenith angle is that at which the sun is seen, by `refracted`.

    Raises:
        InputError: What is no time; a time without a zone where none is given, or with one where
            one is; an unknown zone; an angle out of its range.
    """
    at = universal_time(times, time_zone)
    position = sun_position(
        latitude, longitude, at.day_of_year, at.hour, 0.0, method="almanac", year=at.year
    )
    if not refraction:
        return position
    return SunPosition(refracted(position.zenith), position.azimuth)


def sun_table(
    times: Any,
    latitude: float,
    longitude: float,
    *,
    time_zone: str | float | int | tzinfo | None = None,
) -> "pd.DataFrame":
    """Directions of the sun at one place as a table, a row for each time.

    Args:
        times: Times, as for `sun_at`; they are the table's index.
        latitude: Positive north [rad].
        longitude: Positive east [rad].
        time_zone: Zone of times that have none, as for `sun_at`.

    Returns:
        `sun_zenith` without refraction, `apparent_zenith` with it, and `sun_azimuth` of the compass
        [rad].

    Raises:
        InputError: What `sun_at` refuses.
    """
    import pandas as pd

    position = sun_at(times, latitude, longitude, time_zone=time_zone)
    given = pd.DatetimeIndex(times) if hasattr(times, "dt") else times
    index = given if isinstance(given, pd.DatetimeIndex) else pd.Index(np.atleast_1d(given))
    columns = {
        "sun_zenith": position.zenith,
        "apparent_zenith": refracted(position.zenith),
        "sun_azimuth": compass_azimuth(position.azimuth),
    }
    values = {name: np.atleast_1d(np.asarray(angle, float)) for name, angle in columns.items()}
    return pd.DataFrame(values, index=index.rename("time"))


def refracted(sun_zenith: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """Zenith angle at which the sun is seen through air of 1010 hPa and 10 °C at the ground [rad].

    1.02' cot(h + 10.3 / (h + 5.11)) above the true elevation h, both in degrees; held from 0.83°
    below the horizon, where it is 0.62°.

    Source: Saemundsson (1986), Sky & Telescope 72, 70; in Meeus, "Astronomical Algorithms", 16.4.

    Args:
        sun_zenith: Zenith angle without air [rad].
    """
    degrees = jnp.degrees(jnp.maximum(np.pi / 2 - sun_zenith, _LOWEST))
    lift = 1.02 / 60 / jnp.tan(jnp.radians(degrees + 10.3 / (degrees + 5.11)))
    return sun_zenith - jnp.radians(jnp.maximum(lift, 0.0))


def universal_time(
    times: Any, time_zone: str | float | int | tzinfo | None = None
) -> UniversalTime:
    """Year, day and hour of universal time; arguments as `sun_at`."""
    zone = None if time_zone is None else _zone(time_zone)
    if hasattr(times, "dt"):  # a Series
        import pandas as pd

        times = pd.DatetimeIndex(times)
    if getattr(times, "tz", None) is not None and hasattr(times, "tz_convert"):
        _refuse_two(zone)
        at = times.tz_convert("UTC")
        second = at.second + 1e-6 * at.microsecond
        parts = at.year, at.day_of_year, at.hour + at.minute / 60 + second / 3600
        found = UniversalTime(*(np.asarray(part, float) for part in parts))
        if np.isnan(found.hour).any():
            raise InputError("times: expected a time in every row; got NaT")
        return found
    given = times
    if isinstance(given, np.datetime64) or hasattr(given, "to_numpy"):
        given = np.asarray(given)
    if isinstance(given, np.ndarray) and given.dtype.kind == "M":
        given = given.astype("datetime64[us]").tolist()
    if isinstance(given, np.ndarray):
        given = given.tolist()
    several = isinstance(given, Sequence) and not isinstance(given, str)
    rows = [_parts(one, zone) for one in (given if several else [given])]
    columns = np.array(rows, float).reshape(-1, 3).T
    return UniversalTime(*(columns if several else columns[:, 0]))


def _parts(time: Any, zone: tzinfo | None) -> tuple[int, int, float]:
    if isinstance(time, str):
        try:
            time = datetime.fromisoformat(time)
        except ValueError:
            words = "expected one like 2024-06-21T12:00+02:00"
            raise InputError(f"times: {words}; got {time!r}") from None
    if not isinstance(time, datetime) or time != time:  # NaT is a datetime, and not itself
        raise InputError(f"times: expected ISO strings, datetime or pandas times; got {time!r}")
    if time.tzinfo is None:
        if zone is None:
            raise InputError(
                "times: expected a time zone, as in 2024-06-21T12:00+02:00, or time_zone=...; "
                f"got {time.isoformat()}"
            )
        time = time.replace(tzinfo=zone)
    else:
        _refuse_two(zone)
    at = time.astimezone(UTC)
    midnight = at.replace(hour=0, minute=0, second=0, microsecond=0)
    return at.year, at.timetuple().tm_yday, (at - midnight) / timedelta(hours=1)


def _refuse_two(zone: tzinfo | None) -> None:
    if zone is not None:
        raise InputError(f"time_zone={zone}: expected none for times that have their own")


def _zone(given: str | float | int | tzinfo) -> tzinfo:
    if isinstance(given, tzinfo):
        return given
    try:
        return ZoneInfo(given) if isinstance(given, str) else timezone(timedelta(hours=given))
    except (KeyError, ValueError, TypeError, OSError):
        raise InputError(
            "time_zone: expected a name such as Europe/Vienna, or hours ahead of universal time; "
            f"got {given!r}"
        ) from None
