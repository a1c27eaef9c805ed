"""Data flows one way: a module may import only from the stages before it."""

import ast
from pathlib import Path

import pytest

import skyfit


ORDER = [
    "errors", "_files", "_progress", "_schema", "_typing",              # what everything needs
    "constants", "tables", "provenance",                      # numbers
    "spectrum", "colour", "angles",                           # light and directions
    "legendre", "phase_tables", "phase", "profile", "bands",              # what skies are made of
    "atmosphere", "preetham_air", "sun",
    "models", "weather", "turbidity", "fitting",              # closed forms, and fitting them
    "transfer",                                               # simulation
    "campaign", "error_estimate",                             # which skies, and how good they are
    "dataset",                                                # records of skies, and making them
    "judging", "retrieval",                                   # of fits, and of what made the skies
    "aerial", "marcher", "surfaces",                          # light on its way to eye and ground
    "render", "plots", "export", "compare", "report", "benchmark",  # what is made of them
    "__init__", "cli", "__main__",
]  # fmt: skip
ROOT = Path(skyfit.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))


def stage(path: Path) -> str:
    return path.relative_to(ROOT).parts[0].removesuffix(".py")


def imported_stages(tree: ast.AST, path: Path):
    package = path.relative_to(ROOT).parts[:-1]
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = package[: len(package) + 1 - node.level]
            names = [node.module] if node.module else [alias.name for alias in node.names]
            for name in names:
                yield (*base, *name.split("."))[0]
        elif isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.split(".")[0] == "skyfit":
                    yield (*alias.name.split(".")[1:], "__init__")[0]


def functions(tree: ast.AST):
    kinds = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
    return [node for node in ast.walk(tree) if isinstance(node, kinds)]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_module_imports_only_from_earlier_stages(path):
    here = ORDER.index(stage(path))
    late = [
        other
        for other in imported_stages(ast.parse(path.read_text()), path)
        if ORDER.index(other) > here
    ]
    assert late == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_function_hides_an_import_of_another_stage(path):
    hidden = [
        other
        for function in functions(ast.parse(path.read_text()))
        for other in imported_stages(function, path)
    ]
    assert hidden == []


def test_no_file_is_so_long_that_it_holds_two_ideas():
    lengths = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in FILES}
    assert {name: lines for name, lines in lengths.items() if lines > 300} == {}
