"""A day as an animated picture: suns, frames, GIF or APNG."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from .._files import whole
from .._progress import Progress
from ..errors import InputError
from ..sun import sun_position
from .cameras import AbstractCamera
from .files import check_target
from .frames import Frame, FrameStore, animation_record, frames_directory
from .picture import render, to_pixels
from .sources import AbstractSource


TWILIGHT = np.radians(96.0)  # zenith angle of the sun at the ends of civil twilight
_STEP = 1 / 60  # h


def day_of_suns(
    latitude: float, day_of_year: int, frames: int, lowest: float = float(TWILIGHT)
) -> Float[np.ndarray, "frame 2"]:
    """Zenith angles and compass azimuths of the sun [rad], evenly from dawn to dusk.

    Args:
        latitude: Latitude of the place [rad].
        day_of_year: 1 to 366.
        frames: Number of frames.
        lowest: Zenith angle at which the day begins and ends [rad].

    Raises:
        InputError: The sun stays lower all day.
    """
    hours = np.arange(0, 24, _STEP)
    position = sun_position(latitude, 0.0, day_of_year, hours, 0.0)
    up = hours[np.asarray(position.zenith) <= lowest]
    if up.size == 0:
        raise InputError(
            f"day_of_suns: expected a day on which the sun comes within {np.degrees(lowest):.1f} "
            f"degrees of the zenith; got latitude {np.degrees(latitude):.6g}, day {day_of_year}"
        )
    at = sun_position(latitude, 0.0, day_of_year, np.linspace(up[0], up[-1], frames), 0.0)
    return np.stack([np.asarray(at.zenith), np.asarray(at.azimuth) + np.pi], axis=1)


def animate(
    path: str | PathLike[str],
    source: AbstractSource,
    camera: AbstractCamera,
    suns: Sequence[tuple[float, float]] | Float[np.ndarray, "frame 2"],
    *,
    ev: float | None = None,
    tone: str = "aces",
    gamut: str = "desaturate",
    seconds: float = 8.0,
    overwrite: bool = False,
    progress: Progress | None = None,
    **options: Any,
) -> dict[str, Any]:
    """Render a sky under one sun after the other and write them as one picture that moves.

    Finished frames are kept in a directory beside it, its name with `.frames` at the end, until it
    is written: after an interruption the same call goes on from there. Exposure, tone curve, gamut
    and length may then be others. A sky or camera of a class that is not skyfit's begins anew,
    unless it is a source that has an `identity`.

    Args:
        path: Ends in .gif (256 colours) or .apng (all of them).
        source: Sky that is seen.
        camera: Through what.
        suns: Zenith angle and compass azimuth for each frame [rad].
        ev: Exposure value of all frames; None exposes each by itself, as an eye adapts.
        tone: Tone curve, as of `Picture.save`.
        gamut: Treatment of colours that sRGB lacks, as of `Picture.save`.
        seconds: Duration of the animation [s].
        overwrite: Replace a file that is there.
        progress: Called as `progress("frames", done, total)`.
        **options: Further arguments of `render`.

    Returns:
        The file, how many frames, and the lowest and highest exposure value.

    Raises:
        InputError: Another ending, a file is there, no frame; frames of another animation.
    """
    kind = check_target(path, overwrite)
    if kind not in (".gif", ".apng"):
        raise InputError(f"{path}: expected a name ending in .gif or .apng for many pictures")
    if not 0 < seconds <= 3600:
        raise InputError(f"animate(seconds=...): expected above 0 to 3600 s; got {seconds:g}")
    if len(suns) == 0:
        raise InputError("animate(suns=...): expected one or more; got none")
    suns = np.asarray(suns, float)
    record = animation_record(source, camera, suns, options)
    kept = None
    if record is not None:
        kept = FrameStore(frames_directory(path), record, camera.shape)
    frames, exposures = [], []
    for number, (zenith, azimuth) in enumerate(suns.tolist()):
        frame = None if kept is None else kept.load(number)
        if frame is None:
            picture = render(source, camera, zenith, azimuth, **options)
            frame = Frame(picture.rgb, picture.exposure())
            if kept is not None:
                kept.keep(number, frame)
        exposures.append(frame.exposure if ev is None else ev)
        frames.append(to_pixels(frame.rgb, exposures[-1], tone, gamut))
        if progress is not None:
            progress("frames", len(frames), len(suns))
    _write(Path(path), frames, seconds, overwrite)
    if kept is not None:
        kept.remove(len(suns))
    span = [round(end, 2) for end in (min(exposures), max(exposures))]
    return {"out": str(path), "frames": len(frames), "ev": span, "tone": tone, "gamut": gamut}


def _write(path: Path, frames: list[np.ndarray], seconds: float, overwrite: bool) -> None:
    from PIL import Image

    images = [Image.fromarray(frame) for frame in frames]
    if path.suffix == ".gif":
        # One palette for all, from frames spread over the day, so that nothing flickers.
        chosen = images[:: max(1, len(images) // 12)]
        sheet = Image.new("RGB", (chosen[0].width, sum(one.height for one in chosen)))
        for place, one in enumerate(chosen):
            sheet.paste(one, (0, place * one.height))
        palette = sheet.quantize(256, method=Image.Quantize.MAXCOVERAGE)
        images = [
            one.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG) for one in images
        ]
    with whole(path) as begun:
        images[0].save(
            begun, format="GIF" if path.suffix == ".gif" else "PNG", save_all=True,
            append_images=images[1:], duration=round(1000 * seconds / len(images)), loop=0,
        )  # fmt: skip
        check_target(path, overwrite)
