"""Fitted numbers beside the published ones."""

from typing import Any

from ..colour import PAPER_CHANNELS
from ..errors import InputError
from ..fitting import SkyFit
from ..fitting.document import plain
from ..models.formula import CHANNELS as MODEL_CHANNELS
from ..models.perez import COEFFICIENTS, Perez
from ..models.preetham import (
    ZENITH_ANGLE,
    ZENITH_LUMINANCE,
    published_coefficients,
    published_zenith_chromaticity,
)


PARTS = ("slope", "intercept")


def has_published_form(fit: SkyFit) -> bool:
    """Whether a fit has Perez's A to E of x, y and Y by slope and intercept in one parameter."""
    return (
        fit.distribution.name == Perez.name
        and not fit.linked
        and fit.kind == "Yxy"
        and len(fit.swept) <= 1
    )


def coefficient_table(fit: SkyFit) -> dict[str, dict[str, dict[str, dict[str, float | None]]]]:
    """Coefficients of a fit, their standard errors and the published values.

    Args:
        fit: Fit whose coefficients are listed; published ones stand beside them only if it was
            swept over turbidity.

    Returns:
        By channel (Y, x, y), coefficient (A to E), part (slope, intercept) and kind (refit,
        standard_error, published).
    """
    if not has_published_form(fit):
        raise InputError(
            "coefficient_table(fit=...): expected Perez's form of x, y, Y over one parameter"
        )
    published = published_coefficients() if fit.parameter_name == "turbidity" else None
    table = {}
    for channel in PAPER_CHANNELS:
        table[channel] = {}
        for row, letter in enumerate(COEFFICIENTS):
            table[channel][letter] = {
                part: {
                    "refit": float(fit.coefficients[channel][row, column]),
                    "standard_error": float(fit.standard_errors[channel][row, column]),
                    "published": None
                    if published is None
                    else float(published[MODEL_CHANNELS.index(channel), row, column]),
                }
                for column, part in enumerate(PARTS)
            }
    return table


def zenith_record(fit: SkyFit) -> dict[str, Any]:
    """Numbers of the zenith formulas for report.json: refit, standard errors, published."""
    matrix_x, matrix_y = published_zenith_chromaticity()
    published = {
        "x": {"matrix": matrix_x.tolist()},
        "y": {"matrix": matrix_y.tolist()},
        "Y": {"linear": list(ZENITH_LUMINANCE), "angle": list(ZENITH_ANGLE)},
    }

    return {
        "refit": plain(fit.zenith),
        "standard_error": plain(fit.zenith_standard_errors),
        "published": published,
        "relative_rms": dict(fit.zenith_rms),
    }


def within_errors(table: dict[str, Any], errors: float = 2.0) -> dict[str, int]:
    """How many published numbers lie within some standard errors of the refit, and of how many."""
    letters = [parts for channel in table.values() for parts in channel.values()]
    rows = [row for parts in letters for row in parts.values()]
    near = [abs(row["refit"] - row["published"]) <= errors * row["standard_error"] for row in rows]
    return {"within": sum(near), "of": len(near)}
