"""Files that are written: where they may go, whole or not at all, and by one run at a time."""

import os
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path

from .errors import InputError, not_found


@contextmanager
def whole(path: str | PathLike[str]) -> Iterator[Path]:
    """A name beside `path` to write under, a file or a directory; it takes its place when written.

    What was under `path` stays until then, and stays if writing fails.
    """
    path = Path(os.path.realpath(path))  # a link goes on pointing to the file
    begun, old = _beside(path), _beside(path)
    try:
        yield begun
        if path.is_dir():
            path.rename(old)  # a directory cannot be replaced
        begun.replace(path)
    finally:
        for rest in (begun, old):
            if rest.is_dir():
                shutil.rmtree(rest)
            rest.unlink(missing_ok=True)


def write_text(path: str | PathLike[str], text: str) -> None:
    """Write a text file in UTF-8, whole or not at all."""
    with whole(path) as begun:
        begun.write_text(text, encoding="utf-8")


def read_text(path: str | PathLike[str], most: int, encoding: str = "utf-8-sig") -> str:
    """The text of a file, by default in UTF-8, with or without a byte order mark.

    Raises:
        FileNotFoundError: There is no such file.
        InputError: It is a folder or a device, of more than `most` bytes, or no such text.
    """
    path = Path(path)
    try:
        there = path.exists()
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: is not the name of a file; {error}") from None
    if not there:
        raise not_found(path)
    if not path.is_file():  # reading /dev/zero or a FIFO would never end
        raise InputError(f"{path}: expected a file; this is a folder, or a device")
    if (size := path.stat().st_size) > most:
        raise InputError(f"{path}: expected at most {most} bytes; there are {size}")
    try:
        return path.read_bytes().decode(encoding)
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: expected text in UTF-8; {error}") from None


def refuse_target(path: str | PathLike[str], *, overwrite: bool) -> None:
    """Make sure, before the work, that its result can be written; make the folder if need be.

    An empty file, such as a full disk leaves, is nothing to lose.

    Raises:
        InputError: Something is there that must not be replaced, or nothing can be written there.
    """
    path = Path(path)
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: exists already and is no file; give another name")
    if not overwrite and path.exists() and path.stat().st_size:
        raise InputError(f"{path}: exists already; give another name or overwrite=True")
    make_room(path)


def make_room(path: str | PathLike[str]) -> None:
    """Make the folder of a file that is to be written, and try to write there.

    Raises:
        InputError: It cannot be made, or not be written to.
    """
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        trial = _beside(path)
        trial.touch()
        trial.unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written; {error.strerror}") from None


@contextmanager
def alone(path: str | PathLike[str]) -> Iterator[None]:
    """Keep every other run from writing to `path` meanwhile.

    The lock is the system's: it ends with the process, however that ends.

    Raises:
        InputError: Another run is writing to it.
    """
    import filelock

    path = Path(os.path.realpath(path))
    lock = filelock.FileLock(path.with_name(f".{path.name}.lock"), timeout=0)
    try:
        lock.acquire()
    except filelock.Timeout:
        raise InputError(
            f"{path}: another run is writing to it; wait for it or give another name"
        ) from None
    try:
        yield
    finally:
        Path(lock.lock_file).unlink(missing_ok=True)
        lock.release()


def _beside(path: Path) -> Path:
    return path.with_name(f".{path.name[:100]}.{os.getpid()}-{uuid.uuid4().hex[:6]}")
