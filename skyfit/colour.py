"""From spectra to colour and back: CIE XYZ, xyY, linear sRGB, daylight spectra.

Colours are absolute: Y is the luminance in cd m⁻² of a spectral radiance in W m⁻² sr⁻¹ nm⁻¹. The
observer is the CIE 1931 2° standard observer. The colour axis is last.
"""

from functools import cache

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._typing import ArrayLike, as_float, as_wavelengths
from .constants import LUMINOUS_EFFICACY
from .errors import InputError
from .spectrum import daylight_basis, daylight_table, product_weights


PAPER_CHANNELS = ("Y", "x", "y")  # in the order of the paper's tables; `xyY` has its own

# ITU-R BT.709-6 / IEC 61966-2-1: chromaticities of the primaries and of the D65 white
SRGB_PRIMARIES = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
D65_WHITE = (0.3127, 0.3290)

# M1 and M2 over their common denominator, in (1, x, y): Preetham et al. (1999), appendix A.5
DAYLIGHT_DENOMINATOR = (0.0241, 0.2562, -0.7341)
DAYLIGHT_M1 = (-1.3515, -1.7703, 5.9114)
DAYLIGHT_M2 = (0.0300, -31.4424, 30.0717)


@cache
def matching_functions() -> tuple[np.ndarray, np.ndarray]:
    """Wavelengths [471] in nm and colour-matching functions [471, 3], 360 to 830 nm; read-only."""
    from colour.colorimetry import MSDS_CMFS

    table = MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    wavelengths, values = np.array(table.wavelengths), np.array(table.values)
    wavelengths.flags.writeable = values.flags.writeable = False
    return wavelengths, values


def xyz_weights(wavelengths: ArrayLike) -> Float[Array, "wavelength 3"]:
    """Weights that turn a spectral radiance into CIE XYZ by one matrix product.

    683.002 lm/W times the exact integral of the colour-matching functions (linear between their
    1 nm steps) against a spectrum that is linear between its wavelengths and 0 outside them.

    Args:
        wavelengths: Two or more, increasing [nm].

    Returns:
        [cd m⁻² per W m⁻² sr⁻¹ nm⁻¹].

    Raises:
        InputError: Fewer than two wavelengths, or not increasing.
    """
    lam = as_wavelengths(wavelengths, "xyz_weights(wavelengths=...)")
    if lam.size < 2:
        raise InputError("xyz_weights(wavelengths=...): expected two or more; got one")
    nodes, curves = matching_functions()
    nodes, curves = jnp.asarray(nodes, lam.dtype), jnp.asarray(curves, lam.dtype)
    return LUMINOUS_EFFICACY * product_weights(lam, nodes, curves)


def spectrum_to_xyz(radiance: ArrayLike, wavelengths: ArrayLike) -> Float[Array, "*batch 3"]:
    """CIE XYZ of spectral radiances.

    Args:
        radiance: Wavelength last [W m⁻² sr⁻¹ nm⁻¹].
        wavelengths: Wavelengths, increasing; `xyz_weights` says what is assumed between [nm].

    Returns:
        X, Y, Z on the last axis [cd m⁻²].

    Raises:
        InputError: The last axis of `radiance` is not as long as `wavelengths`.
    """
    light, weights = as_float(radiance), xyz_weights(wavelengths)
    if light.ndim == 0 or light.shape[-1] != weights.shape[0]:
        raise InputError(
            f"spectrum_to_xyz(radiance=...): expected {weights.shape[0]} wavelengths on the last "
            f"axis; got shape {light.shape}"
        )
    return light @ weights.astype(light.dtype)


def luminance(radiance: ArrayLike, wavelengths: ArrayLike) -> Float[Array, "*batch"]:
    """Luminance [cd m⁻²] of spectral radiances; arguments as `spectrum_to_xyz`."""
    return spectrum_to_xyz(radiance, wavelengths)[..., 1]


def xyz_to_xyY(xyz: ArrayLike) -> Float[Array, "*batch 3"]:
    """Chromaticity x, y and luminance Y of tristimulus values.

    Black has no chromaticity; it is given that of D65, with no gradient.
    """
    xyz = as_float(xyz)
    total = xyz.sum(axis=-1)
    lit = total > 0
    safe = jnp.where(lit, total, 1.0)
    x = jnp.where(lit, xyz[..., 0] / safe, D65_WHITE[0])
    y = jnp.where(lit, xyz[..., 1] / safe, D65_WHITE[1])
    return jnp.stack([x, y, xyz[..., 1]], axis=-1)


def xyY_to_xyz(xyY: ArrayLike) -> Float[Array, "*batch 3"]:
    """Tristimulus values of a chromaticity and a luminance; y must be above 0, or black results."""
    x, y, luminance = jnp.moveaxis(as_float(xyY), -1, 0)
    real = y > 0
    scale = jnp.where(real, luminance, 0.0) / jnp.where(real, y, 1.0)
    return jnp.stack([scale * x, scale * y, scale * (1 - x - y)], axis=-1)


@cache
def srgb_matrix() -> np.ndarray:
    """Matrix from XYZ to linear sRGB, from the primaries and D65, so that white is (1, 1, 1).

    The rounded matrix that IEC 61966-2-1 prints differs from it by up to 1e-4.
    """

    def tristimulus(x, y):
        return np.array([x / y, 1.0, (1 - x - y) / y])

    primaries = np.stack([tristimulus(*xy) for xy in SRGB_PRIMARIES], axis=1)
    scale = np.linalg.solve(primaries, tristimulus(*D65_WHITE))
    matrix = np.linalg.inv(primaries * scale)
    matrix.flags.writeable = False
    return matrix


def xyz_to_rgb(xyz: ArrayLike) -> Float[Array, "*batch 3"]:
    """Linear sRGB of tristimulus values; D65 white of 1 cd m⁻² is (1, 1, 1). Not clipped."""
    xyz = as_float(xyz)
    return xyz @ jnp.asarray(srgb_matrix().T, xyz.dtype)


def rgb_to_xyz(rgb: ArrayLike) -> Float[Array, "*batch 3"]:
    """Tristimulus values [cd m⁻²] of linear sRGB, the inverse of `xyz_to_rgb`."""
    rgb = as_float(rgb)
    return rgb @ jnp.asarray(np.linalg.inv(srgb_matrix()).T, rgb.dtype)


def daylight_radiance(
    xyY: ArrayLike,
    wavelengths: ArrayLike,
) -> Float[Array, "*batch wavelength"]:
    """Spectral radiance of daylight of a chromaticity and a luminance.

    S0 + M1 S1 + M2 S2 scaled so that its luminance over 300–830 nm is Y. On the daylight locus the
    chromaticity comes back within 2e-4, as well as the published coefficients of M1 and M2 allow.
    Far from it the sum would turn negative at short wavelengths and is held at 0: in the published
    sky only within some degrees of a sun below 10° elevation, where it raises the luminance by
    less than 0.1 % and shifts the chromaticity by up to 0.024.

    Source: Preetham et al. (1999), appendix A.5, after Wyszecki & Stiles (1982).

    Args:
        xyY: Chromaticity and luminance [cd m⁻²] on the last axis.
        wavelengths: Wavelengths on one axis, each from 300 to 830 [nm].

    Returns:
        Wavelength last [W m⁻² sr⁻¹ nm⁻¹].
    """
    colour = as_float(xyY)
    basis = jnp.atleast_2d(daylight_basis(wavelengths)).astype(colour.dtype)
    return _daylight(colour, basis, jnp.asarray(daylight_luminances(), colour.dtype))


@jax.jit
def _daylight(xyY, basis, luminances):
    # Multiplied by the denominator of M1 and M2, the spectrum has no pole where that vanishes.
    plane = jnp.asarray([DAYLIGHT_DENOMINATOR, DAYLIGHT_M1, DAYLIGHT_M2], xyY.dtype)
    x, y, luminance = xyY[..., 0], xyY[..., 1], xyY[..., 2]
    mix = jnp.stack([jnp.ones_like(x), x, y], axis=-1) @ plane.T
    relative = mix @ luminances
    lit = relative != 0
    scale = jnp.where(lit, luminance, 0.0) / jnp.where(lit, relative, 1.0)
    return jnp.maximum(scale[..., None] * (mix @ basis.T), 0.0)


@cache
def daylight_luminances() -> np.ndarray:
    """Luminance of each daylight basis function, 300–830 nm [3]; read-only."""
    nodes, values = daylight_table()
    cmf_at, cmf = matching_functions()
    fine = np.union1d(nodes, cmf_at)
    left, right = fine[:-1], fine[1:]
    total = np.zeros(values.shape[1])
    for at, share in ((left, 1 / 6), ((left + right) / 2, 4 / 6), (right, 1 / 6)):
        y_bar = np.interp(at, cmf_at, cmf[:, 1], left=0.0, right=0.0)
        basis = np.stack([np.interp(at, nodes, column) for column in values.T], axis=1)
        total += (share * (right - left) * y_bar) @ basis
    total *= LUMINOUS_EFFICACY
    total.flags.writeable = False
    return total


def spectrum_to_xyY(radiance: ArrayLike, wavelengths: ArrayLike) -> Float[Array, "*batch 3"]:
    """Chromaticity and luminance of spectral radiances; arguments as `spectrum_to_xyz`."""
    return xyz_to_xyY(spectrum_to_xyz(radiance, wavelengths))
