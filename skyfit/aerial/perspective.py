"""Aerial perspective under any sky: L(s) = L₀ τ + Σ_i S_i⁰ I_i."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import ArrayLike, Spectrum, as_float, check, is_traced
from ..angles import as_azimuth, as_view_zenith
from ..atmosphere import Atmosphere
from ..errors import InputError
from ..transfer.line_classes import LineClasses, all_alike
from . import closed, integrals, layers as along
from .base import AbstractAerialPerspective
from .layers import Layers
from .scene import (
    Air,
    Sky,
    check_channels,
    layered_air,
    mean_by_response,
    one_sun,
    rgb_weights,
    sky_radiance,
)
from .source import Source, make_source, sky_directions, sunlight_at_ground


BAND_LENGTH = 10e3  # m; of the paths over which bands dim linear sRGB as they should
METHODS = {
    "quadrature": integrals.by_quadrature,
    "paper": closed.as_published,
    "equation 10": closed.near_level,
    "hermite": closed.by_hermite,
}


class AerialPerspective(AbstractAerialPerspective):
    """Exponential layers of air and haze under the light of a sun and any sky.

    Attributes:
        layers: Air and haze; in bands, as every class of lines sees them.
        source: Light that the layers scatter towards the eye at the ground.
        wavelengths: Wavelengths of the channels, or of the spectra that made the RGB [nm].
        method: Rule of the path integrals: "quadrature", or for comparison "paper",
            "equation 10" or "hermite".
        channels: "spectral" or "rgb".
        classes: Classes of lines over which spectral light is averaged.
    """

    layers: Layers
    source: Source
    wavelengths: Spectrum
    classes: LineClasses
    method: str = eqx.field(static=True)
    channels: str = eqx.field(static=True)

    def split(
        self,
        distance: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        observer_altitude: ArrayLike = 0.0,
    ) -> tuple[Float[Array, "*batch channel"], Float[Array, "*batch channel"]]:
        """Transmittance τ and in-scattered light, arguments as `apply`: L = L₀ τ + in-scattered."""
        view = as_view_zenith(view_zenith, "aerial(view_zenith=...)")
        azimuth = as_azimuth(relative_azimuth, "aerial(relative_azimuth=...)")
        s, view, azimuth, height = _rays(distance, view, azimuth, observer_altitude)
        return _split(self, s, view, azimuth, height)

    def transmittance(
        self, distance: ArrayLike, view_zenith: ArrayLike, observer_altitude: ArrayLike = 0.0
    ) -> Float[Array, "*batch channel"]:
        """Share of an object's light that arrives; arguments as `apply`."""
        view = as_view_zenith(view_zenith, "aerial(view_zenith=...)")
        s, view, height = _rays(distance, view, observer_altitude)
        return _transmittance(self, s, view, height)


@jax.jit
def _transmittance(model: AerialPerspective, distance, view, height):
    ray = along.stretch(model.layers, distance, jnp.cos(view), height)
    return model.classes.mean(along.transmittance(model.layers, ray))


@jax.jit
def _split(model: AerialPerspective, distance, view, azimuth, height):
    ray = along.stretch(model.layers, distance, jnp.cos(view), height)
    paths = METHODS[model.method](model.layers, ray)
    glow = jnp.moveaxis(model.source(view, azimuth), -2, 0)
    seen, light = along.transmittance(model.layers, ray), jnp.sum(glow * paths, axis=0)
    return model.classes.mean(seen), model.classes.mean(light)


def aerial_perspective(
    atmosphere: Atmosphere | ArrayLike,
    sky: Sky,
    sun_zenith: ArrayLike,
    *,
    wavelengths: ArrayLike | None = None,
    channels: str = "spectral",
    method: str = "quadrature",
    sun_irradiance: ArrayLike | None = None,
    ground_albedo: ArrayLike | None = None,
) -> AerialPerspective:
    """Aerial perspective under a sky.

    The air is a flat pile of exponential layers, and the light on it that at the ground: Preetham
    et al. (1999), section 4. Good to distances of some hundred kilometres from heights of a few.

    Bands are taken class of lines by class of lines. Light of a sky or sun that is given has the
    same strength in all of them, as if it had come through no band; in linear sRGB bands dim as
    they do on average over 10 km.

    Args:
        atmosphere: A turbidity, for air and haze of `preetham_atmosphere` with the paper's scale
            heights; or an atmosphere, see `skyfit.aerial.layers.exponential_layers`.
        sky: A sky model; a function of view zenith and relative azimuth that returns the radiance
            at the wavelengths; or None for the atmosphere's own, simulated with two orders.
        sun_zenith: Zenith angle of one sun; beyond π/2 no sunlight comes [rad].
        wavelengths: Wavelengths that go with a turbidity, 380 to 780 by 10 if not given [nm].
        channels: "spectral", or "rgb" for linear sRGB.
        method: See `AerialPerspective`.
        sun_irradiance: Direct sunlight at the ground, normal to the beam, one per wavelength; the
            sun through the atmosphere if not given [W m⁻² nm⁻¹].
        ground_albedo: With a turbidity: of the ground, whose light the air scatters too; 0 if
            not given.

    Raises:
        InputError: An unknown method or channel, a bad turbidity or sun; wavelengths or an albedo
            beside an atmosphere, which has its own.
    """
    if method not in METHODS:
        names = ", ".join(repr(name) for name in METHODS)
        raise InputError(f"aerial_perspective(method=...): expected one of {names}; got {method!r}")
    check_channels(channels, "aerial_perspective")
    sun = one_sun(sun_zenith, "aerial_perspective")
    air = layered_air(atmosphere, wavelengths, ground_albedo, "aerial_perspective")
    plain, layers, classes = air.plain, air.layers, air.classes
    lam = air.atmosphere.wavelengths
    if sky is None:
        light = sky_radiance(None, plain, sun, *sky_directions(), "aerial_perspective")
    else:
        light = sky_radiance(sky, air.atmosphere, sun, *sky_directions(), "aerial_perspective")
        light = classes.repeated(light)
    if sun_irradiance is None:
        direct = sunlight_at_ground(plain, sun)
    else:
        direct = classes.repeated(jnp.broadcast_to(as_float(sun_irradiance), lam.shape))
    ground = layers.extinction / jnp.maximum(plain.extinction, 1e-30)
    source = make_source(plain, ground * plain.scattering, light, sun, direct)
    if channels == "rgb":
        layers, source = _in_rgb(air, source)
        classes = all_alike(3)
    return AerialPerspective(layers, source, lam, classes, method, channels)


def _in_rgb(air: Air, source: Source) -> tuple[Layers, Source]:
    """Three channels in place of the spectrum: exact colours of the sources, mean extinctions."""
    weights = rgb_weights(air.atmosphere.wavelengths)
    sun, sky = (air.classes.mean(table) @ weights for table in (source.sun, source.sky))
    extinction = mean_by_response(air.layers_over(BAND_LENGTH).extinction, air.atmosphere)
    return Layers(air.layers.scale_height, extinction), Source(source.sun_zenith, sun, sky)


def _rays(*values: ArrayLike) -> list[Float[Array, "..."]]:
    """Broadcast distance, angles and height to one shape."""
    arrays = [as_float(value) for value in values]
    if not is_traced(arrays[0]):
        check(arrays[0], lambda s: ~(s >= 0), "AerialPerspective: distance must be 0 m or more")
    width = jnp.result_type(*arrays)
    shape = jnp.broadcast_shapes(*(a.shape for a in arrays))
    return [jnp.broadcast_to(a, shape).astype(width) for a in arrays]
