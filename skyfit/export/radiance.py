"""A sky for Radiance: a function file of the formula, and a scene with one sun's numbers."""

import ast
import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..angles import unit_vector
from ..colour import xyY_to_xyz
from ..constants import SUN_ANGULAR_RADIUS
from ..models.formula import FormulaSky
from ..sun.light import sun_xyY, visible_fraction
from .description import Description, Line, frame_fields
from .dialect import Expressions
from .frame import framed
from .straight import Straight


# Radiance's own: "Radiance reference manual", section 2.2; color.h of its sources
_PRIMARIES = np.array([[0.640, 0.330], [0.290, 0.600], [0.150, 0.060]])
_WHITE = np.array([1 / 3, 1 / 3])
_LUMENS_PER_WATT = 179.0
_LEAST_EXPONENT = "-700"  # `exp` complains of less


class Calc(Expressions):
    """Radiance's function files: definitions of names, evaluated where they are needed."""

    def opening(self, heading: list[str]) -> str:
        """The comment at the top, in braces, which it may not have itself."""
        lines = "\n".join(f"  {line}".rstrip() for line in heading)
        return f"{{\n{lines.replace('{', '(').replace('}', ')')}\n}}"

    def definition(self, line: Line) -> str:
        """A name defined by an expression of names made before."""
        return f"{self.prefix}_{line.name} = {self.expression(line.expression)};"

    def _write(self, node: ast.expr):
        match node:
            case ast.Name(id=name):
                return (name if name in ("Dx", "Dy", "Dz") else f"{self.prefix}_{name}"), 4
            case ast.Compare(left=left, ops=[ast.Gt()], comparators=[right]):
                return f"{self._inside(left, 1)} - {self._inside(right, 2)}", 0
            case ast.Compare(left=left, ops=[ast.Lt()], comparators=[right]):
                return f"{self._inside(right, 1)} - {self._inside(left, 2)}", 0
        return super()._write(node)

    def _call(self, name: str, arguments: list[str]) -> str:
        if name == "exp":
            return f"exp(max({_LEAST_EXPONENT}, {arguments[0]}))"
        if name == "pow":
            return f"({arguments[0]})^({arguments[1]})"
        return super()._call(name, arguments)

    def where(self, condition: str, if_true: str, if_false: str) -> str:
        """A choice: the second where the first is above 0."""
        return f"if({condition}, {if_true}, {if_false})"

    def clamp(self, value: str, low: str, high: str) -> str:
        """A value held between two others."""
        return f"min(max({value}, {low}), {high})"

    def number(self, value: float) -> str:
        """A number."""
        return f"{value:.12g}"


def function_file(description: Description, name: str, heading: list[str]) -> str:
    """The function file: red, green and blue along a ray, from a frame's numbers as arguments."""
    functions = framed(description, single=False)
    fields = frame_fields(description)
    given = [Line(field, f"arg({k})") for k, field in enumerate(fields, 1)]
    sun = [f"sun_{axis}" for axis in "xyz"]
    given += [Line(axis, f"arg({k})") for k, axis in enumerate(sun, 1 + len(fields))]
    straight = Straight(functions, (line.name for line in given))
    view = tuple(ast.Name(axis) for axis in ("Dx", "Dy", "Dz"))
    xyz = straight.call(
        "frame_xyz",
        {
            "frame": {field: ast.Name(field) for field in fields},
            "direction": view,
            "sun_direction": tuple(ast.Name(axis) for axis in sun),
        },
    )
    assert isinstance(xyz, tuple)
    rows = zip(("red", "green", "blue"), _radiance_matrix(), strict=True)
    lines = [*straight.lines, *(Line(channel, _weighted(row, xyz)) for channel, row in rows)]
    dialect = Calc(name, ())
    top = [
        *heading,
        "",
        "Arguments, one by one, as they are named below.",
        f"Where they come from, and how {name}_red, {name}_green and {name}_blue are used: the",
        "scene (.rad) that is written beside this file.",
    ]
    body = [f"{name}_{line.name} = {line.expression};" for line in given]
    body += [dialect.definition(line) for line in lines]
    return "\n".join([dialect.opening(top), "", *body]) + "\n"


def scene(
    sky: FormulaSky, name: str, sun: tuple[float, float], heading: list[str], file: str
) -> str:
    """The scene: sun and sky of a formula, z up, x east, y north.

    Args:
        sky: Sky at the parameters of the scene.
        name: What names in the function file begin with.
        sun: Zenith angle and compass azimuth of the sun [rad].
        heading: Comment at the top.
        file: Name of the function file.
    """
    zenith, azimuth = sun
    towards = np.asarray(unit_vector(jnp.asarray(zenith), jnp.asarray(math.pi / 2 - azimuth)))
    numbers = " ".join(f"{value:.9g}" for value in (*frame_numbers(sky, zenith), *towards))
    count = numbers.count(" ") + 1
    direction = " ".join(f"{value:.9g}" for value in towards)
    solar = ["# No sun: the sky does not tell what dims it."]
    if "turbidity" in sky.swept:
        solar = _sun(float(sky.swept["turbidity"]), zenith, name, direction)
    return "\n".join(
        [
            *(f"# {line}".rstrip() for line in heading),
            "",
            *solar,
            "",
            f"void colorfunc {name}_light",
            f"4 {name}_red {name}_green {name}_blue {file}",
            "0",
            f"{count} {numbers}",
            "",
            f"{name}_light glow {name}_glow",
            "0",
            "0",
            "4 1 1 1 0",
            "",
            f"{name}_glow source {name}_dome",
            "0",
            "0",
            "4 0 0 1 180",
            "",
        ]
    )


def frame_numbers(sky: FormulaSky, sun_zenith: float) -> Float[np.ndarray, " field"]:
    """The numbers of a frame, in the order of its fields."""
    sun = jnp.asarray(sun_zenith, float)
    table = sky.coefficients(sun)
    overhead = jnp.ones_like(sun), sun, jnp.cos(sun)
    over = jnp.stack([sky.distribution.value(row, *overhead) for row in table])
    scale = sky.zenith(sun) / over
    return np.concatenate([np.asarray(table, float), np.asarray(scale, float)[:, None]], 1).ravel()


def _sun(turbidity: float, zenith: float, name: str, direction: str) -> list[str]:
    above = float(visible_fraction(jnp.asarray(zenith)))
    if above == 0:
        return ["# No sun: it has set."]
    xyz = np.asarray(xyY_to_xyz(sun_xyY(turbidity, zenith)), float)
    light = " ".join(f"{max(value, 0):.6g}" for value in _radiance_matrix() @ xyz)
    return [
        f"void light {name}_sunlight",
        "0",
        "0",
        f"3 {light}",
        "",
        f"{name}_sunlight source {name}_sun",
        "0",
        "0",
        f"4 {direction} {math.degrees(2 * SUN_ANGULAR_RADIUS):.4g}",
    ]


def _radiance_matrix() -> Float[np.ndarray, "3 3"]:
    """Radiance's red, green and blue [W m⁻² sr⁻¹] of CIE XYZ [cd m⁻²]."""
    import colour

    to_xyz = colour.normalised_primary_matrix(_PRIMARIES, _WHITE)
    return np.linalg.inv(to_xyz) / _LUMENS_PER_WATT


def _weighted(weights: np.ndarray, parts) -> str:
    pairs = zip(weights, parts, strict=True)
    return " + ".join(f"{weight:.12g} * {ast.unparse(part)}" for weight, part in pairs)
