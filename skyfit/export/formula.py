"""Description of `FormulaSky` as source code: distribution, coefficients, scale, channels."""

import numpy as np

from ..colour import D65_WHITE, srgb_matrix, xyz_weights
from ..models.axes import SUN
from ..models.formula import CHANNEL_KINDS, FormulaSky
from ..models.scale import LogScale, PaperZenith
from .dependence import Terms
from .description import FRAME, Description, Function, Line, exact, needed, number
from .distributions import distribution, linked
from .frame import framed
from .names import argument_names
from .scales import scale_functions, scale_of_channel


# Some compilers of shaders refuse anything but ASCII, in comments too.
_ASCII = str.maketrans(
    {"θ": "theta", "γ": "gamma", "χ": "chi", "Σ": "sum of", "π": "pi", "²": "^2", "√": "sqrt"}
)
_BELOW = (
    "A view below the horizon goes on with the sky: the factor of the view's zenith angle is held\n"
    "at the horizon's, the angle to the sun stays the true one. It is no ground, and as bright as\n"
    "the horizon only at the horizon."
)
_POLICY = {
    PaperZenith: (
        f"{_BELOW}\n"
        "With the sun below the horizon the zenith keeps its colour of sunset and dims by a\n"
        "decade for every 2.5 degrees. Luminance is never negative, and nothing jumps."
    ),
    LogScale: (
        f"{_BELOW}\n"
        "A sun lower than the valid range dims the sky at a constant rate, and below the horizon\n"
        "by a decade for every 2.5 degrees; parameters are held at the nearest end of their\n"
        "range. Nothing jumps."
    ),
}
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
    """Describe a formula for any values of its parameters."""
    swept = tuple(f"swept_{k}" for k in range(len(sky.ranges)))
    others = framed(_described(sky, swept), single=False) + framed(
        _described(sky, swept), single=True
    )
    return _described(sky, argument_names((name for name, _ in sky.ranges), others))


def _described(sky: FormulaSky, swept: tuple[str, ...]) -> Description:
    """The formula with these names for its parameters."""
    names = dict(zip((name for name, _ in sky.ranges), _held(swept), strict=True)) | {SUN: SUN}
    channels = _channels(sky)
    scales = scale_functions(sky.scale, swept)
    functions = (
        *distribution(sky.distribution),
        *scales,
        _frame(sky, channels, names, swept),
        *(_channel(sky, channel, swept) for channel in channels),
        *(() if sky.kind == "Yxy" else (_XYZ_TO_XYY,)),
        _frame_xyY_of_angles(sky, channels),
        _xyY_of_angles(swept),
    )
    relative = " / F(0, theta_sun)" if sky.distribution.relative else ""
    what = "zenith value" if scales else "scale"
    formula = (
        f"Each of {', '.join(channels)} = {what} * F(theta, gamma){relative},\n"
        "the coefficients of F depending on what was swept and on the sun;\n"
        f"{sky.distribution.formula.translate(_ASCII)}"
    )
    policy = _POLICY[type(sky.scale)]
    return Description(functions, swept, _numbers(sky, channels), formula, policy)


def _channels(sky: FormulaSky) -> tuple[str, ...]:
    if sky.wavelengths is None:
        return CHANNEL_KINDS[sky.kind]
    bands = [f"{float(band):g}".replace(".", "_") for band in np.asarray(sky.wavelengths)]
    return tuple(f"radiance_{band}nm" for band in bands)


def _frame(sky: FormulaSky, channels: tuple[str, ...], names, swept: tuple[str, ...]) -> Function:
    """All that depends on the sun and the parameters alone: coefficients, and what they weigh."""
    lines = []
    for (_, ends), held, given in zip(sky.ranges, _held(swept), swept, strict=True):
        low, high = map(number, ends)
        comment = f"Outside the valid range, {given} is held at the nearest end."
        lines.append(Line(held, f"clamp({given}, {low}, {high})", comment))
    terms = Terms(sky.basis, names)
    lines += terms.lines
    letters = sky.distribution.names
    links = sky.distribution.links if sky.linked else ("identity",) * len(letters)
    for k, channel in enumerate(channels):
        for letter, link, numbers in zip(letters, links, exact(sky.numbers[k]), strict=True):
            name = f"{letter}_{channel}"
            parts, free = terms.sum(name, numbers)
            lines += [*parts, Line(name, linked(free, link))]
        more, scale = scale_of_channel(sky.scale, k, channel, names, _held(swept))
        lines += more
        if sky.distribution.relative:
            coefficients = ", ".join(f"{letter}_{channel}" for letter in letters)
            scale += f" / distribution({coefficients}, 1, sun_zenith)"
        lines.append(Line(f"scale_{channel}", scale))
    fields = tuple(f"{name}_{channel}" for channel in channels for name in (*letters, "scale"))
    return Function(
        "frame_of_angle",
        "What is the same for every direction under one sun, from its zenith angle [rad]:\n"
        "coefficients of each channel, and its factor.",
        ("sun_zenith", *swept),
        needed(list(dict.fromkeys(lines)), " ".join(fields)),
        "",
        public=True,
        returns_frame=True,
        fields=fields,
    )


def _held(swept: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"held_{name}" for name in swept)


def _value(sky: FormulaSky, channel: str) -> str:
    """One channel in a frame."""
    coefficients = ", ".join(f"frame.{letter}_{channel}" for letter in sky.distribution.names)
    return f"frame.scale_{channel} * distribution({coefficients}, cos_view, gamma)"


def _channel(sky: FormulaSky, channel: str, swept: tuple[str, ...]) -> Function:
    """One channel under any sun."""
    spectral = sky.wavelengths is not None
    return Function(
        channel if spectral else f"channel_{channel}",
        "Spectral radiance [W/(m^2 sr nm)]." if spectral else f"{channel} of the sky.",
        ("cos_view", "gamma", "sun_zenith", *swept),
        (_frame_line(swept),),
        _value(sky, channel),
        public=spectral,
    )


def _frame_line(swept: tuple[str, ...]) -> Line:
    return Line(FRAME, f"frame_of_angle({', '.join(('sun_zenith', *swept))})")


def _frame_xyY_of_angles(sky: FormulaSky, channels: tuple[str, ...]) -> Function:
    """The channels together, as chromaticity and luminance."""
    values = [f"value{k}" for k in range(len(channels))]
    lines = [
        Line(value, _value(sky, channel)) for value, channel in zip(values, channels, strict=True)
    ]
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
        "frame_xyY_of_angles",
        "Chromaticity x, y and luminance Y [cd/m^2] in a frame, from the cosine of the view's\n"
        "zenith angle and the angle gamma between view and sun [rad].",
        (FRAME, "cos_view", "gamma"),
        tuple(lines),
        result,
        returns_vector=True,
        public=True,
    )


def _xyY_of_angles(swept: tuple[str, ...]) -> Function:
    return Function(
        "xyY_of_angles",
        "Chromaticity x, y and luminance Y [cd/m^2] from the cosine of the view's zenith angle,\n"
        "the angle gamma between view and sun, and the sun's zenith angle [rad].",
        ("cos_view", "gamma", "sun_zenith", *swept),
        (_frame_line(swept),),
        "frame_xyY_of_angles(frame, cos_view, gamma)",
        returns_vector=True,
        public=True,
    )


def _to_xyz(sky: FormulaSky):
    """Weights of the channels in X, Y and Z; None where they are x, y and Y."""
    if sky.wavelengths is not None:
        return np.asarray(xyz_weights(sky.wavelengths), float).T
    return {"Yxy": None, "XYZ": np.eye(3), "RGB": np.linalg.inv(srgb_matrix())}[sky.kind]


def _numbers(sky: FormulaSky, names: tuple[str, ...]) -> dict:
    if isinstance(sky.scale, PaperZenith) and not sky.linked:
        tables = exact(sky.numbers)
        if not sky.basis.axes:
            tables = np.concatenate([np.zeros_like(tables), tables], axis=2)
        letters = sky.distribution.names
        return {
            "coefficients": {
                channel: dict(zip(letters, table.tolist(), strict=True))
                for channel, table in zip(names, tables, strict=True)
            },
            "zenith": {
                channel: {part: exact(value).tolist() for part, value in parts.items()}
                for channel, parts in sky.scale.numbers().items()
            },
        }
    return {
        "kind": sky.kind,
        "distribution": sky.distribution.describe(),
        "linked": sky.linked,
        "basis": sky.basis.describe(),
        "numbers": dict(zip(names, exact(sky.numbers).tolist(), strict=True)),
        "scale": sky.scale.describe(),
    }
