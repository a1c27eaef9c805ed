"""Real spherical harmonics of a sky, and the light on planes that follows from them.

Orthonormal, in the order l² + l + m, without the Condon–Shortley phase: Y₁,₋₁, Y₁₀, Y₁₁ are
√(3/4π) times y, z, x. As in Ramamoorthi & Hanrahan (2001), "An efficient representation for
irradiance environment maps".
"""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..errors import InputError
from ..transfer.harmonics import legendre
from .dome import Dome


def real_harmonics(direction: ArrayLike, order: int = 2) -> Float[Array, "*batch {(order+1)**2}"]:
    """Values of the harmonics of degree 0 to `order` in directions.

    Args:
        direction: Directions as unit vectors, components on the last axis.
        order: Highest degree l, 0 or more.

    Raises:
        InputError: A negative order; components that are not three.
    """
    vectors = as_float(direction)
    if order < 0:
        raise InputError(f"real_harmonics(order=...) must be 0 or more; got {order}")
    if vectors.ndim == 0 or vectors.shape[-1] != 3:
        raise InputError(
            f"real_harmonics(direction=...): expected three components on the last axis; got shape "
            f"{vectors.shape}"
        )
    x, y, z = jnp.moveaxis(vectors, -1, 0)
    # With 1 for the sine these are P̄_lm / sin^m, polynomials; the powers of x + iy carry the rest,
    # smooth at the zenith as well.
    columns = legendre(order, order, z, jnp.ones_like(z))
    values, real, imaginary = {}, jnp.ones_like(x), jnp.zeros_like(x)
    for m in range(order + 1):
        for degree in range(m, order + 1):
            scale = math.sqrt((2 * degree + 1) / (4 * math.pi))
            column = scale * columns[m, degree]
            values[degree, m] = column * real
            if m > 0:
                values[degree, -m] = column * imaginary
        real, imaginary = x * real - y * imaginary, x * imaginary + y * real
    return jnp.stack([values[key] for key in sorted(values)], axis=-1)


def project(dome: Dome, order: int = 2) -> Float[Array, "{(order+1)**2} channel"]:
    """Coefficients of a sky: its integrals against the harmonics, with darkness below the horizon.

    The grid's default size serves up to order 20.

    Args:
        dome: The sky.
        order: Highest degree.
    """
    basis = real_harmonics(dome.directions, order)
    return jnp.einsum("zan,z,zac->nc", basis, dome.solid_angle, dome.light)


def harmonic_light(coefficients: ArrayLike, direction: ArrayLike) -> Float[Array, "*batch channel"]:
    """Light from directions, as far as coefficients tell.

    Args:
        coefficients: Coefficients that `project` makes.
        direction: Directions as unit vectors.

    Raises:
        InputError: A number of coefficients that is no square.
    """
    numbers = as_float(coefficients)
    return real_harmonics(direction, _order(numbers)) @ numbers


def harmonic_irradiance(
    coefficients: ArrayLike, normal: ArrayLike
) -> Float[Array, "*batch channel"]:
    """Light on planes from coefficients: each degree times its share of the clamped cosine.

    Of order 2 it is within 3 % of the greatest value for the published sky and the general ones,
    and of no use on planes that little light falls on.

    Args:
        coefficients: Coefficients that `project` makes.
        normal: Normals of the planes as unit vectors.

    Raises:
        InputError: A number of coefficients that is no square.

    Source: Ramamoorthi & Hanrahan (2001), equation 8.
    """
    numbers = as_float(coefficients)
    order = _order(numbers)
    shares = np.concatenate([np.full(2 * k + 1, cosine_share(k)) for k in range(order + 1)])
    weighted = jnp.asarray(shares, numbers.dtype)[:, None] * numbers
    return real_harmonics(normal, order) @ weighted


def cosine_share(degree: int) -> float:
    """What convolution with max(cos, 0) leaves of a degree: π, 2π/3, π/4, 0, -π/24 and on."""
    if degree == 1:
        return 2 * math.pi / 3
    if degree % 2:
        return 0.0
    half = degree // 2
    central = math.comb(degree, half) / 2**degree
    return 2 * math.pi * (-1) ** (half + 1) * central / ((degree + 2) * (degree - 1))


def _order(coefficients):
    count = coefficients.shape[0] if coefficients.ndim else 0
    order = math.isqrt(count) - 1
    if coefficients.ndim != 2 or order < 0 or (order + 1) ** 2 != count:
        raise InputError(
            "harmonic coefficients: expected a square number of them by one or more channels; got "
            f"shape {coefficients.shape}"
        )
    return order
