"""A sky model of any shape, dependence and channels: what a ladder of formulas fits."""

import math
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..angles import view_sun_angle
from ..colour import rgb_to_xyz, spectrum_to_xyz, xyY_to_xyz, xyz_to_xyY
from ..spectrum import linear_in_wavelength
from .base import AbstractSkyModel
from .basis import AbstractBasis
from .directions import align, view_along
from .shapes import AbstractShape
from .twilight import TWILIGHT_DECAY


CHANNEL_KINDS = {"Yxy": ("x", "y", "Y"), "XYZ": ("X", "Y", "Z"), "RGB": ("R", "G", "B")}


class FormulaSky(AbstractSkyModel):
    """Channels that are each a scale times a shape, both depending on a parameter and the sun.

    A channel's value is e^s F(θ, γ), or e^s F(θ, γ) / F(0, θₛ) where the shape is relative to the
    zenith; s and the free numbers of F are sums of numbers times the terms of a basis. Parameter
    and sun are held at the ends of their ranges. A sun lower than those of the range dims the sky
    by a constant rate, and below the horizon by a decade for every 2.5°; chromaticities stay.

    Attributes:
        parameter: Turbidity, or what else was swept; broadcasts against the angles.
        numbers: Of the shape's coefficients in the terms of `basis`, for every channel.
        scales: Of the logarithm of the scale, in the terms of `scale_basis`; cd m⁻², or
            W m⁻² sr⁻¹ nm⁻¹ for spectral bands, or none for chromaticities.
        dimming: How much the logarithm of a scale falls per radian of a sun lower than the range.
        basis: Terms of the shape's coefficients.
        scale_basis: Terms of the scales.
        shape: Formula of the distribution over the dome.
        wavelengths: Of spectral bands [nm]; None for the three channels of a colour.
        kind: "Yxy", "XYZ", "RGB" or "bands".
        parameter_name: What the parameter is called; empty if nothing was swept.
        parameter_range: Where the parameter is valid.
        sun_zenith_range: Suns for which the model was made [rad].
    """

    parameter: Float[Array, "..."]
    numbers: Float[Array, "channel coefficient term"]
    scales: Float[Array, "channel scale_term"]
    dimming: Float[Array, " channel"]
    basis: AbstractBasis
    scale_basis: AbstractBasis
    shape: AbstractShape
    wavelengths: Float[Array, " channel"] | None
    kind: str = eqx.field(static=True)
    parameter_name: str = eqx.field(static=True)
    parameter_range: tuple[float, float] = eqx.field(static=True)
    sun_zenith_range: tuple[float, float] = eqx.field(static=True)

    @property
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """Range of the swept parameter, of the sun's zenith angle [rad], of the bands [nm]."""
        swept = {self.parameter_name: self.parameter_range} if self.parameter_name else {}
        valid = swept | {"sun_zenith": self.sun_zenith_range}
        if self.wavelengths is None:
            return valid
        bands = np.asarray(self.wavelengths)
        return valid | {"wavelength": (float(bands[0]), float(bands[-1]))}

    def channels(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch channel"]:
        """Values of the fitted channels themselves; arguments as `xyY`."""
        angles = as_float(sun_zenith), as_float(view_zenith), as_float(relative_azimuth)
        return _by_angles(self, *angles)

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]; see `AbstractSkyModel.xyY`."""
        values = self.channels(sun_zenith, view_zenith, relative_azimuth)
        return values if self.kind == "Yxy" else xyz_to_xyY(self._tristimulus(values))

    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ [cd m⁻²] for unit vectors, z up; see `AbstractSkyModel.xyz`."""
        return self._tristimulus(_by_vectors(self, as_float(direction), as_float(sun_direction)))

    def radiance(
        self,
        sun_zenith: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        wavelengths: ArrayLike,
    ) -> Float[Array, "*batch wavelength"]:
        """Spectral radiance [W m⁻² sr⁻¹ nm⁻¹]; see `AbstractSkyModel.radiance`.

        Spectral bands are linear in between; wavelengths beyond them are refused. Colours are
        given the daylight spectrum.
        """
        if self.wavelengths is None:
            return super().radiance(sun_zenith, view_zenith, relative_azimuth, wavelengths)
        values = self.channels(sun_zenith, view_zenith, relative_azimuth)
        return linear_in_wavelength(values, self.wavelengths, wavelengths)

    def _tristimulus(self, values):
        if self.wavelengths is not None:
            return spectrum_to_xyz(values, self.wavelengths)
        if self.kind == "Yxy":
            return xyY_to_xyz(values)
        return rgb_to_xyz(values) if self.kind == "RGB" else values

    def _values(self, parameter, sun_zenith, cos_view, gamma, cos_gamma):
        """Every channel, on the last axis, in the precision of the angles."""
        dtype = gamma.dtype
        sky = jax.tree.map(lambda array: array.astype(dtype), self)
        held = jnp.clip(parameter.astype(dtype), *self.parameter_range)
        free = jnp.tensordot(sky.numbers, sky.basis.terms(held, sun_zenith), 1)
        coefficients = jnp.moveaxis(sky.shape.coefficients(jnp.moveaxis(free, 1, 0)), 1, 0)
        value = jax.vmap(sky.shape.value, in_axes=(0, None, None, None))
        scale = jnp.exp(
            jnp.tensordot(sky.scales, sky.scale_basis.terms(held, sun_zenith), 1)
            - _times(sky.dimming, jnp.clip(sun_zenith, max=math.pi / 2), self.sun_zenith_range[1])
            - _times(_decays(sky), sun_zenith, math.pi / 2)
        )
        if sky.shape.relative:
            overhead = jnp.ones_like(sun_zenith)
            scale = scale / value(coefficients, overhead, sun_zenith, jnp.cos(sun_zenith))
        values = scale * value(coefficients, cos_view, gamma, cos_gamma)
        return jnp.moveaxis(values, 0, -1)


def dims_at_night(kind: str) -> tuple[bool, ...]:
    """Which channels of a kind fall with the light: all but chromaticities."""
    return (False, False, True) if kind == "Yxy" else (True,)


def _decays(sky: FormulaSky):
    """How fast each channel's logarithm falls per radian of the sun's depression."""
    fall = TWILIGHT_DECAY * jnp.array(dims_at_night(sky.kind)).astype(sky.dimming.dtype)
    return jnp.broadcast_to(fall, sky.dimming.shape)


def _times(rates, angle, beyond):
    """A rate a channel, times how far an angle lies beyond another."""
    excess = jnp.maximum(angle - beyond, 0.0)
    return rates.reshape(-1, *(1,) * angle.ndim) * excess[None]


@eqx.filter_jit
def _by_angles(sky, sun_zenith, view_zenith, relative_azimuth) -> Any:
    angles = align(sun_zenith, view_zenith, relative_azimuth, sky.parameter)
    sun, view, azimuth, parameter = angles
    gamma = view_sun_angle(view, sun, azimuth)
    return sky._values(parameter, sun, jnp.cos(view), gamma, jnp.cos(gamma))


@eqx.filter_jit
def _by_vectors(sky, direction, sun_direction) -> Any:
    cos_view, sun, gamma, cos_gamma, parameter = view_along(direction, sun_direction, sky.parameter)
    return sky._values(parameter, sun, cos_view, gamma, cos_gamma)
