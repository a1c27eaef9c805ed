"""The marched sky behind the interface of all models."""

import math

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..angles import as_sight, unit_vector
from ..colour import rgb_to_xyz, xyz_to_xyY
from ..models.base import AbstractSkyModel
from ..models.directions import align
from ..models.hoffman import sun_colour
from .air import MarchedAir, scs_air
from .march import LIGHT_STEPS, VIEW_STEPS, march


EYE_HEIGHT = 1.0  # m


class MarchedSky(AbstractSkyModel):
    """A sky marched anew for each direction, seen from 1 m above the ground.

    Red, green and blue of the marcher stand for linear sRGB. Below the horizon one sees the air
    before a black ground; a sun below it leaves a twilight as long as it lights some of the air.

    Attributes:
        air: Air whose `sun` is an illuminance in lx, so that colours are in cd m⁻².
        view_steps: Number of steps along each view.
        light_steps: Number of steps towards the sun.
    """

    air: MarchedAir
    view_steps: int = eqx.field(static=True)
    light_steps: int = eqx.field(static=True)

    @property
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """Range of the sun's zenith angle [rad]."""
        return {"sun_zenith": (0.0, math.pi)}

    def rgb(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Linear sRGB [cd m⁻²]; see `AbstractSkyModel.rgb`."""
        angles = align(*as_sight(sun_zenith, view_zenith, relative_azimuth, "sky"))
        sun, view, azimuth = jnp.broadcast_arrays(*angles)
        toward = unit_vector(sun, jnp.zeros_like(sun))
        return self._look(unit_vector(view, azimuth), toward)

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]; see `AbstractSkyModel.xyY`."""
        return xyz_to_xyY(rgb_to_xyz(self.rgb(sun_zenith, view_zenith, relative_azimuth)))

    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ [cd m⁻²] for unit vectors, z up; see `AbstractSkyModel.xyz`."""
        pair = jnp.broadcast_arrays(*align(as_float(direction), as_float(sun_direction)))
        return rgb_to_xyz(self._look(*pair))

    def _look(self, view, sun):
        eye = jnp.asarray([0.0, 0.0, EYE_HEIGHT], view.dtype)
        light, _ = march(
            self.air, eye, view, sun, view_steps=self.view_steps, light_steps=self.light_steps
        )
        return light


def scs_sky(
    *, view_steps: int = VIEW_STEPS, light_steps: int = LIGHT_STEPS, **air: ArrayLike
) -> MarchedSky:
    """The tutorial's sky in absolute luminance: the sun's illuminance in place of its 20.

    Args:
        view_steps: Number of steps along each view.
        light_steps: Number of steps towards the sun.
        air: What differs from the tutorial's air, as `scs_air` takes it.
    """
    return MarchedSky(scs_air(**{"sun": sun_colour(), **air}), view_steps, light_steps)
