"""Other programs that tests compare with or feed: where one is missing, its tests are skipped.

With SKYFIT_NO_SKIPS=1 in the environment, which every check of a change sets, a skipped test has
failed; see `conftest.py`.
"""

import shutil
from pathlib import Path
from types import ModuleType

import pytest


def peer(name: str) -> ModuleType:
    """Import a package of `skyfit[test]`, or skip: the file at its top, a test in its body."""
    reason = f"{name} cannot be imported: pip install 'skyfit[test]'"
    return pytest.importorskip(name, reason=reason, exc_type=ImportError)


def peer_program(name: str, where: Path) -> str:
    """Path of a program that a package of `skyfit[test]` brings, or skip."""
    found = shutil.which(name, path=str(where))
    if found is None:
        pytest.skip(f"{name} is not in {where}: pip install 'skyfit[test]'")
    return found
