"""Fisheye photographs of the sky as measured skies."""

from os import PathLike

import numpy as np
import xarray as xr

from .._typing import as_float
from ..colour import rgb_to_xyz, xyz_to_xyY
from ..dataset.measurements import measured_sky
from ..errors import InputError
from ..sun import SunPosition
from .cameras import Fisheye
from .read_pictures import read_picture


def read_fisheye(
    path: str | PathLike[str],
    sun: SunPosition,
    *,
    projection: str,
    top: float = 0.0,
    centre: tuple[float, float] | None = None,
    radius: float | None = None,
    white: float | None = None,
    rings: int = 15,
) -> xr.Dataset:
    """A photograph of the whole sky, as a measured sky in patches of about the same size.

    Each patch is the mean of its pixels; patches without any light, or where a pixel is no number,
    are NaN. The sun's disc is part of its patch: cameras do not tell it from the sky.

    Args:
        path: A picture in linear sRGB (.exr or .hdr), looking straight up: with north at its top,
            east is on the left.
        sun: Where the sun stood, as `skyfit.sun_at` says.
        projection: Projection of the lens, as of `Fisheye`: "equidistant" or "equal-area".
        top: Compass azimuth at the picture's top [rad].
        centre: Column and row of the zenith, the first pixel's middle being (0.5, 0.5); the
            picture's middle if not given.
        radius: From there to the horizon, in pixels; to the nearer edge if not given.
        white: Luminance for which the file has (1, 1, 1) [cd m⁻²]; what the file says if not given,
            as `skyfit.render.read_picture` reads it.
        rings: Rings of patches from the zenith to the horizon.

    Returns:
        One sky in the form of `skyfit.dataset`, for fits and domes: `luminance`, `x` and `y` over
        `direction`.

    Raises:
        FileNotFoundError: There is no such file.
        InputError: A file that is no such picture, an unknown projection, a circle beyond the
            picture, or less than 2 rings.
    """
    camera = Fisheye(2, projection, top)  # its circle has radius 1 around (1, 1)
    light = read_picture(path)
    rows, columns, _ = light.rgb.shape
    across, down = (columns / 2, rows / 2) if centre is None else centre
    edge = min(across, down, columns - across, rows - down)
    reach = edge if radius is None else radius
    if not 1 <= reach <= edge + 0.5:
        raise InputError(
            f"{path}: expected a circle of 1 to {edge:g} pixels around {across:g}, {down:g}; "
            f"got {reach:g}"
        )
    if rings < 2:
        raise InputError(f"read_fisheye(rings=...): expected 2 or more; got {rings}")
    column, row = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    seen = camera.look((column - across) / reach + 1, (row - down) / reach + 1)
    inside = np.asarray(seen.inside)
    east, north, up = np.moveaxis(seen.direction[inside], -1, 0)
    zenith, azimuth = np.arccos(np.clip(up, -1, 1)), np.arctan2(east, north)
    patch, at = _patches(zenith, azimuth, rings)
    share = seen.solid_angle[inside]
    total = np.bincount(patch, share, len(at))
    sums = [np.bincount(patch, share * c, len(at)) for c in light.rgb[inside].T]
    with np.errstate(invalid="ignore", divide="ignore"):
        rgb = np.stack(sums, axis=-1) / total[:, None] * (light.white if white is None else white)
    known = np.all(np.isfinite(rgb), axis=1)
    xyz = np.asarray(rgb_to_xyz(as_float(np.where(known[:, None], rgb, 0.0))), float)
    known = known & np.all(xyz > 0, axis=1)
    x, y, luminance = np.where(known, np.asarray(xyz_to_xyY(as_float(xyz)), float).T, np.nan)
    return measured_sky(sun, at[:, 0], at[:, 1], luminance=luminance, x=x, y=y)


def _patches(zenith, azimuth, rings):
    """The patch of each pixel, and zenith angle and azimuth of the middle of every patch."""
    step = np.pi / 2 / (rings - 0.5)  # the first one is the cap around the zenith
    ring = np.minimum((zenith / step + 0.5).astype(int), rings - 1)
    middles = step * np.arange(rings)
    middles[-1] = np.pi / 2 - step / 2
    counts = np.maximum(np.round(2 * np.pi * np.sin(middles) / step), 1).astype(int)
    first = np.concatenate([[0], np.cumsum(counts)])
    turn = (azimuth % (2 * np.pi)) / (2 * np.pi)
    patch = first[ring] + np.minimum((turn * counts[ring]).astype(int), counts[ring] - 1)
    centres = [
        (middles[k], (number + 0.5) / count * 2 * np.pi if k else 0.0)
        for k, count in enumerate(counts)
        for number in range(count)
    ]
    return patch, np.array(centres)
