"""Sunlight at the ground: spectral radiance of the disc, its irradiance and its colour.

Preetham, Shirley & Smits (1999), appendix A.1, after Iqbal (1983), "An Introduction to Solar
Radiation": one transmittance each for molecules, haze, ozone, mixed gases and water vapour.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float, as_wavelengths, check
from ..angles import as_zenith
from ..colour import spectrum_to_xyY
from ..constants import SUN_ANGULAR_RADIUS, SUN_SOLID_ANGLE
from ..preetham_air import OZONE_AMOUNT, table2
from ..spectrum import PAPER_WAVELENGTHS


WATER_VAPOUR = 0.02  # m of precipitable water; appendix A.1
ANGSTROM_EXPONENT = 1.3  # of the haze before the sun; appendix A.1
# Ångström's turbidity coefficient is this times T, plus this: the haze's optical depth at 1 µm.
ANGSTROM_COEFFICIENT = (0.04608, -0.04586)


def sunlight(
    turbidity: ArrayLike,
    sun_zenith: ArrayLike,
    wavelengths: ArrayLike,
    *,
    ozone: ArrayLike = OZONE_AMOUNT,
    water_vapour: ArrayLike = WATER_VAPOUR,
    distance_from_centre: ArrayLike | None = None,
) -> Float[Array, "*batch wavelength"]:
    """Spectral radiance of the sun's disc, seen from the ground.

    Given the haze, ozone and water of ASTM G173-03 (air mass 1.5), the direct spectrum of that
    standard comes out within 3 % (root mean square, 400–750 nm, every 10 nm; 8 % at 690 nm, where
    table 2 has no oxygen), 2.7 % darker and within 0.004 in x and y. Most of it is table 2's sun,
    an older one: the transmittance alone is within 2.5 % up to 580 nm.

    Refraction is left out. While the sun sets, the part of the disc below the horizon is dark: the
    mean over the whole disc falls to 0 smoothly as its centre goes from 0.27° above the horizon to
    0.27° below. Air mass is never asked beyond that, where its formula ends.

    Args:
        turbidity: Turbidity T, 1 or more; sets the haze by Ångström's formula.
        sun_zenith: Zenith angle of the centre of the disc, 0 to π [rad].
        wavelengths: Wavelengths on one axis; table 2's are held beyond 380 and 780 nm [nm].
        ozone: Amount of ozone at normal temperature and pressure [m].
        water_vapour: Precipitable water [m].
        distance_from_centre: Place on the disc in radii, 0 to 1, for the radiance there, darker at
            the limb; the mean over the disc if not given.

    Returns:
        Wavelength last [W m⁻² sr⁻¹ nm⁻¹].

    Raises:
        InputError: Turbidity below 1 or NaN; an angle or distance out of its range; wavelengths
            that do not increase.
    """
    lam = as_wavelengths(wavelengths, "sunlight(wavelengths=...)")
    haze = check(
        as_float(turbidity), lambda v: ~(v >= 1), "sunlight(turbidity=...) must be 1 or more"
    )
    sun = as_zenith(sun_zenith, "sunlight(sun_zenith=...)")
    given = [haze, sun, *(as_float(value) for value in (ozone, water_vapour))]
    if distance_from_centre is not None:
        distance = check(
            as_float(distance_from_centre),
            lambda v: ~((v >= 0) & (v <= 1)),
            "sunlight(distance_from_centre=...) must lie in 0 to 1",
        )
        given.append(distance)
    return _sunlight(jnp.broadcast_arrays(*given), lam)


def sun_irradiance(
    turbidity: ArrayLike,
    sun_zenith: ArrayLike,
    wavelengths: ArrayLike,
    *,
    ozone: ArrayLike = OZONE_AMOUNT,
    water_vapour: ArrayLike = WATER_VAPOUR,
) -> Float[Array, "*batch wavelength"]:
    """Spectral irradiance of the sun on a plane that faces it [W m⁻² nm⁻¹].

    The disc's solid angle of 6.80e-5 sr times its mean radiance; arguments as `sunlight`.
    """
    radiance = sunlight(turbidity, sun_zenith, wavelengths, ozone=ozone, water_vapour=water_vapour)
    return SUN_SOLID_ANGLE * radiance


def sun_xyY(turbidity: ArrayLike, sun_zenith: ArrayLike) -> Float[Array, "*batch 3"]:
    """Chromaticity x, y and luminance Y [cd m⁻²] of the disc, from 380 to 780 nm.

    Its illuminance on a plane that faces it [lx] is Y times `skyfit.constants.SUN_SOLID_ANGLE`. A
    sun that has set is black. Arguments as `sunlight`.
    """
    return spectrum_to_xyY(sunlight(turbidity, sun_zenith, PAPER_WAVELENGTHS), PAPER_WAVELENGTHS)


def air_mass(sun_zenith: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """Relative optical mass of the air towards the sun, by Kasten (1965); appendix A.1.

    1 / (cos θₛ + 0.15 (93.885° - θₛ)^-1.253); 36.5 at the horizon, held from 0.27° below it.
    """
    held = jnp.minimum(sun_zenith, np.pi / 2 + SUN_ANGULAR_RADIUS)
    return 1 / (jnp.cos(held) + 0.15 * (93.885 - jnp.degrees(held)) ** -1.253)


def visible_fraction(sun_zenith: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """Share of the disc above the horizon."""
    height = (np.pi / 2 - sun_zenith) / SUN_ANGULAR_RADIUS
    # The ends of arcsin have infinite slopes, whose difference from the root's would be NaN.
    h = jnp.clip(height, -1 + 1e-6, 1 - 1e-6)
    segment = 0.5 + (h * jnp.sqrt(1 - h**2) + jnp.arcsin(h)) / np.pi
    return jnp.where(height >= 1, 1.0, jnp.where(height <= -1, 0.0, segment))


def limb_exponent(wavelengths: Float[Array, "..."] | float) -> Float[Array, "..."] | float:
    """Exponent α of the limb darkening µ^α at wavelengths [nm]; see `limb_darkening`."""
    return -0.023 + 292.0 / wavelengths


def limb_darkening(
    distance_from_centre: Float[Array, "*batch"], wavelengths: Float[Array, " wavelength"]
) -> Float[Array, "*batch wavelength"]:
    """Radiance of the disc over its mean, along its radius.

    µ^α(λ) with µ = √(1 - r²) and α = -0.023 + 0.292 / λ[µm], whose mean over the disc is
    2 / (2 + α). Made for 416 to 1099 nm.

    Source: Hestroffer & Magnan (1998), "Wavelength dependency of the solar limb darkening",
    Astronomy & Astrophysics 333, 338, equation 5.

    Args:
        distance_from_centre: r in radii, 0 to 1.
        wavelengths: Wavelengths of the result [nm].
    """
    alpha = limb_exponent(_last(wavelengths, distance_from_centre.ndim))
    # Above 0, so that the derivative at the very limb is finite.
    square = jnp.maximum(1 - distance_from_centre**2, 1e-6)[..., None]
    return (1 + alpha / 2) * square ** (alpha / 2)


@jax.jit
def _sunlight(given, lam):
    turbidity, sun_zenith, ozone, water_vapour, *distance = given
    depths = optical_depths(turbidity, air_mass(sun_zenith), ozone, water_vapour, lam)
    at_the_top = table2("sun_W_m-2_nm-1_sr-1", _last(lam, sun_zenith.ndim))
    radiance = visible_fraction(sun_zenith)[..., None] * at_the_top * jnp.exp(-sum(depths.values()))
    return radiance * limb_darkening(distance[0], lam) if distance else radiance


def optical_depths(
    turbidity: Float[Array, "*batch"],
    air_mass: Float[Array, "*batch"],
    ozone: Float[Array, "*batch"],
    water_vapour: Float[Array, "*batch"],
    wavelengths: Float[Array, " wavelength"],
) -> dict[str, Float[Array, "*batch wavelength"]]:
    """Slant optical depth of each constituent; the formulas of appendix A.1.

    Args:
        turbidity: T.
        air_mass: Relative optical mass towards the sun.
        ozone: Amount of ozone at normal temperature and pressure [m].
        water_vapour: Precipitable water [m].
        wavelengths: Wavelengths of the result [nm].
    """
    lam = _last(wavelengths, air_mass.ndim)
    m, ozone, water = air_mass[..., None], ozone[..., None], water_vapour[..., None]
    micron = lam / 1000.0
    slope, intercept = ANGSTROM_COEFFICIENT
    beta = slope * turbidity[..., None] + intercept
    gas = table2("k_gas_m-1", lam) * m
    vapour = table2("k_water_m-1", lam) * water * m
    return {
        "molecules": 0.008735 * micron**-4.08 * m,
        "haze": beta * micron**-ANGSTROM_EXPONENT * m,
        "ozone": table2("k_ozone_m-1", lam) * ozone * m,
        "mixed gases": 1.41 * gas / (1 + 118.93 * gas) ** 0.45,
        "water vapour": 0.2385 * vapour / (1 + 20.07 * vapour) ** 0.45,
    }


def _last(wavelengths, rank):
    """Wavelengths as the last axis after `rank` others."""
    return wavelengths.reshape((1,) * rank + wavelengths.shape)
