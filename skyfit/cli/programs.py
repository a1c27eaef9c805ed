"""Compiled programs, kept from one command to the next.

Compiling the simulator takes longer than running it. JAX can keep what it compiled in a directory;
the command line gives it one, in the user's cache, bounded in size and locked while it is written.
"""

import hashlib
import os
import platform
from pathlib import Path

import click


LARGEST = 512 * 2**20  # bytes; the programs used longest ago go first
_OWN_CHOICE = "JAX_COMPILATION_CACHE_DIR"


def keep_programs() -> None:
    """Let JAX keep compiled programs; a directory that the environment names is left alone."""
    if os.environ.get(_OWN_CHOICE):
        return
    import jax

    directory = programs_directory()
    try:
        directory.mkdir(parents=True, exist_ok=True, mode=0o700)
    except OSError:
        return  # a read-only home costs the time of compiling, nothing else
    if not os.access(directory, os.W_OK):
        return
    jax.config.update("jax_compilation_cache_dir", str(directory))
    jax.config.update("jax_compilation_cache_max_size", LARGEST)
    # Of hundreds of small programs each takes longer to compile than to read.
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)


def programs_directory() -> Path:
    """Where programs are kept: a directory for each kind of processor, which must know them all."""
    from platformdirs import user_cache_path

    return user_cache_path("skyfit") / "programs" / _processor()


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    what = platform.machine() + platform.processor()
    if cpuinfo.exists():
        lines = cpuinfo.read_text(errors="replace").splitlines()
        what += next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return hashlib.sha256(what.encode()).hexdigest()[:12]


def _leave_out(context: click.Context, parameter: click.Parameter, chosen: bool) -> None:
    if chosen:
        import jax

        jax.config.update("jax_enable_compilation_cache", False)


no_cache = click.Option(
    ["--no-cache"],
    is_flag=True,
    expose_value=False,
    is_eager=True,
    callback=_leave_out,
    help="Compile anew, and keep nothing in the cache directory.",
)
