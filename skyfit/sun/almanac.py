"""Apparent place of the sun, to a few thousandths of a degree.

The low-precision theory of J. Meeus, "Astronomical Algorithms", 2nd edition (1998), chapters 12,
22 and 25: mean elements, equation of centre, aberration and the largest terms of nutation; and the
five largest perturbations from his "Astronomical Formulae for Calculators" (1979), chapter 18. Days
are counted from J2000.0 (2000 January 1, 12 h), and whole days apart from the time of day, so that
float32 keeps its digits.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float


# Terrestrial time runs ahead of universal time by about 64 s in 2000 and 69 s in 2020; the sun
# moves 0.0008° in that time, so that one value serves the years in which the theory holds.
DYNAMICAL_TIME_AHEAD = 67.0 / 86400.0  # days
SOLAR_PARALLAX = 8.794 / 3600.0  # degrees


def days_since_2000(
    year: Float[Array, "*#batch"], day_of_year: Float[Array, "*#batch"]
) -> Float[Array, "*batch"]:
    """Days from J2000.0 to 12 h universal time of a day of the Gregorian calendar.

    Args:
        year: Calendar year, a whole number.
        day_of_year: 1 on January 1.
    """
    before = year - 1
    leaps = jnp.floor(before / 4) - jnp.floor(before / 100) + jnp.floor(before / 400)
    # 484 leap days came before the year 2000, whose January 1 is day 0.
    return 365.0 * (year - 2000) + (leaps - 484) + (day_of_year - 1)


def apparent_place(
    noon: Float[Array, "*#batch"], universal_time: Float[Array, "*#batch"]
) -> tuple[Float[Array, "*batch"], Float[Array, "*batch"]]:
    """Declination, and hour angle at Greenwich.

    Args:
        noon: 12 h universal time of the day, in days since J2000.0; `days_since_2000`.
        universal_time: Universal time of that day; may lie outside 0 to 24 [h].

    Returns:
        Geocentric declination [rad]. Hour angle of the sun at longitude 0, positive after noon; not
        reduced to one turn [rad].
    """
    fraction = (universal_time - 12.0) / 24.0
    since = noon + fraction + DYNAMICAL_TIME_AHEAD
    century = since / 36525.0
    anomaly = _turn(357.52911, 0.98560028176, noon, fraction + DYNAMICAL_TIME_AHEAD)
    anomaly = anomaly - jnp.radians(0.0001537) * century**2
    mean_longitude = _turn(280.46646, 0.98564736003, noon, fraction + DYNAMICAL_TIME_AHEAD)
    mean_longitude = mean_longitude + jnp.radians(0.0003032) * century**2
    centre = (
        (1.914602 - 0.004817 * century - 0.000014 * century**2) * jnp.sin(anomaly)
        + (0.019993 - 0.000101 * century) * jnp.sin(2 * anomaly)
        + 0.000289 * jnp.sin(3 * anomaly)
    )
    # Degrees: what Venus (twice), Jupiter and the Moon do to the Earth, and a long period.
    perturbation = (
        0.00134 * jnp.cos(_since_1900(153.23, 22518.7541, noon, fraction))
        + 0.00154 * jnp.cos(_since_1900(216.57, 45037.5082, noon, fraction))
        + 0.00200 * jnp.cos(_since_1900(312.69, 32964.3577, noon, fraction))
        + 0.00179 * jnp.sin(_since_1900(350.74, 445267.1142, noon, fraction))
        + 0.00178 * jnp.sin(_since_1900(231.19, 20.20, noon, fraction))
    )
    node = _turn(125.04452, -0.05295376, noon, fraction)
    moon = _turn(218.3165, 13.17639648, noon, fraction)
    twice_sun, twice_moon = 2 * mean_longitude, 2 * moon
    # Arcseconds; chapter 22.
    nutation = (
        -17.20 * jnp.sin(node)
        - 1.32 * jnp.sin(twice_sun)
        - 0.23 * jnp.sin(twice_moon)
        + 0.21 * jnp.sin(2 * node)
    ) / 3600.0
    tilt = (
        9.20 * jnp.cos(node)
        + 0.57 * jnp.cos(twice_sun)
        + 0.10 * jnp.cos(twice_moon)
        - 0.09 * jnp.cos(2 * node)
    ) / 3600.0
    aberration = -20.4898 / 3600.0
    longitude = mean_longitude + jnp.radians(centre + perturbation + nutation + aberration)
    obliquity = jnp.radians(23.4392911 - 0.0130042 * century + tilt)
    right_ascension = jnp.arctan2(jnp.cos(obliquity) * jnp.sin(longitude), jnp.cos(longitude))
    declination = jnp.arcsin(jnp.sin(obliquity) * jnp.sin(longitude))
    # Sidereal time: a whole turn a day more than the mean sun's; whole days drop out.
    sidereal = _turn(280.46061837, 0.98564736629, noon, fraction) + 2 * jnp.pi * fraction
    sidereal = sidereal + jnp.radians(nutation * jnp.cos(obliquity))
    return declination, sidereal - right_ascension


def _turn(start, per_day, noon, fraction):
    """An angle that grows evenly [rad]: degrees at J2000.0 and per day."""
    return jnp.radians(jnp.mod(start + per_day * noon, 360.0) + per_day * fraction)


def _since_1900(start, per_century, noon, fraction):
    """An angle that grows evenly [rad]: degrees at 1900 January 0.5 and per Julian century."""
    return _turn((start + per_century) % 360.0, per_century / 36525.0, noon, fraction)
