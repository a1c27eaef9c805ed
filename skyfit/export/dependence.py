"""How coefficients depend on the swept parameter and the sun, as lines of source code."""

import math
from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from ..models.axes import (
    LEAST_ELEVATION,
    STRAIGHT,
    AbstractAxis,
    Chebyshev,
    Line as LineAxis,
    Tents,
)
from ..models.basis import Basis
from .description import Line, exact, number


ONE = "1"


class Terms:
    """The terms of a basis: lines that make them, and sums of numbers times them.

    Attributes:
        lines: Lines that make the factors of the terms.
    """

    def __init__(self, basis: Basis, names: Mapping[str, str], prefix: str = ""):
        """Make the factors; `names` are those of the quantities in the program."""
        self.lines: tuple[Line, ...] = ()
        self._factors: list[list[str]] = []
        self._cut = basis.total_degree
        kept = np.array(basis.kept, int).reshape(basis.num_terms, len(basis.axes))
        self._kept = tuple(kept.T)
        for k, axis in enumerate(basis.axes):
            lines, factors = _factors(axis, names[axis.quantity], f"{prefix}{'uvwpqr'[k % 6]}")
            self.lines += tuple(lines)
            self._factors.append(factors)

    def sum(self, name: str, numbers: Float[np.ndarray, " term"]) -> tuple[tuple[Line, ...], str]:
        """Sum of numbers times terms: lines of its parts, and an expression of them."""
        table = np.zeros([len(factors) for factors in self._factors])
        table[self._kept] = np.reshape(numbers, np.shape(table[self._kept]))
        lines: list[Line] = []
        expression = self._sum(name, table, self._factors, lines)
        return tuple(lines), expression

    def _sum(self, name, table, factors, lines) -> str:
        if not factors:
            return number(float(table))
        first, *rest = factors
        if not rest:
            weights = [number(entry) for entry in table]
            if not np.any(table[1:]) and first[0] == ONE:
                return weights[0]
            return _weighted(weights, first, self._none_beyond(table))
        parts = [f"{name}_{i}" for i in range(len(table))]
        if not np.any(table[1:]) and first[0] == ONE:
            return self._sum(name, table[0], rest, lines)
        some = self._none_beyond(table)
        for part, row in zip(parts[:some], table, strict=False):
            text = self._sum(part, row, rest, lines)
            lines.append(Line(part, text))
        return _weighted(parts, first, some)

    def _none_beyond(self, table: np.ndarray) -> int:
        """Number of entries up to the last that is not 0; all of a full product."""
        if not self._cut:
            return len(table)
        some = np.flatnonzero(np.any(table.reshape(len(table), -1), axis=1))
        return int(some[-1]) + 1 if some.size else 1


def _factors(axis: AbstractAxis, variable: str, name: str) -> tuple[list[Line], list[str]]:
    """Lines that make the functions of an axis, and expressions of them."""
    if isinstance(axis, Chebyshev):
        return _chebyshev(name, variable, axis.ends, axis.degree, axis.function)
    if isinstance(axis, Tents):
        return _tents(name, variable, axis.nodes)
    if isinstance(axis, LineAxis):
        return [], [variable, ONE]
    raise TypeError(f"expected an axis that can be exported; got {type(axis).__name__}")


def _weighted(weights: list[str], factors: list[str], count: int) -> str:
    pairs = zip(weights[:count], factors[:count], strict=True)
    return " + ".join(w if f == ONE else f"{w} * {f}" for w, f in pairs)


def _chebyshev(name, variable, ends, degree, function):
    """Chebyshev polynomials of a variable that is put on [-1, 1] and held there."""
    low, high = exact(ends).tolist()
    if degree == 0:
        return [], [ONE]
    if low == high:
        return [], [(ONE, "0", "-1", "0")[k % 4] for k in range(degree + 1)]  # of 0
    lines, held = [], variable
    if function != "identity":
        held = _function(f"clamp({variable}, {number(low)}, {number(high)})", function)
        low, high = (float(_value(end, function)) for end in (low, high))
    slope = 2 / (high - low)
    text = f"clamp({number(slope)} * {held} + {number(-1 - slope * low)}, -1, 1)"
    lines.append(Line(name, text))
    names = [ONE, name]
    while len(names) <= degree:
        following = f"{name}{len(names)}"
        lines.append(Line(following, f"2 * {name} * {names[-1]} - {names[-2]}"))
        names.append(following)
    return lines, names


def _function(sun, function):
    if function == "reciprocal":
        return f"(-1 / {sun})"
    if function == "cosine":
        return f"cos({sun})"
    if function == "cube root through the horizon":
        depression = f"({sun} - {number(math.pi / 2)})"
        square = f"{depression} * {depression} * {number(STRAIGHT**-2)}"
        return f"{depression} * pow(1 + {square}, {number(-1 / 3)})"
    least = number(LEAST_ELEVATION)
    return f"pow(max({number(math.pi / 2)} - {sun}, {least}), {number(1 / 3)})"


def _value(sun, function):
    if function == "reciprocal":
        return -1 / sun
    if function == "cosine":
        return math.cos(sun)
    if function == "cube root through the horizon":
        depression = sun - math.pi / 2
        return depression * (1 + (depression / STRAIGHT) ** 2) ** (-1 / 3)
    return max(math.pi / 2 - sun, LEAST_ELEVATION) ** (1 / 3)


def _tents(name, variable, nodes):
    """Weights of nodes for linear interpolation, held at the ends."""
    places = exact(nodes).tolist()
    if len(places) == 1:
        return [], [ONE]
    held = f"{name}_held"
    lines = [Line(held, f"clamp({variable}, {number(places[0])}, {number(places[-1])})")]
    names = [f"{name}{k}" for k in range(len(places))]
    for k, tent in enumerate(names):
        sides = []
        if k > 0:
            width = places[k] - places[k - 1]
            sides.append(f"({held} - {number(places[k - 1])}) * {number(1 / width)}")
        if k < len(places) - 1:
            width = places[k + 1] - places[k]
            sides.append(f"({number(places[k + 1])} - {held}) * {number(1 / width)}")
        lower = sides[0] if len(sides) == 1 else f"min({', '.join(sides)})"
        lines.append(Line(tent, f"max({lower}, 0)"))
    return lines, names
