"""Description of `PerezSky` as source code: its distributions, its zenith, and what holds them."""

import math
import re

import numpy as np

from ..models.perez import CHANNELS, COEFFICIENTS, PerezSky
from ..models.twilight import TWILIGHT_DECAY
from .description import Description, Function, Line, exact, linear, number, polynomial
from .distributions import PEREZ


FORMULA = (
    "value = zenith value * F(theta, gamma) / F(0, theta_sun) for each of x, y, Y;\n"
    "F = (1 + A exp(B / cos theta)) (1 + C exp(D gamma) + E cos^2 gamma)"
)
POLICY = (
    "A view below the horizon sees the brightness of the horizon. With the sun below the\n"
    "horizon the zenith keeps its colour of sunset and dims by a decade for every 2.5 degrees.\n"
    "Luminance is never negative, and nothing jumps."
)


def describe_perez(sky: PerezSky) -> Description:
    """Describe a Perez sky for any value of its parameter."""
    # A name such as "haze.optical_depth" is none in a program.
    swept = (re.sub(r"\W", "_", sky.parameter_name),) if sky.parameter_name else ()
    shapes = [
        _shape(name, exact(table), swept)
        for name, table in zip(CHANNELS, sky.coefficients, strict=True)
    ]
    chromaticities = [
        _zenith_chromaticity(name, exact(zenith.matrix), swept)
        for name, zenith in (("x", sky.zenith_x), ("y", sky.zenith_y))
    ]
    luminance = _zenith_luminance(sky, swept)
    functions = (PEREZ, *shapes, *chromaticities, luminance, _xyY_of_angles(sky, swept))
    return Description(functions, swept, _numbers(sky), FORMULA, POLICY)


def _shape(channel: str, table: np.ndarray, swept: tuple[str, ...]) -> Function:
    lines = [
        Line(letter, linear(slope, intercept, swept))
        for letter, (slope, intercept) in zip(COEFFICIENTS, table, strict=True)
    ]
    return Function(
        f"shape_{channel}",
        f"F of {channel}.",
        ("cos_view", "gamma", *swept),
        tuple(lines),
        "distribution(A, B, C, D, E, cos_view, gamma)",
    )


def _zenith_chromaticity(channel: str, matrix: np.ndarray, swept: tuple[str, ...]) -> Function:
    quadratic, slope, constant = (polynomial(row, "sun_zenith") for row in matrix)
    lines = [Line("constant", constant)]
    result = "constant"
    if swept:
        lines = [Line("quadratic", quadratic), Line("slope", slope), *lines]
        result = f"(quadratic * {swept[0]} + slope) * {swept[0]} + constant"
    return Function(
        f"zenith_{channel}",
        f"Chromaticity {channel} of the zenith, for a sun above the horizon.",
        ("sun_zenith", *swept),
        tuple(lines),
        result,
    )


def _zenith_luminance(sky: PerezSky, swept: tuple[str, ...]) -> Function:
    a, b, c, d = exact(sky.zenith_luminance.linear)
    p, q = exact(sky.zenith_luminance.angle)
    return Function(
        "zenith_Y",
        "Luminance of the zenith [cd/m^2], for a sun above the horizon; never negative.",
        ("sun_zenith", *swept),
        (
            Line("chi", f"({linear(q, p, swept)}) * ({number(math.pi)} - 2 * sun_zenith)"),
            Line("slope", linear(a, b, swept)),
            Line("constant", linear(c, d, swept)),
        ),
        "max(slope * tan(chi) + constant, 0)",
    )


def _xyY_of_angles(sky: PerezSky, swept: tuple[str, ...]) -> Function:
    half_pi, lines, held = number(math.pi / 2), [], ""
    if swept:
        low, high = map(number, sky.parameter_range)
        comment = f"Outside the valid range, {swept[0]} is held at the nearest end."
        lines = [Line("held", f"clamp({swept[0]}, {low}, {high})", comment)]
        held = ", held"
    lines += [
        Line(
            "day",
            f"clamp(sun_zenith, 0, {half_pi})",
            "At night the zenith keeps its colour of sunset and dims by a decade in 2.5 degrees.",
        ),
        Line("night", f"exp({number(-TWILIGHT_DECAY)} * max(sun_zenith - {half_pi}, 0))"),
    ]
    for name, channel in zip(("x", "y", "luminance"), CHANNELS, strict=True):
        zenith = f"zenith_{channel}(day{held})"
        shape = f"shape_{channel}(cos_view, gamma{held}) / shape_{channel}(1, sun_zenith{held})"
        lines.append(Line(name, f"{zenith} * {shape}"))
    return Function(
        "xyY_of_angles",
        "Chromaticity x, y and luminance Y [cd/m^2] from the cosine of the view's zenith angle,\n"
        "the angle gamma between view and sun, and the sun's zenith angle [rad].",
        ("cos_view", "gamma", "sun_zenith", *swept),
        tuple(lines),
        "vector(x, y, night * luminance)",
        returns_vector=True,
        public=True,
    )


def _numbers(sky: PerezSky) -> dict:
    return {
        "coefficients": {
            channel: dict(zip(COEFFICIENTS, exact(table).tolist(), strict=True))
            for channel, table in zip(CHANNELS, sky.coefficients, strict=True)
        },
        "zenith": {
            "x": {"matrix": exact(sky.zenith_x.matrix).tolist()},
            "y": {"matrix": exact(sky.zenith_y.matrix).tolist()},
            "Y": {
                "linear": exact(sky.zenith_luminance.linear).tolist(),
                "angle": exact(sky.zenith_luminance.angle).tolist(),
            },
        },
    }
