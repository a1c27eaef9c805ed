"""Simulated skies between their directions, and models beside them, as colours.

A source of sky answers `source(sun_zenith, view_zenith, relative_azimuth)` with x, y, Y on the last
axis; the three kinds compared are the simulation, the refit and the published model.
"""

from collections.abc import Callable

import numpy as np
import xarray as xr

from ..models import AbstractSkyModel
from ..render.half_dome import grid_axes, on_dome


Source = Callable[[float | np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def simulated(dataset: xr.Dataset, turbidity: float) -> Source:
    """The simulated skies of one turbidity, between their directions; the sun must be theirs."""
    axes = grid_axes(dataset)
    one = dataset.sel(turbidity=turbidity)

    def source(
        sun_zenith: float | np.ndarray, view_zenith: np.ndarray, relative_azimuth: np.ndarray
    ) -> np.ndarray:
        sky = one.sel(sun_zenith=sun_zenith, method="nearest", tolerance=1e-9)
        x, y = (on_dome(*axes, sky[name].values) for name in ("x", "y"))
        brightness = on_dome(*axes, np.log(sky["luminance"].values))
        direction = (view_zenith, relative_azimuth)
        return np.stack([x(*direction), y(*direction), np.exp(brightness(*direction))], axis=-1)

    return source


def modelled(model: AbstractSkyModel) -> Source:
    """A sky model as a source."""

    def source(
        sun_zenith: float | np.ndarray, view_zenith: np.ndarray, relative_azimuth: np.ndarray
    ) -> np.ndarray:
        sun = np.full_like(view_zenith, sun_zenith)
        return np.asarray(model.xyY(sun, view_zenith, relative_azimuth))

    return source


def fisheye_directions(pixels: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Directions of an equidistant fisheye picture, sun side up.

    Returns:
        View zenith and relative azimuth of each pixel [rad], and which pixels lie in the sky.
    """
    axis = (np.arange(pixels) + 0.5) / pixels * 2 - 1
    right, up = np.meshgrid(axis, axis[::-1])
    radius = np.hypot(right, up)
    return radius * np.pi / 2, np.arctan2(right, up), radius <= 1
