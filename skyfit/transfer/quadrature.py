"""Nodes, weights and interpolation. What does not depend on the atmosphere is NumPy."""

from functools import cache

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


def even_stencil(
    position: Float[Array, "*batch"], count: int, width: int
) -> tuple[Array, list[Float[Array, "*batch"]]]:
    """First of the `width` nearest of the nodes 0, 1, … count - 1, and their Lagrange weights."""
    first = jnp.clip(jnp.floor(position).astype(int) - (width // 2 - 1), 0, count - width)
    t = position - first.astype(position.dtype)
    weights = []
    for k in range(width):
        others = [j for j in range(width) if j != k]
        scale = 1 / float(np.prod([k - j for j in others]))
        weight = scale * (t - others[0])
        for j in others[1:]:
            weight = weight * (t - j)
        weights.append(weight)
    return first, weights


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
