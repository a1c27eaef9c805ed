"""Aerial perspective in air of constant density: Hoffman & Preetham (2002), equations 1 to 4."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import ArrayLike, Scalar, as_float
from ..angles import as_azimuth, as_view_zenith, view_sun_angle
from ..models.directions import align
from ..models.hoffman import HoffmanPreethamSky
from .base import AbstractAerialPerspective
from .scene import one_sun


class UniformAir(AbstractAerialPerspective):
    """Extinction and sunlight scattered in, the same at any height; in linear sRGB.

    Height changes nothing. L_in = E β(Θ) / β (1 - e^{-β s}), equation 4.

    Attributes:
        air: The model whose coefficients, phase functions and sun are used.
        sun_zenith: Zenith angle of the sun [rad].
    """

    air: HoffmanPreethamSky
    sun_zenith: Scalar

    def transmittance(
        self, distance: ArrayLike, view_zenith: ArrayLike = 0.0, observer_altitude: ArrayLike = 0.0
    ) -> Float[Array, "*batch 3"]:
        """F_ex = e^{-β s}, equation 3; arguments as `apply`."""
        return self.split(distance, view_zenith, 0.0, observer_altitude)[0]

    def split(
        self,
        distance: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        observer_altitude: ArrayLike = 0.0,
    ) -> tuple[Float[Array, "*batch 3"], Float[Array, "*batch 3"]]:
        """Transmittance and in-scattered light; arguments as `apply`."""
        view = as_view_zenith(view_zenith, "aerial(view_zenith=...)")
        azimuth = as_azimuth(relative_azimuth, "aerial(relative_azimuth=...)")
        rays = as_float(distance), view, azimuth, as_float(observer_altitude)
        return _split(self, *jnp.broadcast_arrays(*align(*rays)))


def hoffman_preetham_aerial(model: HoffmanPreethamSky, sun_zenith: ArrayLike) -> UniformAir:
    """Aerial perspective that goes with a Hoffman–Preetham sky.

    Args:
        model: Model that `hoffman_preetham_sky` makes.
        sun_zenith: Zenith angle of the sun [rad].
    """
    return UniformAir(model, one_sun(sun_zenith, "hoffman_preetham_aerial"))


@jax.jit
def _split(model: UniformAir, distance, view, azimuth, height):
    # Beyond 1000 km nothing is seen, and infinity has no derivatives.
    far = jnp.clip(distance, 0.0, 1e6)[..., None] + 0 * height[..., None]
    sun = jnp.broadcast_to(model.sun_zenith.astype(view.dtype), view.shape)
    air, haze = model.air.scattered(jnp.cos(view_sun_angle(view, sun, azimuth)))
    beta = model.air.extinction.astype(far.dtype).reshape((1,) * view.ndim + (3,))
    seen = jnp.exp(-beta * far)
    return seen, model.air.sunlight(sun) * (air + haze) / beta * (1 - seen)
