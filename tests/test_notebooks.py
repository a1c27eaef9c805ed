"""The notebooks: kept without outputs, written with public names alone, and run."""

import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

import skyfit


NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))
every_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def read(path):
    return nbformat.read(path, as_version=4)


def code_of(path):
    return [cell for cell in read(path).cells if cell.cell_type == "code"]


def test_the_notebooks_are_numbered_without_a_gap():
    assert [path.name[:2] for path in NOTEBOOKS] == [f"{n:02d}" for n in range(1, 7)]


@every_notebook
def test_no_output_is_kept(path):
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code_of(path))


@every_notebook
def test_it_opens_with_what_it_answers_and_with_float64(path):
    assert "**What this answers:**" in read(path).cells[0].source
    first = code_of(path)[0].source
    assert 'jax.config.update("jax_enable_x64", True)' in first
    assert "skyfit" not in first.split("#")[0]


@every_notebook
def test_only_public_names_of_skyfit_are_used(path):
    code = "\n".join(cell.source for cell in code_of(path))
    public = {name for name in dir(skyfit) if not name.startswith("_")}
    assert set(re.findall(r"\bskyfit\.(\w+)", code)) <= public
    assert set(re.findall(r"^from skyfit import (\w+)$", code, re.MULTILINE)) <= public
    assert not re.search(r"from skyfit\.|import skyfit\.|\._\w", code)


@pytest.mark.slow
@every_notebook
def test_it_runs(path, monkeypatch):
    # The kernel finds this skyfit, whether or not it is installed.
    monkeypatch.setenv("PYTHONPATH", str(Path(skyfit.__file__).parents[1]))
    notebook = read(path)
    place = {"metadata": {"path": str(path.parent)}}
    NotebookClient(notebook, timeout=900, kernel_name="python3", resources=place).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert shown
    warned = [one.text for one in shown if "Warning" in one.get("text", "")]
    # What the paper's own zenith does in hazy air is said, and explained, where it happens.
    assert not [text for text in warned if "the fitted zenith is black" not in text]
