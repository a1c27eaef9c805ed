"""How coefficients depend on the swept parameter and the sun, as lines of source code."""

import math
from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from ..models.basis import LEAST_ELEVATION, AbstractAxis, Basis, Chebyshev, Line as LineAxis, Tents
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
        for k, axis in enumerate(basis.axes):
            lines, factors = _factors(axis, names[axis.quantity], f"{prefix}{'uvwpqr'[k % 6]}")
            self.lines += tuple(lines)
            self._factors.append(factors)

    def sum(self, name: str, numbers: Float[np.ndarray, " term"]) -> tuple[tuple[Line, ...], str]:
        """Sum of numbers times terms: lines of its parts, and an expression of them."""
        table = np.asarray(numbers).reshape([len(factors) for factors in self._factors])
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
            return _weighted(weights, first)
        parts = [f"{name}_{i}" for i in range(len(table))]
        if not np.any(table[1:]) and first[0] == ONE:
            return self._sum(name, table[0], rest, lines)
        for part, row in zip(parts, table, strict=True):
            text = self._sum(part, row, rest, lines)
            lines.append(Line(part, text))
        return _weighted(parts, first)


def _factors(axis: AbstractAxis, variable: str, name: str) -> tuple[list[Line], list[str]]:
    """Lines that make the functions of an axis, and expressions of them."""
    if isinstance(axis, Chebyshev):
        return _chebyshev(name, variable, axis.ends, axis.degree, axis.function)
    if isinstance(axis, Tents):
        return _tents(name, variable, axis.nodes)
    if isinstance(axis, LineAxis):
        return [], [variable, ONE]
    raise TypeError(f"expected an axis that can be exported; got {type(axis).__name__}")


def _weighted(weights: list[str], factors: list[str]) -> str:
    pairs = zip(weights, factors, strict=True)
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
        held = _of_sun(f"clamp({variable}, {number(low)}, {number(high)})", function)
        low, high = (float(_value_of_sun(end, function)) for end in (low, high))
    slope = 2 / (high - low)
    text = f"clamp({number(slope)} * {held} + {number(-1 - slope * low)}, -1, 1)"
    lines.append(Line(name, text))
    names = [ONE, name]
    while len(names) <= degree:
        following = f"{name}{len(names)}"
        lines.append(Line(following, f"2 * {name} * {names[-1]} - {names[-2]}"))
        names.append(following)
    return lines, names


def _of_sun(sun, function):
    if function == "cosine":
        return f"cos({sun})"
    least = number(LEAST_ELEVATION)
    return f"pow(max({number(math.pi / 2)} - {sun}, {least}), {number(1 / 3)})"


def _value_of_sun(sun, function):
    if function == "cosine":
        return math.cos(sun)
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
