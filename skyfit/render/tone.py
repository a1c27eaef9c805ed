"""From luminance to what a screen shows: exposure, tone curves, colours no screen has, encoding."""

import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..errors import InputError


TONES = ("linear", "scs", "reinhard", "aces")
GAMUTS = ("desaturate", "clip", "keep")

# Luminance of the sRGB primaries of 1 cd/m² of white: ITU-R BT.709-6, table 3
_LUMINANCE = (0.2126, 0.7152, 0.0722)
_KEY = 0.25  # where automatic exposure puts the geometric mean: skies are bright scenes
_OUTSIDE = 1e-6  # of the largest channel: below it a negative one is a rounding error


def luminance_at(ev: float) -> float:
    """Luminance [cd m⁻²] that an exposure value makes just white.

    1.2 · 2^EV for ISO 100: the saturation-based speed of ISO 12232 with a lens factor of 0.65.
    """
    return 1.2 * 2.0**ev


def automatic_exposure(rgb: Float[np.ndarray, "*shape 3"], weight: np.ndarray) -> float:
    """Exposure value that puts the geometric mean of the luminance at a quarter of white.

    Args:
        rgb: Linear sRGB, (1, 1, 1) being 1 cd m⁻²; black pixels do not count.
        weight: Weight of each pixel in the mean.

    Source: Reinhard, Stark, Shirley & Ferwerda (2002), "Photographic tone reproduction for digital
    images", equation 1, with the key of a bright scene.
    """
    light = luminance(rgb)
    lit = (light > 0) & (weight > 0)
    if not lit.any():
        return 0.0
    mean = float(np.average(np.log(light[lit], dtype=float), weights=weight[lit]))
    return math.log2(math.exp(mean) / _KEY / 1.2)


def luminance(rgb: Float[np.ndarray, "*shape 3"]) -> Float[np.ndarray, "*shape"]:
    """Luminance [cd m⁻²] of linear sRGB, (1, 1, 1) being white of 1 cd m⁻²."""
    return rgb @ np.asarray(_LUMINANCE, rgb.dtype)


class Displayed(NamedTuple):
    """A picture as a screen shows it.

    Attributes:
        pixels: 8 bits, sRGB.
        overexposed: Pixels with a channel above white after the tone curve, held at white.
    """

    pixels: np.ndarray
    overexposed: int


def display(rgb: Float[np.ndarray, "*shape 3"], ev: float, tone: str) -> Displayed:
    """Expose, bend through a tone curve and encode.

    Args:
        rgb: Linear sRGB [cd m⁻²], none negative; see `into_gamut`.
        ev: Exposure value; `luminance_at(ev)` becomes 1 before the curve.
        tone: "linear" cuts at white. "scs": the curve of *Simulating the Colors of the Sky*, which
            encodes by itself. "reinhard": L / (1 + L) on luminance (Reinhard et al. 2002, equation
            3). "aces": Narkowicz's (2016) fit of the ACES curve, channel by channel.
    """
    if tone not in TONES:
        raise InputError(f"display(tone=...): expected one of {', '.join(TONES)}; got {tone!r}")
    pixels, over = _display(as_float(rgb), as_float(1 / luminance_at(ev)).astype(rgb.dtype), tone)
    return Displayed(np.asarray(pixels), int(over))


def tone_curve(rgb: ArrayLike, tone: str) -> Float[Array, "*shape 3"]:
    """Encoded sRGB, above 1 where overexposed, of exposed linear sRGB; see `display`."""
    rgb = as_float(rgb)
    if tone == "scs":
        low = jnp.maximum(rgb * 0.38317, 0.0)
        return jnp.where(rgb < 1.413, _power(low, 1 / 2.2), 1 - jnp.exp(-rgb))
    if tone == "reinhard":
        light = rgb @ jnp.asarray(_LUMINANCE, rgb.dtype)
        rgb = rgb / (1 + jnp.maximum(light, 0.0))[..., None]
    elif tone == "aces":
        rgb = rgb * (2.51 * rgb + 0.03) / (rgb * (2.43 * rgb + 0.59) + 0.14)
    return encode(rgb)


def encode(linear: ArrayLike) -> Float[Array, "*shape"]:
    """The transfer curve of sRGB, IEC 61966-2-1."""
    linear = as_float(linear)
    curved = 1.055 * _power(jnp.maximum(linear, 0.0031308), 1 / 2.4) - 0.055
    return jnp.where(linear <= 0.0031308, 12.92 * linear, curved)


def into_gamut(rgb: Float[np.ndarray, "*shape 3"], gamut: str) -> tuple[np.ndarray, int]:
    """Bring colours that sRGB does not have, those with a negative channel, into it.

    Args:
        rgb: Linear sRGB.
        gamut: "desaturate" mixes in the white of the same luminance until no channel is negative;
            "clip" puts negative channels to 0, which brightens; "keep" leaves them.

    Returns:
        The colours, and how many pixels were outside.
    """
    if gamut not in GAMUTS:
        raise InputError(
            f"into_gamut(gamut=...): expected one of {', '.join(GAMUTS)}; got {gamut!r}"
        )
    fixed, count = _into_gamut(as_float(rgb), gamut)
    return np.asarray(fixed), int(count)


def _power(x, exponent):
    return jnp.exp(exponent * jnp.log(jnp.maximum(x, 1e-30)))


def _jit(static: int) -> Any:
    return lambda function: jax.jit(function, static_argnums=static)


@_jit(2)
def _display(rgb, scale, tone):
    encoded = tone_curve(rgb * scale, tone)
    over = jnp.sum(jnp.any(encoded > 1 + 1e-6, axis=-1))
    return jnp.round(255 * jnp.clip(encoded, 0.0, 1.0)).astype(jnp.uint8), over


@_jit(1)
def _into_gamut(rgb, gamut):
    least, most = jnp.min(rgb, axis=-1), jnp.max(rgb, axis=-1)
    outside = least < -_OUTSIDE * jnp.maximum(most, 0.0)
    if gamut == "clip":
        rgb = jnp.maximum(rgb, 0.0)
    elif gamut == "desaturate":
        grey = jnp.maximum(rgb @ jnp.asarray(_LUMINANCE, rgb.dtype), 0.0)
        gap = grey - least
        share = jnp.where(least < 0, grey / jnp.where(gap > 0, gap, 1.0), 1.0)
        rgb = jnp.maximum(grey[..., None] + share[..., None] * (rgb - grey[..., None]), 0.0)
    return rgb, jnp.sum(outside)
