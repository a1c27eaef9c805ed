"""Ward-Larson's aerial perspective: the same light from all directions, the same air everywhere."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..angles import as_azimuth, as_view_zenith
from ..atmosphere import Atmosphere
from ..models.directions import align
from .base import AbstractAerialPerspective
from .scene import (
    Sky,
    check_channels,
    layered_air,
    mean_by_response,
    one_sun,
    rgb_weights,
    sky_radiance,
)


KILOMETRE = 1e3


class ConstantAmbient(AbstractAerialPerspective):
    """Uniform extinction towards one colour: L = L₀ τ + ambient (1 - τ), τ = e^{-β s}.

    Directions and height change nothing.

    Attributes:
        extinction: Extinction coefficient of the air [m⁻¹].
        ambient: Light into which everything fades, channel last.
    """

    extinction: Float[Array, " channel"]
    ambient: Float[Array, " channel"]

    def transmittance(
        self, distance: ArrayLike, view_zenith: ArrayLike = 0.0, observer_altitude: ArrayLike = 0.0
    ) -> Float[Array, "*batch channel"]:
        """Share of an object's light that arrives from a distance [m]."""
        view = as_view_zenith(view_zenith, "aerial(view_zenith=...)")
        far, *others = map(as_float, (distance, view, observer_altitude))
        shape = jnp.broadcast_shapes(far.shape, *(other.shape for other in others))
        far = jnp.broadcast_to(far, shape)[..., None]
        # An infinite distance has no derivative worth the name; a long one serves as well.
        rate = self.extinction.reshape((1,) * (far.ndim - 1) + self.extinction.shape)
        return jnp.exp(-rate.astype(far.dtype) * jnp.minimum(far, 1e9))

    def split(
        self,
        distance: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        observer_altitude: ArrayLike = 0.0,
    ) -> tuple[Float[Array, "*batch channel"], Float[Array, "*batch channel"]]:
        """Transmittance τ and in-scattered light; arguments as `apply`."""
        view = as_view_zenith(view_zenith, "aerial(view_zenith=...)")
        azimuth = as_azimuth(relative_azimuth, "aerial(relative_azimuth=...)")
        view, azimuth = align(view, azimuth)
        shape = jnp.broadcast_shapes(view.shape, azimuth.shape)
        seen = self.transmittance(distance, jnp.broadcast_to(view, shape), observer_altitude)
        ambient, seen = align(self.ambient.astype(seen.dtype), seen)
        return seen, ambient * (1 - seen)


def ward_larson_aerial(
    atmosphere: Atmosphere | ArrayLike,
    sky: Sky,
    sun_zenith: ArrayLike,
    *,
    wavelengths: ArrayLike | None = None,
    channels: str = "spectral",
) -> ConstantAmbient:
    """Ward-Larson's model as Preetham et al. (1999), section 5, compare with their own.

    The attenuation is right over one level kilometre at the ground and exponential elsewhere; what
    is scattered in is the radiance of the zenith times the rest of it.

    Args:
        atmosphere: Turbidity or atmosphere, as `aerial_perspective` takes it.
        sky: Sky model, as `aerial_perspective` takes it.
        sun_zenith: Zenith angle of the sun [rad].
        wavelengths: Wavelengths that go with a turbidity [nm].
        channels: "spectral" or "rgb".
    """
    check_channels(channels, "ward_larson_aerial")
    sun = one_sun(sun_zenith, "ward_larson_aerial")
    found = layered_air(atmosphere, wavelengths, None, "ward_larson_aerial")
    air, classes = found.atmosphere, found.classes
    overhead = np.zeros(1)
    zenith = sky_radiance(sky, air, sun, overhead, overhead, "ward_larson_aerial")[0]
    extinction = jnp.sum(found.layers.extinction, axis=0)
    if classes.place:
        extinction = -jnp.log(classes.mean(jnp.exp(-extinction * KILOMETRE))) / KILOMETRE
    if channels == "rgb":
        seen = jnp.exp(-extinction * KILOMETRE)
        extinction = -jnp.log(mean_by_response(seen, air)) / KILOMETRE
        zenith = zenith @ rgb_weights(air.wavelengths)
    return ConstantAmbient(extinction, zenith)
