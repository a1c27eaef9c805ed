"""What a picture may add to an exported sky: the sun, a tone curve, the encoding of sRGB."""

import math

import numpy as np

from ..constants import SUN_ANGULAR_RADIUS
from ..sun.light import limb_exponent
from ..tables import read_table
from .description import Function, Line, number, polynomial


_LIMB = float(limb_exponent(550.0)) / 2  # of 1 - r², whose root is µ


def sun_functions() -> tuple[Function, ...]:
    """The sun's disc: its brightness by direction, and its colour by turbidity."""
    return (_sun_disc(), _sun_xyz())


def _sun_disc() -> Function:
    exponent, radius = number(_LIMB), number(SUN_ANGULAR_RADIUS)
    return Function(
        "sun_disc",
        "Brightness of the sun's disc in a direction over the mean of the whole disc: darker at\n"
        "the limb, 0 beside it and below the horizon. Times the sun's colour it adds to the sky.",
        ("direction", "sun_direction"),
        (
            Line("radius", f"angle_between(direction, sun_direction) / {radius}"),
            Line("square", "max(1 - radius * radius, 1e-6)"),
            Line("disc", f"(1 + {exponent}) * pow(square, {exponent})"),
            Line("seen", "where(direction.z > 0, disc, 0)"),
        ),
        "where(radius < 1, seen, 0)",
        public=True,
    )


def _sun_xyz() -> Function:
    lines = [
        Line("day", f"clamp(sun_zenith, 0, {number(math.pi / 2)})"),
        Line("height", f"93.885 - {number(180 / math.pi)} * day"),
        Line("root", "sqrt(1 / (cos(day) + 0.15 * pow(height, -1.253)))"),
        Line("hazy", "clamp(haze, 1.9, 10)"),
    ]
    powers = read_table("sun_disc_powers")
    for channel in "XYZ":
        table = np.stack([powers[f"haze{k}"] for k in (3, 2, 1, 0)], axis=1)
        rows = [f"{channel}{k}" for k in (3, 2, 1, 0)]
        lines += [
            Line(name, polynomial(row, "hazy"))
            for name, row in zip(rows, table[powers["channel"] == channel], strict=True)
        ]
        text = rows[0]
        for row in rows[1:]:
            text = f"({text}) * root + {row}"
        lines.append(Line(channel, f"exp({text})"))
    return Function(
        "sun_xyz",
        "CIE XYZ [cd/m^2] of the sun's disc, the mean over it, through haze of a turbidity of 1.9\n"
        "to 10: Preetham, Shirley & Smits (1999), appendix A.1, within 2 % in X and Y, 6 % in Z.",
        ("sun_zenith", "haze"),
        tuple(lines),
        "vector(X, Y, Z)",
        returns_vector=True,
        public=True,
    )


_TONE_OF = Function(
    "tone_of",
    "Narkowicz's (2016) fit of the ACES curve, for one channel; from 0 to 1.",
    ("value",),
    (Line("light", "max(value, 0)"),),
    "min(light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14), 1)",
)
_ENCODED = Function(
    "encoded",
    "The transfer curve of sRGB, IEC 61966-2-1, for one channel.",
    ("value",),
    (Line("curved", f"1.055 * pow(max(value, 0.0031308), {number(1 / 2.4)}) - 0.055"),),
    "where(value > 0.0031308, curved, 12.92 * value)",
)
ON_SCREEN = (
    _TONE_OF,
    _ENCODED,
    Function(
        "tone",
        "Linear sRGB as a screen can show it, 0 to 1. A grey as bright as `white` [cd/m^2] is\n"
        "shown as 0.8; at ISO 100, `white` is 1.2 * 2^EV. Under a clear sky 20 000 is a start.",
        ("colour", "white"),
        (),
        "vector(tone_of(colour.x / white), tone_of(colour.y / white), tone_of(colour.z / white))",
        returns_vector=True,
        public=True,
    ),
    Function(
        "encode",
        "Encoded sRGB of linear sRGB: the last step, where the renderer does not do it itself.",
        ("colour",),
        (),
        "vector(encoded(colour.x), encoded(colour.y), encoded(colour.z))",
        returns_vector=True,
        public=True,
    ),
)
