"""Description of `FormulaSky` as source code: distribution, coefficients, scale, channels."""

import numpy as np

from ..colour import D65_WHITE, srgb_matrix, xyz_weights
from ..models.basis import SUN
from ..models.formula import CHANNEL_KINDS, FormulaSky
from ..models.scale import LogScale, PaperZenith
from .dependence import Terms
from .description import Description, Function, Line, exact, needed, number
from .distributions import distribution, linked
from .frame import framed
from .names import argument_names
from .scales import scale_functions, scale_of_channel


# Some compilers of shaders refuse anything but ASCII, in comments too.
_ASCII = str.maketrans(
    {"θ": "theta", "γ": "gamma", "χ": "chi", "Σ": "sum of", "π": "pi", "²": "^2", "√": "sqrt"}
)
_POLICY = {
    PaperZenith: (
        "A view below the horizon sees the brightness of the horizon. With the sun below the\n"
        "horizon the zenith keeps its colour of sunset and dims by a decade for every 2.5\n"
        "degrees. Luminance is never negative, and nothing jumps."
    ),
    LogScale: (
        "A view below the horizon sees the brightness of the horizon. A sun lower than the valid\n"
        "range dims the sky at a constant rate, and below the horizon by a decade for every 2.5\n"
        "degrees; parameters are held at the nearest end of their range. Nothing jumps."
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
    names = dict(zip((name for name, _ in sky.ranges), swept, strict=True)) | {SUN: SUN}
    channels = _channels(sky)
    scales = scale_functions(sky.scale, swept)
    functions = (
        *distribution(sky.distribution),
        *scales,
        *(_channel(sky, k, name, names, swept) for k, name in enumerate(channels)),
        *(() if sky.kind == "Yxy" else (_XYZ_TO_XYY,)),
        _xyY_of_angles(sky, channels, swept),
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


def _channel(sky: FormulaSky, k: int, name: str, names, swept: tuple[str, ...]) -> Function:
    """One channel: its scale, its coefficients and their distribution."""
    terms = Terms(sky.basis, names)
    lines = list(terms.lines)
    links = sky.distribution.links if sky.linked else ("identity",) * len(sky.distribution.names)
    for letter, link, numbers in zip(
        sky.distribution.names, links, exact(sky.numbers[k]), strict=True
    ):
        parts, free = terms.sum(letter, numbers)
        lines += [*parts, Line(letter, linked(free, link))]
    more, scale = scale_of_channel(sky.scale, k, name, names, swept)
    lines += more
    coefficients = ", ".join(sky.distribution.names)
    value = f"{scale} * distribution({coefficients}, cos_view, gamma)"
    if sky.distribution.relative:
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


def _xyY_of_angles(sky: FormulaSky, names: tuple[str, ...], swept: tuple[str, ...]) -> Function:
    """The channels together, as chromaticity and luminance."""
    lines = []
    held = tuple(f"held_{name}" for name in swept)
    for (_, ends), variable, kept in zip(sky.ranges, swept, held, strict=True):
        low, high = map(number, ends)
        comment = f"Outside the valid range, {variable} is held at the nearest end."
        lines.append(Line(kept, f"clamp({variable}, {low}, {high})", comment))
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
