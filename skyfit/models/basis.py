"""How the numbers of a formula depend on what was swept and on the sun.

A basis is a product of axes. An axis is a set of functions of one quantity: a swept parameter, or
the sun's zenith angle. What depends on the quantities, a coefficient or the logarithm of a scale,
is a sum of numbers times terms, the products of one function of every axis: of all such products,
or of those whose degree is low enough in all together.
"""

import itertools
import math
from collections.abc import Mapping
from functools import reduce
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..errors import InputError
from .axes import SUN, AbstractAxis, Chebyshev, axis_from


Quantities = Mapping[str, Float[Array, "..."]]


class Basis(eqx.Module):
    """Products of the functions of some axes; those of the last axis vary fastest.

    Attributes:
        axes: One for every quantity that matters.
        total_degree: Whether only terms are kept whose degrees, each over the highest of its axis,
            add up to 1 or less. A full product over several parameters has far more terms, and
            hardly follows skies better. For Chebyshev polynomials alone.
    """

    axes: tuple[AbstractAxis, ...] = ()
    total_degree: bool = eqx.field(static=True, default=False)

    def __check_init__(self):
        """Refuse a degree of what has none."""
        if self.total_degree and not all(isinstance(axis, Chebyshev) for axis in self.axes):
            raise InputError("Basis(total_degree=...): expected polynomials along every axis")

    @property
    def kept(self) -> tuple[tuple[int, ...], ...]:
        """Number of the function along every axis, for every term."""
        every = itertools.product(*(range(axis.size) for axis in self.axes))
        if not self.total_degree:
            return tuple(every)
        top = [max(axis.size - 1, 1) for axis in self.axes]
        # A share of 1 may come out a rounding error higher.
        return tuple(term for term in every if sum(map(lambda k, n: k / n, term, top)) <= 1 + 1e-9)

    @property
    def num_terms(self) -> int:
        """Number of terms, and of numbers that stand for one coefficient."""
        if self.total_degree:
            return len(self.kept)
        return math.prod(axis.size for axis in self.axes)

    def terms(self, at: Quantities) -> Float[Array, "term *batch"]:
        """Value of every term.

        Args:
            at: Every quantity by name, arrays of one rank; the sun must be among them.
        """
        if self.total_degree and self.axes:
            tables = [axis.functions(at[axis.quantity]) for axis in self.axes]
            products = [
                reduce(jnp.multiply, (rows[k] for rows, k in zip(tables, term, strict=True)))
                for term in self.kept
            ]
            shape = jnp.broadcast_shapes(*(jnp.shape(one) for one in products))
            return jnp.stack([jnp.broadcast_to(one, shape) for one in products])
        found = [jnp.ones_like(at[SUN])] if not self.axes else [None]
        for axis in self.axes:
            rows = axis.functions(at[axis.quantity])
            found = [row if term is None else term * row for term in found for row in rows]
        return jnp.stack([jnp.asarray(term) for term in found])

    def describe(self) -> list[dict[str, Any]] | dict[str, Any]:
        """Axes as names and numbers, for files."""
        axes = [axis.describe() for axis in self.axes]
        if not self.total_degree:
            return axes
        return {
            "terms": "products whose degrees, each over the highest of its axis, add up to 1 or "
            "less; those of the last axis vary fastest",
            "total_degree": True,
            "axes": axes,
        }

    def constant(self) -> Float[np.ndarray, " term"]:
        """Numbers whose sum is 1 everywhere."""
        if self.total_degree:
            return np.eye(self.num_terms)[0]
        return reduce(np.kron, (axis.constant() for axis in self.axes), np.ones(1))

    def bends(self) -> Float[np.ndarray, "bend term"]:
        """Rows that give the kinks of a sum along every axis."""
        if self.total_degree:
            return np.zeros((1, self.num_terms))
        tables = []
        for k, axis in enumerate(self.axes):
            parts = [np.eye(other.size) for other in self.axes]
            parts[k] = axis.bends()
            tables.append(reduce(np.kron, parts, np.ones((1, 1))))
        return np.concatenate([np.zeros((1, self.num_terms)), *tables])


def basis_from(description: list[Mapping[str, Any]] | Mapping[str, Any]) -> Basis:
    """The basis that `Basis.describe` described.

    Raises:
        ValueError: A kind of axis is unknown.
        KeyError: A number is missing.
    """
    if isinstance(description, Mapping):
        axes = tuple(map(axis_from, description["axes"]))
        return Basis(axes, bool(description["total_degree"]))
    return Basis(tuple(map(axis_from, description)))
