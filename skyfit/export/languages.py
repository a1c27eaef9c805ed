"""The languages that sky formulas are written in."""

import re

from .description import BUILT_IN, FRAME, VECTORS, Function
from .dialect import AbstractDialect


_GODOT_CONSTANTS = re.compile(r"\b(E|PI|TAU)\b")


class Glsl(AbstractDialect):
    """GLSL, desktop and ES: no arrays, no version line, so that it goes into any shader."""

    single = True
    number_type, vector_type = "float", "vec3"
    members_in_line = 6

    def structure(self, fields: tuple[str, ...]) -> str:
        """The type of a frame."""
        return f"struct {self.prefix}_frame {{\n{self._members(fields)}\n}};"

    def _members(self, fields: tuple[str, ...]) -> str:
        count = self.members_in_line
        rows = (fields[k : k + count] for k in range(0, len(fields), count))
        return "\n".join(f"    {self.number_type} {', '.join(row)};" for row in rows)

    def frame(self, fields: tuple[str, ...]) -> list[str]:
        """The lines that return a frame of these numbers."""
        set_ = (f"    {FRAME}.{name} = {name};" for name in fields)
        return [f"    {self.declaration(FRAME)};", *set_, f"    return {FRAME};"]

    def signature(self, function: Function) -> str:
        """The line that begins a function."""
        arguments = ", ".join(f"{self._type_of(name)} {name}" for name in function.arguments)
        result = self.vector_type if function.returns_vector else self.number_type
        result = self._type_of(FRAME) if function.returns_frame else result
        return f"{result} {self.prefix}_{function.name}({arguments}) {{"

    def declaration(self, name: str) -> str:
        """The left side of the line that makes a number."""
        return f"{self._type_of(name)} {name}"

    def vector(self, parts: list[str]) -> str:
        """A vector of three expressions."""
        return f"{self.vector_type}({', '.join(parts)})"

    def _type_of(self, name: str) -> str:
        if name == FRAME:
            return f"{self.prefix}_frame"
        return self.vector_type if name in VECTORS else self.number_type


class Hlsl(Glsl):
    """HLSL."""

    vector_type = "float3"


class Godot(Glsl):
    """Godot's shading language: some letters are constants, a member of a structure has a line."""

    members_in_line = 1

    def expression(self, text: str) -> str:
        """An expression of the description in this language."""
        return _GODOT_CONSTANTS.sub(r"\1_", super().expression(text))

    def declaration(self, name: str) -> str:
        """The left side of the line that makes a number."""
        return _GODOT_CONSTANTS.sub(r"\1_", super().declaration(name))

    def signature(self, function: Function) -> str:
        """The line that begins a function."""
        return _GODOT_CONSTANTS.sub(r"\1_", super().signature(function))


class C(Glsl):
    """A C header of static functions in double precision; C++ takes it too."""

    single = False
    names = {"min": "fmin", "max": "fmax"}  # noqa: RUF012
    number_type = "double"

    def __init__(self, prefix: str, functions: tuple[Function, ...]):
        super().__init__(prefix, functions)
        self.vector_type = f"{prefix}_vector"

    def opening(self, heading: list[str]) -> str:
        """Comments, the guard and the vector's type."""
        guard = f"{self.prefix.upper()}_H"
        name = self.vector_type
        return "\n".join(
            [
                "/*",
                *(f" * {line}".rstrip() for line in heading),
                " */",
                f"#ifndef {guard}",
                f"#define {guard}",
                "",
                "#include <math.h>",
                "",
                f"typedef struct {{ double x, y, z; }} {name};",
                "",
                f"static inline {name} {self.prefix}_make(double x, double y, double z) {{",
                f"    {name} made;",
                "    made.x = x;",
                "    made.y = y;",
                "    made.z = z;",
                "    return made;",
                "}",
            ]
        )

    def closing(self) -> str:
        """The end of the guard."""
        return "#endif"

    def structure(self, fields: tuple[str, ...]) -> str:
        """The type of a frame."""
        return f"typedef struct {{\n{self._members(fields)}\n}} {self.prefix}_frame;"

    def signature(self, function: Function) -> str:
        """The line that begins a function."""
        return f"static inline {super().signature(function)}"

    def vector(self, parts: list[str]) -> str:
        """A vector of three expressions."""
        return f"{self.prefix}_make({', '.join(parts)})"

    def clamp(self, value: str, low: str, high: str) -> str:
        """A value held between two others."""
        return f"fmin(fmax({value}, {low}), {high})"

    def comments(self, text: str, indent: str) -> str:
        """Lines of comment, in the form that C of every age takes."""
        lines = text.split("\n")
        return f"{indent}/* " + f"\n{indent} * ".join(lines) + " */"


class JavaScript(AbstractDialect):
    """A JavaScript module; vectors are arrays of three numbers."""

    names = {name: f"Math.{name}" for name in BUILT_IN}  # noqa: RUF012

    def signature(self, function: Function) -> str:
        """The line that begins a function."""
        export = "export " if function.public else ""
        return f"{export}function {self.prefix}_{function.name}({', '.join(function.arguments)}) {{"

    def declaration(self, name: str) -> str:
        """The left side of the line that makes a number."""
        return f"const {name}"

    def frame(self, fields: tuple[str, ...]) -> list[str]:
        """The line that returns a frame of these numbers."""
        return [f"    return {{ {', '.join(fields)} }};"]

    def vector(self, parts: list[str]) -> str:
        """A vector of three expressions."""
        return f"[{', '.join(parts)}]"

    def component(self, vector: str, name: str) -> str:
        """One component of a vector."""
        return f"{vector}[{'xyz'.index(name)}]"

    def clamp(self, value: str, low: str, high: str) -> str:
        """A value held between two others."""
        return f"Math.min(Math.max({value}, {low}), {high})"


class Python(AbstractDialect):
    """A Python module that needs NumPy alone; arguments broadcast, vectors are on the last axis."""

    names = {name: f"np.{name}" for name in BUILT_IN} | {
        "asin": "np.arcsin",
        "pow": "np.power",
        "min": "np.minimum",
        "max": "np.maximum",
    }
    comment, end = "# ", ""

    def opening(self, heading: list[str]) -> str:
        """The module's docstring and its import."""
        return "\n".join(['"""', *heading, '"""', "", "import numpy as np"])

    def body(self, functions: tuple[Function, ...]) -> str:
        """The functions, as far apart as Python's are."""
        return "\n" + super().body(functions).replace("\n\ndef ", "\n\n\ndef ")

    def function(self, function: Function) -> str:
        """One function with its docstring."""
        first, *rest = function.doc.split("\n")
        text = "\n".join([f'    """{first}', *(f"    {line}" for line in rest)])
        lines = [
            f"    {name} = np.asarray({name}, dtype=float)"
            for name in function.arguments
            if name in VECTORS
        ]
        lines += [line for entry in function.body for line in self.line(entry)]
        head = [self.signature(function), f'{text}"""']
        return "\n".join([*head, *lines, *self.returned(function)])

    def frame(self, fields: tuple[str, ...]) -> list[str]:
        """The line that returns a frame of these numbers."""
        entries = ", ".join(f'"{name}": {name}' for name in fields)
        return [f"    return {{{entries}}}"]

    def field(self, name: str) -> str:
        """One number of a frame."""
        return f'{FRAME}["{name}"]'

    def signature(self, function: Function) -> str:
        """The line that begins a function."""
        return f"def {self.prefix}_{function.name}({', '.join(function.arguments)}):"

    def declaration(self, name: str) -> str:
        """The left side of the line that makes a number."""
        return name

    def vector(self, parts: list[str]) -> str:
        """A vector of three expressions."""
        return f"np.stack(np.broadcast_arrays({', '.join(parts)}), axis=-1)"

    def component(self, vector: str, name: str) -> str:
        """One component of a vector."""
        return f"{vector}[..., {'xyz'.index(name)}]"

    def where(self, condition: str, if_true: str, if_false: str) -> str:
        """A choice."""
        return f"np.where({condition}, {if_true}, {if_false})"

    def clamp(self, value: str, low: str, high: str) -> str:
        """A value held between two others."""
        return f"np.clip({value}, {low}, {high})"
