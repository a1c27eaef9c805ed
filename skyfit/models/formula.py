"""The sky model of every formula: distributions over the dome, a basis, and scales."""

from collections.abc import Mapping
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..angles import as_sight, as_zenith, view_sun_angle
from ..colour import rgb_to_xyz, spectrum_to_xyz, xyY_to_xyz, xyz_to_xyY
from ..spectrum import linear_in_wavelength
from .axes import SUN
from .base import AbstractSkyModel
from .basis import Basis
from .directions import align, combine, in_pieces, view_along
from .distribution import AbstractDistribution
from .scale import AbstractScale


CHANNELS = ("x", "y", "Y")  # in the order of `xyY`
CHANNEL_KINDS = {"Yxy": CHANNELS, "XYZ": ("X", "Y", "Z"), "RGB": ("R", "G", "B")}
_XYZ_FROM_TOTAL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, -1.0, 1.0))  # Z = total - X - Y

Ranges = tuple[tuple[str, tuple[float, float]], ...]


class FormulaSky(AbstractSkyModel):
    """Channels that are each a scale times a distribution, both depending on parameters and sun.

    A channel's value is s F(θ, γ), or s F(θ, γ) / F(0, θₛ) where the distribution is relative to
    the zenith. The scale s is that of `scale`. The coefficients of F are sums of numbers times the
    terms of `basis`, or, where the formula is `linked`, links of such sums. Parameters are held at
    the ends of their ranges; see `skyfit.models.base` for what is given below the horizon and at
    night.

    Attributes:
        swept: Value of every swept parameter; each broadcasts against the angles.
        numbers: Numbers of the coefficients in the terms of `basis`, for every channel.
        basis: Terms of the coefficients.
        linked: Whether the sums are free numbers, whose links are the coefficients.
        distribution: Formula of the dome.
        scale: Factor of every channel.
        kind: "Yxy", "XYZ", "RGB" or "bands".
        wavelengths: Wavelengths of spectral bands [nm]; None for the three channels of a colour.
        ranges: Name of every swept parameter, and where it is valid.
        sun_zenith_range: Suns for which the model was made [rad].
    """

    swept: dict[str, Float[Array, "..."]]
    numbers: Float[Array, "channel coefficient term"]
    basis: Basis
    distribution: AbstractDistribution
    scale: AbstractScale
    wavelengths: Float[Array, " channel"] | None
    linked: bool = eqx.field(static=True)
    kind: str = eqx.field(static=True)
    ranges: Ranges = eqx.field(static=True)
    sun_zenith_range: tuple[float, float] = eqx.field(static=True)

    @property
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """Range of each swept parameter, of the sun's zenith angle [rad], of the bands [nm]."""
        valid = dict(self.ranges) | {SUN: self.sun_zenith_range}
        if self.wavelengths is None:
            return valid
        bands = np.asarray(self.wavelengths)
        return valid | {"wavelength": (float(bands[0]), float(bands[-1]))}

    def channels(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch channel"]:
        """Values of the fitted channels themselves; arguments as `xyY`."""
        angles = as_sight(sun_zenith, view_zenith, relative_azimuth, "sky")
        return _by_angles(self, *angles, over_zenith=False)

    def relative(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch channel"]:
        """F(θ, γ) / F(0, θₛ) of every channel: each value over the zenith's. Arguments as `xyY`."""
        angles = as_sight(sun_zenith, view_zenith, relative_azimuth, "sky")
        return _by_angles(self, *angles, over_zenith=True)

    def coefficients(self, sun_zenith: ArrayLike) -> Float[Array, "channel coefficient *batch"]:
        """Coefficients of the distribution in every channel, at the model's parameters and suns."""
        sun, *swept = align(as_zenith(sun_zenith, "sky(sun_zenith=...)"), *self.swept.values())
        return self._coefficients(
            self._held(dict(zip(self.swept, swept, strict=True))) | {SUN: sun}
        )

    def zenith(self, sun_zenith: ArrayLike) -> Float[Array, "*batch channel"]:
        """Value of every channel at the zenith."""
        sun = as_float(sun_zenith)
        return self.channels(sun, jnp.zeros_like(sun), jnp.zeros_like(sun))

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]; see `AbstractSkyModel.xyY`."""
        values = self.channels(sun_zenith, view_zenith, relative_azimuth)
        return values if self.kind == "Yxy" else xyz_to_xyY(self._tristimulus(values))

    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ [cd m⁻²] for unit vectors, z up; see `AbstractSkyModel.xyz`."""
        values = _by_vectors(self, as_float(direction), as_float(sun_direction))
        return values if self.kind == "Yxy" else self._tristimulus(values)

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

    def _held(self, swept: Mapping[str, Any]) -> dict[str, Any]:
        """Parameters by name, held in their ranges."""
        return {name: jnp.clip(swept[name], *ends) for name, ends in self.ranges}

    def _coefficients(self, at: Mapping[str, Any]):
        """Coefficients of every channel, on the first two axes."""
        sums = jnp.tensordot(self.numbers, self.basis.terms(at), 1, precision="highest")
        return jax.vmap(self.distribution.coefficients)(sums) if self.linked else sums

    def _values(self, swept, sun, cos_view, gamma, cos_gamma, *, over_zenith=False):
        """Every channel, on the first axis, in the precision of the angles."""
        sky = jax.tree.map(lambda array: array.astype(gamma.dtype), self)
        at = sky._held({name: value.astype(gamma.dtype) for name, value in swept.items()})
        at[SUN] = sun
        table = sky._coefficients(at)
        scale = jnp.ones((len(table), *table.shape[2:]), gamma.dtype)
        scale = scale if over_zenith else sky.scale(at)
        if sky.distribution.relative or over_zenith:
            overhead = jnp.ones_like(sun), sun, jnp.cos(sun)
            scale = scale / jnp.stack([sky.distribution.value(row, *overhead) for row in table])
        if scale[0].size < gamma.size:
            # What depends on the sun alone is made as one block by a division, which XLA then keeps
            # out of the loop over directions: it does not repeat divisions.
            shape = np.broadcast_shapes(scale.shape[1:], table.shape[2:])
            table = jnp.broadcast_to(table, (*table.shape[:2], *shape))
            scale = jnp.broadcast_to(scale, (len(scale), *shape))
            rows = jnp.concatenate([scale[:, None], table], axis=1)
            rows = rows / jnp.ones_like(rows)
            scale, table = rows[:, 0], rows[:, 1:]
        views = cos_view, gamma, cos_gamma
        if len(table) <= 3:
            pairs = zip(scale, table, strict=True)
            return jnp.stack([k * sky.distribution.value(row, *views) for k, row in pairs])
        values = jax.vmap(sky.distribution.value, in_axes=(0, None, None, None))(table, *views)
        return scale * values


# Compiled as one even where a caller compiles nothing: op by op the first call takes seconds.
@eqx.filter_jit
def _by_angles(sky, sun_zenith, view_zenith, relative_azimuth, *, over_zenith) -> Any:
    angles = align(sun_zenith, view_zenith, relative_azimuth, *sky.swept.values())
    sun, view, azimuth, *swept = angles
    gamma = view_sun_angle(view, sun, azimuth)
    named = dict(zip(sky.swept, swept, strict=True))
    places = named, sun, jnp.cos(view), gamma, jnp.cos(gamma)
    return jnp.moveaxis(sky._values(*places, over_zenith=over_zenith), 0, -1)


@eqx.filter_jit
def _by_vectors(sky, direction, sun_direction) -> Any:
    """Channels of unit vectors, on the last axis; XYZ where they are x, y, Y."""
    if sun_direction.ndim > 1 or any(value.ndim for value in sky.swept.values()):
        return _vectors_at_once(sky, direction, sun_direction)
    return in_pieces(lambda piece: _vectors_at_once(sky, piece, sun_direction), direction)


def _vectors_at_once(sky, direction, sun_direction):
    at = view_along(direction, sun_direction, tuple(sky.swept.values()))
    named = dict(zip(sky.swept, at.swept, strict=True))
    values = sky._values(named, at.sun_zenith, at.cos_view, at.gamma, at.cos_gamma)
    if sky.kind != "Yxy":
        return jnp.moveaxis(values, 0, -1)
    x, y, luminance = values
    total = luminance / y
    return combine(_XYZ_FROM_TOTAL, jnp.stack([total * x, luminance, total]))
