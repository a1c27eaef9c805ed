"""Array aliases and the two doors every public argument passes: conversion and checking."""

from collections.abc import Callable, Sequence
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.core import Tracer
from jaxtyping import Array, ArrayLike as _ArrayLike, Float

from .errors import InputError


# What a caller may pass for an array: a number, an array, or (nested) lists of numbers.
ArrayLike = _ArrayLike | Sequence[Any]
Scalar = Float[Array, ""]
Spectrum = Float[Array, " wavelength"]


def as_float(value: ArrayLike) -> Float[Array, "..."]:
    """Convert to JAX's default float, so `3`, `3.0` and `np.float64(3)` trace alike.

    An array that is already floating keeps its width: float32 data stay float32 where x64 is on.
    """
    dtype = getattr(value, "dtype", None)
    # A weakly typed value (a Python float seen through jit) must not fix the width either.
    if dtype is not None and jnp.issubdtype(dtype, jnp.floating) and np.ndim(value) > 0:
        return _convert(value, jax.dtypes.canonicalize_dtype(dtype))
    return _convert(value, jnp.result_type(float))


def as_parameter(value: ArrayLike) -> Float[Array, "..."]:
    """Convert to JAX's default float whatever the width: what describes an atmosphere has one."""
    return _convert(value, jnp.result_type(float))


def _convert(value: ArrayLike, dtype: Any) -> Float[Array, "..."]:
    if is_traced(value):
        return jnp.asarray(value, dtype=dtype)
    # What is known stays known inside a caller's `jit`, where a conversion would be traced.
    with jax.ensure_compile_time_eval():
        return jnp.asarray(value, dtype=dtype)


def as_scalar(value: ArrayLike, name: str) -> Scalar:
    """Convert one number to JAX's default float.

    Raises:
        InputError: `value` is no number, or several; the message starts with `name`.
    """
    try:
        number = as_parameter(value)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: expected a number; got {value!r}") from error
    if number.ndim != 0:
        raise InputError(f"{name}: expected one value; got shape {number.shape}")
    return number


def as_table(value: Any, name: str, shape: tuple[int, ...]) -> np.ndarray:
    """Finite numbers of a file as an array of float64.

    Raises:
        ValueError: `value` has another shape, or holds what is no finite number; the message starts
            with `name`.
    """
    try:
        array = np.array(value, float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: expected {shape} numbers; {error}") from error
    if array.shape != shape or not np.isfinite(array).all():
        raise InputError(f"{name}: expected {shape} numbers; got shape {array.shape}")
    return array


def as_wavelengths(value: ArrayLike, name: str) -> Spectrum:
    """Convert one or more wavelengths [nm] to JAX's default float.

    Raises:
        InputError: `value` has two axes or no element, or does not increase, or holds anything
            but finite numbers above 0; the message starts with `name`.
    """
    lam = jnp.atleast_1d(as_parameter(value))
    if lam.ndim != 1 or lam.size == 0:
        raise InputError(f"{name}: expected one axis of one value or more; got shape {lam.shape}")
    return check(lam, _is_no_spectrum, f"{name} must increase from above 0 nm")


def falls_or_stays(values: Any) -> Any:
    """Where values along one axis do not exceed the one before, or are NaN; for `check`."""
    xp = jnp if is_traced(values) else np
    return xp.concatenate([xp.isnan(values[:1]), ~(values[1:] > values[:-1])])


def _is_no_spectrum(lam: Any) -> Any:
    return falls_or_stays(lam) | ~((lam > 0) & (lam < np.inf))


def is_traced(*values: object) -> bool:
    """Tell whether any value is known only while a compiled program runs."""
    return any(isinstance(leaf, Tracer) for leaf in jax.tree.leaves(values))


def check(
    value: Float[Array, "..."], fails: Callable[[Any], Any], message: str
) -> Float[Array, "..."]:
    """Refuse a value out of its domain with one line; return the value.

    Args:
        value: The argument to hand on; the check holds only if the return value is used.
        fails: Tells where values are unacceptable, elementwise or as a whole. It is given a NumPy
            array where the value is known (so that nothing need be compiled to refuse it), and
            a traced one where it is not: operators and array methods serve both.
        message: Says what, where, and what was expected. What came is added where it is known.

    Returns:
        `value` unchanged.

    Raises:
        InputError: At once, if the values are known.
        RuntimeError: When the compiled program runs, if they are traced.
    """
    if is_traced(value):
        return eqx.error_if(value, fails(value), message)
    known = np.asarray(value)
    mask = np.broadcast_to(fails(known), known.shape)
    if mask.any():
        got = known[mask].ravel()[0]
        raise InputError(f"{message}; got {got:.6g}")
    return value
