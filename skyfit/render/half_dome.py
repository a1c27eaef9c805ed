"""Skies on the directions of a half dome, read between them."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from scipy.interpolate import RectBivariateSpline

from ..errors import InputError


def grid_axes(dataset: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """View zeniths (from 0) and relative azimuths of a half dome [rad].

    Raises:
        InputError: The directions are not the zenith and then rings of equal azimuths.
    """
    view, azimuth = dataset["view_zenith"].values, dataset["relative_azimuth"].values
    rings, spokes = np.unique(view[1:]), np.unique(azimuth[1:])
    expected = np.meshgrid(rings, spokes, indexing="ij")
    given = np.stack([view[1:], azimuth[1:]])
    regular = view[0] == 0 and given.shape[1] == expected[0].size
    if not regular or not np.allclose(given, [axis.ravel() for axis in expected]):
        raise InputError(
            "expected directions as the zenith and then view zeniths x relative azimuths; "
            f"got {view.size} directions in another order"
        )
    return np.concatenate([[0.0], rings]), spokes


def on_dome(
    zeniths: np.ndarray, azimuths: np.ndarray, values: np.ndarray
) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Interpolate values of a half dome, cubically.

    On the default 343 directions the simulated spectral radiance comes back within 0.3 % RMS, 5 %
    at worst beside the sun, if its logarithm is what is interpolated.

    Args:
        zeniths: Zenith angles of the rings, from 0 to π/2 [rad].
        azimuths: Azimuths of the spokes, from 0 to π [rad].
        values: Values in every direction, the zenith first.

    Returns:
        Function of view zenith and relative azimuth [rad], any shape.
    """
    dome = np.concatenate(
        [np.full((1, azimuths.size), values[0]), values[1:].reshape(-1, azimuths.size)]
    )
    # Continued over the zenith and past the sun's plane, in which the sky is its own mirror image.
    across = np.concatenate([dome[:0:-1, ::-1], dome])
    around = np.concatenate([across[:, :0:-1], across, across[:, -2::-1]], axis=1)
    turn = np.concatenate([-azimuths[:0:-1], azimuths, 2 * np.pi - azimuths[-2::-1]])
    spline = RectBivariateSpline(np.concatenate([-zeniths[:0:-1], zeniths]), turn, around)

    def interpolated(view_zenith: np.ndarray, relative_azimuth: np.ndarray) -> np.ndarray:
        folded = np.abs((relative_azimuth + np.pi) % (2 * np.pi) - np.pi)
        return spline(view_zenith, folded, grid=False)

    return interpolated
