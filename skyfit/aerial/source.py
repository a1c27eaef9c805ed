"""The light that air and haze at the ground scatter into each direction: the tables S⁰.

S_i⁰(θ, φ) = β_i ∫ L(ω) p_i(Θ) dω over sky, sun and sunlit ground; Preetham et al. (1999), section
4.2. Sunlight depends on the angle to the sun alone and has a table over that.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import Scalar, Spectrum
from ..angles import view_sun_angle
from ..atmosphere import Atmosphere
from ..transfer.geometry import Spherical
from ..transfer.harmonics import cosines, legendre
from ..transfer.medium import make_medium
from ..transfer.paths import column_along, rising_leg
from ..transfer.quadrature import gauss


SKY_ZENITHS, SKY_AZIMUTHS = 24, 24  # from zenith to horizon, and half way round
DEGREE, ORDER = 40, 24  # of the spherical harmonics in which the sky is scattered
_TABLE_DEG = (1.0, 2.0)  # steps in zenith and azimuth of the table, which is read linearly
_ANGLES = 512
_OFFSET = 0.01  # of the square-root coordinate of the sun's table; keeps its slope finite


class Source(eqx.Module):
    """Source functions at ground density, read from tables.

    Attributes:
        sun_zenith: Zenith angle of the sun [rad].
        sun: Table of scattered sunlight over the angle to the sun [W m⁻² sr⁻¹ nm⁻¹ m⁻¹, or the
            channel's unit].
        sky: Table of light from sky and ground over view zenith in [0, π], relative azimuth in
            [0, π], the same on both sides of the sun.
    """

    sun_zenith: Scalar
    sun: Float[Array, "angle species channel"]
    sky: Float[Array, "zenith azimuth species channel"]

    def __call__(
        self, view_zenith: Float[Array, "*batch"], relative_azimuth: Float[Array, "*batch"]
    ) -> Float[Array, "*batch species channel"]:
        """Light scattered towards the eye per metre, from the air in a direction."""
        direct = self.sunlight(view_zenith, relative_azimuth)
        total = direct.reshape(*view_zenith.shape, -1)
        zeniths, azimuths = self.sky.shape[:2]
        row = view_zenith / np.pi * (zeniths - 1)
        # Azimuth folded to [0, π]: |((φ + π) mod 2π) - π|.
        folded = jnp.abs(jnp.mod(relative_azimuth + np.pi, 2 * np.pi) - np.pi)
        column = folded / np.pi * (azimuths - 1)
        first, share = _split(row, zeniths)
        flat = self.sky.reshape(zeniths * azimuths, -1).astype(view_zenith.dtype)
        left, inner = _split(column, azimuths)
        for step, weight in ((0, 1 - share), (1, share)):
            start = (first + step) * azimuths + left
            between = flat[start] * (1 - inner)[..., None] + flat[start + 1] * inner[..., None]
            total = total + weight[..., None] * between
        return total.reshape(direct.shape)

    def sunlight(
        self, view_zenith: Float[Array, "*batch"], relative_azimuth: Float[Array, "*batch"]
    ) -> Float[Array, "*batch species channel"]:
        """The part of it that comes straight from the sun."""
        gamma = view_sun_angle(view_zenith, self.sun_zenith.astype(view_zenith.dtype),
                               relative_azimuth)  # fmt: skip
        angles, species, channels = self.sun.shape
        rows = self.sun.reshape(angles, -1).astype(view_zenith.dtype)
        return _linear(rows, _stretch(gamma) * (angles - 1)).reshape(
            *gamma.shape, species, channels
        )


def sky_directions() -> tuple[np.ndarray, np.ndarray]:
    """View zenith and relative azimuth of the directions in which the sky is asked for [rad]."""
    halfway = (np.arange(SKY_AZIMUTHS) + 0.5) / SKY_AZIMUTHS
    zenith, azimuth = np.meshgrid(
        0.5 * np.pi * gauss(SKY_ZENITHS)[0], np.pi * halfway, indexing="ij"
    )
    return zenith.ravel(), azimuth.ravel()


def sunlight_at_ground(atmosphere: Atmosphere, sun_zenith: Scalar) -> Spectrum:
    """Direct sunlight at the ground, normal to the beam; none below the horizon [W m⁻² nm⁻¹]."""
    planet = Spherical(atmosphere.planet_radius, atmosphere.top_altitude)
    medium = make_medium(atmosphere, planet)
    ground = jnp.zeros_like(sun_zenith)
    up = jnp.maximum(jnp.cos(sun_zenith), 0.0)
    leg = rising_leg(planet, ground, up, ground + jnp.inf)
    column = column_along(medium, leg, ground, leg.length)
    light = atmosphere.solar_irradiance * jnp.exp(-column @ atmosphere.extinction)
    return jnp.where(jnp.cos(sun_zenith) >= 0, light, 0.0)


@eqx.filter_jit
def make_source(
    atmosphere: Atmosphere,
    scattering: Float[Array, "species wavelength"],
    sky: Float[Array, "direction wavelength"],
    sun_zenith: Scalar,
    sun_irradiance: Spectrum,
) -> Source:
    """Tabulate the source functions.

    Args:
        atmosphere: Atmosphere with the phase functions and the ground.
        scattering: Coefficients at the ground [m⁻¹].
        sky: Radiance of the sky in `sky_directions`.
        sun_zenith: Zenith angle of the sun [rad].
        sun_irradiance: Irradiance by the sun at the ground, normal to the beam.
    """
    phases = [one.phase for one in atmosphere.constituents]
    moments = _moments(atmosphere.ground_albedo, sky, sun_zenith, sun_irradiance)
    table = jnp.stack([_scattered(phase.legendre(DEGREE), moments) for phase in phases], axis=2)
    steps = jnp.linspace(0.0, 1.0, _ANGLES, dtype=sun_zenith.dtype)
    cosine = jnp.cos(_unstretch(steps))
    sun = jnp.stack([_full(phase.spectral(cosine), sun_irradiance) for phase in phases], axis=1)
    sun = sun * scattering[None] * sun_irradiance[None, None]
    return Source(sun_zenith, sun, jnp.maximum(table * scattering[None, None], 0.0))


def _moments(albedo, sky, sun_zenith, sun_irradiance) -> Float[Array, "order degree wavelength"]:
    """∫ P̄_lm cos(mφ) L dω over sky and sunlit ground."""
    dtype = sky.dtype
    zenith, azimuth = (jnp.asarray(a, dtype) for a in sky_directions())
    area = np.repeat(0.5 * np.pi * gauss(SKY_ZENITHS)[1], SKY_AZIMUTHS) * np.pi / SKY_AZIMUTHS
    area = 2 * jnp.asarray(area, dtype) * jnp.sin(zenith)  # both sides of the sun
    falling = jnp.maximum(jnp.cos(sun_zenith), 0.0) * sun_irradiance
    falling = falling + (area * jnp.cos(zenith)) @ sky
    ground = jnp.broadcast_to((albedo / np.pi * falling)[None], sky.shape)
    total = jnp.zeros((), dtype)
    turn = cosines(ORDER, jnp.cos(azimuth))
    for up, light in ((1, sky), (-1, ground)):
        polynomials = legendre(DEGREE, ORDER, up * jnp.cos(zenith), jnp.sin(zenith))
        total = total + jnp.einsum("mlq,mq,qw->mlw", polynomials, turn * area[None], light)
    return total


def _scattered(chi, moments) -> Float[Array, "zenith azimuth wavelength"]:
    """What a phase function of given Legendre coefficients makes of the light, per solid angle."""
    dtype = moments.dtype
    zenith, azimuth = (np.radians(np.arange(0.0, 180.1, step)) for step in _TABLE_DEG)
    per_degree = (2 * np.arange(DEGREE + 1) + 1) / (4 * np.pi)
    strength = jnp.asarray(per_degree, dtype)[:, None] * chi.astype(dtype)
    polynomials = legendre(
        DEGREE, ORDER, jnp.asarray(np.cos(zenith), dtype), jnp.asarray(np.sin(zenith), dtype)
    )
    by_order = jnp.einsum("mlz,mlw->zmw", polynomials, strength[None] * moments)
    turn = cosines(ORDER, jnp.asarray(np.cos(azimuth), dtype))
    return jnp.einsum("ma,zmw->zaw", turn, by_order)


def _full(values: Float[Array, "angle #wavelength"], light: Spectrum):
    """Give a grey function the wavelengths of the light."""
    return jnp.broadcast_to(values, (*values.shape[:-1], light.shape[-1]))


def _stretch(gamma):
    """Angle to [0, 1], closer near the sun."""
    return (jnp.sqrt(gamma / np.pi + _OFFSET**2) - _OFFSET) / _SPAN


def _unstretch(x):
    return np.pi * jnp.maximum((x * _SPAN + _OFFSET) ** 2 - _OFFSET**2, 0.0)


_SPAN = float(np.sqrt(1 + _OFFSET**2) - _OFFSET)


def _split(position, count):
    """Node to the left, and share of the way to the next."""
    first = jnp.clip(jnp.floor(position).astype(int), 0, count - 2)
    return first, position - first.astype(position.dtype)


def _linear(rows, position):
    first, share = _split(position, rows.shape[0])
    return rows[first] * (1 - share)[..., None] + rows[first + 1] * share[..., None]
