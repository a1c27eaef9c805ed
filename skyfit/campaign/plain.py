"""Atmospheres as names and numbers, for JSON, and back."""

import dataclasses
import typing
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from .. import phase, profile
from ..atmosphere import Atmosphere, Constituent, Refraction
from ..bands import Bands
from ..errors import InputError


# Every class that an atmosphere may be made of; a user's own are not among them.
KNOWN: list[type] = [Atmosphere, Constituent, Refraction, Bands]
for _room in (profile, phase):
    KNOWN += [
        one
        for one in vars(_room).values()
        if isinstance(one, type)
        and issubclass(one, eqx.Module)
        and one.__module__.startswith("skyfit.")
    ]


def to_plain(part: Any) -> Any:
    """An atmosphere, or a part of one, as names and numbers.

    A class that is not skyfit's own is named with its module.
    """
    if isinstance(part, eqx.Module):
        kind = type(part)
        name = kind.__name__ if kind in KNOWN else _full_name(kind)
        fields = {field.name: getattr(part, field.name) for field in dataclasses.fields(part)}
        return {"type": name} | {key: to_plain(value) for key, value in fields.items()}
    if isinstance(part, tuple):
        return [to_plain(one) for one in part]
    if callable(part):
        return _full_name(part)
    return np.asarray(part).tolist()


def from_plain(record: Any, expected: Any = Atmosphere) -> Any:
    """Undo `to_plain`.

    Args:
        record: What `to_plain` made.
        expected: Class of the part, or of what it stands for: profiles and phase functions share
            names.

    Raises:
        InputError: A part is of a class that is not skyfit's own.
    """
    if not isinstance(record, dict):
        return jnp.asarray(record) if isinstance(record, float | list) else record
    kinds = [one for one in KNOWN if one.__name__ == record["type"] and _is_a(one, expected)]
    if not kinds:
        raise InputError(
            f"atmosphere: {record['type']} is no class of skyfit's; the atmosphere cannot be made "
            "from the record, give the program's own"
        )
    kind = kinds[0]
    part = object.__new__(kind)
    for field in dataclasses.fields(kind):
        value = record[field.name]
        if typing.get_origin(field.type) is tuple:
            made: Any = tuple(from_plain(one, None) for one in value)
        else:
            made = from_plain(value, field.type)
        object.__setattr__(part, field.name, made)  # as computed: nothing is normalised again
    return part


def _is_a(kind: type, expected: Any) -> bool:
    return issubclass(kind, expected) if isinstance(expected, type) else True


def _full_name(thing: Any) -> str:
    return f"{thing.__module__}.{getattr(thing, '__qualname__', type(thing).__qualname__)}"
