"""How the coefficients of a formula depend on the swept parameter and on the sun.

A basis is a set of terms, functions of the parameter and of the sun's zenith angle. What depends on
them, a coefficient before its link or the logarithm of a scale, is a sum of numbers times terms.
Parameter and sun are held at the ends of the ranges for which the numbers were made.
"""

import abc
import math
from collections.abc import Mapping
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import as_float


SUN_FUNCTIONS = ("zenith angle", "cosine", "cube root of elevation")
# The cube root is infinitely steep at the horizon: lower suns are taken to be this high.
LEAST_ELEVATION = math.radians(0.1)


class AbstractBasis(eqx.Module):
    """Terms in the swept parameter and the sun's zenith angle."""

    @property
    @abc.abstractmethod
    def num_terms(self) -> int:
        """How many numbers stand for one coefficient."""

    @abc.abstractmethod
    def terms(
        self, parameter: Float[Array, "*#batch"], sun_zenith: Float[Array, "*#batch"]
    ) -> Float[Array, "term *batch"]:
        """Value of every term; of 0 for the parameter where nothing was swept."""

    @abc.abstractmethod
    def describe(self) -> dict[str, Any]:
        """As names and numbers, for files; `basis_from` makes the same basis of it."""

    @abc.abstractmethod
    def roughness(self) -> Float[np.ndarray, "term term"]:
        """Quadratic form in the numbers that is 0 where they vary as smoothly as they can."""


class Polynomial(AbstractBasis):
    """Products of Chebyshev polynomials in the parameter and in a function of the sun.

    Term i (n + 1) + j is Tᵢ(u) Tⱼ(v) with Tₖ(u) = cos(k arccos u), u and v being the parameter and
    the sun's function, both put linearly on [-1, 1] from the ends of their ranges.

    Attributes:
        parameter_range: Where u is -1 and 1; equal where nothing was swept.
        sun_range: Zenith angles of the sun where v is -1 and 1 [rad].
        parameter_degree: Highest i.
        sun_degree: Highest j, n above.
        sun_function: One of `SUN_FUNCTIONS`.
    """

    parameter_range: Float[Array, "2"] = eqx.field(converter=as_float)
    sun_range: Float[Array, "2"] = eqx.field(converter=as_float)
    parameter_degree: int = eqx.field(static=True)
    sun_degree: int = eqx.field(static=True)
    sun_function: str = eqx.field(static=True, default="zenith angle")

    def __check_init__(self):
        """Refuse what is no polynomial."""
        if self.parameter_degree < 0 or self.sun_degree < 0:
            raise ValueError("Polynomial: expected degrees of 0 or more")
        if self.sun_function not in SUN_FUNCTIONS:
            raise ValueError(
                f"Polynomial(sun_function=...): expected one of {SUN_FUNCTIONS}; "
                f"got {self.sun_function!r}"
            )

    @property
    def num_terms(self) -> int:
        """Products of a power of each."""
        return (self.parameter_degree + 1) * (self.sun_degree + 1)

    def terms(self, parameter, sun_zenith):
        """Chebyshev polynomials by their recurrence."""
        u = _unit(parameter, self.parameter_range.astype(parameter.dtype))
        ends = self.sun_range.astype(sun_zenith.dtype)
        held = jnp.clip(sun_zenith, ends[0], ends[1])
        v = _unit(_of_sun(held, self.sun_function), _of_sun(ends, self.sun_function))
        along_u, along_v = _chebyshev(u, self.parameter_degree), _chebyshev(v, self.sun_degree)
        return jnp.stack([a * b for a in along_u for b in along_v])

    def describe(self):
        """Degrees and ranges."""
        (low, high), (first, last) = np.asarray(self.parameter_range), np.asarray(self.sun_range)
        return {
            "kind": "polynomial",
            "terms": "T_i(u) T_j(v), Chebyshev, j fastest; u, v from -1 at low to 1 at high",
            "parameter": {"low": float(low), "high": float(high), "degree": self.parameter_degree},
            "sun_zenith": {
                "function": self.sun_function,
                "low": float(first),
                "high": float(last),
                "degree": self.sun_degree,
            },
        }

    def roughness(self):
        """None: the degree bounds it."""
        return np.zeros((self.num_terms, self.num_terms))


class Nodes(AbstractBasis):
    """Linear interpolation between nodes in the parameter and in the sun's zenith angle.

    Term i n + j is 1 at node i of the parameter and node j of the n suns, and 0 at all others.

    Attributes:
        parameter: Increasing; one node where nothing was swept.
        sun_zenith: Increasing [rad].
    """

    parameter: Float[Array, " node"] = eqx.field(converter=as_float)
    sun_zenith: Float[Array, " sun"] = eqx.field(converter=as_float)

    @property
    def num_terms(self) -> int:
        """One a node."""
        return self.parameter.size * self.sun_zenith.size

    def terms(self, parameter, sun_zenith):
        """Products of two tent functions."""
        along_u = _tents(parameter, self.parameter.astype(parameter.dtype))
        along_v = _tents(sun_zenith, self.sun_zenith.astype(sun_zenith.dtype))
        return jnp.stack([a * b for a in along_u for b in along_v])

    def describe(self):
        """Where the nodes are."""
        return {
            "kind": "nodes",
            "terms": "linear between the nodes of the parameter and of the sun, suns fastest",
            "parameter": np.asarray(self.parameter, float).tolist(),
            "sun_zenith": np.asarray(self.sun_zenith, float).tolist(),
        }

    def roughness(self):
        """Squared jumps of slope along both axes, in units of the mean step."""
        rows = [_bends(np.asarray(x, float)) for x in (self.parameter, self.sun_zenith)]
        across = np.kron(rows[0], np.eye(self.sun_zenith.size))
        along = np.kron(np.eye(self.parameter.size), rows[1])
        return across.T @ across + along.T @ along


def basis_from(description: Mapping[str, Any]) -> AbstractBasis:
    """The basis that `AbstractBasis.describe` described.

    Raises:
        ValueError: A kind that is unknown.
        KeyError: A number is missing.
    """
    kind = description["kind"]
    parameter, sun = description["parameter"], description["sun_zenith"]
    if kind == "nodes":
        return Nodes(parameter, sun)
    if kind == "polynomial":
        return Polynomial(
            (parameter["low"], parameter["high"]),
            (sun["low"], sun["high"]),
            parameter["degree"],
            sun["degree"],
            sun["function"],
        )
    raise ValueError(f"expected a dependence of kind 'polynomial' or 'nodes'; got {kind!r}")


def _of_sun(sun_zenith, function):
    if function == "cosine":
        return jnp.cos(sun_zenith)
    if function == "zenith angle":
        return sun_zenith
    return jnp.maximum(math.pi / 2 - sun_zenith, LEAST_ELEVATION) ** (1 / 3)


def _unit(value, ends):
    """Put [low, high] on [-1, 1] and hold what is outside; 0 where the ends are the same."""
    width = ends[1] - ends[0]
    some = width != 0
    share = (value - ends[0]) / jnp.where(some, width, 1.0)
    return jnp.where(some, jnp.clip(2 * share - 1, -1.0, 1.0), 0.0)


def _chebyshev(x, degree):
    found = [jnp.ones_like(x), x]
    while len(found) <= degree:
        found.append(2 * x * found[-1] - found[-2])
    return found[: degree + 1]


def _tents(x, nodes):
    if nodes.size == 1:
        return [jnp.ones_like(x)]
    held = jnp.clip(x, nodes[0], nodes[-1])
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


def _bends(nodes):
    """Rows that give the change of slope at each inner node."""
    if nodes.size < 3:
        return np.zeros((1, nodes.size))
    step = np.diff(nodes) / np.mean(np.diff(nodes))
    rows = np.zeros((nodes.size - 2, nodes.size))
    for k in range(nodes.size - 2):
        rows[k, k : k + 3] = (1 / step[k], -1 / step[k] - 1 / step[k + 1], 1 / step[k + 1])
    return rows
