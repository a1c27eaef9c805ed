"""Atmospheres that a program gives a campaign: one, or a function that makes one of each value."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from .._typing import is_traced
from ..atmosphere import Atmosphere
from ..errors import InputError
from .plain import from_plain, to_plain


AtmosphereFunction = Callable[..., Atmosphere]
KIND = "given"


Place = Mapping[str, float]  # values of what is swept, by name


class RecordedAtmospheres:
    """A function of the swept values, known at the values of a record alone.

    Args:
        places: Values of the function's parameters in the record.
        atmospheres: Atmosphere of each.
    """

    def __init__(self, places: Sequence[Place], atmospheres: Sequence[Atmosphere]):
        self.names = tuple(places[0])
        pairs = zip(places, atmospheres, strict=True)
        self.atmospheres = {tuple(place.values()): one for place, one in pairs}

    def __call__(self, **swept: float) -> Atmosphere:
        """The atmosphere of one place.

        Raises:
            InputError: The record has no atmosphere of these values.
        """
        values = tuple(swept[name] for name in self.names)
        if values not in self.atmospheres:
            known = [in_words(dict(zip(self.names, one, strict=True))) for one in self.atmospheres]
            few = "; ".join(known[:5]) + ("; ..." if len(known) > 5 else "")
            raise InputError(
                f"atmosphere: on record at {few}; not at {in_words(swept)}: give the function that "
                "made them"
            )
        return self.atmospheres[values]


def in_words(place: Place) -> str:
    """Values by name, for messages."""
    return ", ".join(f"{name} = {value:g}" for name, value in place.items())


def build_given(given: Any, places: Sequence[Place]) -> tuple[Atmosphere, ...]:
    """The atmosphere of every place.

    Args:
        given: An `Atmosphere`, or a function that returns one.
        places: Values of the function's parameters; an `Atmosphere` stays the same everywhere.

    Raises:
        InputError: It is neither, has no such parameters, returns something else, or atmospheres
            of different wavelengths.
    """
    if isinstance(given, Atmosphere):
        return (_known(given),) * len(places)
    made: dict[tuple[float, ...], Atmosphere] = {}
    for place in places:
        values = tuple(place.values())
        if values not in made:
            made[values] = call_given(given, place)
    built = tuple(made[tuple(place.values())] for place in places)
    first = built[0].wavelengths
    for place, one in zip(places, built, strict=True):
        if one.wavelengths.shape != first.shape or not np.allclose(one.wavelengths, first):
            raise InputError(
                "Campaign(atmosphere=...): expected the same wavelengths everywhere; those at "
                f"{in_words(place)} are not those at {in_words(places[0])}"
            )
    return built


def call_given(function: AtmosphereFunction, place: Place) -> Atmosphere:
    """The atmosphere that a function makes of the values of its parameters.

    Raises:
        InputError: It returns something else.
    """
    found = function(**place)
    if not isinstance(found, Atmosphere):
        raise InputError(
            "Campaign(atmosphere=...): expected a function that returns an Atmosphere; at "
            f"{in_words(place)} it returned {type(found).__name__}"
        )
    return _known(found)


def takes(function: Any, names: Sequence[str]) -> bool:
    """Whether a function can be called with arguments of these names, and no other."""
    try:
        inspect.signature(function).bind(**dict.fromkeys(names, 0.0))
    except TypeError:
        return False
    except ValueError:  # it has no signature to look at
        return True
    return True


def given_record(built: tuple[Atmosphere, ...]) -> dict[str, Any]:
    """As plain numbers and words, for JSON."""
    return {"kind": KIND, "atmospheres": [to_plain(one) for one in built]}


def given_of(
    record: Mapping[str, Any], places: Sequence[Place]
) -> Atmosphere | RecordedAtmospheres:
    """Undo `given_record`.

    Args:
        record: What it returned.
        places: Values of the function's parameters; nothing in them where none is left but the
            observer's.

    Raises:
        InputError: A part is of a class that is not skyfit's own.
    """
    built = [from_plain(one) for one in record["atmospheres"]]
    if not places[0] or len(places) != len(built):
        return built[0]
    return RecordedAtmospheres(places, built)


def _known(air: Atmosphere) -> Atmosphere:
    if is_traced(air):
        raise InputError(
            "Campaign(atmosphere=...): expected known numbers; a campaign is ordinary Python and "
            "stays outside jit, vmap and grad"
        )
    return air
