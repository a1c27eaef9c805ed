"""The public verb: a sky formula in a language."""

import json
import math
import re
from typing import Any

from ..errors import InputError
from ..fitting import SkyFit
from ..models.formula import FormulaSky
from .description import Description
from .dialect import AbstractDialect
from .formula import describe_formula
from .frame import framed
from .heading import heading, provenance_of_fit, provenance_of_model
from .languages import C, Glsl, Hlsl, JavaScript, Python


FORMATS: dict[str, type[AbstractDialect] | None] = {
    "glsl": Glsl,
    "hlsl": Hlsl,
    "c": C,
    "js": JavaScript,
    "python": Python,
    "json": None,
}
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
            only) or "json" (the numbers).
        name: What the names of all functions begin with.

    Returns:
        The file's text.

    Raises:
        ValueError: Unknown format, or a name that no language takes.
    """
    if format not in FORMATS:
        raise InputError(f"export_fit(format=...): expected one of {list(FORMATS)}; got {format!r}")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or "__" in name or name.startswith("gl_"):
        raise InputError(
            f"export_fit(name=...): expected a letter, then letters, digits and single "
            f"underscores; got {name!r}"
        )
    sky = _sky(fit)
    description = describe_formula(sky)
    provenance = provenance_of_fit(fit) if isinstance(fit, SkyFit) else provenance_of_model(sky)
    dialect = FORMATS[format]
    if dialect is None:
        return _json(sky, description, provenance)
    functions = framed(description, single=dialect.single)
    top = [*heading(description, name, provenance), "", *_usage(description, name)]
    return dialect(name, functions).file(top, functions)


def _usage(description: Description, name: str) -> list[str]:
    """What else the file has than the functions that its heading names."""
    swept = "".join(f", {argument}" for argument in description.swept)
    return [
        "The same for many directions under one sun, and less work for each:",
        f"frame = {name}_frame_of(sun_direction{swept}), once for a picture, where you set uniforms;",
        f"{name}_frame_rgb(frame, direction, sun_direction), and so _xyz and _xyY, for every pixel.",
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
