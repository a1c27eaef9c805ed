"""The languages that sky formulas are written in."""

from .description import BUILT_IN, VECTORS, Function
from .dialect import AbstractDialect


class Glsl(AbstractDialect):
    """GLSL, desktop and ES: no arrays, no version line, so that it goes into any shader."""

    single = True
    number_type, vector_type = "float", "vec3"

    def signature(self, function: Function) -> str:
        """The line that begins a function."""
        arguments = ", ".join(
            f"{self._type(name in VECTORS)} {name}" for name in function.arguments
        )
        result = self._type(function.returns_vector)
        return f"{result} {self.prefix}_{function.name}({arguments}) {{"

    def declaration(self, name: str) -> str:
        """The left side of the line that makes a number."""
        return f"{self.number_type} {name}"

    def vector(self, parts: list[str]) -> str:
        """A vector of three expressions."""
        return f"{self.vector_type}({', '.join(parts)})"

    def _type(self, vector: bool) -> str:
        return self.vector_type if vector else self.number_type


class Hlsl(Glsl):
    """HLSL."""

    vector_type = "float3"


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

    def closing(self, functions: tuple[Function, ...]) -> str:
        """The end of the guard."""
        return "#endif"

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

    def file(self, heading: list[str], functions: tuple[Function, ...]) -> str:
        """The whole file."""
        return super().file(heading, functions).replace("\n\ndef ", "\n\n\ndef ")

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
        result = f"    return {self.expression(function.result)}"
        return "\n".join([self.signature(function), f'{text}"""', *lines, result])

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
