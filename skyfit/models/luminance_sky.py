"""A sky made of a relative distribution of luminance, a level and a colour."""

import abc
import math

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..angles import as_sight, view_sun_angle
from ..colour import D65_WHITE, xyY_to_xyz
from .base import AbstractSkyModel
from .directions import align, angle_between, components
from .levels import AbstractLevel
from .scale import CubicZenith
from .standard_skies import AbstractLuminanceForm, Parameters, Sight
from .twilight import daytime_sun


class AbstractChromaticity(eqx.Module):
    """One colour for the whole sky."""

    @abc.abstractmethod
    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
        """Chromaticity x and y for a sun above the horizon or on it."""


class ConstantChromaticity(AbstractChromaticity):
    """The same colour whatever the sun.

    Attributes:
        xy: Chromaticity.
    """

    xy: tuple[float, float] = eqx.field(static=True, default=D65_WHITE)

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
        """Chromaticity x and y."""
        x, y = self.xy
        return jnp.full_like(sun_zenith, x), jnp.full_like(sun_zenith, y)


class ZenithChromaticity(AbstractChromaticity):
    """The colour that Preetham et al. (1999), appendix A.2, give the zenith.

    Attributes:
        x: Formula of one coordinate over turbidity and sun.
        y: Formula of the other.
    """

    x: CubicZenith
    y: CubicZenith

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
        """Chromaticity x and y."""
        turbidity = parameters["turbidity"]
        return self.x(turbidity, sun_zenith), self.y(turbidity, sun_zenith)


class LuminanceSky(AbstractSkyModel):
    """A luminance distribution of one colour.

    See `skyfit.models.base` for what is given below the horizon, at night and outside the valid
    range.

    Attributes:
        parameters: What the sky depends on besides the sun, by name; broadcast against the angles.
        distribution: Relative luminance.
        level: Makes it absolute.
        chromaticity: Colour of the whole sky.
        ranges: Where the parameters are valid, by name; they are held at the ends.
    """

    parameters: dict[str, Float[Array, "..."]]
    distribution: AbstractLuminanceForm
    level: AbstractLevel
    chromaticity: AbstractChromaticity
    ranges: tuple[tuple[str, tuple[float, float]], ...] = eqx.field(static=True, default=())

    @property
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """Range of the parameters and of the sun's zenith angle [rad]."""
        return dict(self.ranges) | {"sun_zenith": (0.0, math.pi / 2)}

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]; see `AbstractSkyModel.xyY`."""
        return _xyY(self, *as_sight(sun_zenith, view_zenith, relative_azimuth, "sky"))

    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ [cd m⁻²] for unit vectors, z up; see `AbstractSkyModel.xyz`."""
        return _xyz(self, as_float(direction), as_float(sun_direction))

    def _look(self, sight):
        """x, y and Y along lines of sight, on the last axis."""
        sky = jax.tree.map(lambda array: array.astype(sight.gamma.dtype), self)
        ends, rank = dict(self.ranges), sight.gamma.ndim
        held = {
            name: jnp.clip(_of_rank(value, rank), *ends.get(name, (None, None)))
            for name, value in sky.parameters.items()
        }
        level = sky.level(sky.distribution, sight.sun_zenith, held)
        luminance = level * jnp.maximum(sky.distribution(sight, held), 0.0)
        x, y = sky.chromaticity(daytime_sun(sight.sun_zenith), held)
        return jnp.stack(jnp.broadcast_arrays(x, y, luminance), axis=-1)

    def _rank(self):
        return max((value.ndim for value in self.parameters.values()), default=0)


def _of_rank(array, rank):
    return array.reshape((1,) * (rank - array.ndim) + array.shape)


@eqx.filter_jit
def _xyY(sky, sun_zenith, view_zenith, relative_azimuth):
    rank = max(sky._rank(), sun_zenith.ndim, view_zenith.ndim, relative_azimuth.ndim)
    sun, view, azimuth = (_of_rank(a, rank) for a in (sun_zenith, view_zenith, relative_azimuth))
    gamma = view_sun_angle(view, sun, azimuth)
    view = jnp.clip(view, -math.pi / 2, math.pi / 2)
    cos_view = jnp.maximum(jnp.cos(view), 0.0)
    return sky._look(Sight(view, cos_view, gamma, jnp.cos(gamma), sun))


@eqx.filter_jit
def _xyz(sky, direction, sun_direction):
    rank = max(sky._rank(), direction.ndim - 1, sun_direction.ndim - 1)
    split = align(*components(direction), *components(sun_direction))
    parts = tuple(_of_rank(part, max(rank, part.ndim)) for part in split)
    view, sun = parts[:3], parts[3:]
    gamma, cos_gamma = angle_between(view, sun)
    sun_zenith, view_zenith = (_zenith_angle(vector) for vector in (sun, view))
    held = jnp.minimum(view_zenith, math.pi / 2)
    sight = Sight(held, jnp.maximum(view[2], 0.0), gamma, cos_gamma, sun_zenith)
    return xyY_to_xyz(sky._look(sight))


def _zenith_angle(vector):
    up = jnp.zeros_like(vector[2])
    return angle_between(vector, (up, up, up + 1))[0]
