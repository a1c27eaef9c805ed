"""All orders at once: the sum of a series in which light scatters again and again.

With A one more scattering, the sum x of A b + A² b + … solves x = A (b + x). Plain iteration adds
order after order; where air is thick hundreds count. Anderson's acceleration (1965, J. ACM 12,
547), for every wavelength by itself, needs some ten.
"""

from collections.abc import Callable
from functools import partial
from typing import TypeVar

import jax
import jax.numpy as jnp

from .field import Field


T = TypeVar("T")

_MEMORY = 5  # steps of which the best mixture is sought
_MOST_STEPS = 200
_LOST = 0.01  # residual, relative; where it is larger there is no sum


def sum_of_orders(again: Callable[[Field], Field], first: Field, tolerance: float) -> Field:
    """Sum x of A b + A² b + …: the light of all orders but the first, b.

    Args:
        again: Linear operator A: the field of the next order.
        first: Field b, no sharper than what A returns.
        tolerance: Largest residual of x = A (b + x), relative to x, at every wavelength.

    Returns:
        The sum; not a number at wavelengths at which it does not converge.
    """
    second = again(first)
    # Suns in twilight count as much as those by day.
    size = jnp.sqrt(jnp.mean(second.moments**2, axis=(0, 1, 2), keepdims=True))
    scale = jax.lax.stop_gradient(1 / (size + 1e-30))
    scales = Field(scale, scale[0, 0, 0])

    def remains(x: Field) -> Field:
        return jax.tree.map(jnp.subtract, x, again(x))

    solve = partial(_anderson, scales=scales, tolerance=tolerance)
    return jax.lax.custom_linear_solve(remains, second, solve, solve)


def _anderson(remains, b: Field, *, scales: Field, tolerance: float) -> Field:
    """Solve remains(x) = b, starting from b."""

    def residual(x):
        return jax.tree.map(jnp.subtract, b, remains(x))

    def products(left, right):
        """Inner products by wavelength; any leading axes."""
        pairs = zip(
            jax.tree.leaves(left), jax.tree.leaves(right), jax.tree.leaves(scales), strict=True
        )
        return sum(jnp.sum((u * s**2 * v).reshape(-1, u.shape[-1]), axis=0) for u, v, s in pairs)

    def step(state):
        x, r, xs, rs, count, _ = state
        steps = jnp.arange(_MEMORY)
        gram = jnp.stack([jnp.stack([products(_row(rs, i), _row(rs, j)) for j in range(_MEMORY)])
                          for i in range(_MEMORY)])  # fmt: skip
        gram = jnp.moveaxis(gram, -1, 0)
        side = jnp.stack([products(_row(rs, i), r) for i in range(_MEMORY)], axis=-1)
        trace = jnp.trace(gram, axis1=1, axis2=2)[:, None, None]
        unit = jnp.eye(_MEMORY, dtype=gram.dtype)[None]
        used = (steps < count).astype(gram.dtype)
        ridge = jnp.finfo(gram.dtype).eps * 100 * trace + jnp.where(trace > 0, 0.0, 1.0)
        gram = gram + ridge * unit + (1 - used)[None, None] * unit
        mix = jnp.linalg.solve(gram, side[..., None])[..., 0] * used[None]  # [channel, memory]
        # How far the step goes, less what the history foresaw.
        ahead = jax.tree.map(
            lambda x, r, dx, dr: x + r - jnp.einsum("wk,k...w->...w", mix, dx + dr), x, r, xs, rs
        )
        left = residual(ahead)
        place = count % _MEMORY
        xs = jax.tree.map(lambda h, new, old: h.at[place].set(new - old), xs, ahead, x)
        rs = jax.tree.map(lambda h, new, old: h.at[place].set(new - old), rs, left, r)
        return ahead, left, xs, rs, count + 1, off(ahead, left)

    def off(x, r):
        whole = products(x, x)
        return products(r, r) / jnp.where(whole > 0, whole, 1.0)

    def unfinished(state):
        *_, count, error = state
        return jnp.any(error > tolerance**2) & (count < _MOST_STEPS)

    empty = jax.tree.map(lambda a: jnp.zeros((_MEMORY, *a.shape), a.dtype), b)
    start = residual(b)
    state = b, start, empty, empty, jnp.asarray(0), off(b, start)
    found, *_, error = jax.lax.while_loop(unfinished, step, state)
    sum_is_known = error < _LOST**2
    return jax.tree.map(
        lambda a: jnp.where(jnp.broadcast_to(sum_is_known, a.shape), a, jnp.nan), found
    )


def _row(history: T, index: int) -> T:
    return jax.tree.map(lambda a: a[index], history)
