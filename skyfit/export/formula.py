"""Description of `FormulaSky`, any formula of the ladder, as source code."""

import math
import re

import numpy as np

from ..colour import D65_WHITE, srgb_matrix, xyz_weights
from ..models.formula import CHANNEL_KINDS, FormulaSky, dims_at_night
from ..models.twilight import TWILIGHT_DECAY
from .dependence import Terms
from .description import Description, Function, Line, exact, needed, number
from .distributions import distribution, linked


_POLICY = (
    "A view below the horizon sees the brightness of the horizon. A sun lower than the valid\n"
    "range dims the sky at a constant rate, and below the horizon by a decade for every 2.5\n"
    "degrees; the parameter is held at the nearest end of its range. Nothing jumps."
)
_XYZ_TO_XYY = Function(
    "xyz_to_xyY",
    "Chromaticity x, y and luminance Y of CIE XYZ; black is given the colour of D65.",
    ("colour",),
    (
        Line("total", "colour.x + colour.y + colour.z"),
        Line("safe", "where(total > 0, total, 1)"),
        Line("x", f"where(total > 0, colour.x / safe, {number(D65_WHITE[0])})"),
        Line("y", f"where(total > 0, colour.y / safe, {number(D65_WHITE[1])})"),
    ),
    "vector(x, y, colour.y)",
    returns_vector=True,
)


def describe_formula(sky: FormulaSky) -> Description:
    """Describe a formula of any shape, dependence and channels for any value of its parameter."""
    swept = (re.sub(r"\W", "_", sky.parameter_name),) if sky.parameter_name else ()
    names = _channels(sky)
    channels = [_channel(sky, k, name, swept) for k, name in enumerate(names)]
    end = () if sky.kind == "Yxy" else (_XYZ_TO_XYY,)
    functions = (*distribution(sky.shape), *channels, *end, _xyY_of_angles(sky, names, swept))
    relative = " / F(0, theta_sun)" if sky.shape.relative else ""
    formula = (
        f"Each of {', '.join(names)} = scale * F(theta, gamma){relative}, the scale and the\n"
        "coefficients of F depending on the sun's zenith angle and on what was swept."
    )
    return Description(functions, swept, _numbers(sky, names), formula, _POLICY)


def _channels(sky: FormulaSky) -> tuple[str, ...]:
    if sky.wavelengths is None:
        return CHANNEL_KINDS[sky.kind]
    bands = [f"{float(band):g}".replace(".", "_") for band in np.asarray(sky.wavelengths)]
    return tuple(f"radiance_{band}nm" for band in bands)


def _channel(sky: FormulaSky, k: int, name: str, swept: tuple[str, ...]) -> Function:
    """One channel: its scale, its coefficients and their distribution."""
    terms = Terms(sky.basis, swept)
    lines = list(terms.lines)
    for letter, link, numbers in zip(
        sky.shape.names, sky.shape.links, exact(sky.numbers[k]), strict=True
    ):
        parts, free = terms.sum(letter, numbers)
        lines += [*parts, Line(letter, linked(free, link))]
    scale_terms = Terms(sky.scale_basis, swept, "scale_")
    parts, logarithm = scale_terms.sum("scale", exact(sky.scales[k]))
    lines += [*scale_terms.lines, *parts, Line("logarithm", logarithm), *_dimming(sky, k)]
    coefficients = ", ".join(sky.shape.names)
    value = f"exp(logarithm - fall) * distribution({coefficients}, cos_view, gamma)"
    if sky.shape.relative:
        value += f" / distribution({coefficients}, 1, sun_zenith)"
    spectral = sky.wavelengths is not None
    return Function(
        name if spectral else f"channel_{name}",
        "Spectral radiance [W/(m^2 sr nm)]." if spectral else f"{name} of the sky.",
        ("cos_view", "gamma", "sun_zenith", *swept),
        needed(lines, value),
        value,
        public=spectral,
    )


def _dimming(sky: FormulaSky, k: int) -> tuple[Line, ...]:
    """How much a low or set sun takes off the logarithm of the scale."""
    half_pi, lowest = number(math.pi / 2), number(sky.sun_zenith_range[1])
    rate = float(exact(sky.dimming[k]))
    low = f"{number(rate)} * max(min(sun_zenith, {half_pi}) - {lowest}, 0)" if rate else "0"
    dims = dims_at_night(sky.kind)
    if not dims[k % len(dims)]:
        return (Line("fall", low),)
    night = f"{number(TWILIGHT_DECAY)} * max(sun_zenith - {half_pi}, 0)"
    return (Line("fall", f"{low} + {night}" if rate else night),)


def _xyY_of_angles(sky: FormulaSky, names: tuple[str, ...], swept: tuple[str, ...]) -> Function:
    """The channels together, as chromaticity and luminance."""
    lines = []
    held = swept
    if swept:
        low, high = map(number, sky.parameter_range)
        held = ("held",)
        lines.append(Line("held", f"clamp({swept[0]}, {low}, {high})"))
    prefix = "" if sky.wavelengths is not None else "channel_"
    passed = ", ".join(("cos_view", "gamma", "sun_zenith", *held))
    lines += [Line(f"value{k}", f"{prefix}{name}({passed})") for k, name in enumerate(names)]
    values = [f"value{k}" for k in range(len(names))]
    matrix = _to_xyz(sky)
    if matrix is None:
        result = f"vector({', '.join(values)})"
    else:
        sums = [
            " + ".join(f"{number(w)} * {v}" for w, v in zip(row, values, strict=True))
            for row in matrix
        ]
        lines += [Line(c, total) for c, total in zip("XYZ", sums, strict=True)]
        result = "xyz_to_xyY(vector(X, Y, Z))"
    return Function(
        "xyY_of_angles",
        "Chromaticity x, y and luminance Y [cd/m^2] from the cosine of the view's zenith angle,\n"
        "the angle gamma between view and sun, and the sun's zenith angle [rad].",
        ("cos_view", "gamma", "sun_zenith", *swept),
        tuple(lines),
        result,
        returns_vector=True,
        public=True,
    )


def _to_xyz(sky: FormulaSky):
    """Weights of the channels in X, Y and Z; None where they are x, y and Y."""
    if sky.wavelengths is not None:
        return np.asarray(xyz_weights(sky.wavelengths), float).T
    return {"Yxy": None, "XYZ": np.eye(3), "RGB": np.linalg.inv(srgb_matrix())}[sky.kind]


def _numbers(sky: FormulaSky, names: tuple[str, ...]) -> dict:
    return {
        "kind": sky.kind,
        "shape": sky.shape.describe(),
        "dependence": sky.basis.describe(),
        "numbers": dict(zip(names, exact(sky.numbers).tolist(), strict=True)),
        "scale": {
            "formula": "exp(sum of numbers times terms)",
            "dependence": sky.scale_basis.describe(),
            "numbers": dict(zip(names, exact(sky.scales).tolist(), strict=True)),
            "dimming": dict(zip(names, exact(sky.dimming).tolist(), strict=True)),
        },
    }
