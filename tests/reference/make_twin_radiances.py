"""Remake `twin_radiances.csv`: the slow twin's converged values for generic skies.

Run from the top of the repository: `python tests/reference/make_twin_radiances.py`. It takes half
an hour on one core. The last column, with fewer nodes, shows what the one before it is worth.
"""

import csv
import dataclasses
import sys
from pathlib import Path

import jax
import numpy as np


HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))
WAVELENGTHS = [450.0, 650.0]  # nm
# sun zenith, view zenith, relative azimuth [deg], observer altitude [m], ground albedo
CASES = [
    (80, 30, 20, 0, 0.0),
    (80, 75, 150, 0, 0.0),
    (88, 45, 60, 0, 0.0),
    (88, 85, 10, 0, 0.0),
    (92, 0, 0, 0, 0.0),
    (92, 60, 30, 0, 0.0),
    (92, 80, 170, 0, 0.0),
    (96, 70, 15, 0, 0.0),
    (96, 20, 90, 0, 0.0),
    (50, 45, 50, 0, 0.3),
    (50, 110, 35, 2e3, 0.3),
    (70, 91, 120, 2e3, 0.3),
    (50, 130, 40, 10e3, 0.3),
    (85, 95, 20, 10e3, 0.3),
    (60, 178, 30, 400e3, 0.3),
    (60, 150, 100, 400e3, 0.3),
    (40, 109, 60, 400e3, 0.3),
    (95, 109.3, 10, 400e3, 0.3),
]
COLUMNS = [
    *("sun_zenith_deg", "view_zenith_deg", "relative_azimuth_deg", "observer_altitude_m"),
    *("ground_albedo", "wavelength_nm", "first", "second", "second_with_fewer_nodes"),
]


def main() -> None:
    """Evaluate every case and write the table as it grows."""
    jax.config.update("jax_enable_x64", True)
    import twin

    from skyfit.preetham_air import preetham_atmosphere

    with (HERE / "twin_radiances.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for case in CASES:
            *degrees, altitude, albedo = case
            atm = preetham_atmosphere(3.0, wavelengths=WAVELENGTHS, ground_albedo=albedo)
            view = (*np.radians(degrees), altitude)
            # Twilight needs the most; all suns seen from above the ground here but one are up.
            nodes = 4 if altitude == 0 else 3
            fine, coarse = (
                twin.double(atm, *view, steps=dataclasses.replace(twin.DOUBLE_FINE, nodes=n))
                for n in (nodes, nodes - 1)
            )
            for row in zip(WAVELENGTHS, twin.single(atm, *view), fine, coarse, strict=True):
                table.writerow([*case, row[0], *(f"{value:.6e}" for value in row[1:])])
            file.flush()


if __name__ == "__main__":
    main()
