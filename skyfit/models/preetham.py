"""The published sky of Preetham, Shirley & Smits (1999)."""

import warnings

import numpy as np

from .._typing import ArrayLike, as_float, check, is_traced
from ..tables import read_table
from .axes import Line
from .basis import Basis
from .formula import CHANNELS, FormulaSky
from .perez import COEFFICIENTS, Perez
from .scale import CubicZenith, PaperZenith, TangentZenith


# The luminance formula has a pole near T = 1.64, where 1 + A e^B = 0; 10 is an overcast-like haze.
TURBIDITY_RANGE = (1.9, 10.0)
ZENITH_LUMINANCE = (4045.3, -4971.0, -215.5, 2419.2)  # cd m^-2; appendix A.2
ZENITH_ANGLE = (4 / 9, -1 / 120)


def published_coefficients() -> np.ndarray:
    """A to E as (slope in turbidity, intercept) for x, y, Y: [3, 5, 2]. Appendix A.2."""
    table = read_table("preetham1999_perez_coefficients")
    rows = {
        key: numbers
        for *key_parts, slope, intercept in zip(*table.values(), strict=True)
        for key, numbers in [(tuple(key_parts), (slope, intercept))]
    }
    return np.array([[rows[channel, name] for name in COEFFICIENTS] for channel in CHANNELS])


def published_zenith_chromaticity() -> np.ndarray:
    """Matrices of the zenith's x and y [2, 3, 4]: T², T, 1 by θₛ³, θₛ², θₛ, 1. Appendix A.2."""
    table = read_table("preetham1999_zenith_chromaticity")
    numbers = list(table.values())[2:]
    rows = np.stack(numbers, axis=1)
    order = np.argsort(-table["turbidity_power"], kind="stable")
    rows, channel = rows[order], table["channel"][order]
    return np.stack([rows[channel == name] for name in CHANNELS[:2]])


def preetham_sky(turbidity: ArrayLike) -> FormulaSky:
    """The published sky model at a turbidity.

    Made from simulations for T = 2 to 6; used here from 1.9 to 10. Outside, T is held at the
    nearest end, with a warning where the value is known: towards 1.64 the published luminance has
    a pole, and beyond 10 its zenith luminance turns negative for low suns.

    Args:
        turbidity: T, 1 or more. An array broadcasts against the angles the model is asked for.

    Raises:
        ValueError: Turbidity below 1 or NaN.

    Source: Preetham et al. (1999), appendix A.2.
    """
    value = as_float(turbidity)
    value = check(value, lambda v: ~(v >= 1), "preetham_sky(turbidity=...) must be 1 or more")
    warn_outside(value, TURBIDITY_RANGE, "preetham_sky(turbidity=...)")
    zenith_x, zenith_y = published_zenith_chromaticity()
    return FormulaSky(
        swept={"turbidity": value},
        numbers=as_float(published_coefficients()),
        basis=Basis((Line("turbidity", TURBIDITY_RANGE),)),
        distribution=Perez(),
        scale=PaperZenith(
            CubicZenith(as_float(zenith_x)),
            CubicZenith(as_float(zenith_y)),
            TangentZenith(as_float(ZENITH_LUMINANCE), as_float(ZENITH_ANGLE)),
            "turbidity",
        ),
        wavelengths=None,
        linked=False,
        kind="Yxy",
        ranges=(("turbidity", TURBIDITY_RANGE),),
        sun_zenith_range=(0.0, np.pi / 2),
    )


def warn_outside(value: ArrayLike, valid: tuple[float, float], argument: str) -> None:
    """Warn that a known value lies outside a valid range and is held at its end."""
    if is_traced(value) or np.size(value) == 0:
        return
    known = np.asarray(value)  # of a JAX array: its own `min` would be traced inside `jit`
    low, high = float(known.min()), float(known.max())
    # A value computed in float32 may miss the end by a rounding error.
    slack = 1e-6 * max(abs(end) for end in valid)
    if low < valid[0] - slack or high > valid[1] + slack:
        got, taken = (low, valid[0]) if low < valid[0] else (high, valid[1])
        warnings.warn(
            f"{argument} is valid from {valid[0]:.6g} to {valid[1]:.6g} and held there; "
            f"got {got:.6g}, and {taken:.6g} is used",
            stacklevel=3,
        )
