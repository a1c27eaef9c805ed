"""The public verb: a sky formula in a language."""

import json
import math
import re
from typing import Any

from .._typing import as_scalar, check
from ..errors import InputError
from ..fitting import SkyFit
from ..models.formula import FormulaSky
from .description import Description
from .dialect import AbstractDialect
from .formula import describe_formula
from .frame import framed
from .heading import heading, provenance_of_fit, provenance_of_model
from .languages import C, Glsl, Hlsl, JavaScript, Python
from .radiance import function_file, scene
from .targets import TEMPLATES, write_target


FORMATS: dict[str, type[AbstractDialect] | None] = {
    "glsl": Glsl,
    "hlsl": Hlsl,
    "c": C,
    "js": JavaScript,
    "python": Python,
    "json": None,
}
RADIANCE = "radiance"
TARGETS = (*TEMPLATES, RADIANCE)
SCHEMA = "skyfit/sky/1"


def export_fit(fit: SkyFit | FormulaSky, format: str, *, name: str = "sky") -> str:
    """Write a sky formula as source code, readable and ready to paste into a renderer.

    The code has functions of the view's and the sun's directions (unit vectors, z up) and of the
    swept parameter, which is an argument: `sky_xyY`, `sky_xyz` and `sky_rgb`, and
    `sky_xyY_of_angles` for who has angles. Below the horizon and at night they follow the same
    policy as the models here (`skyfit.models.base`).

    Args:
        fit: A fit, or a model such as `preetham_sky(3.0)`; its own parameter plays no part.
        format: "glsl", "hlsl", "c" (a header, double precision), "js" (a module), "python" (NumPy
            only) or "json" (the numbers); or a renderer's own file: "threejs", "blender", "godot",
            "unity", "unreal", "shadertoy" or "radiance" (the function file; `radiance_scene` writes
            what uses it).
        name: What the names of all functions begin with.

    Returns:
        The file's text.

    Raises:
        ValueError: Unknown format, or a name that no language takes.
    """
    if format not in (*FORMATS, *TARGETS):
        known = [*FORMATS, *TARGETS]
        raise InputError(f"export_fit(format=...): expected one of {known}; got {format!r}")
    _check_name(name, "export_fit(name=...)")
    sky = _sky(fit)
    description, provenance = describe_formula(sky), _provenance(fit)
    if format == "json":
        return _json(sky, description, provenance)
    top = heading(description, name, provenance)
    if format == RADIANCE:
        return function_file(description, name, _without_use(top))
    if format in TEMPLATES:
        return write_target(format, description, dict(sky.ranges), name, _without_use(top))
    top = [*top, "", *_usage(description, name)]
    dialect = FORMATS[format]
    assert dialect is not None
    functions = framed(description, single=dialect.single)
    return dialect(name, functions).file(top, functions)


def radiance_scene(
    fit: SkyFit | FormulaSky,
    sun_zenith: float,
    sun_azimuth: float = math.pi,
    *,
    name: str = "sky",
    function_file: str | None = None,
    **swept: float,
) -> str:
    """Write sky and sun as a scene of Radiance (.rad): z up, x east, y north.

    It has the numbers of one sun, as `gendaylit` has them, for the function file that
    `export_fit(fit, "radiance", name=name)` writes. The sun's disc is there where turbidity is
    among the parameters: that of `skyfit.sunlight`.

    Args:
        fit: A fit, or a model such as `preetham_sky(3.0)`, whose parameters stand.
        sun_zenith: Zenith angle of the sun, in [0, pi] [rad].
        sun_azimuth: Compass azimuth of the sun [rad].
        name: What the names of what is made begin with, here and in the function file.
        function_file: Name of that file, without blanks; the `name` with .cal if not given.
        **swept: Value of every parameter of a fit, held at the ends of its range.

    Returns:
        The file's text.

    Raises:
        InputError: A sun out of range, parameters that are not the fit's, or a name that is none.
    """
    _check_name(name, "radiance_scene(name=...)")
    zenith = as_scalar(sun_zenith, "radiance_scene(sun_zenith=...)")
    check(zenith, _no_zenith, "radiance_scene(sun_zenith=...) must lie in [0, pi]")
    file = f"{name}.cal" if function_file is None else function_file
    if file != "".join(file.split()):
        raise InputError(f"radiance_scene(function_file=...): expected no blanks; got {file!r}")
    sky = fit.sky(**swept) if isinstance(fit, SkyFit) else fit
    description = describe_formula(sky)
    given = zip(description.swept, sky.swept.values(), strict=True)
    values = "".join(f"{argument} {float(value):.6g}, " for argument, value in given)
    degrees = f"{math.degrees(zenith):.6g} degrees from the zenith"
    top = [
        *_without_use(heading(description, name, _provenance(fit))),
        "",
        f"Here: {values}sun {degrees}, azimuth {math.degrees(sun_azimuth):.6g}.",
        "Radiances are luminances over 179 lm/W.",
    ]
    return scene(sky, name, (float(zenith), float(sun_azimuth)), top, file)


def _provenance(fit: SkyFit | FormulaSky) -> list[str]:
    return provenance_of_fit(fit) if isinstance(fit, SkyFit) else provenance_of_model(fit)


def _check_name(name: str, what: str) -> None:
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or "__" in name or name.startswith("gl_"):
        raise InputError(
            f"{what}: expected a letter, then letters, digits and single underscores; got {name!r}"
        )


def _without_use(top: list[str]) -> list[str]:
    """A heading without the paragraph that tells how the functions are called."""
    first = next(k for k, line in enumerate(top) if line.startswith("Use "))
    return top[:first] + top[top.index("", first) + 1 :]


def _usage(description: Description, name: str) -> list[str]:
    """What else the file has than the functions that its heading names."""
    swept = "".join(f", {argument}" for argument in description.swept)
    return [
        "The same for many directions under one sun, and less work for each:",
        f"frame = {name}_frame_of(sun_direction{swept}), once for a picture;",
        f"{name}_frame_rgb(frame, direction, sun_direction), or _xyz or _xyY, for every pixel.",
        f"Besides, for who wants them: {name}_sun_disc and {name}_sun_xyz, the sun in the sky;",
        f"{name}_tone and {name}_encode, from luminance to what a screen shows.",
    ]


def _sky(fit: SkyFit | FormulaSky) -> FormulaSky:
    if not isinstance(fit, SkyFit):
        return fit
    return fit.sky(**{name: ends[0] for name, ends in fit.swept.items()})


def _json(sky: FormulaSky, description: Description, provenance: list[str]) -> str:
    low, high = map(math.degrees, sky.sun_zenith_range)
    document = {
        "schema": SCHEMA,
        "provenance": provenance,
        "formula": description.formula.split("\n"),
        **_swept(sky),
        "sun_zenith_range_deg": [low, high],
        "units": {"angles": "rad", "luminance": "cd/m^2"},
        **description.numbers,
    }
    return json.dumps(document, indent=1, allow_nan=False) + "\n"


def _swept(sky: FormulaSky) -> dict[str, Any]:
    """The swept parameter, or all of several."""
    entries = [{"name": name, "range": list(ends)} for name, ends in sky.ranges]
    if len(entries) > 1:
        return {"parameters": entries}
    return {"parameter": entries[0] if entries else None}


def _no_zenith(value):
    return ~((value >= 0) & (value <= math.pi))
