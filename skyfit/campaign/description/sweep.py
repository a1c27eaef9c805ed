"""A parameter that a campaign sweeps: any number of its description."""

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...errors import InputError
from .spectra import Part


OBSERVER_ALTITUDE = "simulation.observer_altitude_m"  # the one swept number that is no atmosphere's
GROUND_ALBEDO = "atmosphere.ground_albedo"  # of the paper's atmosphere
UNITS = {
    "_per_m": "m-1",
    "_per_m2": "m-2",
    "_per_m3": "m-3",
    "_m": "m",
    "_cm": "cm",
    "_m2": "m2",
    "_nm": "nm",
    "_K": "K",
    "_au": "au",
}


@dataclass(frozen=True)
class Sweep:
    """A parameter and its values.

    Args:
        name: Dimension of the dataset, and the argument of `SkyFit.sky`.
        key: Place of the number in the file, as in "constituents.dust.optical_depth".
        values: Values of the number, increasing, in the unit of the key.
    """

    name: str
    key: str
    values: Sequence[float]

    def __post_init__(self):
        """Take lists too, as JSON has them."""
        object.__setattr__(self, "values", tuple(map(float, self.values)))

    @property
    def units(self) -> str:
        """Unit of the values, by the ending of the key."""
        return unit_of(self.key)[1]

    @property
    def long_name(self) -> str:
        """For people."""
        return f"{self.key} of the campaign"


def unit_of(key: str) -> tuple[str, str]:
    """The last word of a key without its unit, and the unit."""
    word = key.rsplit(".", 1)[-1]
    for ending in sorted(UNITS, key=len, reverse=True):
        if word.endswith(ending):
            return word.removesuffix(ending), UNITS[ending]
    return word, "1"


def number_at(description: Part, key: str) -> float:
    """The number that a key stands for.

    Raises:
        InputError: There is no such key, or it holds no number; the message says what there is.
    """
    holder, word = _holder(description, key)
    value = holder.get(word)
    if isinstance(value, bool) or not isinstance(value, int | float):
        numbers = [
            k for k, v in holder.items() if isinstance(v, int | float) and not isinstance(v, bool)
        ]
        raise InputError(
            f"expected the key of a number; {key} is none, but {', '.join(numbers) or 'nothing'} is"
        )
    return float(value)


def replaced(description: Part, key: str, value: float) -> Part:
    """The description with another number at a key."""
    number_at(description, key)
    changed = copy.deepcopy(description)
    holder, word = _holder(changed, key)
    holder[word] = value
    return changed


def _holder(description: Part, key: str) -> tuple[Any, str]:
    """The table in which a key's last word stands."""
    *path, word = key.split(".")
    here: Any = description
    for depth, step in enumerate(path):
        if isinstance(here, list):
            here = {part["name"]: part for part in here}
        if not isinstance(here, dict) or step not in here:
            known = ", ".join(here) if isinstance(here, dict) else "no table"
            where = ".".join(path[:depth]) or "the file"
            raise InputError(f"expected a key of the file; {where} has {known}, not {step}")
        here = here[step]
    if not isinstance(here, dict):
        raise InputError(f"expected the key of a number; got {key}")
    return here, word
