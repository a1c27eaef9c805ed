"""Angles between unit vectors, fast and with finite gradients: the geometry of `model.xyz`."""

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float


_LARGEST_PIECE = 16384  # directions: 200 kB in float32


def components(
    direction: Float[Array, "*batch 3"],
) -> tuple[Float[Array, "*batch"], Float[Array, "*batch"], Float[Array, "*batch"]]:
    """Split vectors into arrays of x, y and z."""
    # A product with the identity, since XLA on CPU does not vectorise loops over strided slices:
    # a million float32 directions through the Perez formula take 10 ms this way and 13 the other.
    x, y, z = _product(jnp.eye(3, dtype=direction.dtype), direction.reshape(-1, 3).T)
    batch = direction.shape[:-1]
    return x.reshape(batch), y.reshape(batch), z.reshape(batch)


class VectorView(NamedTuple):
    """What a model asks of unit vectors, one array of each, all of one rank.

    Attributes:
        cos_view: Cosine of the view zenith angle.
        sun_zenith: [rad].
        gamma: Angle between view and sun [rad].
        cos_gamma: Cosine of that angle.
        swept: The model's parameters, given the same rank.
    """

    cos_view: Float[Array, "..."]
    sun_zenith: Float[Array, "..."]
    gamma: Float[Array, "..."]
    cos_gamma: Float[Array, "..."]
    swept: tuple[Float[Array, "..."], ...]


def view_along(
    direction: Float[Array, "*#batch 3"],
    sun_direction: Float[Array, "*#batch 3"],
    swept: tuple[Float[Array, "..."], ...],
) -> VectorView:
    """Angles of unit vectors, z up, and the parameters of a model laid beside them."""
    split = align(*components(direction), *components(sun_direction), *swept)
    view, sun, swept = split[:3], split[3:6], split[6:]
    up = jnp.zeros_like(sun[2])
    sun_zenith, _ = angle_between(sun, (up, up, up + 1))
    gamma, cos_gamma = angle_between(view, sun)
    return VectorView(view[2], sun_zenith, gamma, cos_gamma, swept)


def combine(
    matrix: tuple[tuple[float, ...], ...], parts: Float[Array, "part *batch"]
) -> Float[Array, "*batch 3"]:
    """Linear combinations of arrays, put on the last axis; a product for the same reason."""
    flat = parts.reshape(parts.shape[0], -1)
    mixed = _product(flat.T, jnp.asarray(matrix, parts.dtype).T)
    return mixed.reshape(*parts.shape[1:], len(matrix))


def _product(
    first: Float[Array, "row inner"], second: Float[Array, "inner column"]
) -> Float[Array, "row column"]:
    # Accelerators must not round the factors to fewer bits.
    return jnp.matmul(first, second, precision=jax.lax.Precision.HIGHEST)


def angle_between(
    first: tuple[Float[Array, "*#batch"], ...], second: tuple[Float[Array, "*#batch"], ...]
) -> tuple[Float[Array, "*batch"], Float[Array, "*batch"]]:
    """Angle between unit vectors given by components, and its cosine.

    From the chord between their tips: `arccos` of the dot product has an infinite gradient where
    they meet, loses half the digits there, and is slow on CPUs.

    Returns:
        The angle in [0, π] [rad], within 3e-7 of its value in float32 and 1e-14 in float64; its
        gradient at the ends is taken as 0. The cosine of the angle.
    """
    x, y, z = (a - b for a, b in zip(first, second, strict=True))
    square = (x**2 + y**2 + z**2) / 4
    nearer = jnp.minimum(square, 1 - square)
    safe = jnp.maximum(nearer, 1e-30)
    ratio = jnp.zeros_like(safe)
    for coefficient in reversed(arcsine_ratio(6 if safe.dtype == jnp.float32 else 17)):
        ratio = ratio * safe + coefficient
    angle = 2 * jnp.sqrt(safe) * ratio
    return jnp.where(square < 0.5, angle, math.pi - angle), 1 - 2 * square


@cache
def arcsine_ratio(degree: int) -> tuple[float, ...]:
    """Polynomial in t for arcsin(√t) / √t up to 1/2; degree 6 is within 1.5e-7, 17 within 4e-15."""

    def ratio(t):
        root = np.sqrt(t)
        return np.arcsin(root) / root

    fit = np.polynomial.Chebyshev.interpolate(ratio, degree, domain=[0.0, 0.5])
    power = fit.convert(kind=np.polynomial.Polynomial, domain=[-1, 1], window=[-1, 1])
    return tuple(float(c) for c in power.coef)


def in_pieces(
    evaluate: Callable[[Float[Array, "piece 3"]], Float[Array, "piece channel"]],
    direction: Float[Array, "*batch 3"],
) -> Float[Array, "*batch channel"]:
    """Evaluate many directions piece by piece, so that what lies between stays in a CPU's cache.

    A million float32 directions of the Perez sky take 12 ms this way and up to 25 at once: fresh
    memory for every intermediate result costs more than the formula. Few directions, and numbers
    of them without a suitable divisor, are evaluated at once.
    """
    size = _piece(math.prod(direction.shape[:-1]))
    if size is None or jax.default_backend() != "cpu":
        return evaluate(direction)
    pieces = direction.reshape(-1, size, 3)
    return jax.lax.map(evaluate, pieces).reshape(*direction.shape[:-1], -1)


def _piece(count: int) -> int | None:
    """A divisor of a large number that is a good number of directions to evaluate at once."""
    if count < 4 * _LARGEST_PIECE:
        return None
    return next((n for n in range(_LARGEST_PIECE, _LARGEST_PIECE // 4, -1) if count % n == 0), None)


def align(*arrays: Float[Array, "..."]) -> tuple[Float[Array, "..."], ...]:
    """Give arrays the same rank by leading axes of size 1, so that they broadcast as in NumPy."""
    rank = max(array.ndim for array in arrays)
    return tuple(array.reshape((1,) * (rank - array.ndim) + array.shape) for array in arrays)
