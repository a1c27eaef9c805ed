"""The hard atmospheres are what their table says, and the stored skies belong to them."""

import csv
import dataclasses
from pathlib import Path

import numpy as np
import pytest
import twin
from hard_atmospheres import CASES, PREETHAM, hard_atmosphere, name_of


REFERENCE = Path(__file__).parent / "reference"
# The twin's pieces, cut at the knots of the smoke too, and with more of them up high.
STEPS = dataclasses.replace(
    twin.SINGLE,
    shells=(*twin.SINGLE.shells, 2999.0, *range(3200, 5000, 200), *range(33_000, 80_000, 1000)),
)
ANGLES = ("sun_zenith_deg", "view_zenith_deg", "relative_azimuth_deg")


def monte_carlo_rows():
    with (REFERENCE / "monte_carlo_skies.csv").open(newline="") as file:
        return [
            {key: text if key == "case" else float(text) for key, text in row.items()}
            for row in csv.DictReader(file)
        ]


def hard_rows():
    with np.load(REFERENCE / "hard_atmospheres.npz") as file:
        table = {key: file[key] for key in file}
    names = [name_of(*pair) for pair in zip(table.pop("set"), table.pop("case"), strict=True)]
    columns = [values.tolist() for values in table.values()]
    return [
        {"case": name} | dict(zip(table, values, strict=True))
        for name, *values in zip(names, *columns, strict=True)
    ]


@pytest.mark.parametrize(
    ("name", "depths"),
    [
        ("clear550", [0.0973, 0.03]),
        ("haze4", [0.0973, 4.0, 0.03]),
        ("smoke3", [0.0973, 3.0, 0.03]),
        ("uv320", [0.93, 0.1, 0.28]),
        ("planet mars dust g.9 t.5", [0.0973, 0.5, 0.03]),
        ("planet titan haze.2", [0.0973, 0.2, 0.03]),
        ("volcanic", [0.0973, 0.2, 0.03]),
        ("mie dust t2", [0.0973, 2.0, 0.03]),
    ],
)
def test_optical_depths_are_those_of_the_table(name, depths):
    atm = hard_atmosphere(name)
    # The library sums columns on panels of 333 m, across the knots of a layer of 2 km.
    np.testing.assert_allclose(atm.optical_depth()[:, 0], depths, rtol=1e-3)


def test_every_stored_sky_has_its_atmosphere():
    known = {*CASES, *PREETHAM}
    assert {row["case"] for row in monte_carlo_rows()} <= known
    assert {row["case"] for row in hard_rows()} <= known


@pytest.mark.parametrize(
    "row",
    [*monte_carlo_rows()[::13], *hard_rows()[::29]],
    ids=lambda row: f"{row['case']} {row['sun_zenith_deg']:g} {row['view_zenith_deg']:g}",
)
def test_stored_first_order_is_the_twins(row):
    atm = hard_atmosphere(row["case"])
    angles = np.radians([row[key] for key in ANGLES])
    want = twin.single(atm, *angles, observer_altitude=row["observer_altitude_m"], steps=STEPS)
    np.testing.assert_allclose(row["order1"], want[0], rtol=1e-3, atol=1e-9)


def test_stored_orders_add_up_to_less_than_all_of_them():
    for row in monte_carlo_rows():
        known = row["order1"] + row["order2"] + row["order3"]
        assert known < row["total"] + 2 * row["total_se"]
        assert row["total_se"] < 0.01 * row["total"] or row["sun_zenith_deg"] > 95
