"""Legendre polynomials, and the powers that are series of phase functions in them."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


def legendre_polynomials(
    degree: int, x: Float[Array, " point"]
) -> Float[Array, "{degree}+1 point"]:
    """Legendre polynomials P₀…P_degree at points in [-1, 1], by the three-term recurrence."""

    def step(carry, n):
        before, here = carry
        after = ((2 * n + 1) * x * here - n * before) / (n + 1)
        return (here, after), here

    start = (jnp.zeros_like(x), jnp.ones_like(x))
    return jax.lax.scan(step, start, jnp.arange(degree + 1, dtype=x.dtype))[1]


def powers(g: Float[Array, " wavelength"], degree: int) -> Float[Array, "{degree}+1 wavelength"]:
    """1, g, g², … g^degree; by products, so that the derivative at g = 0 is finite."""
    return jax.lax.scan(lambda here, _: (here * g, here), jnp.ones_like(g), length=degree + 1)[1]
