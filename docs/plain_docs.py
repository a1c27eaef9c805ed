"""Makes docstrings and signatures plain while the pages are built, for Griffe."""

import importlib
import inspect
import re

import griffe


class PlainBrackets(griffe.Extension):
    """Escapes a bracket that follows another: "in [0, π] [rad]" is no link."""

    def on_object(self, *, obj: griffe.Object, **_) -> None:
        """Called for each module, class, function and attribute."""
        if obj.docstring is not None:
            obj.docstring.value = re.sub(r"\](\s+)\[", r"]\1\\[", obj.docstring.value)


class PlainDefaults(griffe.Extension):
    """Writes a default's number in place of the constant's name, which a page does not explain."""

    def on_function(self, *, func: griffe.Function, **_) -> None:
        """Called for each function and method."""
        named = [p for p in func.parameters if re.search(r"\b[A-Z][A-Z_]+\b", str(p.default or ""))]
        if not named:
            return
        thing = importlib.import_module(func.module.path)
        for name in func.path.removeprefix(func.module.path + ".").split("."):
            thing = getattr(thing, name)
        known = inspect.signature(thing).parameters
        for parameter in named:
            value = known[parameter.name].default
            is_number = isinstance(value, int | float)
            parameter.default = f"{value:.6g}" if is_number else repr(value).replace("\n", " ")
