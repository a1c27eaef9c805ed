"""Atmospheres that a program gives a campaign: one, or a function that makes one of each value."""

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .._typing import is_traced
from ..atmosphere import Atmosphere
from ..errors import InputError
from .plain import from_plain, to_plain


AtmosphereFunction = Callable[..., Atmosphere]
KIND = "given"


class RecordedAtmospheres:
    """A function of the swept value, known at the values of a record alone.

    Args:
        name: Name of the swept parameter.
        atmospheres: Atmosphere of each value.
    """

    def __init__(self, name: str, atmospheres: Mapping[float, Atmosphere]):
        self.name, self.atmospheres = name, dict(atmospheres)

    def __call__(self, **swept: float) -> Atmosphere:
        """The atmosphere of one value.

        Raises:
            InputError: The record has no atmosphere of that value.
        """
        value = swept[self.name]
        if value not in self.atmospheres:
            known = ", ".join(f"{one:g}" for one in self.atmospheres)
            raise InputError(
                f"atmosphere: on record at {self.name} = {known}; not at {value:g}: give the "
                "function that made them"
            )
        return self.atmospheres[value]


def build_given(given: Any, name: str | None, values: tuple[float, ...]) -> tuple[Atmosphere, ...]:
    """The atmosphere of every swept value.

    Args:
        given: An `Atmosphere`, or a function that returns one.
        name: Parameter of the function; None for an `Atmosphere` that stays the same.
        values: Values of the parameter.

    Raises:
        InputError: It is neither, has no such parameter, returns something else, or atmospheres of
            different wavelengths.
    """
    if isinstance(given, Atmosphere):
        return (_known(given),) * len(values)
    built = tuple(call_given(given, str(name), value) for value in values)
    first = built[0].wavelengths
    for value, one in zip(values, built, strict=True):
        if one.wavelengths.shape != first.shape or not np.allclose(one.wavelengths, first):
            raise InputError(
                f"Campaign(atmosphere=...): expected the same wavelengths at every {name}; those "
                f"at {name} = {value:g} are not those at {name} = {values[0]:g}"
            )
    return built


def call_given(function: AtmosphereFunction, name: str, value: float) -> Atmosphere:
    """The atmosphere that a function makes of one value.

    Raises:
        InputError: It returns something else.
    """
    found = function(**{name: value})
    if not isinstance(found, Atmosphere):
        raise InputError(
            "Campaign(atmosphere=...): expected a function that returns an Atmosphere; at "
            f"{name} = {value:g} it returned {type(found).__name__}"
        )
    return _known(found)


def takes(function: Any, name: str) -> bool:
    """Whether a function can be called with one argument of that name, and no other."""
    try:
        inspect.signature(function).bind(**{name: 0.0})
    except TypeError:
        return False
    except ValueError:  # it has no signature to look at
        return True
    return True


def given_record(built: tuple[Atmosphere, ...]) -> dict[str, Any]:
    """As plain numbers and words, for JSON."""
    return {"kind": KIND, "atmospheres": [to_plain(one) for one in built]}


def given_of(
    record: Mapping[str, Any], name: str | None, values: tuple[float, ...]
) -> Atmosphere | RecordedAtmospheres:
    """Undo `given_record`.

    Raises:
        InputError: A part is of a class that is not skyfit's own.
    """
    built = [from_plain(one) for one in record["atmospheres"]]
    if name is None or len(values) != len(built):
        return built[0]
    return RecordedAtmospheres(name, dict(zip(values, built, strict=True)))


def _known(air: Atmosphere) -> Atmosphere:
    if is_traced(air):
        raise InputError(
            "Campaign(atmosphere=...): expected known numbers; a campaign is ordinary Python and "
            "stays outside jit, vmap and grad"
        )
    return air
