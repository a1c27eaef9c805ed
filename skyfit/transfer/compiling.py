"""Compiling large programs in less time."""

from collections.abc import Callable
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
        return eqx.filter_jit(function, **options)

    return call


@cache
def _known_options() -> dict[str, bool | int] | None:
    """The options, or None for an XLA that has no such."""
    try:
        jax.jit(jnp.negative, compiler_options=_OPTIONS).lower(0.0).compile()
    except jax.errors.JaxRuntimeError:
        return None
    return _OPTIONS
