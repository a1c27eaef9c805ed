"""The questions every sky model answers.

One policy holds for all fitted formulas:

- a view below the horizon goes on with the sky: the gradation towards the horizon is held at its
  limit, while the angle to the sun stays the true one, so that nothing jumps; it is no ground, and
  as bright as the horizon only at the horizon;
- a sun below the horizon leaves the zenith the colour it has at sunset, and dims it by a decade
  for every 2.5° (measured twilight falls from about 600 lx at sunset to 3 lx at -6°);
- luminance is never negative: where a formula's zenith luminance is, the sky is black;
- turbidity, or what else was swept, is held at the nearest end of the model's valid range.
"""

import abc

import equinox as eqx
from jaxtyping import Array, Float

from .._typing import ArrayLike
from ..colour import daylight_radiance, xyY_to_xyz, xyz_to_rgb


class AbstractSkyModel(eqx.Module):
    """A sky as a function of view direction and sun. Angles in radians; arguments broadcast."""

    __hash__ = object.__hash__  # arrays have none, and `jax.jit(model.xyY)` asks for it

    @property
    @abc.abstractmethod
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest value of each input for which the model was made."""

    @abc.abstractmethod
    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²].

        Args:
            sun_zenith: Zenith angle of the sun; beyond π/2 it is night [rad].
            view_zenith: Zenith angle of the view direction [rad].
            relative_azimuth: View azimuth minus sun azimuth, 0 towards the sun [rad].
        """

    @abc.abstractmethod
    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ [cd m⁻²] for unit vectors, z up: the fast path.

        Args:
            direction: View directions, components on the last axis.
            sun_direction: Towards the sun, components on the last axis.
        """

    def rgb(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Linear sRGB, not clipped; D65 white of 1 cd m⁻² is (1, 1, 1). Arguments as `xyY`."""
        return xyz_to_rgb(xyY_to_xyz(self.xyY(sun_zenith, view_zenith, relative_azimuth)))

    def radiance(
        self,
        sun_zenith: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        wavelengths: ArrayLike,
    ) -> Float[Array, "*batch wavelength"]:
        """Spectral radiance [W m⁻² sr⁻¹ nm⁻¹], the daylight spectrum of that colour.

        Args:
            sun_zenith: Zenith angle of the sun [rad].
            view_zenith: Zenith angle of the view direction [rad].
            relative_azimuth: View azimuth minus sun azimuth [rad].
            wavelengths: One axis, each from 300 to 830 [nm].
        """
        colour = self.xyY(sun_zenith, view_zenith, relative_azimuth)
        return daylight_radiance(colour, wavelengths)
