"""Described functions written out as one list of lines, for languages without local variables."""

import ast
import copy
from collections.abc import Iterable, Mapping

from ..errors import InputError
from .description import VECTORS, Function, Line


Value = ast.expr | tuple[ast.expr, ...] | dict[str, ast.expr]


class Straight:
    """Lines in the order in which they are needed, each a number with a name of its own.

    Calls of described functions are written out; what was made before under the same expression is
    not made again.

    Attributes:
        lines: Lines made so far.
    """

    def __init__(self, functions: tuple[Function, ...], taken: Iterable[str] = ()):
        """Begin; names that are `taken` are given to no line."""
        self.lines: list[Line] = []
        self._functions = {function.name: function for function in functions}
        self._made: dict[str, str] = {}
        self._names = set(taken)

    def call(self, name: str, arguments: Mapping[str, Value]) -> Value:
        """A function's result: a name or number, three of them for a vector, by field for a frame.

        Args:
            name: Name of the function.
            arguments: Its arguments by name, in the same form.
        """
        function, scope = self._functions[name], dict(arguments)
        for line in function.body:
            scope[line.name] = self._value(line.expression, scope, line.name)
        if function.fields:
            return {field: scope[field] for field in function.fields}  # type: ignore[return-value]
        return self._value(function.result, scope, name)

    def _value(self, text: str, scope: Mapping[str, Value], name: str) -> Value:
        return self._named(self._rewritten(ast.parse(text, mode="eval").body, scope), name)

    def _named(self, value: Value, name: str) -> Value:
        """A value whose numbers have names."""
        if isinstance(value, tuple):
            parts = zip(value, "xyz", strict=True)
            return tuple(self._atom(part, f"{name}_{axis}") for part, axis in parts)
        return value if isinstance(value, dict) else self._atom(value, name)

    def _atom(self, node: ast.expr, name: str) -> ast.expr:
        if isinstance(node, ast.Name | ast.Constant):
            return node
        text = ast.unparse(node)
        if text not in self._made:
            new, k = name, 1
            while new in self._names:
                k += 1
                new = f"{name}_{k}"
            self._names.add(new)
            self._made[text] = new
            self.lines.append(Line(new, text))
        return ast.Name(self._made[text])

    def _rewritten(self, node: ast.expr, scope: Mapping[str, Value]) -> Value:
        match node:
            case ast.Constant():
                return node
            case ast.Name(id=name):
                return scope[name]
            case ast.Attribute(value=ast.Name(id=name), attr=attr):
                whole = scope[name]
                if isinstance(whole, dict):
                    return whole[attr]
                assert isinstance(whole, tuple)
                assert name in VECTORS
                return whole["xyz".index(attr)]
            case ast.Call(func=ast.Name(id="vector"), args=args):
                return tuple(self._number(arg, scope) for arg in args)
            case ast.Call(func=ast.Name(id=name), args=args) if name in self._functions:
                names = self._functions[name].arguments
                values = (self._rewritten(arg, scope) for arg in args)
                named = {n: self._named(v, n) for n, v in zip(names, values, strict=True)}
                return self.call(name, named)
        new = copy.copy(node)
        for field, part in ast.iter_fields(node):
            if isinstance(node, ast.Call) and field == "func":
                continue
            if isinstance(part, ast.expr):
                setattr(new, field, self._number(part, scope))
            elif isinstance(part, list):
                entries = [self._number(p, scope) if isinstance(p, ast.expr) else p for p in part]
                setattr(new, field, entries)
        return new

    def _number(self, node: ast.expr, scope: Mapping[str, Value]) -> ast.expr:
        value = self._rewritten(node, scope)
        if not isinstance(value, ast.expr):
            raise InputError(f"not in the syntax of descriptions: {ast.unparse(node)}")
        return value
