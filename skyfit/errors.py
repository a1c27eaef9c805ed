"""What skyfit says where it is asked for something impossible."""

import errno
import os
from os import PathLike


class InputError(ValueError):
    """A value, a file or an option that skyfit cannot take; the message says which, and why.

    Every check of skyfit's own raises it. Any other `ValueError` is a fault of skyfit or of a
    library below it.
    """


def not_found(path: str | PathLike[str]) -> FileNotFoundError:
    """The error of a file that is not there."""
    return FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
