"""The sun at times of the calendar, against NREL's algorithm in pvlib; both ways of azimuths."""

import inspect
from datetime import UTC, datetime, timedelta, timezone

import jax
import jax.numpy as jnp
import numpy as np
import pandas as pd
import pytest
from peers import peer

import skyfit
from skyfit.angles import azimuth_from_south, compass_azimuth
from skyfit.sun.times import refracted


pytestmark = pytest.mark.any_precision


VIENNA = np.radians([48.2, 16.37])
# One instant, 2024-06-21 10:00 UTC, in every way to say it.
SAME = {
    "iso": "2024-06-21T12:00+02:00",
    "zulu": "2024-06-21T10:00:00Z",
    "datetime": datetime(2024, 6, 21, 10, tzinfo=UTC),
    "timestamp": pd.Timestamp("2024-06-21T12:00", tz="Europe/Vienna"),
    "index": pd.DatetimeIndex(["2024-06-21T12:00"], tz="Europe/Vienna"),
    "series": pd.Series(pd.DatetimeIndex(["2024-06-21T19:00"], tz="Asia/Tokyo")),
    "list": ["2024-06-21T10:00Z"],
}
WITHOUT_ZONE = {
    "iso": "2024-06-21 12:00",
    "datetime": datetime(2024, 6, 21, 12),
    "datetime64": np.datetime64("2024-06-21T12:00"),
    "array": np.array(["2024-06-21T12:00"], "datetime64[ns]"),
    "index": pd.DatetimeIndex(["2024-06-21T12:00"]),
}


@pytest.mark.float64
def test_a_year_of_suns_is_nrels():
    pvlib = peer("pvlib")
    year = pd.date_range("2024-01-01", "2025-01-01", freq="7h13min", tz="Europe/Vienna")
    want = pvlib.solarposition.spa_python(
        year, *np.degrees(VIENNA), pressure=101000.0, temperature=10.0, delta_t=69.0
    )
    got = np.degrees(skyfit.sun_table(year, *VIENNA))
    assert got.index.equals(year)
    # The almanac is within 0.006°; pvlib cuts refraction off 0.83° below the horizon.
    np.testing.assert_allclose(got["sun_zenith"], want["zenith"], atol=0.006)
    near = (want["zenith"] < 90.8).to_numpy()
    np.testing.assert_allclose(
        got["apparent_zenith"][near], want["apparent_zenith"][near], atol=0.01
    )
    away = (got["sun_azimuth"] - want["azimuth"] + 180) % 360 - 180
    np.testing.assert_allclose(away, 0.0, atol=0.01)


@pytest.mark.parametrize("times", SAME.values(), ids=SAME)
def test_a_time_is_the_same_however_it_is_said(times):
    # By NREL's algorithm.
    got = np.degrees(np.ravel(skyfit.sun_at(times, *VIENNA)[0]))
    np.testing.assert_allclose(got, 27.1769, atol=0.02)


@pytest.mark.parametrize("times", WITHOUT_ZONE.values(), ids=WITHOUT_ZONE)
@pytest.mark.parametrize("zone", ["Europe/Vienna", 2, timezone(timedelta(hours=2))])
def test_times_without_a_zone_are_given_one_or_refused(times, zone):
    got = np.ravel(skyfit.sun_at(times, *VIENNA, time_zone=zone)[0])
    np.testing.assert_allclose(got, skyfit.sun_at(SAME["iso"], *VIENNA)[0])
    with pytest.raises(skyfit.InputError, match="expected a time zone"):
        skyfit.sun_at(times, *VIENNA)


@pytest.mark.parametrize(
    ("times", "zone", "words"),
    [
        ("noon", None, "expected one like 2024-06-21"),
        (12.0, None, "expected ISO strings, datetime or pandas times; got 12.0"),
        ([pd.NaT], "UTC", "got NaT"),
        (pd.DatetimeIndex(["2024-06-21", None], tz="UTC"), None, "got NaT"),
        (SAME["iso"], "UTC", "expected none for times that have their own"),
        (SAME["index"], "UTC", "expected none for times that have their own"),
        (WITHOUT_ZONE["iso"], "Middle/Earth", "expected a name such as Europe/Vienna"),
        (WITHOUT_ZONE["iso"], 99, "expected a name such as Europe/Vienna"),
    ],
)
def test_what_is_no_time_is_refused(times, zone, words):
    with pytest.raises(skyfit.InputError, match=words):
        inspect.unwrap(skyfit.sun_at)(times, *VIENNA, time_zone=zone)


def test_the_sun_at_a_time_has_derivatives_by_place():
    def zenith(latitude):
        return skyfit.sun_at(SAME["iso"], latitude, VIENNA[1]).zenith

    step = 1e-2
    ends = zenith(VIENNA[0] + step) - zenith(VIENNA[0] - step)
    np.testing.assert_allclose(jax.grad(zenith)(VIENNA[0]), ends / (2 * step), rtol=2e-3)


def test_refraction_lifts_the_sun_by_half_a_degree_at_the_horizon_and_never_sinks_it():
    # Meeus, example 16.a: 33.2′ of true altitude are lifted by 24.618′.
    zenith = jnp.radians(90 - jnp.asarray([33.2 / 60, 0.0, 90.0, -40.0]))
    lift = 60 * np.degrees(zenith - refracted(zenith))
    np.testing.assert_allclose(lift[:3], [24.618, 28.98, 0.0], atol=0.02)
    assert lift[3] == pytest.approx(37.1, abs=0.1)  # 1.02′ cot 1.575°, as 0.83° below the horizon


@pytest.mark.parametrize(
    ("south", "north"), [(0.0, 180.0), (90.0, 270.0), (-90.0, 90.0), (180.0, 0.0), (-135.0, 45.0)]
)
def test_azimuths_from_the_south_and_of_the_compass(south, north):
    turned = np.degrees(compass_azimuth(np.radians(south)))
    np.testing.assert_allclose(turned % 360, north, atol=1e-4)
    back = np.degrees(azimuth_from_south(np.radians(north)))
    np.testing.assert_allclose(back, south, atol=1e-4)
    assert -180 < back <= 180
