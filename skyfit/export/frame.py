"""What every exported sky has around its formula: angles from directions, and colour spaces."""

from ..colour import srgb_matrix
from ..models.directions import arcsine_ratio
from .description import FRAME, Description, Function, Line, number, polynomial
from .screen import ON_SCREEN, sun_functions


def framed(description: Description, *, single: bool) -> tuple[Function, ...]:
    """All functions of a file: the formula's own between those for directions and for colours.

    Args:
        description: Description of the sky.
        single: Whether the language has single precision only.
    """
    half = _HALF_ANGLE_IN_SINGLE if single else _HALF_ANGLE
    before = (half, _ANGLE_BETWEEN, _GAMMA)
    colours = (_XYY_TO_XYZ, _XYZ_TO_RGB, *_views(description.swept))
    return (*before, *description.functions, *colours, *sun_functions(), *ON_SCREEN)


_SERIES = tuple(reversed(arcsine_ratio(6)))

_HALF_ANGLE = Function(
    "half_angle",
    "Half of the angle whose half has this squared sine.",
    ("square",),
    (),
    "asin(sqrt(min(square, 1)))",
)
_HALF_ANGLE_IN_SINGLE = Function(
    "half_angle",
    "Half of the angle whose half has this squared sine, within 1.5e-7: arcsines that shader\n"
    "languages bring may be off by 1e-4.",
    ("square",),
    (
        Line("nearer", "max(min(square, 1 - square), 0)"),
        Line("series", polynomial(_SERIES[:4], "nearer")),
        Line("ratio", polynomial(("series", *_SERIES[4:]), "nearer")),
        Line("root", "sqrt(nearer) * ratio"),
    ),
    "where(square < 0.5, root, 1.5707963267949 - root)",
)
_ANGLE_BETWEEN = Function(
    "angle_between",
    "Angle between two unit vectors [rad], from their chord: exact where they meet.",
    ("direction", "sun_direction"),
    tuple(Line(c, f"direction.{c} - sun_direction.{c}") for c in "xyz"),
    "2 * half_angle((x * x + y * y + z * z) / 4)",
)
_GAMMA = Function(
    "gamma",
    "Angle between view and sun [rad] from their zenith angles and the view's azimuth, 0 towards\n"
    "the sun.",
    ("sun_zenith", "view_zenith", "relative_azimuth"),
    (
        Line("rise", "sin((view_zenith - sun_zenith) / 2)"),
        Line("turn", "sin(relative_azimuth / 2)"),
    ),
    "2 * half_angle(rise * rise + sin(view_zenith) * sin(sun_zenith) * turn * turn)",
    public=True,
)
_XYY_TO_XYZ = Function(
    "xyY_to_xyz",
    "CIE XYZ of a chromaticity x, y and a luminance Y.",
    ("colour",),
    (Line("scale", "where(colour.y > 0, colour.z, 0) / max(colour.y, 1e-6)"),),
    "vector(scale * colour.x, scale * colour.y, scale * (1 - colour.x - colour.y))",
    returns_vector=True,
)
_XYZ_TO_RGB = Function(
    "xyz_to_rgb",
    "Linear sRGB of CIE XYZ.",
    ("colour",),
    tuple(
        Line(name, " + ".join(f"{number(k)} * colour.{c}" for k, c in zip(row, "xyz", strict=True)))
        for name, row in zip(("red", "green", "blue"), srgb_matrix(), strict=True)
    ),
    "vector(red, green, blue)",
    returns_vector=True,
)


def _views(swept: tuple[str, ...]) -> tuple[Function, ...]:
    """The functions of direction and sun that a renderer calls: with a frame, and at once."""
    more = "".join(f", {name}" for name in swept)
    # The sun's zenith angle by its chord to the zenith, like every angle here.
    up = "angle_between(sun_direction, vector(0, 0, 1))"
    vectors = ("direction", "sun_direction")
    gamma = Line("gamma", "angle_between(direction, sun_direction)")
    colours = (
        ("xyY", "Chromaticity x, y and luminance Y [cd/m^2] of the sky in a direction"),
        ("xyz", "CIE XYZ [cd/m^2] of the sky"),
        ("rgb", "Linear sRGB of the sky, not clipped; D65 white of 1 cd/m^2 is (1, 1, 1)"),
    )
    in_frame = (
        "frame_xyY_of_angles(frame, direction.z, gamma)",
        "xyY_to_xyz(frame_xyY(frame, direction, sun_direction))",
        "xyz_to_rgb(frame_xyz(frame, direction, sun_direction))",
    )

    def view(name, doc, arguments, body, result):
        return Function(name, doc, arguments, body, result, returns_vector=True, public=True)

    frame = Function(
        "frame_of",
        "What is the same for every direction under one sun: make it once for a picture.",
        ("sun_direction", *swept),
        (),
        f"frame_of_angle({up}{more})",
        returns_frame=True,
        public=True,
    )
    return (
        frame,
        *(
            view(
                f"frame_{name}",
                f"{doc}, in a frame.",
                (FRAME, *vectors),
                (gamma,) if name == "xyY" else (),
                result,
            )
            for (name, doc), result in zip(colours, in_frame, strict=True)
        ),
        *(
            view(
                name,
                f"{doc}.",
                (*vectors, *swept),
                (Line(FRAME, f"frame_of(sun_direction{more})"),),
                f"frame_{name}(frame, direction, sun_direction)",
            )
            for name, doc in colours
        ),
    )
