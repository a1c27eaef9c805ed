"""What `conftest.py` makes of tests: none skipped in a check, slow files first, float64 or not."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


HERE = Path(__file__).parent
MISSING_IN_ONE_TEST = """
from peers import peer

def test_alone():
    pass

def test_beside_another_program():
    peer("a_program_that_nobody_has")
"""
MISSING_IN_A_FILE = """
from peers import peer

peer("a_program_that_nobody_has")

def test_never_reached():
    pass
"""
QUICK = """
import jax, pytest

pytestmark = pytest.mark.any_precision

def test_precision():
    assert jax.numpy.ones(()).dtype == "float32"

@pytest.mark.float64
def test_digits():
    assert jax.numpy.ones(()).dtype == "float64"
"""
LONG = """
import pytest

@pytest.mark.slow
def test_long():
    pass
"""


def outcome(where, text, no_skips):
    return pytest_of(where, {"test_it.py": text}, SKYFIT_NO_SKIPS=no_skips)


def pytest_of(where, files, **environment):
    for name in ("conftest.py", "peers.py"):
        (where / name).write_text((HERE / name).read_text())
    for name, text in files.items():
        (where / name).write_text(text)
    options = ["-rs", "-v", "-p", "no:cacheprovider", "-c", os.devnull, "--rootdir=."]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options],
        cwd=where, env=os.environ | environment, capture_output=True, text=True,
    )  # fmt: skip
    return done.returncode, done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("text", [MISSING_IN_ONE_TEST, MISSING_IN_A_FILE], ids=["test", "file"])
def test_what_a_missing_program_skips_has_failed_where_nothing_may_be_skipped(text, tmp_path):
    code, said = outcome(tmp_path, text, "0")
    assert code in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED)
    assert "1 skipped" in said
    assert "a_program_that_nobody_has cannot be imported: pip install 'skyfit[test]'" in said
    code, said = outcome(tmp_path, text, "1")
    assert code in (pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.INTERRUPTED)
    assert "skipped: " in said
    assert "a_program_that_nobody_has cannot be imported: pip install 'skyfit[test]'" in said


@pytest.mark.slow
def test_files_with_slow_tests_come_first(tmp_path):
    _, said = pytest_of(tmp_path, {"test_a.py": QUICK, "test_b.py": LONG}, SKYFIT_X64="1")
    assert said.index("test_b.py::test_long PASSED") < said.index("test_a.py::test_digits PASSED")
    assert "test_a.py::test_precision FAILED" in said


@pytest.mark.slow
def test_without_float64_what_needs_it_is_left_out(tmp_path):
    code, said = pytest_of(tmp_path, {"test_a.py": QUICK, "test_b.py": LONG}, SKYFIT_X64="0")
    assert code == pytest.ExitCode.OK
    assert "test_a.py::test_precision PASSED" in said
    assert "1 passed, 2 deselected" in said
