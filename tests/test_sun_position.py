"""Where the sun stands: the paper's formulas and the almanac against NREL's algorithm in pvlib."""

import inspect

import jax
import jax.numpy as jnp
import numpy as np
import pandas as pd
import pytest
from peers import peer

from skyfit import sun_position
from skyfit.sun import almanac


pytestmark = pytest.mark.any_precision


SITES = [(0.0, 0.0), (40.0, -105.0), (-35.0, 149.0), (65.0, 25.0), (-64.0, -60.0), (20.0, 175.0)]


def times_and_places(years, count):
    """Sites, years, days of the year and clock times at random, and the time zones of the sites."""
    rng = np.random.default_rng(20)
    for latitude, longitude in SITES:
        year, day = rng.integers(*years, count), rng.integers(1, 366, count)
        clock = rng.uniform(0.0, 24.0, count)
        yield latitude, longitude, year, day, clock, round(longitude / 15)


def nrel(latitude, longitude, year, day, clock, zone):
    """Zenith angle and azimuth west of south by the Solar Position Algorithm, in radians."""
    pvlib = peer("pvlib")
    when = pd.to_datetime([f"{y}-01-01" for y in year], utc=True)
    when = when + pd.to_timedelta(day - 1, unit="D") + pd.to_timedelta(clock - zone, unit="h")
    table = pvlib.solarposition.spa_python(when, latitude, longitude, delta_t=67.0)
    return np.radians(table.zenith.to_numpy()), np.radians(table.azimuth.to_numpy() - 180)


def errors(method, years=(1980, 2051), count=300, dtype=np.float64):
    """Angles between the sun and where it should be [degrees]."""
    apart = []
    for latitude, longitude, year, day, clock, zone in times_and_places(years, count):
        zenith, azimuth = nrel(latitude, longitude, year, day, clock, zone)
        extra = {} if method == "paper" else {"year": year.astype(dtype)}
        place = np.radians([latitude, longitude]).astype(dtype)
        got = sun_position(
            *place, day.astype(dtype), clock.astype(dtype), dtype(np.radians(15 * zone)),
            method=method, **extra,
        )  # fmt: skip
        h = np.sin((zenith - got.zenith) / 2) ** 2
        h += np.sin(zenith) * np.sin(got.zenith) * np.sin((azimuth - got.azimuth) / 2) ** 2
        apart.append(np.degrees(2 * np.arcsin(np.sqrt(h))))
    return np.concatenate(apart)


def test_the_papers_sun_is_within_one_and_a_third_degrees_of_nrels():
    # What the docstring of sun_position says: 1.3° at most and 0.36° in the mean square.
    error = errors("paper")
    assert 1.0 < error.max() < 1.3
    np.testing.assert_allclose(np.sqrt(np.mean(error**2)), 0.36, atol=0.01)


def test_the_almanacs_sun_is_within_six_thousandths_of_a_degree_of_nrels():
    error = errors("almanac")
    assert error.max() < 0.006
    assert np.sqrt(np.mean(error**2)) < 0.0016


def test_the_almanac_keeps_a_sixtieth_of_a_degree_in_float32(float32):
    assert errors("almanac", dtype=np.float32).max() < 0.015


def test_the_almanac_places_the_sun_of_an_example_of_meeus():
    # "Astronomical Algorithms", example 25.b: 1992 October 13, 0 h dynamical time (59 s ahead of
    # universal time): declination -7° 47' 01.74", right ascension 13 h 13 min 30.749 s.
    noon = almanac.days_since_2000(jnp.asarray(1992.0), jnp.asarray(287.0))
    declination, hour_angle = almanac.apparent_place(noon, jnp.asarray(-59 / 3600))
    np.testing.assert_allclose(np.degrees(declination), -7.783817, atol=0.001)
    # Sidereal time at 0 h universal time by chapter 12: 21.8013°, and 0.0041° of nutation; 59 s
    # are a quarter of a degree. The sun's apparent place is good to 0.002°.
    right_ascension = np.mod(21.8054 - 59 * 361 / 86400 - np.degrees(hour_angle), 360)
    np.testing.assert_allclose(right_ascension, 198.378121, atol=0.002)


@pytest.mark.parametrize(
    ("date", "days"),
    [("2000-01-01", 0), ("2001-01-01", 366), ("1999-12-31", -1), ("2100-03-01", 36584)],
)
def test_days_are_counted_by_the_gregorian_calendar(date, days):
    stamp = pd.Timestamp(date)
    year, day = jnp.asarray(float(stamp.year)), jnp.asarray(float(stamp.day_of_year))
    assert almanac.days_since_2000(year, day) == days == (stamp - pd.Timestamp("2000-01-01")).days


@pytest.mark.float64
def test_the_papers_formulas_by_hand():
    # Day 172, 50° N on the standard meridian, 12 h: declination 0.4093 sin(2π 91/368) = 0.40929,
    # equation of time 0.170 sin(4π 92/373) - 0.129 sin(2π 164/355) = -0.0233 h.
    zenith, azimuth = sun_position(np.radians(50.0), 0.3, 172, 12.0, 0.3)
    hour_angle = (
        np.pi / 12 * (0.170 * np.sin(4 * np.pi * 92 / 373) - 0.129 * np.sin(2 * np.pi * 164 / 355))
    )
    dec, lat = 0.4093 * np.sin(2 * np.pi * 91 / 368), np.radians(50.0)
    up = np.sin(lat) * np.sin(dec) + np.cos(lat) * np.cos(dec) * np.cos(hour_angle)
    np.testing.assert_allclose(zenith, np.arccos(up), rtol=1e-12)
    np.testing.assert_allclose(np.degrees(zenith), 26.55, atol=0.02)
    assert -0.02 < azimuth < 0


@pytest.mark.parametrize(("method", "extra"), [("paper", {}), ("almanac", {"year": 2024})])
def test_the_sun_rises_in_the_east_and_sets_in_the_west(method, extra):
    hours = np.array([6.5, 12.2, 17.5])
    azimuth = sun_position(0.8, 0.0, 80, hours, 0.0, method=method, **extra).azimuth
    assert azimuth[0] < -1.3 < -0.1 < azimuth[1] < 0.2 < 1.3 < azimuth[2]


@pytest.mark.parametrize(("method", "extra"), [("paper", {}), ("almanac", {"year": 2024})])
def test_east_of_the_meridian_the_clock_is_behind_the_sun(method, extra):
    # 15° of longitude are an hour of the clock; the almanac's sun moves on by 0.01° meanwhile.
    east = sun_position(0.7, np.radians(15.0), 200, 9.0, 0.0, method=method, **extra)
    later = sun_position(0.7, 0.0, 200, 10.0, 0.0, method=method, **extra)
    np.testing.assert_allclose(east, later, atol=1e-12 if method == "paper" else 2e-4)


@pytest.mark.float64
@pytest.mark.parametrize(("method", "extra"), [("paper", {}), ("almanac", {"year": 2024.0})])
def test_derivatives_are_finite_and_right(method, extra):
    @jax.jit
    def both(arguments):
        return jnp.stack(sun_position(*arguments, method=method, **extra))

    at = jnp.asarray([0.7, 0.1, 120.0, 15.0, 0.2])
    jacobian = jax.jit(jax.jacfwd(both))(at)
    step = 1e-4
    for k in range(5):
        nudge = step * jnp.zeros(5).at[k].set(1.0)
        slope = (both(at + nudge) - both(at - nudge)) / (2 * step)
        np.testing.assert_allclose(jacobian[:, k], slope, rtol=1e-5, atol=1e-7)


def test_a_sun_overhead_has_finite_derivatives():
    def zenith(hour):
        return sun_position(0.0, 0.0, 81, hour, 0.0).zenith

    # Day 81: declination 0; overhead at the equator when solar time is 12 h.
    noon = 12 - 0.170 * np.sin(4 * np.pi / 373) + 0.129 * np.sin(2 * np.pi * 73 / 355)
    np.testing.assert_allclose(zenith(noon), 0.0, atol=1e-12)
    assert np.isfinite(jax.grad(zenith)(noon))


def test_arguments_broadcast_and_map():
    grid = sun_position(np.array([[0.1], [0.9]]), 0.0, 10, np.array([8.0, 10.0, 14.0]), 0.0)
    assert grid.zenith.shape == (2, 3)
    one = jax.jit(jax.vmap(lambda hour: sun_position(0.9, 0.0, 10, hour, 0.0).zenith))
    np.testing.assert_allclose(one(jnp.array([8.0, 10.0, 14.0])), grid.zenith[1], rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"latitude": 51.0}, r"latitude=...\) must lie in -π/2 to π/2; got 51"),
        ({"day_of_year": 2451545}, r"day_of_year=...\) must lie in 1 to 366; got 2.45"),
        ({"day_of_year": 0}, "must lie in 1 to 366; got 0"),
        ({"method": "spa"}, r"method=...\): expected one of \('paper', 'almanac'\); got 'spa'"),
        ({"method": "almanac"}, r"year=...\): method 'almanac' takes a year; got None"),
        ({"year": 2024}, r"year=...\): method 'paper' takes no year; got 2024"),
    ],
)
def test_mistakes_are_named(change, message):
    arguments = {
        "latitude": 0.5, "longitude": 0.0, "day_of_year": 100,
        "standard_time": 12.0, "standard_meridian": 0.0,
    }  # fmt: skip
    with pytest.raises(ValueError, match=message):
        # Without the suite's type checks: a user may pass anything.
        inspect.unwrap(sun_position)(**(arguments | change))
