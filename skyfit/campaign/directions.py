"""Suns and directions of a campaign, and which they are where none are given."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import ArrayLike, Float


Values = ArrayLike | Sequence[int | float]

PAPER_TURBIDITIES = (2.0, 3.0, 4.0, 5.0, 6.0)
# The paper simulated 12 suns and 343 directions and lists neither: these are this project's choice.
PAPER_SUN_ZENITHS_DEG = tuple(np.linspace(0.0, 85.0, 12).tolist())
PAPER_VIEW_ZENITHS_DEG = tuple(np.arange(5.0, 91.0, 5.0).tolist())
PAPER_RELATIVE_AZIMUTHS_DEG = tuple(np.arange(0.0, 181.0, 10.0).tolist())


def half_dome(
    view_zenith: Values, relative_azimuth: Values, *, zenith: bool = True
) -> tuple[Float[np.ndarray, " direction"], Float[np.ndarray, " direction"]]:
    """Directions on a grid, the zenith first.

    Args:
        view_zenith: Zenith angles of the rings [rad].
        relative_azimuth: Azimuths from the sun in each ring [rad].
        zenith: Put the zenith before the rings.

    Returns:
        View zenith and relative azimuth of every direction [rad].
    """
    rings, spokes = np.meshgrid(
        np.atleast_1d(np.asarray(view_zenith, float)),
        np.atleast_1d(np.asarray(relative_azimuth, float)),
        indexing="ij",
    )
    first = np.zeros(1 if zenith else 0)
    return np.concatenate([first, rings.ravel()]), np.concatenate([first, spokes.ravel()])


def paper_directions() -> tuple[Float[np.ndarray, " direction"], Float[np.ndarray, " direction"]]:
    """The default 343 directions: the zenith, and 5° … 90° by 5° times 0° … 180° by 10°."""
    return half_dome(np.radians(PAPER_VIEW_ZENITHS_DEG), np.radians(PAPER_RELATIVE_AZIMUTHS_DEG))
