"""One description of a formula, from which every language is written.

A formula is a list of functions of numbers and vectors. Their expressions are text in Python's
syntax, restricted to `+ - * /`, comparisons, components such as `direction.z` and `frame.A_x`,
numbers, and calls:
of the functions in `BUILT_IN`, of `vector(x, y, z)`, of `where(condition, if_true, if_false)` and
of functions described before.
"""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from numpy import ndarray


BUILT_IN = ("exp", "sqrt", "sin", "cos", "tan", "asin", "pow", "min", "max", "clamp")


@dataclass(frozen=True)
class Line:
    """`name = expression`: a new number.

    Attributes:
        name: Name of the number.
        expression: See the module's docstring for the syntax.
        comment: One line above it, or nothing.
    """

    name: str
    expression: str
    comment: str = ""


@dataclass(frozen=True)
class Function:
    """A function that returns a number, a vector or a frame: what is the same for a whole picture.

    Attributes:
        name: Name without the prefix that the export gives to all.
        doc: What the function returns, in one or more lines.
        arguments: Names of the arguments; `direction`, `sun_direction` and `colour` are vectors,
            `frame` is a frame.
        body: Lines, in order.
        result: Expression that is returned.
        returns_vector: Whether the result is a vector.
        public: Whether callers are meant to use it.
        returns_frame: Whether the result is a frame.
        fields: Names of lines that together are the frame that is returned, in place of a result.
    """

    name: str
    doc: str
    arguments: tuple[str, ...]
    body: tuple[Line, ...]
    result: str
    returns_vector: bool = False
    public: bool = False
    returns_frame: bool = False
    fields: tuple[str, ...] = ()


VECTORS = ("direction", "sun_direction", "colour")
FRAME = "frame"


@dataclass(frozen=True)
class Description:
    """A sky formula.

    Attributes:
        functions: Functions in an order in which each calls only those before it; the last is
            `xyY_of_angles(cos_view, gamma, sun_zenith, *swept)`.
        swept: Names of the swept parameters.
        numbers: The formula's coefficients as data.
        formula: The formula as people write it.
        policy: What the formula gives outside of where it was made, in a sentence.
    """

    functions: tuple[Function, ...]
    swept: tuple[str, ...]
    numbers: dict[str, Any]
    formula: str
    policy: str


def frame_fields(description: Description) -> tuple[str, ...]:
    """Names of the numbers that are the same for a whole picture."""
    return next(function.fields for function in description.functions if function.fields)


def needed(lines: list[Line], result: str) -> tuple[Line, ...]:
    """The lines that a result depends on, in their order."""
    kept: list[Line] = []
    words = set(re.findall(r"\w+", result))
    for line in reversed(lines):
        if line.name in words:
            kept.append(line)
            words |= set(re.findall(r"\w+", line.expression))
    return tuple(reversed(kept))


def reached(functions: tuple[Function, ...], *names: str) -> tuple[Function, ...]:
    """The functions of these names and all that they call, in their order."""
    kept: list[Function] = []
    words = set(names)
    for function in reversed(functions):
        if function.name in words:
            kept.append(function)
            texts = (function.result, *(line.expression for line in function.body))
            words |= set(re.findall(r"\w+(?=\()", " ".join(texts)))
    return tuple(reversed(kept))


def linear(slope: float, intercept: float, swept: tuple[str, ...]) -> str:
    """Expression of a number linear in the swept parameter, or of the intercept without one."""
    return polynomial((slope, intercept), swept[0]) if swept else number(intercept)


def polynomial(coefficients: tuple[Any, ...] | Float[ndarray, " power"], variable: str) -> str:
    """Expression of a polynomial in Horner's form, the highest power first.

    The first coefficient may be the name of a number.
    """
    first = coefficients[0]
    text = first if isinstance(first, str) else number(first)
    for coefficient in coefficients[1:]:
        factor = f"({text})" if "+" in text else text
        text = f"{factor} * {variable} + {number(coefficient)}"
    return text


def number(value: float) -> str:
    """A number, with more digits than a formula of the sky can need."""
    return f"{float(value):.12g}"


def exact(values: Any) -> Float[ndarray, "..."]:
    """Numbers of a model in float64; those kept in float32 as short decimals, as they were meant.

    0.1787 in float32 is 0.17870000004768372 in float64.
    """
    array = np.asarray(values)
    if array.dtype != np.float32:
        return array.astype(float)
    return np.array([float(str(value)) for value in array.ravel()]).reshape(array.shape)
