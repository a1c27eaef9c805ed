"""The cache of compiled programs that the command line keeps."""

import os
import subprocess
import sys

import pytest


pytestmark = pytest.mark.any_precision

COMPILES = """
from skyfit import cli
from skyfit.cli.programs import keep_programs, programs_directory

keep_programs()
cli.run({arguments})
import jax
import jax.numpy as jnp

jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
jax.jit(lambda x: jnp.sin(x) * 2)(1.0)
print(len(list(programs_directory().glob("*-cache"))))
"""


def kept(directory, arguments, **environment):
    """How many programs are in the cache directory after a command and a program."""
    left = {name: text for name, text in os.environ.items() if not name.startswith("JAX_")}
    run = subprocess.run(
        [sys.executable, "-c", COMPILES.format(arguments=arguments)],
        env=left | {"XDG_CACHE_HOME": str(directory), "HOME": str(directory), **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stderr == ""
    return int(run.stdout.splitlines()[-1])


@pytest.mark.slow
def test_programs_are_kept_in_the_users_cache_unless_told_not_to(tmp_path):
    export = ["export", "published", "--format", "c"]
    command = [*export, "--out", str(tmp_path / "a.c")]
    kept_now = kept(tmp_path, command)
    assert kept_now > 0
    left_out = [*export, "--out", str(tmp_path / "b.c"), "--no-cache"]
    assert kept(tmp_path / "other", left_out) == 0


@pytest.mark.slow
def test_a_directory_of_the_users_own_is_left_alone(tmp_path):
    own = tmp_path / "own"
    command = ["export", "published", "--format", "c", "--out", str(tmp_path / "a.c")]
    assert kept(tmp_path, command, JAX_COMPILATION_CACHE_DIR=str(own)) == 0
    assert list(own.glob("*-cache"))


@pytest.mark.slow
def test_a_home_that_cannot_be_written_costs_nothing_but_time(tmp_path):
    (tmp_path / "skyfit").write_text("in the way of the directory")
    command = ["export", "published", "--format", "c", "--out", str(tmp_path / "a.c")]
    assert kept(tmp_path, command) == 0
