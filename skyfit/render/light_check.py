"""Light that cannot be is refused: a picture of it would look like one."""

import numpy as np
from jaxtyping import Bool, Float

from ..errors import InputError
from .sources import AbstractSource
from .tone import luminance


_ROUNDING = 1e-5  # of the brightest pixel beside the sun's


def refuse_impossible_light(
    rgb: Float[np.ndarray, "row column 3"], weight: Float[np.ndarray, "row column"], what: str
) -> None:
    """Expect finite light everywhere, and no luminance below 0.

    Args:
        rgb: Linear sRGB [cd m⁻²]. Channels may be negative: colours that sRGB does not have.
        weight: Weight of each pixel; 0 where the sun's disc is, whose rounding is larger than other
            pixels' light.
        what: Name of what is seen, for the message.

    Raises:
        InputError: There is other light.
    """
    broken = np.any(~np.isfinite(rgb), axis=-1)
    if broken.any():
        raise InputError(
            f"{what}: expected finite light; got NaN or infinity in {_some(broken)} pixels"
        )
    light = luminance(rgb)
    rounding = _ROUNDING * np.max(np.abs(rgb[weight > 0]), initial=0.0)
    below = light < -rounding
    if below.any():
        raise InputError(
            f"{what}: expected a luminance of 0 cd/m2 or more; got {light.min():.4g} at worst, "
            f"below 0 in {_some(below)} pixels"
        )


def refuse_black_day(
    source: AbstractSource,
    sun_zenith: float,
    rgb: Float[np.ndarray, "row column 3"],
    sky: Bool[np.ndarray, "row column"],
) -> None:
    """Expect light in a sky that the sun shines on.

    Args:
        source: The sky.
        sun_zenith: Zenith angle of the sun [rad].
        rgb: Linear sRGB, finite.
        sky: Mask of the pixels of the sky alone, above the horizontal.

    Raises:
        InputError: There is none.
    """
    if sky.any() and source.is_day(sun_zenith) and not (luminance(rgb[sky]) > 0).any():
        raise InputError(
            f"{source.name}: expected a bright sky under a sun "
            f"{90 - np.degrees(sun_zenith):.4g} deg high; got a black one"
        )


def _some(pixels: np.ndarray | np.bool) -> str:
    return f"{np.count_nonzero(pixels)} of {pixels.size}"
