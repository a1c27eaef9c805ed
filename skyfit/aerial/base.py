"""What every aerial perspective offers: L(s) = L₀ τ + in-scattered light."""

import abc

import equinox as eqx
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..models.directions import align


class AbstractAerialPerspective(eqx.Module):
    """What happens to light between an object and the eye.

    Channels, on the last axis, are wavelengths [W m⁻² sr⁻¹ nm⁻¹] or linear sRGB [cd m⁻²].
    Angles in radians, lengths in metres. Arguments broadcast.
    """

    @abc.abstractmethod
    def split(
        self,
        distance: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        observer_altitude: ArrayLike = 0.0,
    ) -> tuple[Float[Array, "*batch channel"], Float[Array, "*batch channel"]]:
        """Transmittance τ and in-scattered light, arguments as `apply`: L = L₀ τ + in-scattered."""

    @abc.abstractmethod
    def transmittance(
        self, distance: ArrayLike, view_zenith: ArrayLike, observer_altitude: ArrayLike = 0.0
    ) -> Float[Array, "*batch channel"]:
        """Share of an object's light that arrives; arguments as `apply`."""

    def inscatter(
        self,
        distance: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        observer_altitude: ArrayLike = 0.0,
    ) -> Float[Array, "*batch channel"]:
        """Light added on the way; arguments as `apply`."""
        return self.split(distance, view_zenith, relative_azimuth, observer_altitude)[1]

    def apply(
        self,
        radiance0: ArrayLike,
        distance: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        observer_altitude: ArrayLike = 0.0,
    ) -> Float[Array, "*batch channel"]:
        """Light of an object as it arrives at the eye.

        Args:
            radiance0: Radiance at the object, channel last.
            distance: Distance from the eye, 0 or more; infinite for the sky or for a full view of
                the air [m]. A ray that comes to 500 m below altitude 0 ends there.
            view_zenith: Zenith angle of the ray from the eye, in [0, π] [rad].
            relative_azimuth: View azimuth minus sun azimuth [rad].
            observer_altitude: Altitude of the eye [m].
        """
        seen, light = self.split(distance, view_zenith, relative_azimuth, observer_altitude)
        light0, seen, light = align(as_float(radiance0), seen, light)
        return light0.astype(seen.dtype) * seen + light
