"""Broadband light of a clear sky on the ground: the whole solar spectrum, from a few numbers."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float, check
from ..angles import as_zenith
from .light import ANGSTROM_COEFFICIENT, ANGSTROM_EXPONENT, air_mass, visible_fraction


SOLAR_CONSTANT = 1364.0  # W m^-2; Bird & Hulstrom (1981)
OZONE = 0.35  # cm; as in `skyfit.sun.light`
WATER_VAPOUR = 2.0  # cm; likewise
FORWARD_SHARE = 0.84  # of the light that haze scatters; Bird & Hulstrom (1981)


class Irradiance(NamedTuple):
    """Light on the ground over the whole spectrum [W m⁻²].

    Attributes:
        direct_normal: The sun's, on a plane that faces it.
        diffuse_horizontal: The sky's without its sun, on a horizontal plane.
    """

    direct_normal: Float[Array, "*batch"]
    diffuse_horizontal: Float[Array, "*batch"]


def clear_sky_irradiance(
    turbidity: ArrayLike, sun_zenith: ArrayLike, *, ground_albedo: ArrayLike = 0.2
) -> Irradiance:
    """Direct and diffuse irradiance under a clear sky by Bird's model.

    The haze is that of `skyfit.sunlight`; 0.35 cm of ozone, 2 cm of water vapour, sea level.

    Args:
        turbidity: T, 1 or more.
        sun_zenith: Zenith angle of the sun; once it has set both are 0 [rad].
        ground_albedo: Albedo of the ground, which lights the sky from below.

    Raises:
        InputError: Turbidity below 1 or NaN; an angle out of its range.

    Source: Bird & Hulstrom (1981), "A simplified clear sky model for direct and diffuse insolation
    on horizontal surfaces", SERI/TR-642-761.
    """
    value = check(
        as_float(turbidity),
        lambda v: ~(v >= 1),
        "clear_sky_irradiance(turbidity=...) must be 1 or more",
    )
    sun = as_zenith(sun_zenith, "clear_sky_irradiance(sun_zenith=...)")
    given = (value, sun, as_float(ground_albedo))
    return bird(*jnp.broadcast_arrays(*given))


@jax.jit
def bird(
    turbidity: Float[Array, "*batch"],
    sun_zenith: Float[Array, "*batch"],
    ground_albedo: Float[Array, "*batch"],
) -> Irradiance:
    """The formulas of `clear_sky_irradiance`, whose arguments these are."""
    m = air_mass(sun_zenith)
    cosine = jnp.maximum(jnp.cos(sun_zenith), 0.0)
    ozone, water = OZONE * m, WATER_VAPOUR * m
    rayleigh = jnp.exp(-0.0903 * m**0.84 * (1 + m - m**1.01))
    ozone_left = (
        1
        - 0.1611 * ozone * (1 + 139.48 * ozone) ** -0.3035
        - 0.002715 * ozone / (1 + 0.044 * ozone + 0.0003 * ozone**2)
    )
    gases = jnp.exp(-0.0127 * m**0.26)
    water_left = 1 - 2.4959 * water / ((1 + 79.034 * water) ** 0.6828 + 6.385 * water)
    depth = _haze_depth(turbidity)
    haze = jnp.exp(-(depth**0.873) * (1 + depth - depth**0.7088) * m**0.9108)
    absorbed = 1 - 0.1 * (1 - m + m**1.06) * (1 - haze)  # left after absorption by the haze
    scattered = haze / absorbed  # left after scattering by it
    direct = SOLAR_CONSTANT * 0.9662 * rayleigh * ozone_left * gases * water_left * haze
    direct = direct * visible_fraction(sun_zenith)
    sky = (
        (SOLAR_CONSTANT * 0.79 * cosine)
        * (ozone_left * gases * water_left * absorbed)
        * (0.5 * (1 - rayleigh) + FORWARD_SHARE * (1 - scattered))
        / (1 - m + m**1.02)
    )
    sky_albedo = 0.0685 + (1 - FORWARD_SHARE) * (1 - scattered)
    total = (direct * cosine + sky) / (1 - ground_albedo * sky_albedo)
    return Irradiance(direct, jnp.maximum(total - direct * cosine, 0.0))


def _haze_depth(turbidity):
    """Broadband optical depth of the haze, from those at 380 and 500 nm."""
    slope, intercept = ANGSTROM_COEFFICIENT
    at_380, at_500 = (
        (slope * turbidity + intercept) * (nm / 1000.0) ** -ANGSTROM_EXPONENT
        for nm in (380.0, 500.0)
    )
    return 0.2758 * at_380 + 0.35 * at_500
