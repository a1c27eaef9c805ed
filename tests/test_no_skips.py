"""A check of a change skips nothing: what a missing program would skip has failed there."""

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
EXPECTED_TO_FAIL = """
import pytest

@pytest.mark.xfail
def test_known():
    raise AssertionError
"""


def outcome(where, text, no_skips):
    for name in ("conftest.py", "peers.py"):
        (where / name).write_text((HERE / name).read_text())
    (where / "test_it.py").write_text(text)
    options = ["-rs", "-q", "-p", "no:cacheprovider", "-c", os.devnull, "--rootdir=."]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options, "test_it.py"],
        cwd=where, env=os.environ | {"SKYFIT_NO_SKIPS": no_skips}, capture_output=True, text=True,
    )  # fmt: skip
    return done.returncode, done.stdout


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


def test_what_is_known_to_fail_is_not_skipped(tmp_path):
    assert outcome(tmp_path, EXPECTED_TO_FAIL, "1")[0] == pytest.ExitCode.OK
