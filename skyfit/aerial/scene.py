"""What every model of aerial perspective is given: air, a sky, a sun, channels."""

from collections.abc import Callable
from typing import NamedTuple, cast

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, Scalar, Spectrum, as_float, as_scalar, check
from ..atmosphere import Atmosphere, Constituent
from ..colour import xyz_to_rgb, xyz_weights
from ..errors import InputError
from ..models import AbstractSkyModel
from ..preetham_air import preetham_atmosphere
from ..transfer.line_classes import LineClasses, line_classes, side_by_side
from ..transfer.simulate_sky import simulate
from .layers import PAPER_SCALE_HEIGHTS, Layers, exponential_layers


Sky = AbstractSkyModel | Callable[[Array, Array], Array] | None


class Air(NamedTuple):
    """What lies between eye and object.

    Attributes:
        atmosphere: Atmosphere as it was given.
        plain: Atmosphere without bands: a channel for every wavelength and class of lines.
        layers: Exponential layers of the atmosphere without bands.
        classes: Classes of lines, whose channels make up a wavelength.
    """

    atmosphere: Atmosphere
    plain: Atmosphere
    layers: Layers
    classes: LineClasses

    def layers_over(self, length: float) -> Layers:
        """Layers with one coefficient for all classes of lines: their mean over a path [m]."""
        if not self.classes.place:
            return self.layers
        return exponential_layers(_smoothed(self.atmosphere, length))


def layered_air(
    atmosphere: Atmosphere | ArrayLike,
    wavelengths: ArrayLike | None,
    ground_albedo: ArrayLike | None,
    caller: str,
) -> Air:
    """An atmosphere, or that of a turbidity, and its exponential layers.

    Raises:
        InputError: Bad turbidity; wavelengths or albedo beside an atmosphere, which has its own.
    """
    if not isinstance(atmosphere, Atmosphere):
        air = preetham_atmosphere(
            as_scalar(atmosphere, f"{caller}(atmosphere=...)"),
            wavelengths=wavelengths,
            ground_albedo=0.0 if ground_albedo is None else ground_albedo,
        )
        layers = Layers(as_float(list(PAPER_SCALE_HEIGHTS)), air.extinction)
        return Air(air, air, layers, line_classes(air))
    for name, value in (("wavelengths", wavelengths), ("ground_albedo", ground_albedo)):
        if value is not None:
            raise InputError(f"{caller}({name}=...): the atmosphere has its own; got {value!r}")
    plain, classes = side_by_side(atmosphere)
    return Air(atmosphere, plain, exponential_layers(plain), classes)


def _smoothed(atmosphere: Atmosphere, length: float) -> Atmosphere:
    """An atmosphere whose bands are absorption that dims a path at density 1 as they do."""

    def smooth(one: Constituent) -> Constituent:
        if one.bands is None:
            return one
        absorption = one.absorption + one.bands.optical_depth(length) / length
        return eqx.tree_at(
            lambda c: (c.absorption, c.bands), one, (absorption, None), is_leaf=lambda x: x is None
        )

    changed = tuple(map(smooth, atmosphere.constituents))
    return eqx.tree_at(lambda a: a.constituents, atmosphere, changed)


def one_sun(sun_zenith: ArrayLike, caller: str) -> Scalar:
    """The sun's zenith angle, checked [rad]."""
    sun = as_scalar(sun_zenith, f"{caller}(sun_zenith=...)")
    message = f"{caller}(sun_zenith=...) must lie in [0, pi] rad"
    return check(sun, lambda v: ~((v >= 0) & (v <= np.pi + 1e-6)), message)


def check_channels(channels: str, caller: str) -> None:
    """Refuse channels that are neither spectral nor RGB."""
    if channels not in ("spectral", "rgb"):
        raise InputError(f"{caller}(channels=...): expected 'spectral' or 'rgb'; got {channels!r}")


def sky_radiance(
    sky: Sky, air: Atmosphere, sun: Scalar, zenith: np.ndarray, azimuth: np.ndarray, caller: str
) -> Float[Array, "direction wavelength"]:
    """Radiance of a sky in directions; with None, that of the air by a simulation of two orders."""
    view = as_float(zenith), as_float(azimuth)
    if sky is None:
        return simulate(air, sun, *view).radiance
    if isinstance(sky, AbstractSkyModel):
        light = sky.radiance(sun, *view, air.wavelengths)
    else:
        light = as_float(cast(Callable, sky)(*view))
    expected = (zenith.size, air.wavelengths.size)
    if light.shape != expected:
        raise InputError(
            f"{caller}(sky=...): expected radiance of shape {expected}, direction by wavelength; "
            f"got {light.shape}"
        )
    return light


def rgb_weights(wavelengths: Spectrum) -> Float[Array, "wavelength 3"]:
    """Weights that turn a spectral radiance into linear sRGB."""
    return xyz_to_rgb(xyz_weights(wavelengths))


def mean_by_response(
    coefficient: Float[Array, "*batch wavelength"], air: Atmosphere
) -> Float[Array, "*batch 3"]:
    """Mean of a coefficient over each primary's response to sunlight above the air.

    With it the colours of short paths are right, and those of long ones nearly so.
    """
    response = rgb_weights(air.wavelengths) * air.solar_irradiance[:, None]
    return jnp.maximum(coefficient @ (response / jnp.sum(response, axis=0)[None]), 0.0)
