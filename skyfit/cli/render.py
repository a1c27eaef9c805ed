"""`skyfit render`: a sky to a picture."""

from pathlib import Path
from typing import Any

import click
import numpy as np

import skyfit
from skyfit.render import AIRS, GAMUTS, PRECISIONS, PROJECTIONS, TONES
from skyfit.render.terrain import check_samples

from .interrupt import on_interrupt
from .options import FILE, Number, as_json, overwrite, settings
from .output import print_record, progress
from .place import DAY, hint_at_radians, refuse_still, sun_of_still


VIEWS = ("fisheye", "panorama", "perspective")


@click.command()
@click.argument("sky", type=FILE, required=False)
@click.option(
    "--out",
    type=FILE,
    required=True,
    help="Picture to write: .exr or .hdr with luminances, .png for a screen; .gif or .apng for a "
    "day.",
)
@click.option(
    "--turbidity",
    type=Number(),
    help="Turbidity of the sky, 3 where there is no SKY; or value of what else the file sweeps.",
)
@settings
@click.option(
    "--sun-zenith-deg", type=Number(0, 180), callback=hint_at_radians,
    help="Zenith angle of the sun, in degrees; 45 if absent, or that of the one sky in SKY.",
)  # fmt: skip
@click.option(
    "--sun-azimuth-deg", type=Number(-360, 360),
    help="Azimuth of the sun by compass, in degrees: 0 north, 90 east; 180 if absent.",
)  # fmt: skip
@click.option(
    "--view", type=click.Choice(VIEWS), default="fisheye", show_default=True,
    help="Projection of the picture.",
)  # fmt: skip
@click.option(
    "--projection", type=click.Choice(PROJECTIONS), default="equidistant",
    show_default=True, help="Whether equal distances or equal areas of a fisheye are equal angles.",
)  # fmt: skip
@click.option(
    "--height", type=click.IntRange(1, 16384), default=512, show_default=True,
    help="Rows of the picture; a panorama is twice as wide, a fisheye square.",
)  # fmt: skip
@click.option(
    "--width",
    type=click.IntRange(1, 16384),
    help="Columns of a perspective; 4/3 of the rows if absent.",
)
@click.option(
    "--facing-deg", type=Number(), default=0.0, show_default=True,
    help="Compass azimuth at the top of a fisheye, or in the middle of another view, in degrees.",
)  # fmt: skip
@click.option(
    "--elevation-deg", type=Number(-90, 90), default=10.0, show_default=True,
    help="Elevation of the middle of a perspective, in degrees.",
)  # fmt: skip
@click.option(
    "--field-of-view-deg",
    type=Number(0.01, 180, max_open=True),
    default=65.0,
    show_default=True,
    help="Width of a perspective, in degrees.",
)
@click.option(
    "--altitude-m", type=Number(0), default=0.0, show_default=True,
    help="Altitude of the eye above the ground, in metres; for skies that are simulated (.toml).",
)  # fmt: skip
@click.option("--sun/--no-sun", "sun_disc", default=True, help="Show the sun's disc.")
@click.option(
    "--ground-albedo", type=Number(0, 1),
    help="Albedo of the ground below the horizon; 0.2 if absent, or the atmosphere's own.",
)  # fmt: skip
@click.option(
    "--latitude-deg", type=Number(-90, 90), help="Latitude of the place, in degrees north."
)
@click.option(
    "--longitude-deg", type=Number(-180, 360), help="Longitude of the place, in degrees east."
)
@click.option(
    "--time",
    help="Time of one picture, as 2024-06-21T12:00+02:00; or solar time as 12:00, with "
    "--day-of-year.",
)
@click.option(
    "--day-of-year",
    type=click.IntRange(1, 366),
    help="Day of the year of a solar time, or of a day's frames.",
)
@click.option(
    "--to-sun-zenith-deg", type=Number(0, 180), callback=hint_at_radians,
    help="Zenith angle to which the sun moves from --sun-zenith-deg, for no day, in degrees.",
)  # fmt: skip
@click.option(
    "--frames", type=click.IntRange(1, 2000), default=96, show_default=True, help="Frames of a day."
)
@click.option(
    "--seconds",
    type=Number(0, 3600, min_open=True),
    default=8.0,
    show_default=True,
    help="How long the frames of a day are shown.",
)
@click.option(
    "--ev", type=Number(-100, 100), help="Exposure value (ISO 100) of a PNG; automatic if absent."
)
@click.option(
    "--tone", type=click.Choice(TONES), default="aces", show_default=True,
    help="Tone curve from luminance to a PNG's values.",
)  # fmt: skip
@click.option(
    "--gamut", type=click.Choice(GAMUTS), default="desaturate",
    show_default=True, help="What becomes of colours that sRGB does not have.",
)  # fmt: skip
@click.option(
    "--precision", type=click.Choice(PRECISIONS), default="half", show_default=True,
    help="Precision of the numbers of an EXR.",
)  # fmt: skip
@click.option(
    "--terrain", type=FILE,
    help="Heights (.npz, .tif) to stand on, or the word sample; for --view perspective.",
)  # fmt: skip
@click.option(
    "--eye-east-m", type=Number(),
    help="Distance of the eye east of the terrain's corner, in metres; its middle if absent.",
)  # fmt: skip
@click.option(
    "--eye-north-m", type=Number(),
    help="Distance of the eye north of the terrain's corner, in metres; its middle if absent.",
)  # fmt: skip
@click.option(
    "--aerial", type=click.Choice(AIRS), default="paper", show_default=True,
    help="Air before the terrain: by the paper, by Ward and Larson, or none.",
)  # fmt: skip
@click.option("--shafts", is_flag=True, help="Have the terrain shade the air too.")
@click.option(
    "--samples", type=int, default=16, show_default=True, help="Rays per pixel of a terrain."
)
@overwrite
@as_json
def render(sky: Path | None, out: Path, as_json: bool, **options: Any) -> int:
    """Make a picture of a sky, or of a day of them.

    The picture is a fisheye dome, a panorama or a perspective.

    SKY is a fit (.json), a campaign file (.toml) whose sky is simulated, a dataset (.zarr, .nc), or
    a word: refit for the paper's formula fitted to its campaign, cornell for a measured sky,
    published for the published model, as without SKY. EXR and HDR files hold luminance, a PNG what
    a camera would show of it. Finished frames of a day are kept beside it until it is written:
    after an interruption the same command continues.

    \b
    skyfit render --turbidity 3 --sun-zenith-deg 60 --out sky.png
    skyfit render fit.json --turbidity 3 --view panorama --out sky.exr
    skyfit render sims/mars.toml --turbidity 0.5 --out mars.png
    skyfit render --latitude-deg 48 --longitude-deg 16 --time 2024-06-21T18:00+02:00 --out now.png
    skyfit render --latitude-deg 48 --day-of-year 172 --out day.gif
    """  # noqa: D301, click reads the backslash
    look = skyfit.render
    check_samples(options["samples"])
    kind = look.check_target(out, options["overwrite"])
    camera = _camera(options)
    moving = kind in (".gif", ".apng")
    given, azimuth = _sun(options, moving)
    if moving:
        if options["terrain"] is not None:
            raise click.UsageError("--terrain: only for one picture, not for a day")
        _suns(options, 0.0, 0.0)  # whether it is a day, before its sky is looked for
    land = _land(options["terrain"], options["view"], options["shafts"], options["aerial"])
    height = 0.0 if land is not None else options["altitude_m"]
    source = look.load_source(sky, options["turbidity"], given, height, options["settings"])
    shown = {name: options[name] for name in ("sun_disc", "ground_albedo")}
    saved = {name: options[name] for name in ("ev", "tone", "gamut", "overwrite")}
    zenith = look.sun_of(source, given)
    with progress("rendering", quiet=as_json) as bar:
        if moving:
            suns, kept = _suns(options, zenith, azimuth), look.frames_directory(out)

            def words() -> str | None:
                written = out.exists() and not options["overwrite"]
                if written or not (kept / "record.json").exists():
                    return None
                done = len(list(kept.glob("*.light")))
                return f"{done} of {len(suns)} frames are in {kept}; the same command continues"

            with on_interrupt(words):
                record = look.animate(
                    out, source, camera, suns, seconds=options["seconds"],
                    progress=bar, **saved, **shown,
                )  # fmt: skip
            record = {"sky": source.name, **record}
        else:
            picture = (
                look.render(source, camera, zenith, azimuth, **shown)
                if land is None
                else _landscape(source, land, camera, zenith, azimuth, options, bar)
            )
            record = picture.save(out, precision=options["precision"], **saved)
            record = {"sky": picture.description, **record}
    print_record(record, as_json)
    return 0


def _land(terrain: Path | None, view: str, shafts: bool, aerial: str):
    if terrain is None:
        if shafts:
            raise click.UsageError("--shafts: only with --terrain")
        return None
    if shafts and aerial != "paper":
        raise click.UsageError("--shafts: only with --aerial paper")
    if view != "perspective":
        raise click.UsageError("--terrain: only for --view perspective")
    look = skyfit.render
    return look.sample_elevation() if str(terrain) == "sample" else look.load_elevation(terrain)


def _landscape(source, land, camera, zenith, azimuth, options, bar):
    look, (wide, deep) = skyfit.render, land.size
    albedo = options["ground_albedo"]
    albedo = source.ground_albedo if albedo is None else albedo
    east, north = options["eye_east_m"], options["eye_north_m"]
    eye = (wide / 2 if east is None else east, deep / 2 if north is None else north)
    air = look.air_before(source, zenith, options["aerial"], albedo, sunlight=options["sun_disc"])
    return look.render_terrain(
        source, land, camera, eye, zenith, azimuth, air, ground_albedo=albedo,
        samples=options["samples"], sun_disc=options["sun_disc"], shafts=options["shafts"],
        progress=bar,
    )  # fmt: skip


def _sun(options: dict[str, Any], moving: bool) -> tuple[float | None, float]:
    """Zenith angle of the sun, where it is known, and its azimuth."""
    placed = refuse_still(options) if moving else sun_of_still(options)
    if placed is not None:
        return placed
    azimuth = options["sun_azimuth_deg"]
    return _radians(options["sun_zenith_deg"]), float(
        np.radians(180 if azimuth is None else azimuth)
    )


def _suns(options: dict[str, Any], zenith: float, azimuth: float) -> np.ndarray:
    """Zenith angle and azimuth of every frame."""
    frames, last = options["frames"], _radians(options["to_sun_zenith_deg"])
    if last is not None:
        return np.stack([np.linspace(zenith, last, frames), np.full(frames, azimuth)], axis=1)
    if options["latitude_deg"] is None or options["day_of_year"] is None:
        raise click.UsageError(f"--out: {DAY}")
    latitude = np.radians(options["latitude_deg"])
    return skyfit.render.day_of_suns(latitude, options["day_of_year"], frames)


def _radians(degrees: float | None) -> float | None:
    return None if degrees is None else float(np.radians(degrees))


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
