"""The suite is stricter than a user's program."""

from pathlib import Path

import jax
import matplotlib as mpl
import pytest


# The whole suite runs in float64, and a silent promotion or broadcast is an error.
jax.config.update("jax_enable_x64", True)
jax.config.update("jax_numpy_dtype_promotion", "strict")
jax.config.update("jax_numpy_rank_promotion", "raise")

mpl.use("Agg")


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
