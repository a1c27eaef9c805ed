"""Finished frames of an animation under way: kept beside it until it is written."""

import contextlib
import hashlib
import json
import os
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..errors import InputError
from ..provenance import versions
from .cameras import AbstractCamera
from .identity import UnknownError, digest
from .sources import AbstractSource


SCHEMA = "skyfit/frames/1"
_RECORD = "record.json"
_ANOTHER = {
    "schema": "by another version of skyfit",
    "skyfit": "by another version of skyfit",
    "precision": "in another precision",
    "source": "of another sky",
    "camera": "through another camera",
    "suns": "under other suns",
    "options": "with other options",
}


class Frame(NamedTuple):
    """A picture before exposure and tone curve.

    Attributes:
        rgb: Colours of the pixels, as of `Picture`.
        exposure: The exposure value that suits it.
    """

    rgb: Float[np.ndarray, "row column 3"]
    exposure: float


class FrameStore:
    """Frames of one animation on disk; the directory is made with the first of them.

    Each file ends up under its name only when it is whole, and begins with a digest of the
    animation, the frame's number and its content: what is damaged or of elsewhere does not count.

    Args:
        directory: Directory of the frames.
        record: Animation that the frames belong to, by `animation_record`.
        shape: Rows and columns.

    Raises:
        InputError: There are frames of another animation, or something else.
    """

    def __init__(
        self, directory: str | PathLike[str], record: Mapping[str, Any], shape: tuple[int, int]
    ):
        self.directory, self._shape = Path(directory), shape
        self._record = json.dumps(record, indent=1)
        self._key = json.dumps([record[name] for name in _ANOTHER])
        if self.directory.is_dir() and not any(map(self._of_value, self.directory.iterdir())):
            return
        if self.directory.exists():
            self._refuse_another(record)

    def load(self, number: int) -> Frame | None:
        """A frame by its number from 0; None if it is still to be rendered, or not finite."""
        file = self._file(number)
        if not file.is_file():
            return None
        content = file.read_bytes()
        seal, body = content[:32], content[32:]
        if seal != self._seal(number, body):
            return None
        rgb = np.frombuffer(body, "<f4", offset=8).reshape(*self._shape, 3)
        if not np.isfinite(rgb).all():
            return None
        return Frame(rgb, float(np.frombuffer(body, "<f8", count=1)[0]))

    def keep(self, number: int, frame: Frame) -> None:
        """Write a frame to disk."""
        self.directory.mkdir(exist_ok=True)
        record = self.directory / _RECORD
        if not record.exists() or record.stat().st_size == 0:
            _write_whole(record, self._record.encode())
        body = np.array(frame.exposure, "<f8").tobytes() + frame.rgb.astype("<f4").tobytes()
        _write_whole(self._file(number), self._seal(number, body) + body)

    def remove(self, count: int) -> None:
        """Delete `count` frames, their record, and the directory if nothing else is in it."""
        for file in (*map(self._file, range(count)), self.directory / _RECORD):
            for name in (file, *_parts(file)):
                name.unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            self.directory.rmdir()

    def _of_value(self, file: Path) -> bool:
        """Not what is left of a record whose writing was cut short."""
        record = self.directory / _RECORD
        return file not in _parts(record) and (file != record or file.stat().st_size > 0)

    def _file(self, number: int) -> Path:
        return self.directory / f"frame-{number + 1:04d}.light"

    def _seal(self, number: int, body: bytes) -> bytes:
        sealed = hashlib.sha256(f"{self._key} {number} ".encode())
        sealed.update(body)
        return sealed.digest()

    def _refuse_another(self, record: Mapping[str, Any]) -> None:
        try:
            found = json.loads((self.directory / _RECORD).read_bytes())
            differing = [name for name in _ANOTHER if found.get(name) != record[name]]
        except (OSError, ValueError, AttributeError):
            raise InputError(
                f"{self.directory}: expected frames of an animation; found something else"
            ) from None
        if differing:
            raise InputError(
                f"{self.directory}: holds frames {_ANOTHER[differing[0]]}; give the picture "
                "another name, or remove them to begin anew"
            )


def frames_directory(path: str | PathLike[str]) -> Path:
    """Where finished frames of an animation are until it is written."""
    return Path(f"{Path(path)}.frames")


def animation_record(
    source: AbstractSource,
    camera: AbstractCamera,
    suns: Float[np.ndarray, "frame 2"],
    options: Mapping[str, Any],
) -> dict[str, Any] | None:
    """What the frames of an animation belong to, for JSON; None if the sky is not to be told.

    Exposure, tone curve and gamut are not in it: frames are kept before them.
    """
    # A subclass that changes the sky but not `identity` would be taken for its parent.
    if "identity" not in vars(type(source)):
        return None
    try:
        digests = {
            "source": digest((source.identity(), source.has_ground, source.ground_albedo)),
            "camera": digest(camera),
            "suns": digest(suns),
            "options": digest(dict(sorted(options.items()))),
        }
    except UnknownError:
        return None
    made = {"skyfit": versions()["skyfit"], "precision": jnp.result_type(float).name}
    return {"schema": SCHEMA, "sky": source.name, "frames": len(suns), **made, **digests}


def _write_whole(path: Path, content: bytes) -> None:
    part = _part(path)
    try:
        part.write_bytes(content)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _part(path: Path) -> Path:
    return path.with_name(f"{path.name}.{os.getpid()}.part")


def _parts(path: Path) -> list[Path]:
    """What any process has left of a file that it had begun."""
    return list(path.parent.glob(f"{path.name}.*.part"))
