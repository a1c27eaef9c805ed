"""What schemas of campaign files and of fits have in common, for pydantic."""

import itertools
from collections.abc import Sequence
from typing import Any, TypeVar

from pydantic import BeforeValidator

from .errors import InputError


Values = TypeVar("Values", bound=Sequence[float])


def increasing(values: Values) -> Values:
    """Refuse values that do not increase."""
    for before, after in itertools.pairwise(values):
        if after <= before:
            raise InputError(f"expected increasing values; got {before:g} before {after:g}")
    return values


def one_of(*choices: str) -> BeforeValidator:
    """For an annotation: one of several words."""
    *most, last = map(repr, choices)

    def validate(given: Any) -> Any:
        if given not in choices:
            raise InputError(f"expected {', '.join(most)} or {last}; got {given!r}")
        return given

    return BeforeValidator(validate)
