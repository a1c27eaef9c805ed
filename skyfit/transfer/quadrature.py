"""Nodes, weights and interpolation. What does not depend on the atmosphere is NumPy."""

from functools import cache

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int


_GROUP = 32


def safe_sqrt(x: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """Square root, 0 with slope 0 where the argument is not positive."""
    positive = x > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, x, 1.0)), 0.0)


@cache
def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss–Legendre nodes and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1), 0.5 * w


def running_sum(
    values: Float[Array, "step *batch"], backward: bool = False
) -> Float[Array, "step *batch"]:
    """Σ over the first axis up to each step, or from each to the last.

    One product of matrices, full precision: `jnp.cumsum` compiles three programs.
    """
    count = values.shape[0]
    steps = np.triu(np.ones((count, count))) if backward else np.tril(np.ones((count, count)))
    steps = jnp.asarray(steps, values.dtype)
    return jnp.tensordot(steps, values, 1, precision="highest")


def count_passed(x: Float[Array, "*batch"], nodes: Float[Array, " node"]) -> Int[Array, "*batch"]:
    """How many of the nodes are no larger than x."""
    # XLA cuts sums of more than 32 in two, with the comparisons in memory between.
    groups = -(-nodes.size // _GROUP)
    padded = jnp.pad(nodes, (0, groups * _GROUP - nodes.size), constant_values=jnp.inf)
    padded = padded.reshape((1,) * x.ndim + (groups, _GROUP))
    by_group = jnp.sum(x[..., None, None] >= padded, axis=-1, dtype=jnp.int8)
    return jnp.sum(by_group.astype(int), axis=-1)


def interpolate(
    x: Float[Array, "*batch"], nodes: Float[Array, " node"], values: Float[Array, " node"]
) -> Float[Array, "*batch"]:
    """`jnp.interp` in less to compile: straight lines between nodes that do not fall."""
    left = jnp.clip(count_passed(x, nodes) - 1, 0, nodes.size - 2)
    both = jnp.stack([nodes[:-1], nodes[1:], values[:-1], values[1:]], axis=1)[left]
    low, high, at_low, at_high = (both[..., k] for k in range(4))
    wide = high - low > jnp.finfo(x.dtype).eps * jnp.abs(high)
    share = jnp.where(wide, jnp.clip(x, low, high) - low, 0.0) / jnp.where(wide, high - low, 1.0)
    return at_low + share * (at_high - at_low)


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
    stencil = [nodes[first + k] if count > width else nodes[k] for k in range(width)]
    weights = []
    for k in range(width):
        weight = jnp.ones_like(x)
        for other in range(width):
            if other != k:
                weight = weight * (x - stencil[other]) / (stencil[k] - stencil[other])
        weights.append(weight)
    if count == width:
        return jnp.stack(weights, axis=-1)
    dense = jnp.zeros((*x.shape, count), x.dtype)
    for k, weight in enumerate(weights):
        dense = dense + jnp.where(
            jnp.arange(count).reshape(column) == (first + k)[..., None], weight[..., None], 0.0
        )
    return dense
