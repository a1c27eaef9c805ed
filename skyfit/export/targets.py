"""Skies as files that renderers take as they are: templates around the languages."""

from collections.abc import Mapping
from importlib import resources

from jinja2 import Environment, StrictUndefined

from ..constants import SUN_ANGULAR_RADIUS, SUN_SOLID_ANGLE
from .description import Description, number, reached
from .dialect import AbstractDialect
from .frame import framed
from .languages import Glsl, Godot, Hlsl, JavaScript, Python


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
        if language == "hlsl-struct":
            return Hlsl(name, ()).structure(_fields(description))
        dialect = _LANGUAGES[language.removesuffix("-bare")]
        functions = framed(description, single=dialect.single)
        functions = reached(functions, *names) if names else functions
        writer = dialect(name, functions)
        if language.endswith("-bare"):
            return "\n\n".join(map(writer.function, functions))
        text = writer.body(functions)
        if language == "glsl" and "frame_of_angle" not in writer.functions:
            return f"{writer.structure(_fields(description))}\n\n{text}"
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
    }
    source = (resources.files("skyfit.export") / "targets" / TEMPLATES[target]).read_text("utf-8")
    environment = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    return environment.from_string(source).render(words)


def _fields(description: Description) -> tuple[str, ...]:
    return next(function.fields for function in description.functions if function.fields)


def _parameter(argument: str, low: float, high: float) -> dict[str, str]:
    """What templates say of a parameter; in the middle of its range, or at 3, as turbidity is."""
    middle = 3.0 if low <= 3.0 <= high else (low + high) / 2
    ends = {"low": _decimal(low), "high": _decimal(high), "middle": _decimal(middle)}
    return {"argument": argument, "words": f"{argument}, from {low:.6g} to {high:.6g}", **ends}


def _decimal(value: float) -> str:
    """A number that no language takes for an integer."""
    text = f"{value:.6g}"
    return text if any(mark in text for mark in ".e") else f"{text}.0"
