"""`skyfit export`: a sky formula as source code."""

import math
from pathlib import Path
from typing import Any

import click

import skyfit
from skyfit._files import refuse_target, write_text
from skyfit.export import FORMATS, TARGETS, radiance_scene
from skyfit.export.write import RADIANCE
from skyfit.fitting import paper_refit
from skyfit.render.source_files import PUBLISHED, REFIT

from .options import FILE, Number, as_json, overwrite, settings
from .output import print_record


@click.command()
@click.argument("sky")
@click.option(
    "--format",
    "--target",
    "language",
    type=click.Choice([*FORMATS, *TARGETS]),
    required=True,
    help="A language: python needs NumPy only, json has the numbers. Or a renderer, for a file "
    "that runs as it is; for radiance, --out ends in .rad, and the .cal is written beside it.",
)
@click.option("--out", type=FILE, required=True, help="File of the code.")
@click.option(
    "--name", default="sky", show_default=True, help="What the functions' names begin with."
)
@click.option(
    "--sun-zenith-deg",
    type=Number(0, 180),
    help="Zenith angle of the sun of a .rad, in degrees; 45 if absent.",
)
@click.option(
    "--sun-azimuth-deg",
    type=Number(),
    help="Azimuth of the sun of a .rad by compass, in degrees; 180 if absent.",
)
@settings
@overwrite
@as_json
def export(
    sky: str, language: str, out: Path, name: str, overwrite: bool, as_json: bool, **scene: Any
) -> int:
    """Write a sky formula as source code for a renderer.

    SKY is a fit file, or the word "published", or "refit": the paper's formula fitted to the
    paper's campaign.

    \b
    skyfit export fit.json --format glsl --out sky.glsl
    skyfit export refit --target threejs --out sky.js
    skyfit export published --target radiance --set turbidity=3 --sun-zenith-deg 50 --out sky.rad
    """  # noqa: D301, click reads the backslash
    files = [out]
    if language == RADIANCE:
        if out.suffix != ".rad":
            raise click.UsageError(f"--out: expected a name that ends in .rad; got {out}")
        files.append(out.with_suffix(".cal"))
    elif any(value not in (None, {}) for value in scene.values()):
        raise click.UsageError("--sun-zenith-deg, --sun-azimuth-deg, --set: only for radiance")
    for file in files:
        refuse_target(file, overwrite=overwrite)
    formula, settings = _formula(sky, scene["settings"] if language == RADIANCE else None)
    texts = [skyfit.export_fit(formula, language, name=name)]
    if language == RADIANCE:
        zenith, azimuth = (scene[f"sun_{angle}_deg"] for angle in ("zenith", "azimuth"))
        sun = math.radians(45.0 if zenith is None else zenith)
        north = math.radians(180.0 if azimuth is None else azimuth)
        found = radiance_scene(
            formula, sun, north, name=name, function_file=files[1].name, **settings
        )
        texts.insert(0, found)
    for file, text in zip(files, texts, strict=True):
        write_text(file, text)
    lines = sum(text.count("\n") for text in texts)
    written = ", ".join(map(str, files))
    print_record({"out": written, "format": language, "lines": lines}, as_json)
    return 0


def _formula(sky: str, settings: dict[str, float] | None):
    """A sky by file or word, and the parameters that it still wants; None where it stays open."""
    if sky != PUBLISHED:
        fit = paper_refit() if sky == REFIT else skyfit.load_fit(Path(sky).expanduser())
        if settings is not None and set(settings) != set(fit.swept):
            wanted = ", ".join(f"{name}=VALUE" for name in fit.swept) or "none"
            raise click.UsageError(f"--set: expected {wanted} for this fit")
        return fit, settings or {}
    if settings is None:
        return skyfit.preetham_sky(2.0), {}  # turbidity is an argument of what is written
    if list(settings) != ["turbidity"]:
        raise click.UsageError("--set: expected turbidity=VALUE for the published model")
    return skyfit.preetham_sky(settings["turbidity"]), {}
