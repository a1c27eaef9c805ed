"""Smooth functions of direction, kept on a few rings and spokes and read in between.

One zone of the sphere lies between the vertical (zenith or nadir) and a horizon, or between two
circles around the vertical. Rings crowd towards a zone's edges, where skies change fastest; spokes
towards the sun, from its azimuth to the opposite, about which a sky is its own mirror image.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import map_coordinates, spline_filter


_BEYOND = 6  # rings continued past the vertical; a cubic spline forgets in as many


class Zone(NamedTuple):
    """A ring-shaped part of the sphere.

    Attributes:
        start: Zenith angle of one edge; 0 or π for the vertical itself [rad].
        end: Zenith angle of the other edge [rad].
    """

    start: float
    end: float

    @property
    def open(self) -> bool:
        """Whether it contains the vertical."""
        return self.start in (0.0, np.pi)

    def rings(self, count: int) -> Float[np.ndarray, " ring"]:
        """Zenith angles [rad]: from start to end, dense towards the end and any other edge."""
        x = np.linspace(0, 1, count)
        share = np.sin(x * np.pi / 2) if self.open else (1 - np.cos(np.pi * x)) / 2
        return self.start + (self.end - self.start) * share

    def place(self, zenith: Float[np.ndarray, " ray"]) -> Float[np.ndarray, " ray"]:
        """Inverse of `rings`: 0 at the start, 1 at the end."""
        share = np.clip((zenith - self.start) / (self.end - self.start), 0, 1)
        return np.arcsin(share) * 2 / np.pi if self.open else np.arccos(1 - 2 * share) / np.pi

    def holds(self, zenith: Float[np.ndarray, " ray"]) -> Bool[np.ndarray, " ray"]:
        """Which zenith angles lie within."""
        low, high = sorted((self.start, self.end))
        return (zenith >= low) & (zenith <= high)


def spokes(count: int) -> Float[np.ndarray, " spoke"]:
    """Azimuths from the sun's to its opposite, dense towards the sun's [rad]."""
    return np.pi * (1 - np.cos(np.linspace(0, np.pi / 2, count)))


def turn(azimuth: Float[np.ndarray, " ray"]) -> Float[np.ndarray, " ray"]:
    """Inverse of `spokes` for azimuths from 0 to π: 0 at the sun's, 1 at its opposite."""
    return np.arccos(1 - azimuth / np.pi) * 2 / np.pi


class DomeTable:
    """A function on a zone, by cubic splines in the coordinates of `Zone.place` and `spokes`.

    At an edge with crowded rings, and in the sun's plane, the function is even in its coordinate,
    which makes the splines' mirrored ends exact.

    Args:
        zone: Zone of the sky.
        values: Values on the zone's rings and spokes.
    """

    def __init__(self, zone: Zone, values: Float[np.ndarray, "ring spoke"]):
        self.zone = zone
        self.rings, self.spokes = values.shape
        self.before = min(_BEYOND, self.rings - 1) if zone.open else 0
        # Across the vertical a ring continues on the opposite side, between the spokes there.
        opposite = turn(np.pi - spokes(self.spokes)) * (self.spokes - 1)
        place = np.meshgrid(np.arange(self.before, 0, -1), opposite, indexing="ij")
        beyond = map_coordinates(values, place, order=3, mode="mirror")
        self.table = spline_filter(np.concatenate([beyond, values]), order=3, mode="mirror")

    def __call__(
        self, zenith: Float[np.ndarray, " ray"], azimuth: Float[np.ndarray, " ray"]
    ) -> Float[np.ndarray, " ray"]:
        """Values at zenith angles within the zone and azimuths from the sun's [rad]."""
        folded = np.abs((azimuth + np.pi) % (2 * np.pi) - np.pi)
        row = self.zone.place(zenith) * (self.rings - 1) + self.before
        column = turn(folded) * (self.spokes - 1)
        return map_coordinates(self.table, [row, column], order=3, mode="mirror", prefilter=False)
