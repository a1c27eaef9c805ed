"""What a thing is made of as one number, the same in every run of the program."""

import dataclasses
import hashlib
import json
from typing import Any

import numpy as np


_HOUSE = __name__.partition(".")[0]


class UnknownError(TypeError):
    """Something whose content cannot be told from its fields."""


def digest(thing: Any) -> str:
    """SHA-256 of numbers, words, arrays, lists, tuples, dictionaries and skyfit's own modules.

    Values count to the last bit, and so do their types: 3 is not 3.0.

    Raises:
        UnknownError: There is anything else in it. Of a class of somebody else's the program may
            change while its fields stay the same.
    """
    return hashlib.sha256(json.dumps(_plain(thing)).encode()).hexdigest()


def _plain(thing: Any) -> Any:
    """Lists that begin with their kind; only numbers and words stand for themselves."""
    if thing is None or type(thing) in (bool, int, float, str):
        return thing
    if hasattr(thing, "dtype"):
        array = np.ascontiguousarray(thing)
        if array.dtype.hasobject:
            raise UnknownError("an array of objects")
        content = hashlib.sha256(array.tobytes()).hexdigest()
        return ["array", array.dtype.str, np.shape(thing), content]
    if type(thing) in (tuple, list):
        return [type(thing).__name__, *map(_plain, thing)]
    if type(thing) is dict:
        return ["dict", *([_plain(key), _plain(value)] for key, value in thing.items())]
    kind = type(thing)
    if dataclasses.is_dataclass(thing) and kind.__module__.partition(".")[0] == _HOUSE:
        fields = [[one.name, _plain(getattr(thing, one.name))] for one in dataclasses.fields(thing)]
        return [f"{kind.__module__}.{kind.__qualname__}", *fields]
    raise UnknownError(f"{kind.__module__}.{kind.__qualname__}")
