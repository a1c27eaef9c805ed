"""Functions of one quantity, swept or the sun's zenith angle: polynomials, tents, a line.

Quantities are held at the ends of the ranges for which the numbers of a formula were made.
"""

import abc
import math
from collections.abc import Mapping
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import as_float, is_traced
from ..errors import InputError


SUN = "sun_zenith"  # the quantity that every sky has [rad]
FUNCTIONS = (
    *("identity", "reciprocal", "cosine", "cube root of elevation"),
    "cube root through the horizon",
)
# The cube root is infinitely steep at the horizon: lower suns are taken to be this high.
LEAST_ELEVATION = math.radians(0.1)
# How far from the horizon the other cube root is a straight line, roughly.
STRAIGHT = math.radians(4.0)


class AbstractAxis(eqx.Module):
    """Functions of one quantity.

    Attributes:
        quantity: Name of the quantity, a swept parameter or `SUN`.
    """

    quantity: eqx.AbstractVar[str]

    @property
    @abc.abstractmethod
    def size(self) -> int:
        """Number of functions."""

    @abc.abstractmethod
    def functions(self, value: Float[Array, "*batch"]) -> list[Float[Array, "*batch"]]:
        """Value of every function."""

    @abc.abstractmethod
    def describe(self) -> dict[str, Any]:
        """Names and numbers that describe the axis in files; `axis_from` reads them."""

    @abc.abstractmethod
    def constant(self) -> Float[np.ndarray, " size"]:
        """Numbers whose sum is 1 everywhere."""

    def bends(self) -> Float[np.ndarray, "bend size"]:
        """Rows that give the kinks of a sum; none where it is smooth by its making."""
        return np.zeros((1, self.size))


class Chebyshev(AbstractAxis):
    """Chebyshev polynomials Tₖ(u) = cos(k arccos u) of a function of a quantity.

    The function of the quantity is put linearly on u from -1 to 1 between the ends.

    Attributes:
        quantity: Name of the quantity.
        ends: Values of the quantity where u is -1 and 1.
        degree: Highest k.
        function: One of `FUNCTIONS`; all but two are for the sun's zenith angle. The second
            cube root is d (1 + (d/4°)²)^(-1/3), d being the distance from the horizon.
    """

    quantity: str = eqx.field(static=True)
    ends: Float[Array, "2"] = eqx.field(converter=as_float)
    degree: int = eqx.field(static=True)
    function: str = eqx.field(static=True, default="identity")

    def __check_init__(self):
        """Refuse what is no polynomial."""
        if self.degree < 0:
            raise InputError("Chebyshev(degree=...): expected 0 or more")
        if self.function not in FUNCTIONS:
            raise InputError(
                f"Chebyshev(function=...): expected one of {FUNCTIONS}; got {self.function!r}"
            )
        if self.function == "reciprocal" and not is_traced(self.ends) and self.ends[0] <= 0:
            raise InputError(
                f"Chebyshev(function='reciprocal'): expected a {self.quantity} above 0; got "
                f"{float(self.ends[0]):g}"
            )

    @property
    def size(self):
        """One more than the degree."""
        return self.degree + 1

    def functions(self, value):
        """Chebyshev polynomials by their recurrence; u is 0 where both ends are the same."""
        ends = self.ends.astype(value.dtype)
        held = jnp.clip(value, ends[0], ends[1])
        low, high = _function(ends, self.function)
        some = high != low
        share = (_function(held, self.function) - low) / jnp.where(some, high - low, 1.0)
        u = jnp.where(some, jnp.clip(2 * share - 1, -1.0, 1.0), 0.0)
        found = [jnp.ones_like(u), u]
        while len(found) <= self.degree:
            found.append(2 * u * found[-1] - found[-2])
        return found[: self.size]

    def describe(self):
        """Ends, degree and function."""
        low, high = np.asarray(self.ends, float).tolist()
        return {
            "quantity": self.quantity,
            "kind": "chebyshev",
            "functions": "T_0(u), T_1(u), ... to the degree; u from -1 at low to 1 at high",
            "of": self.function,
            "low": low,
            "high": high,
            "degree": self.degree,
        }

    def constant(self):
        """T₀ is 1."""
        return np.eye(self.size)[0]


class Tents(AbstractAxis):
    """Linear interpolation: function k is 1 at node k and falls to 0 at its neighbours.

    Attributes:
        quantity: Name of the quantity.
        nodes: Increasing values of the quantity.
    """

    quantity: str = eqx.field(static=True)
    nodes: Float[Array, " node"] = eqx.field(converter=as_float)

    @property
    def size(self):
        """One function a node."""
        return self.nodes.size

    def functions(self, value):
        """Tents."""
        if self.nodes.size == 1:
            return [jnp.ones_like(value)]
        nodes = self.nodes.astype(value.dtype)
        held = jnp.clip(value, nodes[0], nodes[-1])
        found = []
        for k in range(nodes.size):
            sides = []
            if k > 0:
                sides.append((held - nodes[k - 1]) / (nodes[k] - nodes[k - 1]))
            if k < nodes.size - 1:
                sides.append((nodes[k + 1] - held) / (nodes[k + 1] - nodes[k]))
            lower = sides[0] if len(sides) == 1 else jnp.minimum(*sides)
            found.append(jnp.maximum(lower, 0.0))
        return found

    def describe(self):
        """Where the nodes are."""
        return {
            "quantity": self.quantity,
            "kind": "tents",
            "functions": "1 at a node, 0 at all others, linear between",
            "nodes": np.asarray(self.nodes, float).tolist(),
        }

    def constant(self):
        """Tents add up to 1."""
        return np.ones(self.size)

    def bends(self):
        """Change of slope at each inner node, in units of the mean step."""
        nodes = np.asarray(self.nodes, float)
        if nodes.size < 3:
            return super().bends()
        step = np.diff(nodes) / np.mean(np.diff(nodes))
        rows = np.zeros((nodes.size - 2, nodes.size))
        for k in range(nodes.size - 2):
            rows[k, k : k + 3] = (1 / step[k], -1 / step[k] - 1 / step[k + 1], 1 / step[k + 1])
        return rows


class Line(AbstractAxis):
    """The quantity itself and 1: numbers are slope and intercept, as Preetham et al. print them.

    Attributes:
        quantity: Name of the quantity.
        ends: Values between which the quantity is held.
    """

    quantity: str = eqx.field(static=True)
    ends: Float[Array, "2"] = eqx.field(converter=as_float)

    @property
    def size(self):
        """Two."""
        return 2

    def functions(self, value):
        """The quantity held between its ends, and 1."""
        ends = self.ends.astype(value.dtype)
        return [jnp.clip(value, ends[0], ends[1]), jnp.ones_like(value)]

    def describe(self):
        """The ends."""
        low, high = np.asarray(self.ends, float).tolist()
        return {
            "quantity": self.quantity,
            "kind": "line",
            "functions": "the quantity, held from low to high, and 1",
            "low": low,
            "high": high,
        }

    def constant(self):
        """No slope."""
        return np.array([0.0, 1.0])


def axis_from(one: Mapping[str, Any]) -> AbstractAxis:
    """The axis that `AbstractAxis.describe` described.

    Raises:
        ValueError: The kind is unknown.
        KeyError: A number is missing.
    """
    kind, quantity = one["kind"], one["quantity"]
    if kind == "tents":
        return Tents(quantity, one["nodes"])
    if kind == "line":
        return Line(quantity, (one["low"], one["high"]))
    if kind == "chebyshev":
        return Chebyshev(quantity, (one["low"], one["high"]), one["degree"], one["of"])
    raise InputError(f"expected an axis of kind 'chebyshev', 'tents' or 'line'; got {kind!r}")


def _function(value, name):
    if name == "reciprocal":
        return -1 / value
    if name == "cosine":
        return jnp.cos(value)
    if name == "cube root through the horizon":
        depression = value - math.pi / 2
        return depression * (1 + (depression / STRAIGHT) ** 2) ** (-1 / 3)
    if name == "cube root of elevation":
        return jnp.maximum(math.pi / 2 - value, LEAST_ELEVATION) ** (1 / 3)
    return value
