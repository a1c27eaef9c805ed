"""Keeps units in brackets from being taken for links: "in [0, π] [rad]" is not one."""

import re

import griffe


class PlainBrackets(griffe.Extension):
    """Escapes a bracket that follows another, in every docstring."""

    def on_object(self, *, obj: griffe.Object, **_) -> None:
        """Called for each module, class, function and attribute."""
        if obj.docstring is not None:
            obj.docstring.value = re.sub(r"\](\s+)\[", r"]\1\\[", obj.docstring.value)
