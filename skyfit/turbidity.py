"""Turbidity from what is easier to observe, and back: visibility, haze, brightness of the zenith.

Turbidity T is the optical thickness of air and haze over that of the air alone, at 550 nm
(Preetham, Shirley & Smits 1999, section 2.1). Air and haze are those of
`skyfit.preetham_atmosphere`: the U.S. Standard Atmosphere, and Elterman's haze to 32 km, whose
density at the ground over its column turns thickness into visibility there.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ._typing import ArrayLike, as_float, as_parameter, check
from .constants import TOP_OF_ATMOSPHERE, TURBIDITY_WAVELENGTH
from .errors import InputError
from .models.preetham import TURBIDITY_RANGE, ZENITH_ANGLE, ZENITH_LUMINANCE
from .models.scale import TangentZenith
from .preetham_air import TurbidityMeaning, haze_scattering, rayleigh_scattering
from .profile import StandardAtmosphere, elterman_haze
from .sun.light import ANGSTROM_EXPONENT


CONTRAST = 0.02  # least contrast an observer makes out; section 2.1
LOWEST_SUN = math.radians(80.0)  # below it, two turbidities can have the same zenith luminance


def meteorological_range(
    turbidity: ArrayLike,
    *,
    turbidity_means: TurbidityMeaning = "optical thickness",
    contrast: float = CONTRAST,
) -> Float[Array, "..."]:
    """Distance at which a black target against the horizon fades, by Koschmieder's law [m].

    -ln(contrast) over the extinction at the ground at 550 nm: 45.5 km at T = 2, 288 km in pure air.

    Args:
        turbidity: T, 1 or more.
        turbidity_means: Meaning of turbidity, as for `skyfit.preetham_atmosphere`; with
            "coefficients" the range is 42 km at T = 2.
        contrast: 0.02 for the meteorological range; 0.05 for the meteorological optical range that
            weather stations report as visibility.

    Raises:
        InputError: Turbidity below 1 or NaN; an unknown meaning; a contrast outside 0 to 1.
    """
    value = _at_least_one(turbidity, "meteorological_range")
    air, slope, intercept = _extinction_line(turbidity_means, "meteorological_range")
    return _threshold(contrast, "meteorological_range") / (air + slope * value + intercept)


def from_meteorological_range(
    distance: ArrayLike,
    *,
    turbidity_means: TurbidityMeaning = "optical thickness",
    contrast: float = CONTRAST,
) -> Float[Array, "..."]:
    """Turbidity at which targets fade at a distance [m]: the inverse of `meteorological_range`.

    Other arguments as there. A distance beyond that of pure air gives a turbidity below 1.

    Raises:
        InputError: A distance that is not above 0; an unknown meaning; a contrast outside 0 to 1.
    """
    distance = check(
        as_float(distance),
        lambda v: ~(v > 0),
        "from_meteorological_range(distance=...) must be above 0 m",
    )
    air, slope, intercept = _extinction_line(turbidity_means, "from_meteorological_range")
    extinction = _threshold(contrast, "from_meteorological_range") / distance
    return (extinction - air - intercept) / slope


def aerosol_optical_depth(
    turbidity: ArrayLike,
    wavelength: ArrayLike = TURBIDITY_WAVELENGTH,
    *,
    angstrom_exponent: ArrayLike = ANGSTROM_EXPONENT,
) -> Float[Array, "..."]:
    """Vertical optical depth of the haze: T - 1 times the air's at 550 nm, there.

    Args:
        turbidity: T, 1 or more.
        wavelength: Wavelength of the optical depth [nm].
        angstrom_exponent: α by which the depth goes as wavelength^-α.

    Raises:
        InputError: Turbidity below 1 or NaN.
    """
    value = _at_least_one(turbidity, "aerosol_optical_depth")
    spectral = (as_float(wavelength) / TURBIDITY_WAVELENGTH) ** -as_float(angstrom_exponent)
    return (value - 1) * _air_optical_depth() * spectral


def from_aerosol_optical_depth(
    optical_depth: ArrayLike,
    wavelength: ArrayLike = TURBIDITY_WAVELENGTH,
    *,
    angstrom_exponent: ArrayLike = ANGSTROM_EXPONENT,
) -> Float[Array, "..."]:
    """Turbidity of a haze of an optical depth: the inverse of `aerosol_optical_depth`.

    A sun photometer's 0.1 at 500 nm, for instance, is T = 1.77. Other arguments as there.

    Raises:
        InputError: A depth below 0.
    """
    depth = check(
        as_float(optical_depth),
        lambda v: ~(v >= 0),
        "from_aerosol_optical_depth(optical_depth=...) must be 0 or more",
    )
    spectral = (as_float(wavelength) / TURBIDITY_WAVELENGTH) ** as_float(angstrom_exponent)
    return 1 + depth * spectral / _air_optical_depth()


def from_zenith_luminance(luminance: ArrayLike, sun_zenith: ArrayLike) -> Float[Array, "..."]:
    """Turbidity at which the published zenith luminance has a value.

    The inverse of `skyfit.preetham_sky(turbidity).xyY(sun_zenith, 0, 0)[..., 2]` in turbidity, on
    the 1.9 to 10 for which that holds; a darker or brighter zenith is given the nearest end.

    Args:
        luminance: Luminance of the zenith [cd m⁻²].
        sun_zenith: Zenith angle of the sun, at most 80°: below, haze dims the zenith as well [rad].

    Raises:
        InputError: A sun lower than that.

    Source: Preetham et al. (1999), appendix A.2; solved by bisection, with the derivatives of the
    exact solution.
    """
    sun = check(
        as_float(sun_zenith),
        lambda v: ~((v >= 0) & (v <= LOWEST_SUN + 1e-6)),
        "from_zenith_luminance(sun_zenith=...) must lie in 0 to 80° (1.3963)",
    )
    return _zenith_turbidity(*jnp.broadcast_arrays(as_float(luminance), sun))


@jax.jit
def _zenith_turbidity(luminance, sun):
    zenith = TangentZenith(
        jnp.asarray(ZENITH_LUMINANCE, sun.dtype), jnp.asarray(ZENITH_ANGLE, sun.dtype)
    )

    def halve(ends, _):
        low, high = ends
        middle = (low + high) / 2
        brighter = zenith(middle, sun) > luminance
        return (jnp.where(brighter, low, middle), jnp.where(brighter, middle, high)), None

    low, high = (jnp.full_like(sun, end) for end in TURBIDITY_RANGE)
    (low, high), _ = jax.lax.scan(halve, (low, high), length=50)
    root = jax.lax.stop_gradient((low + high) / 2)
    # A last step of Newton's, which carries the derivatives of the implicit function.
    (_, slope) = jax.jvp(lambda t: zenith(t, sun), (root,), (jnp.ones_like(root),))
    polished = root - (zenith(root, sun) - luminance) / jax.lax.stop_gradient(slope)
    return jnp.clip(polished, *TURBIDITY_RANGE)


def _at_least_one(turbidity, name):
    message = f"{name}(turbidity=...) must be 1 or more"
    return check(as_float(turbidity), lambda v: ~(v >= 1), message)


def _threshold(contrast, name):
    if not 0 < contrast < 1:
        raise InputError(f"{name}(contrast=...) must lie between 0 and 1; got {contrast}")
    return -math.log(contrast)


def _extinction_line(meaning, name):
    """At the ground at 550 nm [m⁻¹]: the air's, and slope and intercept over T of the haze's."""
    at = as_parameter(TURBIDITY_WAVELENGTH)
    air = rayleigh_scattering(at)
    if meaning == "optical thickness":
        slope = _air_optical_depth() / elterman_haze().column(TOP_OF_ATMOSPHERE)
        return air, slope, -slope
    if meaning == "coefficients":
        one, two = (haze_scattering(t, at) for t in (1.0, 2.0))
        return air, two - one, 2 * one - two
    expected = "'optical thickness' or 'coefficients'"
    raise InputError(f"{name}(turbidity_means=...): expected {expected}; got {meaning!r}")


def _air_optical_depth():
    """Vertical optical depth of the air at 550 nm."""
    column = StandardAtmosphere().column(TOP_OF_ATMOSPHERE)
    return rayleigh_scattering(as_parameter(TURBIDITY_WAVELENGTH)) * column
