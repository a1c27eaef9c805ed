"""`skyfit render`: a sky to a picture."""

from pathlib import Path
from typing import Any

import click
import numpy as np

import skyfit

from .options import as_json
from .output import print_record, progress


PROJECTIONS, PRECISIONS = ("equidistant", "equal-area"), ("half", "float")
TONES, GAMUTS = ("linear", "scs", "reinhard", "aces"), ("desaturate", "clip", "keep")
VIEWS = ("fisheye", "panorama", "perspective")


@click.command()
@click.argument("sky", type=click.Path(path_type=Path), required=False)
@click.option(
    "--out", type=click.Path(path_type=Path), required=True, help="Ends in .exr, .hdr or .png."
)
@click.option("--turbidity", type=float, help="Of the sky, where the file does not say.")
@click.option("--sun-zenith-deg", type=click.FloatRange(0, 180), default=45.0, show_default=True)
@click.option(
    "--sun-azimuth-deg", type=float, default=180.0, show_default=True,
    help="Compass: 0 north, 90 east.",
)  # fmt: skip
@click.option("--view", type=click.Choice(VIEWS), default="fisheye", show_default=True)
@click.option(
    "--projection", type=click.Choice(PROJECTIONS), default="equidistant",
    show_default=True, help="Of a fisheye.",
)  # fmt: skip
@click.option(
    "--height", type=click.IntRange(1, 16384), default=512, show_default=True,
    help="Rows; a panorama is twice as wide, a fisheye square.",
)  # fmt: skip
@click.option("--width", type=click.IntRange(1, 16384), help="Columns of a perspective; 4/3 rows.")
@click.option(
    "--facing-deg", type=float, default=0.0, show_default=True,
    help="Azimuth at a fisheye's top, or in the middle of another view.",
)  # fmt: skip
@click.option("--elevation-deg", type=click.FloatRange(-90, 90), default=10.0, show_default=True)
@click.option("--field-of-view-deg", type=float, default=65.0, show_default=True)
@click.option("--altitude-m", type=click.FloatRange(0), default=0.0, show_default=True)
@click.option("--sun/--no-sun", "sun_disc", default=True, help="Show the sun's disc.")
@click.option("--ground-albedo", type=click.FloatRange(0, 1), default=0.2, show_default=True)
@click.option("--ev", type=float, help="Exposure value (ISO 100) of a PNG; automatic if absent.")
@click.option(
    "--tone", type=click.Choice(TONES), default="aces", show_default=True,
    help="Tone curve of a PNG.",
)  # fmt: skip
@click.option(
    "--gamut", type=click.Choice(GAMUTS), default="desaturate",
    show_default=True, help="What becomes of colours that sRGB does not have.",
)  # fmt: skip
@click.option(
    "--precision", type=click.Choice(PRECISIONS), default="half", show_default=True,
    help="Of an EXR.",
)  # fmt: skip
@click.option("--overwrite", is_flag=True, help="Replace the picture that is there.")
@as_json
def render(sky: Path | None, out: Path, as_json: bool, **options: Any) -> int:
    """Make a picture of a sky: fisheye dome, panorama or perspective.

    SKY is a fit (.json); without it the published model is shown. EXR and HDR files hold
    luminance, a PNG what a camera would show of it.
    """
    look = skyfit.render
    look.check_target(out, options["overwrite"])
    camera = _camera(options)
    source = look.load_source(sky, options["turbidity"])
    with progress("rendering", quiet=as_json):
        picture = look.render(
            source,
            camera,
            np.radians(options["sun_zenith_deg"]),
            np.radians(options["sun_azimuth_deg"]),
            sun_disc=options["sun_disc"],
            ground_albedo=options["ground_albedo"],
        )
    names = ("ev", "tone", "gamut", "precision", "overwrite")
    record = picture.save(out, **{name: options[name] for name in names})
    print_record({"sky": picture.description, **record}, as_json)
    return 0


def _camera(options: dict[str, Any]):
    look, rows = skyfit.render, options["height"]
    facing = np.radians(options["facing_deg"])
    if options["altitude_m"] and options["view"] != "perspective":
        raise click.UsageError("--altitude-m: only for --view perspective")
    if options["view"] == "fisheye":
        return look.Fisheye(rows, options["projection"], facing)
    if options["view"] == "panorama":
        return look.Panorama(rows, facing)
    return look.Perspective(
        options["width"] or round(rows * 4 / 3), rows, facing,
        np.radians(options["elevation_deg"]), np.radians(options["field_of_view_deg"]),
        options["altitude_m"],
    )  # fmt: skip
