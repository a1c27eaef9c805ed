"""Ctrl-C ends a command within two seconds, whatever it is doing.

Python raises `KeyboardInterrupt` in the main thread, between two of its steps: not while a program
is being compiled or runs, and where the step is a callback of the garbage collector it is dropped.
So a thread of its own hears of the signal too, and after a time of grace says what there is to say
and ends the process.
"""

import contextlib
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from .output import INTERRUPTED, complain


GRACE = 1.2  # s, for the main thread to end by itself
_STOP = b"\0"  # no signal has this number
_words: list[Callable[[], str | None]] = []
_speaks = threading.Lock()


@contextmanager
def on_interrupt(words: Callable[[], str | None]) -> Iterator[None]:
    """Have `words` say how to go on, should the command be interrupted meanwhile."""
    _words.append(words)
    try:
        yield
    except KeyboardInterrupt:
        raise  # they are still to be said
    except BaseException:
        _words.remove(words)
        raise
    else:
        _words.remove(words)


def interrupted() -> int:
    """Say once, in one line, that the command was interrupted; return the exit status."""
    said = _words.pop()() if _words else None
    _words.clear()
    return complain(f"interrupted: {said}" if said else "interrupted", INTERRUPTED)


@contextmanager
def leaving_at_once() -> Iterator[None]:
    """Leave the process by Ctrl-C within two seconds, as long as this lasts."""
    if threading.current_thread() is not threading.main_thread():
        yield  # signals are the main thread's
        return
    ear, mouth = socket.socketpair()
    mouth.setblocking(False)
    heard = threading.Event()

    def listen() -> None:
        if ear.recv(1) in (_STOP, b""):
            return
        heard.set()
        threading.Event().wait(GRACE)
        if _speaks.acquire(blocking=False):
            _leave(interrupted())

    def hear(number: int, frame: object) -> None:
        heard.set()
        raise KeyboardInterrupt

    def dropped(error: Any) -> None:
        if not issubclass(error.exc_type, KeyboardInterrupt):
            sys.__unraisablehook__(error)

    before = signal.signal(signal.SIGINT, hear)
    sys.unraisablehook = dropped  # the interruption is told in one line
    fd = signal.set_wakeup_fd(mouth.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=listen, daemon=True).start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(fd)
        signal.signal(signal.SIGINT, before)
        sys.unraisablehook = sys.__unraisablehook__
        mouth.send(_STOP)
        if heard.is_set() and _speaks.acquire(blocking=False):
            _leave(INTERRUPTED)  # threads at work would be waited for


def _leave(status: int) -> None:
    if sys.stderr.isatty():
        sys.stderr.write("\x1b[?25h")  # the cursor, which a bar of progress hides
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(status)
