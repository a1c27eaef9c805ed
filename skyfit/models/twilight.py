"""What a formula made for day gives when the sun is below the horizon."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float


TWILIGHT_DECAY = math.log(10) / math.radians(2.5)  # per radian of the sun's depression


def daytime_sun(sun_zenith: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """The sun's zenith angle, held at the horizon while it is below [rad]."""
    return jnp.clip(sun_zenith, 0.0, math.pi / 2)


def dimming(sun_zenith: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """Luminance over that of sunset: 1 by day, then a tenth for every 2.5° of depression."""
    return jnp.exp(-TWILIGHT_DECAY * (jnp.maximum(sun_zenith, math.pi / 2) - math.pi / 2))
