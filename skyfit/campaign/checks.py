"""Checks of a campaign's arguments."""

from typing import Any

import numpy as np

from ..errors import InputError


def axis_of(
    name: str, given: Any, low: float, high: float, *, increasing: bool = True
) -> tuple[float, ...]:
    """One axis of numbers within bounds, as Python floats."""
    try:
        axis = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        raise InputError(f"Campaign({name}=...): expected numbers; got {given!r:.60}") from None
    if axis.ndim != 1 or axis.size == 0:
        raise InputError(f"Campaign({name}=...): expected one axis; got shape {axis.shape}")
    # A rounding error beyond π is no reason to refuse a direction.
    outside = ~(np.isfinite(axis) & (axis >= low) & (axis <= high + 1e-9))
    if outside.any():
        bounds = f"within [{low:.6g}, {high:.6g}]" if np.isfinite(high) else f"{low:.6g} or more"
        raise InputError(
            f"Campaign({name}=...): expected finite values {bounds if np.isfinite(low) else ''}"
            f"; got {axis[outside][0]:.6g}".replace(" ;", ";")
        )
    if increasing and np.any(np.diff(axis) <= 0):
        at = int(np.argmax(np.diff(axis) <= 0))
        raise InputError(
            f"Campaign({name}=...): expected increasing values; got {axis[at]:.6g} "
            f"before {axis[at + 1]:.6g}"
        )
    return tuple(axis.tolist())


def one_of(owner: str, name: str, given: Any, choices: tuple[str, ...]) -> None:
    """Refuse a word that is none of the choices."""
    if given not in choices:
        expected = ", ".join(repr(choice) for choice in choices)
        raise InputError(f"{owner}({name}=...): expected one of {expected}; got {given!r}")
