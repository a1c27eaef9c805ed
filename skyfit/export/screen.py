"""What a picture may add to an exported sky: the sun, a tone curve, the encoding of sRGB."""

import math
from functools import cache

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..colour import xyY_to_xyz
from ..constants import SUN_ANGULAR_RADIUS
from ..sun.light import air_mass, limb_darkening, sun_xyY, visible_fraction
from .description import Function, Line, number, polynomial


_MIDDLE_OF_LIGHT = 550.0  # nm
_DEGREE = 3


def sun_functions() -> tuple[Function, ...]:
    """The sun's disc: its brightness by direction, and its colour by turbidity."""
    return (_sun_disc(), _sun_xyz())


def _sun_disc() -> Function:
    """Darker at the limb, as `skyfit.sunlight` has it at 550 nm."""
    centre = limb_darkening(jnp.zeros(()), jnp.asarray([_MIDDLE_OF_LIGHT]))
    exponent = number(float(centre[0]) - 1)
    radius = number(SUN_ANGULAR_RADIUS)
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


@cache
def sun_numbers() -> Float[np.ndarray, "3 power power"]:
    """Numbers of ln X, Y, Z of the sun's disc: by powers of the root of air mass and of turbidity.

    The highest power first on both axes; least squares on turbidities 1.9 to 10 and suns 0 to 90
    degrees from the zenith.
    """
    haze, sun = (a.ravel() for a in np.meshgrid(np.linspace(1.9, 10, 12), _suns()))
    above = np.asarray(visible_fraction(jnp.asarray(sun)), float)
    light = np.asarray(xyY_to_xyz(sun_xyY(haze, sun)), float) / above[:, None]
    root = np.sqrt(np.asarray(air_mass(jnp.asarray(sun)), float))
    powers = np.arange(_DEGREE, -1, -1)
    terms = root[:, None, None] ** powers[:, None] * haze[:, None, None] ** powers
    found = np.linalg.lstsq(terms.reshape(len(sun), -1), np.log(light), rcond=None)[0]
    return found.T.reshape(3, _DEGREE + 1, _DEGREE + 1)


def _suns() -> Float[np.ndarray, " sun"]:
    """Zenith angles, closer together where light falls fast [rad]."""
    return np.radians(np.r_[np.linspace(0, 80, 20), np.linspace(81, 90, 20)])


def _sun_xyz() -> Function:
    lines = [
        Line("day", f"clamp(sun_zenith, 0, {number(math.pi / 2)})"),
        Line("height", f"93.885 - {number(180 / math.pi)} * day"),
        Line("root", "sqrt(1 / (cos(day) + 0.15 * pow(height, -1.253)))"),
        Line("hazy", "clamp(haze, 1.9, 10)"),
    ]
    for channel, table in zip("XYZ", sun_numbers(), strict=True):
        rows = [f"{channel}{k}" for k in range(_DEGREE + 1)]
        lines += [
            Line(name, polynomial(row, "hazy")) for name, row in zip(rows, table, strict=True)
        ]
        first, *rest = rows
        text = first
        for row in rest:
            text = f"({text}) * root + {row}"
        lines.append(Line(channel, f"exp({text})"))
    return Function(
        "sun_xyz",
        "CIE XYZ [cd/m^2] of the sun's disc, the mean over it, through haze of a turbidity of 1.9\n"
        "to 10: Preetham, Shirley & Smits (1999), appendix A.1. Y is within 2 % of its integral.",
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
