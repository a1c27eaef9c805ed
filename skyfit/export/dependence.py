"""How coefficients depend on the swept parameter and the sun, as lines of source code."""

import math

import numpy as np
from jaxtyping import Float

from ..models.basis import LEAST_ELEVATION, AbstractBasis, Nodes, Polynomial
from .description import Line, exact, number


ONE = "1"


class Terms:
    """The terms of a basis: lines that make them, and sums of numbers times them.

    Attributes:
        lines: Make the factors of the terms.
    """

    def __init__(self, basis: AbstractBasis, swept: tuple[str, ...], prefix: str = ""):
        parameter = swept[0] if swept else None
        if isinstance(basis, Polynomial):
            sets = [
                _chebyshev(f"{prefix}u", parameter, basis.parameter_range, basis.parameter_degree),
                _chebyshev(f"{prefix}v", "sun_zenith", basis.sun_range, basis.sun_degree,
                           basis.sun_function),
            ]  # fmt: skip
        elif isinstance(basis, Nodes):
            sets = [
                _tents(f"{prefix}p", parameter, basis.parameter),
                _tents(f"{prefix}s", "sun_zenith", basis.sun_zenith),
            ]
        else:
            raise TypeError(f"expected a Polynomial or Nodes to export; got {type(basis).__name__}")
        (first, self._along_parameter), (second, self._along_sun) = sets
        self.lines = (*first, *second)

    def sum(self, name: str, numbers: Float[np.ndarray, " term"]) -> tuple[tuple[Line, ...], str]:
        """Sum of numbers times terms: lines of its parts, and an expression of them."""
        rows = np.asarray(numbers).reshape(len(self._along_parameter), len(self._along_sun))
        if not np.any(rows[1:]) and not np.any(rows[:, 1:]) and self._along_sun[0] == ONE:
            return (), number(rows[0, 0])
        if len(rows) == 1:
            return (), _weighted([number(n) for n in rows[0]], self._along_sun)
        parts = [f"{name}_{i}" for i in range(len(rows))]
        lines = [
            Line(part, _weighted([number(n) for n in row], self._along_sun))
            for part, row in zip(parts, rows, strict=True)
        ]
        return tuple(lines), _weighted(parts, self._along_parameter)


def _weighted(weights: list[str], factors: list[str]) -> str:
    pairs = zip(weights, factors, strict=True)
    return " + ".join(w if f == ONE else f"{w} * {f}" for w, f in pairs)


def _chebyshev(name, variable, ends, degree, function="zenith angle"):
    """Chebyshev polynomials of a variable that is put on [-1, 1] and held there."""
    low, high = exact(ends).tolist()
    if degree == 0:
        return [], [ONE]
    if variable is None or low == high:
        return [], [(ONE, "0", "-1", "0")[k % 4] for k in range(degree + 1)]  # of 0
    lines, held = [], variable
    if function != "zenith angle":
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
    if variable is None or len(places) == 1:
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
