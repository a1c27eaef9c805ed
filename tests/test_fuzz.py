"""Some malformed files and command lines: the rest are `python tests/fuzz_files.py`'s."""

import warnings

import fuzz_files
import pytest


@pytest.mark.slow
def test_malformed_files_and_command_lines_are_answered_with_one_line(monkeypatch):
    from skyfit.dataset import runner

    monkeypatch.setattr(runner, "simulate", runner.simulate)  # put back afterwards
    with warnings.catch_warnings():
        warnings.simplefilter("default")  # as on the command line
        counts, faults = fuzz_files.run(range(48), seed=20)
    assert faults == []
    assert {kind for kind, _, _ in counts} == set(fuzz_files.KINDS)
    assert sum(counts.values()) == 48
