"""The suite is stricter than a user's program."""

import os
from pathlib import Path

import jax
import matplotlib as mpl
import pytest


# The whole suite runs in float64, and a silent promotion or broadcast is an error. SKYFIT_X64=0 is
# for a run without float64, of the tests marked `any_precision` and not `float64`.
FLOAT64 = os.environ.get("SKYFIT_X64", "1") != "0"
jax.config.update("jax_enable_x64", FLOAT64)
jax.config.update("jax_numpy_dtype_promotion", "strict")
jax.config.update("jax_numpy_rank_promotion", "raise")
NO_SKIPS = os.environ.get("SKYFIT_NO_SKIPS") == "1"

mpl.use("Agg")


def pytest_collection_modifyitems(config, items):
    # Files with slow tests first, so that none is left for one process at the end.
    long = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in long)
    if not FLOAT64:
        kept = [item for item in items if holds_in_float32(item)]
        config.hook.pytest_deselected(items=[item for item in items if item not in set(kept)])
        items[:] = kept


def holds_in_float32(item):
    marks = {mark.name for mark in item.iter_markers()}
    return "any_precision" in marks and not marks & {"float64", "slow"}


def fails_if_skipped(report):
    """Where nothing may be skipped, what is skipped has failed, with the reason it gave."""
    if NO_SKIPS and report.skipped:
        reason = report.longrepr[2]
        report.outcome = "failed"
        report.longrepr = f"SKYFIT_NO_SKIPS=1, but {report.nodeid} was skipped: {reason}"
    return report


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_makereport():
    return fails_if_skipped((yield))


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_make_collect_report():
    return fails_if_skipped((yield))


@pytest.fixture
def float32():
    """A program that never switched float64 on."""
    with jax.enable_x64(False):
        yield


@pytest.fixture(autouse=True, scope="module")
def programs_end_before_memory_does():
    """Drop compiled programs now and then.

    Each holds a dozen memory mappings, and Linux grants a process 65 530: a worker that kept the
    whole suite's programs would be aborted.
    """
    yield
    mappings = Path("/proc/self/maps")
    if not mappings.exists() or len(mappings.read_text().splitlines()) > 20_000:
        jax.clear_caches()
