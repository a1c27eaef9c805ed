"""Writing described functions in a language: expressions, lines, functions, files."""

import abc
import ast

from ..errors import InputError
from .description import BUILT_IN, FRAME, VECTORS, Function, Line


_SIGNS = {ast.Add: ("+", 1), ast.Sub: ("-", 1), ast.Mult: ("*", 2), ast.Div: ("/", 2)}
_COMPARISONS = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_TIGHT = 4  # binds closer than any operator


class Expressions:
    """How a language writes expressions of numbers: as C does, where it does not say otherwise.

    Attributes:
        single: Whether it has single precision only.
        names: Built-in functions that are called otherwise than in the description.
    """

    single = False
    names: dict[str, str] = {}  # noqa: RUF012

    def __init__(self, prefix: str, functions: tuple[Function, ...]):
        self.prefix = prefix
        self.functions = {function.name for function in functions}

    def number(self, value: float) -> str:
        """A number, never one that the language takes for an integer."""
        text = f"{value:.9g}" if self.single else f"{value:.12g}"
        text = text.replace("e-0", "e-")
        return text if any(mark in text for mark in ".e") else f"{text}.0"

    def where(self, condition: str, if_true: str, if_false: str) -> str:
        """A choice."""
        return f"({condition} ? {if_true} : {if_false})"

    def clamp(self, value: str, low: str, high: str) -> str:
        """A value held between two others."""
        return f"clamp({value}, {low}, {high})"

    def expression(self, text: str) -> str:
        """An expression of the description in this language."""
        return self._write(ast.parse(text, mode="eval").body)[0]

    def _write(self, node: ast.expr) -> tuple[str, int]:
        """Text, and how tightly its outermost operator binds."""
        match node:
            case ast.Constant(value=int() | float() as value):
                return self.number(float(value)), _TIGHT
            case ast.Name(id=name):
                return name, _TIGHT
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{self._inside(operand, 3)}", 2
            case ast.Compare(left=left, ops=[sign], comparators=[right]):
                return f"{self._inside(left, 1)} {_COMPARISONS[type(sign)]} " + self._inside(
                    right, 1
                ), 0
            case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div()):
                return self._binary(node)
            case ast.Call(func=ast.Name(id=name), args=args):
                return self._call(name, [self._write(arg)[0] for arg in args]), _TIGHT
        raise InputError(f"not in the syntax of descriptions: {ast.unparse(node)}")

    def _binary(self, node: ast.BinOp) -> tuple[str, int]:
        sign, binds = _SIGNS[type(node.op)]
        right = node.right
        if sign == "+" and isinstance(right, ast.UnaryOp):
            sign, right = "-", right.operand
        elif sign == "+" and isinstance(right, ast.BinOp) and isinstance(right.left, ast.UnaryOp):
            sign, right = "-", ast.BinOp(right.left.operand, right.op, right.right)
        closer = binds + (sign in "-/")
        return f"{self._inside(node.left, binds)} {sign} {self._inside(right, closer)}", binds

    def _inside(self, node: ast.expr, least: int) -> str:
        text, binds = self._write(node)
        return text if binds >= least else f"({text})"

    def _call(self, name: str, arguments: list[str]) -> str:
        if name == "where":
            return self.where(*arguments)
        if name == "clamp":
            return self.clamp(*arguments)
        if name in self.functions:
            return f"{self.prefix}_{name}({', '.join(arguments)})"
        if name not in BUILT_IN:
            raise InputError(f"not in the syntax of descriptions: {name}(...)")
        return f"{self.names.get(name, name)}({', '.join(arguments)})"


class AbstractDialect(Expressions):
    """A language with functions and vectors. What most share with C is here.

    Attributes:
        comment: What begins a line of comment.
        end: What ends a statement.
    """

    comment = "// "
    end = ";"

    def file(self, heading: list[str], functions: tuple[Function, ...]) -> str:
        """The whole file."""
        parts = [self.opening(heading), self.body(functions), self.closing()]
        return "\n\n".join(part for part in parts if part) + "\n"

    def body(self, functions: tuple[Function, ...]) -> str:
        """The functions alone, after the type of a frame where the language wants one."""
        frames = [self.structure(function.fields) for function in functions if function.fields]
        return "\n\n".join(part for part in (*frames, *map(self.function, functions)) if part)

    def structure(self, fields: tuple[str, ...]) -> str:
        """The type of a frame."""
        return ""

    def opening(self, heading: list[str]) -> str:
        """Comments at the top, and what the language wants before the first function."""
        return self.comments("\n".join(heading), "")

    def closing(self) -> str:
        """What comes after the last function."""
        return ""

    def function(self, function: Function) -> str:
        """One function with its comment."""
        lines = [line for entry in function.body for line in self.line(entry)]
        head = [self.comments(function.doc, ""), self.signature(function)]
        return "\n".join([*head, *lines, *self.returned(function), "}"])

    def returned(self, function: Function) -> list[str]:
        """The lines that return a function's result."""
        if function.fields:
            return self.frame(function.fields)
        return [f"    return {self.expression(function.result)}{self.end}"]

    @abc.abstractmethod
    def frame(self, fields: tuple[str, ...]) -> list[str]:
        """The lines that return a frame of these numbers."""

    def line(self, line: Line) -> list[str]:
        """One new number, after its comment."""
        text = f"    {self.declaration(line.name)} = {self.expression(line.expression)}{self.end}"
        return [*([self.comments(line.comment, "    ")] if line.comment else []), text]

    def comments(self, text: str, indent: str) -> str:
        """Lines of comment."""
        return "\n".join(f"{indent}{self.comment}{line}".rstrip() for line in text.split("\n"))

    @abc.abstractmethod
    def signature(self, function: Function) -> str:
        """The line that begins a function."""

    @abc.abstractmethod
    def declaration(self, name: str) -> str:
        """The left side of the line that makes a number."""

    @abc.abstractmethod
    def vector(self, parts: list[str]) -> str:
        """A vector of three expressions."""

    def component(self, vector: str, name: str) -> str:
        """One component of a vector."""
        return f"{vector}.{name}"

    def field(self, name: str) -> str:
        """One number of a frame."""
        return f"{FRAME}.{name}"

    def _write(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.Attribute(value=ast.Name(id=name), attr=attr) if name in VECTORS:
                return self.component(name, attr), _TIGHT
            case ast.Attribute(value=ast.Name(id="frame"), attr=attr):
                return self.field(attr), _TIGHT
        return super()._write(node)

    def _call(self, name: str, arguments: list[str]) -> str:
        return self.vector(arguments) if name == "vector" else super()._call(name, arguments)
