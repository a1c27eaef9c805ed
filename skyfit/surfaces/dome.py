"""The light of a whole sky under one sun, on a grid made for sums over the dome."""

from functools import cache

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_scalar
from ..angles import as_zenith
from ..colour import xyY_to_xyz
from ..errors import InputError
from ..models import AbstractSkyModel


ZENITHS, AZIMUTHS = 64, 128


class Dome(eqx.Module):
    """Light from every direction above the horizon; nothing comes from below.

    Azimuth 0 is towards the sun, π/2 a quarter turn from it in the sense of `relative_azimuth`;
    unit vectors have x towards the sun and z up.

    Attributes:
        light: Per direction of the grid and channel: CIE XYZ [cd m⁻²], spectral radiance
            [W m⁻² sr⁻¹ nm⁻¹], or whatever was put in, over steradian.
        sun_zenith: Zenith angle of the sun, whose disc is no part of the dome [rad].
    """

    light: Float[Array, "zenith azimuth channel"]
    sun_zenith: Float[Array, ""]

    @property
    def directions(self) -> Float[Array, "zenith azimuth 3"]:
        """Unit vectors of the grid."""
        zenith, azimuth, _ = self._grid()
        vectors = np.stack(
            [
                np.sin(zenith)[:, None] * np.cos(azimuth),
                np.sin(zenith)[:, None] * np.sin(azimuth),
                np.broadcast_to(np.cos(zenith)[:, None], (zenith.size, azimuth.size)),
            ],
            axis=-1,
        )
        return jnp.asarray(vectors, self.light.dtype)

    @property
    def solid_angle(self) -> Float[Array, " zenith"]:
        """What a direction stands for, the same all around [sr]; 2π in sum."""
        return jnp.asarray(self._grid()[2], self.light.dtype)

    def _grid(self):
        return dome_grid(self.light.shape[0], self.light.shape[1])


@cache
def dome_grid(
    zeniths: int, azimuths: int
) -> tuple[
    Float[np.ndarray, " zenith"], Float[np.ndarray, " azimuth"], Float[np.ndarray, " zenith"]
]:
    """Zenith angles [rad], azimuths [rad] and solid angle of each ring's directions [sr].

    Gauss-Legendre in the zenith angle, where skies that darken or brighten like e^{b / cos θ}
    are smooth, by midpoints in azimuth.
    """
    x, w = np.polynomial.legendre.leggauss(zeniths)
    zenith = np.pi / 4 * (x + 1)
    azimuth = (np.arange(azimuths) + 0.5) * 2 * np.pi / azimuths
    weight = np.pi / 4 * w * np.sin(zenith) * 2 * np.pi / azimuths
    for array in (zenith, azimuth, weight):
        array.flags.writeable = False
    return zenith, azimuth, weight


def sky_dome(
    model: AbstractSkyModel,
    sun_zenith: ArrayLike,
    *,
    wavelengths: ArrayLike | None = None,
    zeniths: int = ZENITHS,
    azimuths: int = AZIMUTHS,
) -> Dome:
    """The light of a sky model under one sun.

    With the grid's default size the light of the published and the CIE's skies on the ground is
    within 2e-5 of the converged one, on tilted planes within 2e-4.

    Args:
        model: Sky model of one parameter value; `jax.vmap` for more.
        sun_zenith: Zenith angle of the sun [rad].
        wavelengths: Wavelengths of spectral radiance [nm]; CIE XYZ if not given.
        zeniths: Rings of the grid.
        azimuths: Directions of each ring.

    Raises:
        InputError: More than one sun; a grid of less than two rings or four directions.
    """
    argument = "sky_dome(sun_zenith=...)"
    sun = as_zenith(as_scalar(sun_zenith, argument), argument)
    if zeniths < 2 or azimuths < 4:
        raise InputError(
            f"sky_dome(zeniths=..., azimuths=...): expected 2 and 4 or more; got {zeniths}, "
            f"{azimuths}"
        )
    zenith, azimuth, _ = dome_grid(zeniths, azimuths)
    view = jnp.asarray(zenith, sun.dtype)[:, None], jnp.asarray(azimuth, sun.dtype)[None]
    if wavelengths is None:
        light = xyY_to_xyz(model.xyY(sun, *view))
    else:
        light = model.radiance(sun, *view, wavelengths)
    if light.ndim != 3:
        raise InputError(f"sky_dome(model=...): expected one sky; got shape {light.shape[:-3]}")
    return Dome(light, sun)
