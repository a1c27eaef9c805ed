"""Skies on record as sources: simulated datasets and measurements, between their directions."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Float
from scipy.interpolate import RBFInterpolator

from ..colour import D65_WHITE, xyY_to_xyz
from ..errors import InputError
from .cameras import direction_of
from .half_dome import grid_axes, on_dome
from .sources import AbstractSource, sun_through_haze


_SAME_SUN = np.radians(0.01)
_SMOOTHING = 1e-3
_NEEDED = ("luminance", "x", "y", "view_zenith", "relative_azimuth", "sun_zenith")


class RecordedSource(AbstractSource):
    """One sky of a dataset. Colours between its directions are interpolated, as logarithms.

    On a half dome (the zenith, then rings of equal azimuths) by bicubic splines; else by thin-plate
    splines over the unit vectors, a little smoothed: measurements at one place may differ. Where no
    azimuth is beyond the half turn from 0 to π, both sides of the sun are taken as alike. What is
    lower than the lowest direction has the light above it.

    Args:
        sky: One sky: `luminance`, `x`, `y` over `direction`, with `view_zenith`,
            `relative_azimuth`, and a scalar `sun_zenith`; directions with `reliable` false, or
            where a value is NaN, are left out. Without `x` and `y` it is white, as D65 is.
        name: Name of the sky.
        turbidity: Turbidity of the air before the sun; None if unknown.
    """

    def __init__(self, sky: xr.Dataset, name: str, turbidity: float | None = None):
        if "luminance" in sky and not {"x", "y"} & set(sky.variables):
            x, y = D65_WHITE
            sky = sky.assign(x=0 * sky["luminance"] + x, y=0 * sky["luminance"] + y)
        for needed in _NEEDED:
            if needed not in sky.variables:
                raise InputError(f"{name}: {needed} is missing")
        if sky["luminance"].dims != ("direction",):
            raise InputError(f"{name}: expected one sky; got dimensions {sky['luminance'].dims}")
        if "reliable" in sky:
            sky = sky.isel(direction=np.flatnonzero(sky["reliable"].values))
        parts = [sky[needed].values for needed in _NEEDED[:-1]]
        known = ~np.isnan(parts).any(axis=0)
        if not known.any():
            raise InputError(f"{name}: expected a value in some direction; all are NaN")
        sky = sky.isel(direction=np.flatnonzero(known))
        self.sky, self.name, self.turbidity = sky, name, turbidity
        self.sun_zenith = float(sky["sun_zenith"])

    def sun_xyz(self, sun_zenith):  # noqa: D102
        return sun_through_haze(self.name, self.turbidity, sun_zenith)

    def identity(self) -> Any:  # noqa: D102
        return [self.sky[name].values for name in _NEEDED], self.turbidity

    def xyz(self, direction, sun_zenith, sun_azimuth):  # noqa: D102
        if abs(sun_zenith - self.sun_zenith) > _SAME_SUN:
            raise InputError(
                f"{self.name}: its sun is at {np.degrees(self.sun_zenith):.2f} degrees from the "
                f"zenith; got {np.degrees(sun_zenith):.2f}"
            )
        unit = direction.astype(float)
        zenith = np.arctan2(np.hypot(unit[:, 0], unit[:, 1]), unit[:, 2])
        zenith = np.minimum(zenith, float(self.sky["view_zenith"].max()))
        azimuth = np.arctan2(unit[:, 0], unit[:, 1]) - sun_azimuth
        return np.exp(self._logarithms(zenith, azimuth))

    @cached_property
    def _logarithms(self):
        """Function of view zenith and relative azimuth: logarithms of X, Y, Z on the last axis."""
        sky = self.sky
        xyY = np.stack([sky[name].values.astype(float) for name in ("x", "y", "luminance")], -1)
        values = np.log(np.maximum(np.asarray(xyY_to_xyz(xyY)), 1e-6))
        view, azimuth = sky["view_zenith"].values, sky["relative_azimuth"].values
        try:
            axes = grid_axes(sky)
        except ValueError:
            return _scattered(view, azimuth, values, self.name)
        if min(axis.size for axis in axes) < 2:
            return _scattered(view, azimuth, values, self.name)
        splines = [on_dome(*axes, column) for column in values.T]
        return lambda zenith, azimuth: np.stack([one(zenith, azimuth) for one in splines], -1)


def _scattered(
    view: np.ndarray, azimuth: np.ndarray, values: Float[np.ndarray, "direction 3"], name: str
):
    if azimuth.min() >= 0 and azimuth.max() <= np.pi:
        view, azimuth = np.tile(view, 2), np.concatenate([azimuth, -azimuth])
        values = np.tile(values, (2, 1))
    unit = direction_of(view, azimuth)
    # A plane through the points would leave the surface over them open.
    if np.linalg.matrix_rank(np.insert(unit, 0, 1.0, axis=1), tol=1e-6) < 4:
        raise InputError(
            f"{name}: expected directions all over the dome, four or more that are not on one "
            f"circle; got {view.size}"
        )
    plate = RBFInterpolator(unit, values, kernel="thin_plate_spline", smoothing=_SMOOTHING)
    return _fine_grid(plate, float(view.max()))


def _fine_grid(plate: RBFInterpolator, lowest: float):
    """A table of a smooth function, since a picture asks a million times."""
    from scipy.interpolate import RegularGridInterpolator

    rings, turn = np.linspace(0, lowest, 91), np.linspace(-np.pi, np.pi, 181)
    unit = direction_of(rings[:, None], turn[None, :])
    table = plate(unit.reshape(-1, 3)).reshape(rings.size, turn.size, -1)
    read = RegularGridInterpolator((rings, turn), table)

    def lookup(zenith: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
        return read(np.stack([zenith, (azimuth + np.pi) % (2 * np.pi) - np.pi], axis=-1))

    return lookup


def select_sky(
    data: xr.Dataset,
    name: str,
    turbidity: float | None,
    sun_zenith: float | None,
    parameters: Mapping[str, float] | None = None,
) -> xr.Dataset:
    """One sky of a dataset, by the values of its dimensions.

    Args:
        data: Skies over (turbidity, sun_zenith) or other swept parameters, or over time.
        name: Name of the dataset, for messages.
        turbidity: The turbidity, or the value of the only swept parameter; None if there is only
            one value.
        sun_zenith: Zenith angle of the sun, within 0.01°; None if there is only one [rad].
        parameters: Values of swept parameters by name; the number of a `sample`.

    Raises:
        InputError: No such sky; the message lists what there is.
    """
    if "luminance" not in data:
        raise InputError(f"{name}: luminance is missing")
    suns = ("sun_zenith", "time")
    swept = [str(dim) for dim in data["luminance"].dims if dim not in ("direction", *suns)]
    given = dict(parameters or {})
    refuse_others(given, name, swept)
    if turbidity is not None and swept:
        given.setdefault("turbidity" if "turbidity" in swept else swept[0], turbidity)
    for dim in [dim for dim in data["luminance"].dims if dim not in ("direction",)]:
        sun = dim in suns
        wanted = sun_zenith if sun else given.get(str(dim))
        values = np.atleast_1d(data["sun_zenith" if sun else str(dim)].values)
        scale = 180 / np.pi if sun else 1.0
        there = ", ".join(f"{scale * value:.6g}" for value in values)
        what = "a sun at" if sun else f"a {dim} of"
        if wanted is None and values.size > 1:
            raise InputError(f"{name}: expected {what} one of {there}; got none")
        near = 0 if wanted is None else int(np.abs(values - wanted).argmin())
        slack = _SAME_SUN if sun else 1e-6
        if wanted is not None and abs(values[near] - wanted) > slack:
            raise InputError(f"{name}: expected {what} one of {there}; got {scale * wanted:.6g}")
        data = data.isel({dim: near})
    return data


def refuse_others(given: Mapping[str, float], what: str, names: Sequence[str]) -> None:
    """Refuse values of parameters that are not a sky's.

    Raises:
        InputError: There is one.
    """
    if unknown := [name for name in given if name not in names]:
        ours = f"values of {', '.join(names)} alone" if names else "no parameters"
        raise InputError(
            f"{what}: expected {ours} (--set, parameters=...); got {', '.join(unknown)}"
        )
