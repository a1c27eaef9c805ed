"""The published sky as shaders use it, and the course of a day.

After "Simulating a Day's Sky", a shader of Preetham, Shirley & Smits (1999): luminance over that of
the zenith under an overhead sun, so that a screen's 1 is the brightest zenith; and a sun that
follows date and place. Its slip in the date is not followed (see the README's misprints): the
formulas take the day of the year.
"""

from typing import Literal, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..colour import xyY_to_xyz, xyz_to_rgb
from ..errors import InputError
from ..sun import SunPosition, sun_position
from .base import AbstractSkyModel
from .formula import FormulaSky
from .preetham import preetham_sky


class DaySky(AbstractSkyModel):
    """The published sky over its zenith's luminance under an overhead sun.

    Where other models have cd m⁻², this one has a number near 1 and less: Y of the zenith falls
    from 1 to about a tenth at sunset. Below the horizon, at night and outside the valid range it
    does as `skyfit.models.base` says.

    Attributes:
        sky: The published sky.
    """

    sky: FormulaSky

    @property
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """Range of turbidity and of the sun's zenith angle [rad]."""
        return self.sky.valid_range

    @property
    def white(self) -> Float[Array, "..."]:
        """Luminance of the zenith under an overhead sun, which counts as 1 [cd m⁻²]."""
        return self.sky.zenith(0.0)[..., 2]

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and Y over `white`; arguments as `AbstractSkyModel.xyY`."""
        colour = self.sky.xyY(sun_zenith, view_zenith, relative_azimuth)
        white = self._white_like(colour)
        return jnp.concatenate([colour[..., :2], colour[..., 2:] / white], axis=-1)

    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ over `white` for unit vectors, z up; arguments as `AbstractSkyModel.xyz`."""
        light = self.sky.xyz(direction, sun_direction)
        return light / self._white_like(light)

    def srgb(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """What a screen shows: sRGB with its transfer curve, cut off at 0 and 1.

        Arguments as `xyY`.
        """
        linear = xyz_to_rgb(xyY_to_xyz(self.xyY(sun_zenith, view_zenith, relative_azimuth)))
        cut = jnp.clip(linear, 0.0, 1.0)
        # Above the curve's linear piece, so that its root has a finite slope.
        curve = 1.055 * jnp.maximum(cut, 0.0031308) ** (1 / 2.4) - 0.055
        return jnp.where(cut <= 0.0031308, 12.92 * cut, curve)

    def _white_like(self, colour):
        white = self.white.astype(colour.dtype)[..., None]
        return white.reshape((1,) * (colour.ndim - white.ndim) + white.shape)


def day_sky(turbidity: ArrayLike) -> DaySky:
    """The published sky normalised for a screen.

    Args:
        turbidity: Turbidity, as for `skyfit.preetham_sky`.

    Raises:
        InputError: Turbidity below 1 or NaN.
    """
    return DaySky(preetham_sky(turbidity))


class DayCourse(NamedTuple):
    """A sky at several times of a day.

    Attributes:
        standard_time: Clock times [hour] [h].
        sun: Where the sun stands, [hour] each [rad].
        xyY: Chromaticity and luminance of each direction [hour, direction, 3], in the model's unit.
        towards_sun: xyY where the sun stands, the colour of its light in the shader [hour, 3].
    """

    standard_time: Float[Array, " hour"]
    sun: SunPosition
    xyY: Float[Array, "hour direction 3"]
    towards_sun: Float[Array, "hour 3"]


def day_course(
    model: AbstractSkyModel,
    latitude: ArrayLike,
    longitude: ArrayLike,
    day_of_year: ArrayLike,
    standard_meridian: ArrayLike,
    *,
    view_zenith: ArrayLike = 0.0,
    view_azimuth: ArrayLike = 0.0,
    standard_time: ArrayLike | None = None,
    method: Literal["paper", "almanac"] = "paper",
    year: ArrayLike | None = None,
) -> DayCourse:
    """A sky over a day, from place and date.

    Args:
        model: Any sky model.
        latitude: One place; positive north [rad].
        longitude: Positive east [rad].
        day_of_year: 1 to 366.
        standard_meridian: Longitude to which the clock is set, positive east [rad].
        view_zenith: Zenith angles of the directions; one axis or one number [rad].
        view_azimuth: Their azimuths, positive west of south like the sun's [rad].
        standard_time: Clock times, one axis; every full hour from 0 to 23 if not given [h].
        method: Method of the sun's position, as for `skyfit.sun_position`.
        year: Year of the date, as for `skyfit.sun_position`.

    Raises:
        InputError: Times or directions of more than one axis; what `skyfit.sun_position` refuses.
    """
    hours = np.arange(24.0) if standard_time is None else standard_time
    clock, zenith, azimuth = (
        jnp.atleast_1d(as_float(value)) for value in (hours, view_zenith, view_azimuth)
    )
    for name, axis in (
        ("standard_time", clock), ("view_zenith", zenith), ("view_azimuth", azimuth)
    ):  # fmt: skip
        if axis.ndim != 1:
            raise InputError(f"day_course({name}=...): expected one axis; got shape {axis.shape}")
    sun = sun_position(
        latitude, longitude, day_of_year, clock, standard_meridian, method=method, year=year
    )
    if sun.zenith.ndim != 1:
        raise InputError(f"day_course: expected one place and date; got {sun.zenith.shape}")
    relative = azimuth[None] - sun.azimuth[:, None]
    seen = model.xyY(sun.zenith[:, None], zenith[None], relative)
    towards = model.xyY(sun.zenith, jnp.minimum(sun.zenith, np.pi / 2), jnp.zeros_like(clock))
    return DayCourse(clock, sun, seen, towards)
