"""Perez's distribution over the sky, and the sky model made of three of them.

Sources: Perez, Seals & Michalsky (1993), "All-weather model for sky luminance distribution", Solar
Energy 50(3); Preetham, Shirley & Smits (1999), equations 3 and 4.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..angles import view_sun_angle
from .base import AbstractSkyModel
from .directions import align, combine, in_pieces, view_along
from .twilight import daytime_sun, dimming
from .zenith import CubicZenith, TangentZenith


CHANNELS = ("x", "y", "Y")  # in the order of `xyY`
COEFFICIENTS = ("A", "B", "C", "D", "E")

# At cos θ below this, e^{B/cos θ} is 0 in float64 for any B below -1e-6: the limit is exact there.
LEAST_COSINE = 1e-9
_XYZ_FROM_TOTAL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, -1.0, 1.0))  # Z = total - X - Y


def perez(
    coefficients: Float[Array, "5 *#batch"],
    cos_view: Float[Array, "*#batch"],
    gamma: Float[Array, "*#batch"],
    cos_gamma: Float[Array, "*#batch"],
) -> Float[Array, "*batch"]:
    """F = (1 + A e^{B/cos θ}) (1 + C e^{D γ} + E cos²γ).

    Args:
        coefficients: A, B, C, D, E on the first axis; B below 0.
        cos_view: Cosine of the view zenith angle; at 0 and below, the horizon's limit is returned.
        gamma: Angle between view and sun [rad].
        cos_gamma: Its cosine.
    """
    a, b, c, d, e = coefficients
    airmass = 1 / jnp.maximum(cos_view, LEAST_COSINE)
    gradation = 1 + a * jnp.exp(b * airmass)
    indicatrix = 1 + c * jnp.exp(d * gamma) + e * cos_gamma**2
    return gradation * indicatrix


class PerezSky(AbstractSkyModel):
    """Perez distributions of x, y and Y, their coefficients linear in a swept parameter.

    A value is the zenith's times F(θ, γ) / F(0, θₛ). See `skyfit.models.base` for what is given
    below the horizon, at night and outside the valid range.

    Attributes:
        parameter: Turbidity, or what else was swept; broadcasts against the angles.
        coefficients: A to E as (slope, intercept) in the parameter, for x, y, Y.
        zenith_x: Chromaticity of the zenith.
        zenith_y: Chromaticity of the zenith.
        zenith_luminance: Luminance of the zenith.
        parameter_name: What the parameter is called; empty if nothing was swept.
        parameter_range: Where the parameter is valid; it is held at the ends.
        sun_zenith_range: Suns for which the model was made [rad].
    """

    parameter: Float[Array, "..."]
    coefficients: Float[Array, "3 5 2"]
    zenith_x: CubicZenith
    zenith_y: CubicZenith
    zenith_luminance: TangentZenith
    parameter_name: str = eqx.field(static=True)
    parameter_range: tuple[float, float] = eqx.field(static=True)
    sun_zenith_range: tuple[float, float] = eqx.field(static=True)

    @property
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """Range of the swept parameter and of the sun's zenith angle [rad]."""
        swept = {self.parameter_name: self.parameter_range} if self.parameter_name else {}
        return swept | {"sun_zenith": self.sun_zenith_range}

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]; see `AbstractSkyModel.xyY`."""
        angles = as_float(sun_zenith), as_float(view_zenith), as_float(relative_azimuth)
        return _xyY(self, *angles)

    def relative(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """F(θ, γ) / F(0, θₛ) of x, y and Y: each value over the zenith's. Arguments as `xyY`."""
        angles = as_float(sun_zenith), as_float(view_zenith), as_float(relative_azimuth)
        return _relative(self, *angles)

    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ [cd m⁻²] for unit vectors, z up; see `AbstractSkyModel.xyz`."""
        return _xyz(self, as_float(direction), as_float(sun_direction))

    def perez_coefficients(self) -> Float[Array, "3 5 *batch"]:
        """A to E for x, y, Y at the model's parameter, held to its valid range."""
        held = self._held()
        slope, intercept = jnp.moveaxis(self.coefficients, -1, 0)
        shape = (*slope.shape, *(1,) * held.ndim)
        return slope.reshape(shape) * held[None, None] + intercept.reshape(shape)

    def _at(self, parameter) -> "PerezSky":
        """The same sky at another parameter, in the precision of that."""
        sky = jax.tree.map(lambda array: array.astype(parameter.dtype), self)
        return eqx.tree_at(lambda s: s.parameter, sky, parameter)

    def _held(self):
        return jnp.clip(self.parameter, *self.parameter_range)

    def _distributions(self, cos_view, gamma, cos_gamma):
        """F of each channel, in the shape the arguments broadcast to."""
        return [perez(row, cos_view, gamma, cos_gamma) for row in self.perez_coefficients()]

    def _overhead(self, sun_zenith):
        """F(0, θₛ) of each channel, on the first axis."""
        overhead = jnp.ones_like(sun_zenith)
        return jnp.stack(self._distributions(overhead, sun_zenith, jnp.cos(sun_zenith)))

    def _zenith(self, sun_zenith):
        """x, y and Y of the zenith, on the first axis."""
        held, day = self._held(), daytime_sun(sun_zenith)
        luminance = dimming(sun_zenith) * jnp.maximum(self.zenith_luminance(held, day), 0.0)
        return jnp.stack([self.zenith_x(held, day), self.zenith_y(held, day), luminance])


# Compiled as one even where a caller compiles nothing: op by op the first call takes seconds.
@eqx.filter_jit
def _xyY(sky, sun_zenith, view_zenith, relative_azimuth):
    sky, sun, cos_view, gamma = _geometry(sky, sun_zenith, view_zenith, relative_azimuth)
    scales = sky._zenith(sun) / sky._overhead(sun)
    values = sky._distributions(cos_view, gamma, jnp.cos(gamma))
    return jnp.stack([k * f for k, f in zip(scales, values, strict=True)], axis=-1)


@eqx.filter_jit
def _relative(sky, sun_zenith, view_zenith, relative_azimuth):
    sky, sun, cos_view, gamma = _geometry(sky, sun_zenith, view_zenith, relative_azimuth)
    values = sky._distributions(cos_view, gamma, jnp.cos(gamma))
    return jnp.stack([f / f0 for f, f0 in zip(values, sky._overhead(sun), strict=True)], axis=-1)


def _geometry(sky, sun_zenith, view_zenith, relative_azimuth):
    angles = align(sun_zenith, view_zenith, relative_azimuth, sky.parameter)
    sun, view, azimuth, parameter = angles
    gamma = view_sun_angle(view, sun, azimuth)
    return sky._at(parameter.astype(gamma.dtype)), sun, jnp.cos(view), gamma


@eqx.filter_jit
def _xyz(sky, direction, sun_direction):
    if sun_direction.ndim > 1 or sky.parameter.ndim > 0:
        return _xyz_at_once(sky, direction, sun_direction)
    return in_pieces(lambda piece: _xyz_at_once(sky, piece, sun_direction), direction)


def _xyz_at_once(sky, direction, sun_direction):
    cos_view, sun, gamma, cos_gamma, parameter = view_along(direction, sun_direction, sky.parameter)
    sky = sky._at(parameter.astype(gamma.dtype))
    zenith, overhead = sky._zenith(sun), sky._overhead(sun)
    table = jnp.broadcast_to(sky.perez_coefficients(), (3, 5, *zenith.shape[1:]))
    # What depends on the sun alone is divided as one block, which XLA then keeps out of the loop
    # over directions: it does not repeat divisions.
    rows = jnp.concatenate([zenith[:, None], table], axis=1) / jnp.concatenate(
        [overhead[:, None], jnp.ones_like(table)], axis=1
    )
    x, y, luminance = (row[0] * perez(row[1:], cos_view, gamma, cos_gamma) for row in rows)
    total = luminance / y
    return combine(_XYZ_FROM_TOTAL, jnp.stack([total * x, luminance, total]))
