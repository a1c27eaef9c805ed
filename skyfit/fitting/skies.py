"""What a fit reads from a sky dataset: values of each channel, sky by sky."""

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal, get_args

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from .._typing import as_float
from ..angles import view_sun_angle
from ..colour import D65_WHITE, spectrum_to_xyY
from ..errors import InputError
from ..models.axes import SUN
from ..models.formula import CHANNELS


if TYPE_CHECKING:
    import xarray as xr


Weights = Literal["equal", "solid angle"]
Residuals = Literal["relative", "absolute"]
WEIGHTS, RESIDUALS = get_args(Weights), get_args(Residuals)

VARIABLES = {"x": "x", "y": "y", "Y": "luminance"}
# Dimensions that tell skies apart without being swept: their sun is in `sun_zenith`.
SUN_DIMENSIONS = ("sun_zenith", "time")
SAMPLE = "sample"  # a dimension along which all swept parameters vary together
LOWEST_SUN = np.radians(108.0)  # where astronomical twilight ends
ZENITH = 1e-6  # rad: views closer to the zenith than this are the zenith
# View zenith of a direction without a value: neither fits nor errors look below the horizon.
MISSING = np.pi  # rad
WHITE = dict(zip(("x", "y"), D65_WHITE, strict=True))


@dataclass(frozen=True)
class Skies:
    """Skies in a row, as NumPy arrays.

    Attributes:
        swept: Value of every swept parameter for each sky, by name; empty if nothing was swept.
        sun_zenith: Zenith angle of the sun [rad].
        view_zenith: Zenith angle of every view; `MISSING` where it has no value [rad].
        relative_azimuth: Azimuth of every view from the sun's [rad].
        values: Values of x, y, Y (in cd m⁻²), or of the channels named, all finite.
        zenith: Values at the zenith; None if no direction is the zenith.
        shape: Shape of the dataset's sky dimensions, before they were put in a row.
        channels: Names of the channels.
        kind: Kind of the channels: "Yxy", "XYZ", "RGB" or "bands".
        wavelengths: Wavelengths of spectral bands [nm].
    """

    swept: dict[str, Float[np.ndarray, " sky"]]
    sun_zenith: Float[np.ndarray, " sky"]
    view_zenith: Float[np.ndarray, "sky direction"]
    relative_azimuth: Float[np.ndarray, "sky direction"]
    values: Float[np.ndarray, "channel sky direction"]
    zenith: Float[np.ndarray, "channel sky"] | None
    shape: tuple[int, ...]
    channels: tuple[str, ...] = CHANNELS
    kind: str = "Yxy"
    wavelengths: Float[np.ndarray, " channel"] | None = None

    @cached_property
    def gamma(self) -> Float[np.ndarray, "sky direction"]:
        """Angle between view and sun [rad]."""
        sun = as_float(self.sun_zenith)[:, None]
        angles = (as_float(self.view_zenith), sun, as_float(self.relative_azimuth))
        return np.asarray(_view_sun_angle(*angles), float)

    @property
    def count(self) -> int:
        """Number of skies."""
        return self.sun_zenith.size

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest value of every swept parameter."""
        return {name: (float(v.min()), float(v.max())) for name, v in self.swept.items()}

    @property
    def quantities(self) -> dict[str, Float[np.ndarray, " sky"]]:
        """What a basis may depend on: the swept parameters and the sun, by name."""
        return {**self.swept, SUN: self.sun_zenith}

    @property
    def sun_zenith_range(self) -> tuple[float, float]:
        """Highest and lowest sun [rad]."""
        return float(self.sun_zenith.min()), float(self.sun_zenith.max())

    def subset(self, chosen: Bool[np.ndarray, " sky"]) -> "Skies":
        """Some of the skies, in a row."""
        return dataclasses.replace(
            self,
            swept={name: values[chosen] for name, values in self.swept.items()},
            sun_zenith=self.sun_zenith[chosen],
            view_zenith=self.view_zenith[chosen],
            relative_azimuth=self.relative_azimuth[chosen],
            values=self.values[:, chosen],
            zenith=None if self.zenith is None else self.zenith[:, chosen],
            shape=(int(chosen.sum()),),
        )

    def weights(self, kind: str, max_view_zenith: float) -> Float[np.ndarray, "sky direction"]:
        """Weight of each residual, 0 beyond a view zenith angle [rad].

        "solid angle" gives each direction its share of the band of zenith angles halfway to the
        next ones, so that a grid's crowded zenith counts no more than the rest of the dome.
        """
        # A grid that ends at the limit must not lose its last ring to a rounding error.
        inside = self.view_zenith <= max_view_zenith + 1e-6
        if kind == "equal":
            return inside.astype(float)
        rows = [np.sqrt(_solid_angles(row)) for row in self.view_zenith]
        weight = inside * np.stack(rows)
        return weight / np.sqrt(np.mean(weight[inside] ** 2))

    def groups(self, by: Literal["all", "swept", "sky"]) -> Int[np.ndarray, "lane sky"]:
        """Which skies share coefficients; -1 pads a group that is shorter than others."""
        if by == "all":
            return np.arange(self.count)[None]
        if by == "sky":
            return np.arange(self.count)[:, None]
        table = np.stack([np.zeros(self.count), *self.swept.values()], axis=1)
        _, which = np.unique(table, axis=0, return_inverse=True)
        members = [np.flatnonzero(which == k) for k in range(which.max() + 1)]
        longest = max(map(len, members))
        return np.stack([np.pad(m, (0, longest - m.size), constant_values=-1) for m in members])


_view_sun_angle = jax.jit(view_sun_angle)


def read_skies(data: "xr.Dataset", caller: str = "fit_sky", *, night: bool = False) -> Skies:
    """Put a dataset's skies in a row and check them.

    Directions where a value or an angle is NaN are left out, sky by sky; in simulated skies, which
    have none, it is refused.

    Args:
        data: Skies in the form of `skyfit.dataset`: `luminance`, `x`, `y` (or `radiance`, from
            which they follow; or `luminance` alone, which is given the colour of D65) over
            `direction` and the sky's dimensions; `view_zenith`, `relative_azimuth`, `sun_zenith`,
            in radians.
        caller: Name of the function whose argument `data` is, for messages.
        night: Whether suns are taken to 18° below the horizon; else to the horizon.

    Raises:
        ValueError: A variable is missing, the sun is below the horizon, a sky has no value at all,
            or a value cannot be fitted: infinite, or not above 0.
    """
    for name in ("view_zenith", "relative_azimuth", "sun_zenith"):
        if name not in data.variables:
            raise InputError(f"{caller}(data=...): expected a variable {name!r}; there is none")
    channels = _channels(data, caller)
    dims = tuple(str(d) for d in channels["Y"].dims if d != "direction")
    swept = [d for d in dims if d not in (*SUN_DIMENSIONS, SAMPLE)]
    if SAMPLE in dims:
        over = [str(name) for name, array in data.coords.items() if array.dims == (SAMPLE,)]
        swept += [name for name in over if name not in (SAMPLE, "sun_zenith")]
    empty = [str(d) for d, size in channels["Y"].sizes.items() if size == 0]
    if empty:
        raise InputError(f"{caller}(data=...): expected skies; {', '.join(empty)} is empty")
    for name in swept:
        if name == "self":  # `fit.sky(self=...)` is no call
            raise InputError(f"{caller}(data=...): a parameter may not be called {name!r}")
        if name not in data.coords:
            raise InputError(f"{caller}(data=...): dimension {name!r} has no coordinate values")
    shape = tuple(channels["Y"].sizes[d] for d in dims)
    template = channels["Y"].transpose(*dims, "direction")

    def row(variable: "xr.DataArray", *, directions: bool) -> np.ndarray:
        like = template if directions else template.isel(direction=0)
        alien = [str(d) for d in variable.dims if d not in like.dims]
        if alien:
            raise InputError(
                f"{caller}(data=...): {variable.name} has dimensions {alien} that luminance lacks"
            )
        array = variable.broadcast_like(like).transpose(*like.dims)
        return np.asarray(array.values, float).reshape(-1, *like.shape[len(dims) :])

    view = row(data["view_zenith"], directions=True)
    azimuth = row(data["relative_azimuth"], directions=True)
    sun = row(data["sun_zenith"], directions=False)
    values = np.stack([row(channels[name], directions=True) for name in CHANNELS])
    if "campaign" not in data.attrs:  # of a simulation, which leaves nothing out
        view, azimuth, values = without_gaps(view, azimuth, values, caller)
    _refuse_unfit(caller, sun, view, azimuth, values, night=night)
    return Skies(
        swept={name: row(data[name], directions=False) for name in swept},
        sun_zenith=sun,
        view_zenith=view,
        relative_azimuth=azimuth,
        values=values,
        zenith=zenith_values(view, values),
        shape=shape,
    )


def _channels(data: "xr.Dataset", caller: str) -> dict[str, "xr.DataArray"]:
    """x, y and Y of a dataset."""
    missing = [name for name in VARIABLES.values() if name not in data.variables]
    if not missing:
        return {channel: data[name] for channel, name in VARIABLES.items()}
    if "radiance" not in data.variables or "wavelength" not in data.variables:
        if missing == list(WHITE):
            light = data["luminance"]
            return {"Y": light} | {name: light * 0 + white for name, white in WHITE.items()}
        raise InputError(
            f"{caller}(data=...): expected the variables {list(VARIABLES.values())}, luminance "
            f"alone, or radiance over wavelength; {missing} are missing"
        )
    light = data["radiance"].transpose(..., "wavelength")
    xyY = np.asarray(spectrum_to_xyY(jnp.asarray(light.values), data["wavelength"].values))
    one = light.isel(wavelength=0, drop=True)
    return {channel: one.copy(data=xyY[..., k]) for k, channel in enumerate(CHANNELS)}


def without_gaps(view, azimuth, values, caller):
    """View, azimuth and values with `MISSING` views, and harmless values, where one is NaN."""
    gone = np.isnan(view) | np.isnan(azimuth) | np.isnan(values).any(axis=0)
    empty = int(gone.all(axis=1).sum())
    if empty:
        raise InputError(
            f"{caller}(data=...): expected skies with a value somewhere; {empty} of {len(gone)} "
            "have none"
        )
    if not gone.any():
        return view, azimuth, values
    filler = [np.median(channel[~gone]) for channel in values]
    values = np.where(gone, np.reshape(filler, (-1, 1, 1)), values)
    return np.where(gone, MISSING, view), np.where(gone, 0.0, azimuth), values


def _refuse_unfit(caller, sun, view, azimuth, values, *, night) -> None:
    checked = {"sun_zenith": sun, "view_zenith": view, "relative_azimuth": azimuth}
    checked |= {VARIABLES[name]: array for name, array in zip(CHANNELS, values, strict=True)}
    for name, array in checked.items():
        bad = np.count_nonzero(~np.isfinite(array))
        if bad:
            raise InputError(
                f"{caller}(data=...): {name} has {bad} non-finite values of {array.size}"
            )
    for name in VARIABLES.values():
        bad = np.count_nonzero(checked[name] <= 0)
        if bad:
            raise InputError(
                f"{caller}(data=...): {name} must be above 0; {bad} of {checked[name].size} "
                "values are not"
            )
    lit = "0 to 0.6 π rad, the end of twilight" if night else "0 to π/2 rad, by day"
    lowest = LOWEST_SUN if night else np.pi / 2
    for name, low, high, words in (
        ("sun_zenith", 0.0, lowest, lit),
        ("view_zenith", 0.0, np.pi, "0 to π rad"),
        ("relative_azimuth", -2 * np.pi, 2 * np.pi, "-2π to 2π rad"),
    ):
        outside = (checked[name] < low - 1e-6) | (checked[name] > high + 1e-6)
        if outside.any():
            raise InputError(
                f"{caller}(data=...): {name} must lie in {words}; "
                f"got {checked[name][outside][0]:.6g}"
            )


def distinct(values: Float[np.ndarray, " sky"]) -> Float[np.ndarray, " value"]:
    """Values that differ by more than rounding errors, 1e-9 of the largest, increasing."""
    ordered = np.unique(values)
    gap = 1e-9 * np.abs(ordered).max()
    return ordered[np.r_[True, np.diff(ordered) > gap]]


def zenith_values(
    view: Float[np.ndarray, "sky direction"], values: Float[np.ndarray, "channel sky direction"]
) -> Float[np.ndarray, "channel sky"] | None:
    """Mean of the directions at the zenith, if every sky has one."""
    at = view <= ZENITH
    if not at.any(axis=1).all():
        return None
    return (values * at).sum(axis=-1) / at.sum(axis=-1)


def _solid_angles(view: Float[np.ndarray, " direction"]) -> Float[np.ndarray, " direction"]:
    # What is missing has no share, and must not push the horizon down.
    view = np.where(view == MISSING, np.pi / 2, view)
    rings, ring, count = np.unique(view, return_inverse=True, return_counts=True)
    edges = np.concatenate([[0.0], 0.5 * (rings[1:] + rings[:-1]), [max(np.pi / 2, rings[-1])]])
    return (-np.diff(np.cos(edges)) / count)[ring]
