"""Nodes, weights and interpolation. What does not depend on the atmosphere is NumPy."""

from functools import cache

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float


def safe_sqrt(x: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """Square root, 0 with slope 0 where the argument is not positive."""
    positive = x > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, x, 1.0)), 0.0)


@cache
def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss–Legendre nodes and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1), 0.5 * w


@cache
def polynomial_fit(count: int) -> np.ndarray:
    """From moments of a function with P_n to weights on its values at Gauss nodes; [node, degree].

    P_n are Legendre polynomials shifted to [0, 1]. If s is known at the nodes, its interpolating
    polynomial has ∫ s r = Σ_j s_j Σ_n fit_jn ∫ P_n r for any r.
    """
    x, w = gauss(count)
    values = np.polynomial.legendre.legvander(2 * x - 1, count - 1)
    return w[:, None] * values * (2 * np.arange(count) + 1)


def legendre_moments(
    count: int, x: Float[Array, " point"], weighted: Float[Array, "point species"]
) -> Float[Array, "degree species"]:
    """Σ P_n(x) weighted, for shifted Legendre polynomials of degree below `count`."""
    y = (2 * x - 1)[:, None]

    def step(carry, n):
        before, here = carry
        after = ((2 * n + 1) * y * here - n * before) / (n + 1)
        return (here, after), jnp.sum(here, axis=0)

    # The recurrence is linear, so it may carry the weighted values themselves.
    start = (jnp.zeros_like(weighted), weighted)
    return jax.lax.scan(step, start, jnp.arange(count, dtype=x.dtype))[1]


def lagrange_weights(
    nodes: Float[Array, " node"], x: Float[Array, "*batch"]
) -> Float[Array, "*batch node"]:
    """Weights of cubic interpolation at x between the four nearest nodes, 0 for all others.

    Args:
        nodes: Increasing. With fewer than four, all are used.
        x: Held within the first and last node.
    """
    count = nodes.shape[0]
    width = min(4, count)
    x = jnp.clip(x, nodes[0], nodes[-1])
    column = (1,) * x.ndim + (count,)
    first = jnp.sum(x[..., None] >= nodes.reshape(column), axis=-1) - width // 2
    first = jnp.clip(first, 0, count - width)
    stencil = [nodes[first + k] for k in range(width)]
    dense = jnp.zeros((*x.shape, count), x.dtype)
    for k in range(width):
        weight = jnp.ones_like(x)
        for other in range(width):
            if other != k:
                weight = weight * (x - stencil[other]) / (stencil[k] - stencil[other])
        dense = dense + jnp.where(
            jnp.arange(count).reshape(column) == (first + k)[..., None], weight[..., None], 0.0
        )
    return dense
