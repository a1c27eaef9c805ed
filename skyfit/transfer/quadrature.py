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


@cache
def product_rule(nodes: int, fine: int) -> np.ndarray:
    """Weights that integrate smooth × rough on [0, 1]; [node, fine].

    The smooth factor is known at `nodes` Gauss nodes and interpolated by its polynomial; the
    rough one is known at `fine` Gauss nodes. ∫ s(x) r(x) dx = Σ s_j W_jf r_f.
    """
    x, w = gauss(nodes)
    x_fine, w_fine = gauss(fine)
    return (_legendre(nodes, x).T * _norms(nodes)) @ _legendre(nodes, x_fine) * w[:, None] * w_fine


@cache
def running_integral(nodes: int, fine: int) -> np.ndarray:
    """Weights of ∫₀ˣ r at Gauss nodes x, for r known at `fine` Gauss nodes; [node, fine]."""
    x, _ = gauss(nodes)
    x_fine, w_fine = gauss(fine)
    # ∫ P_n over [0, x] in the shifted variable: (P_{n+1} - P_{n-1}) / (2 (2n + 1)); n = 0 gives x.
    values = _legendre(fine + 1, x)
    integral = np.empty((fine, nodes))
    integral[0] = x
    n = np.arange(1, fine)[:, None]
    integral[1:] = (values[2:] - values[:-2]) / (2 * (2 * n + 1))
    return (integral.T * _norms(fine)) @ _legendre(fine, x_fine) * w_fine


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


def _legendre(count: int, x: np.ndarray) -> np.ndarray:
    """Legendre polynomials shifted to [0, 1]; [degree, point]."""
    return np.polynomial.legendre.legvander(2 * x - 1, count - 1).T


def _norms(count: int) -> np.ndarray:
    """1 / ∫ P_n² over [0, 1]."""
    return 2 * np.arange(count) + 1.0
