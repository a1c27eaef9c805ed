"""Compiling large programs in less time, and saying so."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp

from .._typing import is_traced


P = ParamSpec("P")
R = TypeVar("R")

# On processors XLA's older fusion compiles the simulator in two thirds of the time of its present
# one, and the first level of LLVM's optimisation takes a seventh less than the third; the program
# runs as fast.
_OPTIONS = {"xla_cpu_use_fusion_emitters": False, "xla_backend_optimization_level": 1}

_told: ContextVar[Callable[[], None] | None] = ContextVar("_told", default=None)


@contextmanager
def told_of_compiling(tell: Callable[[], None]) -> Iterator[None]:
    """Call `tell` whenever the simulator begins to be compiled, in this thread."""
    token = _told.set(tell)
    try:
        yield
    finally:
        _told.reset(token)


def compile_quickly(function: Callable[P, R]) -> Callable[P, R]:
    """`eqx.filter_jit`, with options for XLA where it is a program of its own.

    Inside a caller's transformation, which decides how its whole program is compiled, they are left
    out.
    """
    part = eqx.filter_jit(function)

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        # Inside `jit` even constants are traced.
        inside = is_traced(args, kwargs, jnp.zeros(()))
        return (part if inside else alone())(*args, **kwargs)

    @cache
    def alone():
        options: Any = {"compiler_options": _known_options()}  # handed on to `jax.jit`
        return eqx.filter_jit(traced, **options)

    @wraps(function)
    def traced(*args: P.args, **kwargs: P.kwargs) -> R:
        # Python runs this while a program is traced, which is when it is about to be compiled.
        if (tell := _told.get()) is not None:
            tell()
        return function(*args, **kwargs)

    return call


@cache
def _known_options() -> dict[str, bool | int] | None:
    """The options that XLA_FLAGS does not set itself, or None for an XLA that has no such."""
    chosen = os.environ.get("XLA_FLAGS", "")
    options = {name: value for name, value in _OPTIONS.items() if name not in chosen}
    try:
        jax.jit(jnp.negative, compiler_options=options).lower(0.0).compile()
    except jax.errors.JaxRuntimeError:
        return None
    return options
