"""What all tables of a campaign file have in common, and what is said where one is wrong."""

import difflib
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from ...errors import InputError


class Section(BaseModel):
    """A table of the file: no unknown key, no silent conversion."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, content: Any) -> Any:
        known = [field.alias or name for name, field in cls.model_fields.items()]
        for key in content if isinstance(content, dict) else ():
            if key not in known:
                near = difflib.get_close_matches(key, known, n=1)
                words = (
                    f"did you mean {near[0]}?" if near else f"expected one of {', '.join(known)}"
                )
                raise PydanticCustomError("unknown_key", "{words}", {"key": key, "words": words})
        return content

    def exactly_one_of(self, *names: str, or_none: bool = False) -> None:
        """Refuse two keys that say the same thing, and none that does.

        Raises:
            InputError: Listing the keys.
        """
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) > 1 or not (given or or_none):
            number = "at most" if or_none else "exactly"
            came = " and ".join(given) or "none"
            raise InputError(f"expected {number} one of {', '.join(names)}; got {came}")


# Where pydantic's own words are for programmers.
_WORDS = {
    "model_type": "expected a table",
    "model_attributes_type": "expected a table",
    "int_type": "expected a whole number",
    "missing": "is missing",
}


def one_line(error: ValidationError) -> str:
    """The first thing wrong with the file, and how many more there are."""
    first, *others = error.errors(include_url=False)
    place = _place(first["loc"])
    context = first.get("ctx", {})
    if first["type"] == "unknown_key":
        place.append(context["key"])
        text = f"unknown key; {context['words']}"
    elif first["type"] == "union_tag_invalid":
        place.append("kind")
        text = f"expected one of {context['expected_tags']}; got {context['tag']!r}"
    elif first["type"] == "union_tag_not_found":
        place.append("kind")
        text = "is missing"
    elif first["type"] == "value_error":
        text = first["msg"].removeprefix("Value error, ")
    else:
        text = first["msg"].replace("Input should be", "expected").replace("a valid ", "a ")
        came = "" if first["type"] == "missing" else f"; got {first['input']!r}"
        text = _WORDS.get(first["type"], text) + came
    more = f" (and {len(others)} more)" if others else ""
    where = _key(place)
    return f"{where}: {text}{more}" if where else f"{text}{more}"


def _place(loc: tuple[int | str, ...]) -> list[int | str]:
    """Without the values of `kind` that pydantic puts behind what there are several kinds of."""
    several = ("profile", "size", "sweep")
    before = (None, None, *loc)
    return [
        part
        for part, last, first in zip(loc, before[1:], before, strict=False)
        if not (last in several or (first == "constituents" and isinstance(last, int)))
    ]


def _key(place: list[Any]) -> str:
    words = [f"[{part}]" if isinstance(part, int) else f".{part}" for part in place]
    return "".join(words).removeprefix(".")
