"""Skies as files that renderers take as they are: templates around the languages."""

import ast
from collections.abc import Mapping
from importlib import resources
from typing import Any

from jinja2 import Environment, StrictUndefined

from ..constants import SUN_ANGULAR_RADIUS, SUN_SOLID_ANGLE
from .description import Description, frame_fields, number, reached
from .dialect import AbstractDialect
from .frame import framed
from .languages import Glsl, Godot, Hlsl, JavaScript, Python
from .straight import Straight


TEMPLATES = {
    "threejs": "threejs.js.j2",
    "blender": "blender.py.j2",
    "godot": "godot.gdshader.j2",
    "unity": "unity.shader.j2",
    "unreal": "unreal.hlsl.j2",
    "shadertoy": "shadertoy.glsl.j2",
}
_LANGUAGES: dict[str, type[AbstractDialect]] = {
    "js": JavaScript,
    "glsl": Glsl,
    "hlsl": Hlsl,
    "godot": Godot,
    "python": Python,
}
_PLAIN_HAZE = "3.0"  # before the sun, where the sky's own parameters do not tell it


def write_target(
    target: str,
    description: Description,
    ranges: Mapping[str, tuple[float, float]],
    name: str,
    heading: list[str],
) -> str:
    """The file of a renderer.

    Args:
        target: One of `TEMPLATES`.
        description: The sky.
        ranges: Ends of what was swept, by its name in the sky.
        name: What the names of all functions begin with.
        heading: Lines of the comment at the top.
    """

    def code(language: str, *names: str) -> str:
        """Functions in a language: all, or these and what they call."""
        dialect = _LANGUAGES[language]
        functions = framed(description, single=dialect.single)
        functions = reached(functions, *names) if names else functions
        writer = dialect(name, functions)
        text = writer.body(functions)
        if language == "glsl" and "frame_of_angle" not in writer.functions:
            return f"{writer.structure(frame_fields(description))}\n\n{text}"
        return text

    arguments = description.swept
    parameters = [_parameter(a, *ends) for a, ends in zip(arguments, ranges.values(), strict=True)]
    place = list(ranges).index("turbidity") if "turbidity" in ranges else None
    haze = None if place is None else arguments[place]
    words = {
        "name": name,
        "class": "".join(part.capitalize() for part in name.split("_")) + "Dome",
        "parameters": parameters,
        "arguments": "".join(f", {argument}" for argument in arguments),
        "given": "".join(f", given_{argument}" for argument in arguments),
        "haze": haze or _PLAIN_HAZE,
        "given_haze": f"given_{haze}" if haze else _PLAIN_HAZE,
        "listed_haze": _PLAIN_HAZE if place is None else f"PARAMETERS[{place}]",
        "solid_angle": number(SUN_SOLID_ANGLE),
        "diameter": number(2 * SUN_ANGULAR_RADIUS),
        "commented": lambda mark: "\n".join(f"{mark}{line}".rstrip() for line in heading),
        "code": code,
        "written_out": _written_out(description, f"given_{haze}" if haze else _PLAIN_HAZE),
    }
    source = (resources.files("skyfit.export") / "targets" / TEMPLATES[target]).read_text("utf-8")
    environment = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    return environment.from_string(source).render(words)


def _written_out(description: Description, haze: str) -> dict[str, Any]:
    """Sky and sun without functions: lines of HLSL, and names of what they make."""
    vectors = {
        name: tuple(ast.Name(f"{short}_{axis}") for axis in "xyz")
        for name, short in (("direction", "view"), ("sun_direction", "sun"))
    }
    given = {argument: ast.Name(f"given_{argument}") for argument in description.swept}
    taken = [part.id for vector in vectors.values() for part in vector]
    straight = Straight(framed(description, single=True), [*taken, "light"])
    sky = straight.call("rgb", vectors | given)
    disc = straight.call("sun_disc", vectors)
    up = ast.Constant(0), ast.Constant(0), ast.Constant(1)
    zenith = straight.call(
        "angle_between", {"direction": vectors["sun_direction"], "sun_direction": up}
    )
    before = ast.parse(haze, mode="eval").body
    xyz = straight.call("sun_xyz", {"sun_zenith": zenith, "haze": before})
    sun = straight.call("xyz_to_rgb", {"colour": xyz})
    assert isinstance(sky, tuple)
    assert isinstance(disc, ast.expr)
    assert isinstance(sun, tuple)
    writer = Hlsl("", ())
    lines = "\n".join(text.strip() for line in straight.lines for text in writer.line(line))
    names = {"sky": [ast.unparse(p) for p in sky], "sun": [ast.unparse(p) for p in sun]}
    return {"lines": lines, "disc": ast.unparse(disc), **names}


def _parameter(argument: str, low: float, high: float) -> dict[str, str]:
    """What templates say of a parameter; in the middle of its range, or at 3, as turbidity is."""
    middle = 3.0 if low <= 3.0 <= high else (low + high) / 2
    ends = {"low": _decimal(low), "high": _decimal(high), "middle": _decimal(middle)}
    return {"argument": argument, "words": f"{argument}, from {low:.6g} to {high:.6g}", **ends}


def _decimal(value: float) -> str:
    """A number that no language takes for an integer."""
    text = f"{value:.6g}"
    return text if any(mark in text for mark in ".e") else f"{text}.0"
