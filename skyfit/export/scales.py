"""Scales of channels as source code: the zenith of the paper, or the exponential of a sum."""

import math
from collections.abc import Mapping

import numpy as np

from ..models.formula import CHANNELS
from ..models.scale import AbstractScale, LogScale, PaperZenith
from ..models.twilight import TWILIGHT_DECAY
from .dependence import Terms
from .description import Function, Line, exact, linear, number, polynomial


_HALF_PI = number(math.pi / 2)


def scale_functions(scale: AbstractScale, swept: tuple[str, ...]) -> tuple[Function, ...]:
    """Functions that the channels' scales call: none for a `LogScale`."""
    if not isinstance(scale, PaperZenith):
        return ()
    quantity = swept if scale.quantity else ()
    return (
        _zenith_chromaticity("x", exact(scale.x.matrix), quantity, swept),
        _zenith_chromaticity("y", exact(scale.y.matrix), quantity, swept),
        _zenith_luminance(scale, quantity, swept),
    )


def scale_of_channel(
    scale: AbstractScale, k: int, name: str, names: Mapping[str, str], swept: tuple[str, ...]
) -> tuple[list[Line], str]:
    """Lines before, and the expression of, a channel's scale; their names end in the channel's."""
    if isinstance(scale, PaperZenith):
        day = Line(
            "day",
            f"clamp(sun_zenith, 0, {_HALF_PI})",
            "At night the zenith keeps its colour of sunset and dims by a decade in 2.5 degrees.",
        )
        value = f"zenith_{name}({', '.join(('day', *swept))})"
        if name != CHANNELS[2]:
            return [day], value
        night = Line("night", f"exp({number(-TWILIGHT_DECAY)} * max(sun_zenith - {_HALF_PI}, 0))")
        return [day, night], f"night * {value}"
    assert isinstance(scale, LogScale)
    terms = Terms(scale.basis, names, "scale_")
    parts, logarithm = terms.sum(f"scale_{name}", exact(scale.numbers[k]))
    whole, fall = f"logarithm_{name}", f"fall_{name}"
    lines = [*terms.lines, *parts, Line(whole, logarithm), Line(fall, _fall(scale, k))]
    return lines, f"exp({whole} - {fall})"


def _fall(scale: LogScale, k: int) -> str:
    """How much a low or set sun takes off the logarithm of the scale."""
    rate, lowest = float(exact(scale.dimming[k])), number(scale.lowest_sun)
    low = f"{number(rate)} * max(min(sun_zenith, {_HALF_PI}) - {lowest}, 0)" if rate else "0"
    if not scale.night[k]:
        return low
    dark = number(max(math.pi / 2, scale.lowest_sun))
    night = f"{number(TWILIGHT_DECAY)} * max(sun_zenith - {dark}, 0)"
    return f"{low} + {night}" if rate else night


def _zenith_chromaticity(
    channel: str, matrix: np.ndarray, quantity: tuple[str, ...], swept: tuple[str, ...]
) -> Function:
    quadratic, slope, constant = (polynomial(row, "sun_zenith") for row in matrix)
    lines = [Line("constant", constant)]
    result = "constant"
    if quantity:
        lines = [Line("quadratic", quadratic), Line("slope", slope), *lines]
        result = f"(quadratic * {quantity[0]} + slope) * {quantity[0]} + constant"
    return Function(
        f"zenith_{channel}",
        f"Chromaticity {channel} of the zenith, for a sun above the horizon.",
        ("sun_zenith", *swept),
        tuple(lines),
        result,
    )


def _zenith_luminance(
    scale: PaperZenith, quantity: tuple[str, ...], swept: tuple[str, ...]
) -> Function:
    a, b, c, d = exact(scale.luminance.linear)
    p, q = exact(scale.luminance.angle)
    return Function(
        "zenith_Y",
        "Luminance of the zenith [cd/m^2], for a sun above the horizon; never negative.",
        ("sun_zenith", *swept),
        (
            Line("chi", f"({linear(q, p, quantity)}) * ({number(math.pi)} - 2 * sun_zenith)"),
            Line("slope", linear(a, b, quantity)),
            Line("constant", linear(c, d, quantity)),
        ),
        "max(slope * tan(chi) + constant, 0)",
    )
