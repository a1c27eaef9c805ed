"""Simulated skies between their directions, and models beside them, as colours.

A source of sky answers `source(sun_zenith, view_zenith, relative_azimuth)` with x, y, Y on the last
axis; the three kinds compared are the simulation, the refit and the published model.
"""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
import xarray as xr

from ..angles import unit_vector
from ..colour import xyz_to_xyY
from ..models import AbstractSkyModel
from ..render.half_dome import grid_axes, on_dome
from ..render.sources import AbstractSource


Source = Callable[[float | np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def colours_of(sky: AbstractSkyModel | AbstractSource | Source) -> Source:
    """Any sky as a source: a model, a source of pictures, or a source as it is."""
    if isinstance(sky, AbstractSkyModel):
        return modelled(sky)
    if not isinstance(sky, AbstractSource):
        return sky

    def source(
        sun_zenith: float | np.ndarray, view_zenith: np.ndarray, relative_azimuth: np.ndarray
    ) -> np.ndarray:
        # Its azimuths are the compass's; with the sun in the north they are those from the sun.
        vector = np.asarray(unit_vector(jnp.asarray(view_zenith), jnp.asarray(relative_azimuth)))
        turned = np.stack([vector[..., 1], vector[..., 0], vector[..., 2]], axis=-1)
        light = sky.xyz(turned.reshape(-1, 3), float(np.max(sun_zenith)), 0.0)
        return np.asarray(xyz_to_xyY(light)).reshape(*turned.shape[:-1], 3)

    return source


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
