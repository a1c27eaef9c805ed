"""Light on planes of any tilt: of the sun, the sky and the ground before them."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float, as_scalar
from ..angles import as_azimuth, as_view_zenith, cos_view_sun_angle, unit_vector
from ..colour import xyY_to_xyz
from ..constants import SUN_SOLID_ANGLE
from ..sun import sun_irradiance, sun_xyY
from .dome import Dome


class PlaneLight(NamedTuple):
    """What falls on a plane, channel last.

    Illuminance [lx] and the two beside it for a dome in CIE XYZ; spectral irradiance
    [W m⁻² nm⁻¹] for one in spectral radiance.

    Attributes:
        direct: Light of the sun's disc; 0 if it was left out.
        sky: Light of the sky without the disc.
        ground: Reflected by the ground before the plane.
    """

    direct: Float[Array, "*batch channel"]
    sky: Float[Array, "*batch channel"]
    ground: Float[Array, "*batch channel"]

    @property
    def diffuse(self) -> Float[Array, "*batch channel"]:
        """Of sky and ground."""
        return self.sky + self.ground

    @property
    def total(self) -> Float[Array, "*batch channel"]:
        """Of all three."""
        return self.direct + self.sky + self.ground


def plane_light(
    dome: Dome,
    tilt: ArrayLike = 0.0,
    azimuth: ArrayLike = 0.0,
    *,
    sun: ArrayLike | None = None,
    ground_albedo: ArrayLike = 0.0,
) -> PlaneLight:
    """Light of a sky on planes.

    Args:
        dome: The sky.
        tilt: Tilt of the plane: 0 faces up, π/2 is a wall, π faces down [rad].
        azimuth: Azimuth the plane faces, from the sun's [rad]; broadcasts against `tilt`.
        sun: What the sun's disc puts on a plane that faces it, per channel (`sun_light`); without
            it the disc is left out.
        ground_albedo: Albedo of an even, diffusing ground, lit by sky and sun.

    Raises:
        InputError: An angle out of its range.
    """
    tilt, azimuth = jnp.broadcast_arrays(
        as_view_zenith(tilt, "plane_light(tilt=...)"),
        as_azimuth(azimuth, "plane_light(azimuth=...)"),
    )
    normal = unit_vector(tilt, azimuth)
    facing = jnp.maximum(jnp.einsum("zac,...c->...za", dome.directions, normal), 0.0)
    sky = jnp.einsum("...za,z,zac->...c", facing, dome.solid_angle, dome.light)
    disc = jnp.zeros(dome.light.shape[-1:], dome.light.dtype) if sun is None else as_float(sun)
    cosine = cos_view_sun_angle(tilt, jnp.broadcast_to(dome.sun_zenith, tilt.shape), azimuth)
    last = (1,) * tilt.ndim + disc.shape
    direct = jnp.maximum(cosine, 0.0)[..., None] * disc.reshape(last)
    upward = jnp.einsum("za,z,zac->c", dome.directions[..., 2], dome.solid_angle, dome.light)
    upward = upward + jnp.maximum(jnp.cos(dome.sun_zenith), 0.0) * disc
    seen = as_float(ground_albedo) * (1 - jnp.cos(tilt)) / 2
    return PlaneLight(direct, sky, seen[..., None] * upward.reshape(last))


def sun_light(
    turbidity: ArrayLike, sun_zenith: ArrayLike, wavelengths: ArrayLike | None = None
) -> Float[Array, " channel"]:
    """What the sun's disc puts on a plane that faces it, for `plane_light`.

    Args:
        turbidity: Turbidity, as for `skyfit.sunlight`.
        sun_zenith: Zenith angle of the sun [rad].
        wavelengths: Wavelengths of spectral irradiance [W m⁻² nm⁻¹]; CIE XYZ, Y in
            lx, if not given.
    """
    at = as_scalar(turbidity, "sun_light(turbidity=...)")
    sun = as_scalar(sun_zenith, "sun_light(sun_zenith=...)")
    if wavelengths is not None:
        return sun_irradiance(at, sun, wavelengths)
    return SUN_SOLID_ANGLE * xyY_to_xyz(sun_xyY(at, sun))
