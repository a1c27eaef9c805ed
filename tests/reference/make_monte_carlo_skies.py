"""Remake `monte_carlo_skies.csv`: radiances of hard atmospheres by backward Monte Carlo.

Run from the top of the repository: `python tests/reference/make_monte_carlo_skies.py`. It takes
most of an hour on one core; how many paths there are depends on its speed, so that numbers come
back within their errors. `tests/monte_carlo.py` does the work, `tests/hard_atmospheres.py` says
what the names mean.
"""

import csv
import dataclasses
import sys
from pathlib import Path

import jax
import numpy as np


HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))
TARGET = 0.003  # standard error over total at which a direction is done
SECONDS = 45.0  # of the processor, after which it is done too
# Where that leaves errors above 0.5 %.
PATIENT = {("smoke3", 88): 150.0, ("volcanic", 94): 150.0}

# View zenith angle and relative azimuth [deg].
WIDE = ((0, 0), (45, 0), (75, 180), (85, 90))
TWILIGHT = ((0, 0), (45, 0), (75, 180), (89, 0))
NEAR_SUN = ((0, 0), (45, 0), (55, 0), (62, 0), (75, 180), (85, 90))
PREETHAM = ((0, 0), (45, 0), (60, 90), (75, 180), (85, 90))
# Case, sun zenith angle [deg], observer altitude [m], views.
SKIES = (
    ("volcanic", 60, 0, TWILIGHT),
    ("volcanic", 94, 0, TWILIGHT),
    ("smoke.5", 88, 0, WIDE),
    ("smoke3", 88, 0, WIDE),
    ("dust g.95 t1", 60, 0, NEAR_SUN),
    ("dust g.9 t.5", 60, 0, NEAR_SUN),
    ("two terms t.5", 60, 0, NEAR_SUN),
    ("mie dust t.5", 60, 0, NEAR_SUN),
    ("mie dust t2", 60, 0, NEAR_SUN),
    ("preetham 40", 30, 0, PREETHAM),
    ("preetham 40", 60, 0, PREETHAM),
    ("haze4", 60, 0, WIDE),
    ("haze4", 60, 12e3, ((135, 60),)),
    ("volcanic", 98, 0, TWILIGHT),
    ("clear550", 96, 0, TWILIGHT),
    ("clear550", 98, 0, TWILIGHT),
)
COLUMNS = [
    *("case", "sun_zenith_deg", "observer_altitude_m", "view_zenith_deg", "relative_azimuth_deg"),
    *("order1", "order2", "order2_se", "order3", "order3_se", "total", "total_se"),
]


def main(path: Path) -> None:
    """Follow paths for every direction and write the table as it grows."""
    jax.config.update("jax_enable_x64", True)
    import monte_carlo
    from hard_atmospheres import hard_atmosphere

    with path.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for name, sun, altitude, views in SKIES:
            shells = monte_carlo.Shells(hard_atmosphere(name))
            for zenith, azimuth in views:
                sky = monte_carlo.sky(
                    shells,
                    *np.radians([sun, zenith, azimuth]),
                    observer_altitude=altitude,
                    target=TARGET,
                    seconds=PATIENT.get((name, sun), SECONDS),
                )
                values = (f"{value:.6e}" for value in dataclasses.astuple(sky))
                table.writerow([name, sun, f"{altitude:g}", zenith, azimuth, *values])
                file.flush()


if __name__ == "__main__":
    main(HERE / "monte_carlo_skies.csv")
