"""Spherical harmonics of a light field that is even in azimuth about the sun's plane.

With P̄_lm = √((2 - δ_m0) (l - m)!/(l + m)!) P_l^m the addition theorem reads
P_l(cos Θ) = Σ_m P̄_lm(μ) P̄_lm(μ') cos m(φ - φ'). So a field with moments
L_lm = ∫ P̄_lm(μ) cos(mφ) L dω is scattered into Σ_l (2l + 1)/4π χ_l Σ_m P̄_lm cos(mφ) L_lm,
χ_l being the Legendre coefficients of the phase function: scattering is a product.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float


def legendre(
    degree: int, order: int, mu: Float[Array, "*batch"], sine: Float[Array, "*batch"]
) -> Float[Array, "{order}+1 {degree}+1 *batch"]:
    """P̄_lm at directions of cosine μ, for m up to `order` and l up to `degree`; 0 where l < m."""
    # P̄_lm = a μ P̄_{l-1,m} - b P̄_{l-2,m}, started on the diagonal by P̄_mm ∝ sin^m θ.
    n, m = np.arange(degree + 1)[:, None], np.arange(order + 1)[None, :]
    gap = np.maximum(n**2 - m**2, 1)
    a = np.where(n > m, (2 * n - 1) / np.sqrt(gap), 0.0)
    b = np.where(n > m, np.sqrt(np.maximum((n - 1) ** 2 - m**2, 0) / gap), 0.0)
    k = np.arange(1, degree + 2)
    steps = np.where(k > 1, np.sqrt((2 * k - 1) / (2 * k)), 1.0)
    column = (-1,) + (1,) * mu.ndim

    def step(carry, row):
        before, here, diagonal = carry
        a_l, b_l, start, growth = row
        mixed = a_l.reshape(column) * mu[None] * here - b_l.reshape(column) * before
        new = mixed + start.reshape(column) * diagonal[None]
        return (here, new, growth * sine * diagonal), new

    rows = tuple(jnp.asarray(c, mu.dtype) for c in (a, b, n == m, steps))
    zero = jnp.zeros((order + 1, *mu.shape), mu.dtype)
    _, values = jax.lax.scan(step, (zero, zero, jnp.ones_like(mu)), rows)
    return jnp.swapaxes(values, 0, 1)


def cosines(order: int, cos_azimuth: Float[Array, "*batch"]) -> Float[Array, "{order}+1 *batch"]:
    """cos(mφ) from cos φ for m up to `order`, by Chebyshev's recurrence: smooth at 0 and π."""

    def step(carry, _):
        before, here = carry
        return (here, 2 * cos_azimuth * here - before), here

    start = (cos_azimuth, jnp.ones_like(cos_azimuth))
    return jax.lax.scan(step, start, length=order + 1)[1]
