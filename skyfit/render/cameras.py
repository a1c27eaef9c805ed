"""Which direction each pixel looks into.

The frame is east, north, up. Azimuths are the compass's: 0 north, π/2 east. Places in a picture
are in pixels, column to the right and row downwards; the middle of the first pixel is (0.5, 0.5).
"""

import abc
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from ..angles import as_azimuth, as_view_zenith
from ..errors import InputError


PROJECTIONS = ("equidistant", "equal-area")
MAX_PIXELS = 16384  # along one side


class Rays(NamedTuple):
    """Lines of sight of a picture.

    Attributes:
        direction: Unit vectors east, north, up; anything where `inside` is false.
        inside: Mask of the pixels that show something.
        solid_angle: Solid angle of each pixel [sr].
    """

    direction: Float[np.ndarray, "*shape 3"]
    inside: Bool[np.ndarray, "*shape"]
    solid_angle: Float[np.ndarray, "*shape"]


class AbstractCamera(abc.ABC):
    """A picture's size and projection; immutable."""

    @property
    @abc.abstractmethod
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""

    @abc.abstractmethod
    def look(self, column: Float[np.ndarray, "*shape"], row: Float[np.ndarray, "*shape"]) -> Rays:
        """Lines of sight through places in the picture [pixel]."""

    @abc.abstractmethod
    def place(
        self, direction: Float[np.ndarray, "*shape 3"]
    ) -> tuple[Float[np.ndarray, "*shape"], Float[np.ndarray, "*shape"]]:
        """Column and row [pixel] where unit vectors are seen; NaN where they are not."""

    def rays(self) -> Rays:
        """Lines of sight through the middle of every pixel, in float32; read-only."""
        return _rays(self)


@lru_cache(maxsize=4)
def _rays(camera: AbstractCamera) -> Rays:
    rows, columns = camera.shape
    column, row = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    found = camera.look(column, row)
    arrays = (found.direction.astype(np.float32), found.inside, found.solid_angle)
    for array in arrays:
        array.flags.writeable = False
    return Rays(*arrays)


@dataclass(frozen=True)
class Fisheye(AbstractCamera):
    """The whole dome in a circle, seen looking straight up: north at the top, east on the left.

    Args:
        pixels: Side of the square picture.
        projection: "equidistant": the distance from the middle is proportional to the zenith
            angle. "equal-area": to the sine of half of it, as in *Simulating the Colors of the
            Sky*, whose cos θ = 1 - r² that is; every pixel has the same solid angle.
        top: Azimuth at the picture's top [rad].
    """

    pixels: int = 512
    projection: str = "equidistant"
    top: float = 0.0

    def __post_init__(self):
        """Refuse impossible sizes."""
        _check_pixels("Fisheye(pixels=...)", self.pixels)
        if self.projection not in PROJECTIONS:
            raise InputError(
                "Fisheye(projection=...): expected 'equidistant' or 'equal-area'; "
                f"got {self.projection!r}"
            )
        as_azimuth(self.top, "Fisheye(top=...)")

    @property
    def shape(self):  # noqa: D102
        return self.pixels, self.pixels

    def look(self, column, row):  # noqa: D102
        right, up = 2 * column / self.pixels - 1, 1 - 2 * row / self.pixels
        radius = np.hypot(right, up)
        area = (2 / self.pixels) ** 2
        if self.projection == "equidistant":
            zenith = radius * np.pi / 2
            # sin θ dθ dφ over r dr dφ
            solid_angle = area * (np.pi / 2) ** 2 * np.sinc(zenith / np.pi)
        else:
            zenith = np.arccos(1 - np.minimum(radius, 1) ** 2)
            solid_angle = np.full_like(radius, 2 * area)
        azimuth = self.top - np.arctan2(right, up)
        return Rays(direction_of(zenith, azimuth), radius <= 1, solid_angle)

    def place(self, direction):  # noqa: D102
        east, north, up = np.moveaxis(direction, -1, 0)
        zenith = np.arctan2(np.hypot(east, north), up)
        equidistant = self.projection == "equidistant"
        radius = zenith / (np.pi / 2) if equidistant else np.sqrt(2) * np.sin(zenith / 2)
        turn = self.top - np.arctan2(east, north)
        seen = np.where(up >= 0, self.pixels / 2, np.nan)
        return seen * (1 + radius * np.sin(turn)), seen * (1 - radius * np.cos(turn))


@dataclass(frozen=True)
class Panorama(AbstractCamera):
    """All directions in an equirectangular picture, twice as wide as high, seen from within.

    The zenith is the first row's upper edge, the nadir the last row's lower edge; to the right the
    azimuth grows: north, east, south, west.

    Args:
        height: Rows.
        centre: Azimuth in the picture's middle [rad].
    """

    height: int = 512
    centre: float = 0.0

    def __post_init__(self):
        """Refuse impossible sizes."""
        _check_pixels("Panorama(height=...)", self.height)
        as_azimuth(self.centre, "Panorama(centre=...)")

    @property
    def shape(self):  # noqa: D102
        return self.height, 2 * self.height

    def look(self, column, row):  # noqa: D102
        step = np.pi / self.height
        zenith, azimuth = row * step, self.centre - np.pi + column * step
        # Exact for a pixel about this place: the difference of two cosines.
        solid_angle = step * 2 * np.sin(step / 2) * np.sin(zenith)
        return Rays(direction_of(zenith, azimuth), np.ones(zenith.shape, bool), solid_angle)

    def place(self, direction):  # noqa: D102
        east, north, up = np.moveaxis(direction, -1, 0)
        step = np.pi / self.height
        turn = (np.arctan2(east, north) - self.centre + np.pi) % (2 * np.pi)
        return turn / step, np.arctan2(np.hypot(east, north), up) / step


@dataclass(frozen=True)
class Perspective(AbstractCamera):
    """A pinhole camera.

    Args:
        width: Columns.
        height: Rows.
        azimuth: Compass azimuth of the direction it looks into [rad].
        elevation: Elevation of that direction above the horizontal [rad].
        field_of_view: Angle from the left edge to the right one, below π [rad].
        altitude: Altitude of the eye above the ground; only simulated skies change with it [m].
    """

    width: int = 800
    height: int = 600
    azimuth: float = 0.0
    elevation: float = 0.0
    field_of_view: float = np.radians(65.0)
    altitude: float = 0.0

    def __post_init__(self):
        """Refuse impossible sizes."""
        _check_pixels("Perspective(width=...)", self.width)
        _check_pixels("Perspective(height=...)", self.height)
        as_azimuth(self.azimuth, "Perspective(azimuth=...)")
        as_view_zenith(self.elevation, "Perspective(elevation=...)")
        if not 1e-4 <= self.field_of_view < np.pi:
            raise InputError(
                "Perspective(field_of_view=...): expected 0.0001 to pi rad; "
                f"got {self.field_of_view:.6g}"
            )
        if not 0 <= self.altitude < np.inf:
            raise InputError(
                f"Perspective(altitude=...): expected 0 m or more; got {self.altitude:.6g}"
            )

    @property
    def shape(self):  # noqa: D102
        return self.height, self.width

    def look(self, column, row):  # noqa: D102
        scale = self._focal_length()
        x, y = (column - self.width / 2) / scale, (self.height / 2 - row) / scale
        length = np.sqrt(1 + x**2 + y**2)
        forward, right, up = self._axes()
        vector = forward + x[..., None] * right + y[..., None] * up
        direction = vector / length[..., None]
        return Rays(direction, np.ones(x.shape, bool), 1 / (length**3 * scale**2))

    def place(self, direction):  # noqa: D102
        forward, right, up = self._axes()
        ahead = direction @ forward
        scale = self._focal_length() / np.where(ahead > 1e-9, ahead, np.nan)
        return (
            self.width / 2 + scale * (direction @ right),
            self.height / 2 - scale * (direction @ up),
        )

    def _focal_length(self) -> float:
        return self.width / 2 / np.tan(self.field_of_view / 2)

    def _axes(self):
        forward = direction_of(np.pi / 2 - self.elevation, self.azimuth)
        right = direction_of(np.pi / 2, self.azimuth + np.pi / 2)
        return forward, right, np.cross(right, forward)


def direction_of(
    zenith: float | np.ndarray, azimuth: float | np.ndarray
) -> Float[np.ndarray, "*shape 3"]:
    """Unit vectors east, north, up of zenith angles and compass azimuths [rad]; they broadcast."""
    zenith, azimuth = np.broadcast_arrays(zenith, azimuth)
    sine = np.sin(zenith)
    return np.stack([sine * np.sin(azimuth), sine * np.cos(azimuth), np.cos(zenith)], axis=-1)


def _check_pixels(name: str, pixels: int) -> None:
    if isinstance(pixels, bool) or not isinstance(pixels, int) or not 1 <= pixels <= MAX_PIXELS:
        raise InputError(f"{name}: expected 1 to {MAX_PIXELS}; got {pixels!r}")
