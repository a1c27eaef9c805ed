"""What direction does to the colour of the air: Preetham et al. (1999), figure 8, in numbers."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..colour import D65_WHITE, spectrum_to_xyY
from ..models import preetham_sky
from .constant import ward_larson_aerial
from .perspective import aerial_perspective


EAST, WEST = np.pi, 0.0  # azimuth from the setting sun
LOW_SUN = float(np.radians(85.0))  # half an hour before a summer's sunset in middle latitudes


class Airlight(NamedTuple):
    """Colour of the air before a black object, over distance.

    Attributes:
        xyY: Chromaticity and luminance [cd m⁻²].
        hue: CIE 1976 u'v' hue angle about D65 [rad]; 0 is red, π/2 yellow, -π/2 blue.
    """

    xyY: Float[Array, "distance 3"]
    hue: Float[Array, " distance"]


class Sunset(NamedTuple):
    """Airlight to the east and to the west, by the paper's model and by Ward-Larson's.

    Attributes:
        east: Air away from the sun.
        west: Air towards the sun.
        constant: Air by Ward-Larson's model, which knows no direction.
        hue_shift: Turn of the hue from east to west, in (-π, π] [rad].
        chroma_shift: Distance between east and west in the u'v' plane.
    """

    east: Airlight
    west: Airlight
    constant: Airlight
    hue_shift: Float[Array, " distance"]
    chroma_shift: Float[Array, " distance"]


def sunset_airlight(
    distance: ArrayLike,
    turbidity: ArrayLike = 6.0,
    sun_zenith: ArrayLike = LOW_SUN,
    observer_altitude: ArrayLike = 100.0,
) -> Sunset:
    """Level views east and west under the published sky, half an hour before sunset by default.

    Args:
        distance: Distance to black objects, one axis [m].
        turbidity: T.
        sun_zenith: Zenith angle of the sun [rad].
        observer_altitude: Altitude of the eye [m].
    """
    far, sky = jnp.atleast_1d(as_float(distance)), preetham_sky(turbidity)
    model = aerial_perspective(turbidity, sky, sun_zenith)
    east, west = (
        _airlight(model.inscatter(far, np.pi / 2, side, observer_altitude), model.wavelengths)
        for side in (EAST, WEST)
    )
    constant = ward_larson_aerial(turbidity, sky, sun_zenith)
    same = _airlight(constant.inscatter(far, np.pi / 2, EAST), model.wavelengths)
    turn = jnp.mod(west.hue - east.hue + np.pi, 2 * np.pi) - np.pi
    apart = jnp.linalg.norm(_uv(west.xyY) - _uv(east.xyY), axis=-1)
    return Sunset(east, west, same, turn, apart)


def _airlight(radiance, wavelengths) -> Airlight:
    colour = spectrum_to_xyY(radiance, wavelengths)
    u, v = jnp.moveaxis(_uv(colour) - _uv(as_float([*D65_WHITE, 1.0]))[None], -1, 0)
    return Airlight(colour, jnp.arctan2(v, u))


def _uv(xyY: Float[Array, "*batch 3"]) -> Float[Array, "*batch 2"]:
    """CIE 1976 u', v' of chromaticities; CIE 015:2018, equation 8.31."""
    x, y = xyY[..., 0], xyY[..., 1]
    below = 12 * y - 2 * x + 3
    return jnp.stack([4 * x / below, 9 * y / below], axis=-1)
