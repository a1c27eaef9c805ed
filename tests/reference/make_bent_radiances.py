"""Make `bent_radiances.csv`: `python tests/reference/make_bent_radiances.py`, some minutes."""

import sys
from pathlib import Path

import numpy as np


HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

import bent_twin  # noqa: E402
import test_refraction as cases  # noqa: E402


def main():
    """Write the first order of the tests' atmosphere."""
    bending = cases.twin_of(cases.hazy(), 2.8e-4)
    lines = ["sun_zenith_deg,view_zenith_deg,relative_azimuth_deg,L450,L550,L650"]
    for sun in (60, 85, 89, 92, 96):
        for view in (0, 60, 85, 89):
            azimuths = [0] if view == 0 else [0, 180]
            light = bent_twin.first(
                bending, np.radians(sun), np.radians(view), np.radians(azimuths)
            )
            for azimuth, one in zip(azimuths, light, strict=True):
                lines.append(f"{sun},{view},{azimuth}," + ",".join(f"{x:.9e}" for x in one))
    (HERE / "bent_radiances.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
