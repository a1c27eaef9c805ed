"""The sun of `skyfit render` by place and time, and angles that look like radians."""

import json
import re

import numpy as np
import pytest

from skyfit import cli


STILL = ["render", "--turbidity", "3", "--height", "8", "--out", "a.png", "--json"]
VIENNA = ["--latitude-deg", "48.2", "--longitude-deg", "16.37"]
EQUINOX = ["--latitude-deg", "45", "--day-of-year", "81"]


@pytest.mark.parametrize(
    ("words", "zenith", "azimuth"),
    [
        # NREL's algorithm in pvlib.
        ([*VIENNA, "--time", "2024-06-21T12:00+02:00"], 27.1769, 150.6861),
        # The paper's declination is 0 on day 81: by day the sun is 15° an hour along the equator.
        ([*EQUINOX, "--time", "12:00"], 45.0, 180.0),
        ([*EQUINOX, "--time", "09:00"], 60.0, 180 - np.degrees(np.arctan(np.sqrt(2)))),
        ([], 45.0, 180.0),
        (["--sun-zenith-deg", "60", "--sun-azimuth-deg", "90"], 60.0, 90.0),
    ],
)
def test_a_still_is_of_its_place_and_time(words, zenith, azimuth, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.run([*STILL, *words]) == 0
    found = json.loads(capsys.readouterr().out)["sky"]
    got = [float(x) for x in re.findall(r"sun zenith (\S+) deg, azimuth (\S+) deg", found)[0]]
    np.testing.assert_allclose(got, [zenith, azimuth], atol=0.06)  # four digits are printed


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (EQUINOX, "a picture by place needs"),
        (VIENNA, "a picture by place needs"),
        (["--day-of-year", "81"], "a picture by place needs"),
        ([*VIENNA, *EQUINOX[2:], "--time", "12:00"], "a picture by place needs"),
        ([*VIENNA, "--time", "2024-06-21T12:00"], "--time: expected a time zone"),
        ([*VIENNA, "--time", "noon"], "--time: expected one like 2024-06-21T12:00+02:00"),
        ([*EQUINOX, "--time", "noon"], "--time: expected one like 12:00; got 'noon'"),
        ([*EQUINOX, "--time", "12:00", "--sun-zenith-deg", "60"], "--sun-zenith-deg: not beside"),
        (["--to-sun-zenith-deg", "90"], "--to-sun-zenith-deg: only for a day"),
        ([*EQUINOX, "--time", "12:00", "--out", "a.gif"], "--time: only for one picture"),
    ],
)
def test_options_that_would_do_nothing_are_refused(words, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.run([*STILL, *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("degrees", "lines"), [("0.8", 1), ("45", 0), ("0", 0)])
def test_a_zenith_angle_that_looks_like_radians_is_hinted_at(
    degrees, lines, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    assert cli.run([*STILL, "--sun-zenith-deg", degrees]) == 0
    error = capsys.readouterr().err
    assert error.count("\n") == lines
    assert ("--sun-zenith-deg 0.8 is in degrees; 0.8 rad is 45.84" in error) == bool(lines)
