"""Rays of the tutorial's cameras, its tone curve, and its sequence from noon to dusk."""

from collections.abc import Iterator

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from .air import MarchedAir
from .march import march
from .sky import EYE_HEIGHT


FRAMES = 128
LAST_SUN = 0.6 * np.pi  # rad from the zenith: 18° below the horizon


def fisheye_rays(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Directions of a square picture of the whole sky, looking up.

    The tutorial's projection, 1 - cos θ = r² with r the distance from the middle, shows equal solid
    angles as equal areas. The first row is the south, the first column the west.

    Returns:
        Unit vectors [size, size, 3], z up. Whether a pixel shows the sky [size, size].
    """
    x, y = np.meshgrid(*[2 * (np.arange(size) + 0.5) / size - 1] * 2)
    square = x**2 + y**2
    shown = square <= 1
    cosine = 1 - np.minimum(square, 1.0)
    azimuth, sine = np.arctan2(y, x), np.sqrt(1 - cosine**2)
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], axis=-1), shown


def camera_rays(
    width: int, height: int, field_of_view: float, pitch: float = 0.0, heading: float = 0.0
) -> np.ndarray:
    """Directions through the pixels of an ordinary camera, the top row first.

    Args:
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
        field_of_view: Vertical angle [rad].
        pitch: Angle of the axis above the level [rad].
        heading: Azimuth of the axis, from x towards y [rad].

    Returns:
        Unit vectors [height, width, 3], z up.
    """
    half = np.tan(field_of_view / 2)
    right = (2 * (np.arange(width) + 0.5) / width - 1) * half * width / height
    above = (1 - 2 * (np.arange(height) + 0.5) / height) * half
    right, above = np.meshgrid(right, above)
    forward = np.cos(pitch) - np.sin(pitch) * above
    up = np.sin(pitch) + np.cos(pitch) * above
    x = forward * np.cos(heading) + right * np.sin(heading)
    y = forward * np.sin(heading) - right * np.cos(heading)
    rays = np.stack([x, y, up], axis=-1)
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def tone_map(light: ArrayLike) -> Float[Array, "*batch 3"]:
    """The tutorial's curve from light to a display's values in [0, 1].

    (0.38317 L)^(1/2.2) below 1.413 and 1 - e^{-L} above, for its sun of 20.
    """
    light = jnp.maximum(as_float(light), 0.0)
    dark = light < 1.413
    low = (0.38317 * jnp.where(dark & (light > 0), light, 1.0)) ** (1 / 2.2)
    return jnp.where(dark, jnp.where(light > 0, low, 0.0), 1 - jnp.exp(-light))


def day_frames(
    air: MarchedAir, size: int = 512, frames: int = FRAMES
) -> Iterator[tuple[float, Array]]:
    """The sky through a fisheye from the sun overhead to 18° below the horizon.

    Args:
        air: Air that `scs_air` makes.
        size: Side of the square pictures [pixels].
        frames: Number of frames.

    Yields:
        Zenith angle of the sun [rad], and the picture's light [size, size, 3]; 0 off the sky.
    """
    rays, shown = fisheye_rays(size)
    rays, mask = as_float(rays), jnp.asarray(shown)[..., None]
    eye = jnp.asarray([0.0, 0.0, EYE_HEIGHT], rays.dtype)
    for angle in np.linspace(0.0, LAST_SUN, frames):
        sun = jnp.asarray([np.sin(angle), 0.0, np.cos(angle)], rays.dtype)
        light, _ = march(air, eye, rays, sun)
        yield float(angle), jnp.where(mask, light, 0.0)
