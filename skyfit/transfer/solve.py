"""All orders at once: the sum of a series in which light scatters again and again.

With A one more scattering, the sum y of b + A b + A² b + … solves y = b + A y. Plain iteration adds
order after order; where air is thick hundreds count. Anderson's acceleration (1965, J. ACM 12,
547), for every wavelength by itself, needs some ten.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .field import Field


T = TypeVar("T")

_MEMORY = 5  # steps of which the best mixture is sought
_MOST_STEPS = 200
_LOST = 0.01  # residual, relative; where it is larger there is no sum


@partial(jax.custom_jvp, nondiff_argnums=(0, 3))
def sum_of_orders(
    again: Callable[[Any, Field], Field], medium: Any, first: Field, tolerance: float
) -> Field:
    """Sum A b + A² b + …: the light of all orders but the first, b.

    Args:
        again: `again(medium, field)` is A: the field of the next order, linear in the field.
        medium: What A depends on and may be differentiated by; a pytree.
        first: Field b, no sharper than what A returns.
        tolerance: Largest residual of y = b + A y, relative to the sum, at every wavelength.

    Returns:
        The sum; not a number at wavelengths at which it does not converge.
    """
    whole = _anderson(lambda y: _minus(y, again(medium, y)), first, tolerance=tolerance)
    return _minus(whole, first)


@sum_of_orders.defjvp
def _sum_of_orders_moved(again, tolerance, primals, tangents):
    """The sum and its tangent: (1 - A) dy = db + dA y, solved likewise and transposable."""
    medium, first = primals
    beyond = sum_of_orders(again, medium, first, tolerance)
    whole = _plus(first, beyond)
    moved = jax.jvp(lambda given: again(given, whole), (medium,), tangents[:1])[1]
    solve = partial(_anderson, tolerance=tolerance)
    change = jax.lax.custom_linear_solve(
        lambda y: _minus(y, again(medium, y)), _plus(tangents[1], moved), solve, solve
    )
    return beyond, _minus(change, tangents[1])


def _anderson(remains: Callable[[Field], Field], b: Field, *, tolerance: float) -> Field:
    """Solve remains(y) = b."""

    def step(state):
        y, r, ys, rs, gram, scale, count, _ = state
        mix = _best_mixture(gram, _products(rs, r, scale), count)
        # How far the step goes, less what the history foresaw.
        ahead = jax.tree.map(
            lambda y, r, dy, dr: y + r - jnp.einsum("kw,k...w->...w", mix, dy + dr), y, r, ys, rs
        )
        left = _minus(b, remains(ahead))
        scale = jnp.where(count == 0, _scale(left), scale)
        place = count % _MEMORY
        ys = jax.tree.map(lambda h, new: h.at[place].set(new), ys, _minus(ahead, y))
        change = _minus(left, r)
        rs = jax.tree.map(lambda h, new: h.at[place].set(new), rs, change)
        row = _products(rs, change, scale)
        gram = gram.at[place].set(row).at[:, place].set(row)
        return ahead, left, ys, rs, gram, scale, count + 1, error(ahead, left, scale)

    def error(y, r, scale):
        """Square of what is left over the square of the later orders, by wavelength."""
        later, left = (_products(_one(a), a, scale)[0] for a in (_minus(y, b), r))
        # After the first step no later order is there yet, and the second is what is left.
        return jnp.where(left > 0, left / jnp.where(later > 0, later, left), 0.0)

    def unfinished(state):
        *_, count, error = state
        return jnp.any(error > tolerance**2) & (count < _MOST_STEPS)

    nothing = jax.tree.map(jnp.zeros_like, b)
    empty = jax.tree.map(lambda a: jnp.zeros((_MEMORY, *a.shape), a.dtype), b)
    scale = jnp.ones_like(b.irradiance)
    gram = jnp.zeros((_MEMORY, _MEMORY, scale.shape[-1]), scale.dtype)
    unknown = jnp.full_like(scale[0], jnp.inf)
    state = nothing, b, empty, empty, gram, scale, jnp.asarray(0), unknown
    found, *_, last = jax.lax.while_loop(unfinished, step, state)
    sum_is_known = last < _LOST**2
    return jax.tree.map(
        lambda a: jnp.where(jnp.broadcast_to(sum_is_known, a.shape), a, jnp.nan), found
    )


def _best_mixture(
    gram: Float[Array, "step step wavelength"], side: Float[Array, "step wavelength"], count: Array
) -> Float[Array, "step wavelength"]:
    """How much of each remembered change takes most off the residual: least squares.

    Args:
        gram: Products of the changes of the residual among themselves.
        side: Their products with the residual.
        count: How many steps were made; what was not remembered yet has no share.
    """
    gram = jnp.moveaxis(gram, -1, 0)
    trace = jnp.trace(gram, axis1=1, axis2=2)[:, None, None]
    unit = jnp.eye(_MEMORY, dtype=gram.dtype)[None]
    used = (jnp.arange(_MEMORY) < count).astype(gram.dtype)[:, None]
    ridge = jnp.finfo(gram.dtype).eps * 100 * trace + jnp.where(trace > 0, 0.0, 1.0)
    gram = gram + ridge * unit + (1 - used)[None] * unit
    return jnp.linalg.solve(gram, side.T[..., None])[..., 0].T * used


def _scale(second: Field) -> Float[Array, "sun wavelength"]:
    """Inverse size of light under each sun: suns in twilight count as much as those by day."""
    size = jnp.sqrt(jnp.mean(second.moments**2, axis=(0, 1, 2)))
    return jax.lax.stop_gradient(1 / (size + 1e-30))


def _products(
    history: Field, one: Field, scale: Float[Array, "sun wavelength"]
) -> Float[Array, "step wavelength"]:
    """Inner products, by wavelength, of each field of a history with one field."""
    weighted = jax.tree.map(lambda a: a * jnp.broadcast_to(scale**2, a.shape), one)
    each = [
        jnp.sum(h * a[None], axis=tuple(range(1, a.ndim)))
        for h, a in zip(jax.tree.leaves(history), jax.tree.leaves(weighted), strict=True)
    ]
    return jnp.sum(jnp.stack(each), axis=0)


def _one(field: T) -> T:
    """A history of one."""
    return jax.tree.map(lambda a: a[None], field)


def _plus(a: T, b: T) -> T:
    return jax.tree.map(jnp.add, a, b)


def _minus(a: T, b: T) -> T:
    return jax.tree.map(jnp.subtract, a, b)
