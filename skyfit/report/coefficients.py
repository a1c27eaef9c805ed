"""Fitted numbers beside the published ones."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..fitting import SkyFit
from ..models.perez import CHANNELS as MODEL_CHANNELS, COEFFICIENTS
from ..models.preetham import (
    ZENITH_ANGLE,
    ZENITH_LUMINANCE,
    published_coefficients,
    published_zenith_chromaticity,
)
from . import style


CHANNELS = ("Y", "x", "y")
PARTS = ("slope", "intercept")


def coefficient_table(fit: SkyFit) -> dict[str, dict[str, dict[str, dict[str, float | None]]]]:
    """Coefficients of a fit, their standard errors and the published values.

    Args:
        fit: Its published counterpart exists only if it was swept over turbidity.

    Returns:
        By channel (Y, x, y), coefficient (A to E), part (slope, intercept) and kind (refit,
        standard_error, published).
    """
    published = published_coefficients() if fit.parameter_name == "turbidity" else None
    table = {}
    for channel in CHANNELS:
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

    def plain(numbers: dict[str, dict[str, np.ndarray]]) -> dict[str, dict[str, Any]]:
        return {
            channel: {name: np.asarray(array).tolist() for name, array in parts.items()}
            for channel, parts in numbers.items()
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


def coefficient_chart(fit: SkyFit) -> Figure:
    """Coefficients over turbidity: refit with its errors, two-stage fit, published."""
    figure = style.new_figure(11.0, 5.4)
    panels = figure.subplots(len(CHANNELS), len(COEFFICIENTS), sharex=True)
    low, high = fit.parameter_range or (0.0, 1.0)
    turbidity = np.linspace(low, high, 41)
    published = published_coefficients()
    for row, channel in enumerate(CHANNELS):
        for column, letter in enumerate(COEFFICIENTS):
            panel = panels[row, column]
            line = np.polyval(fit.coefficients[channel][column], turbidity)
            spread = 2 * _spread(fit.standard_errors[channel][column], low, high, turbidity)
            panel.fill_between(
                turbidity, line - spread, line + spread, color=style.REFIT["color"],
                alpha=0.2, linewidth=0, label="± 2 standard errors",
            )  # fmt: skip
            panel.plot(turbidity, line, label="refit, all at once", **style.REFIT)
            numbers = published[MODEL_CHANNELS.index(channel), column]
            panel.plot(
                turbidity, np.polyval(numbers, turbidity), label="published", **style.PUBLISHED
            )
            if fit.two_stage is not None:
                stage = fit.two_stage[channel]
                panel.plot(
                    stage.values, stage.coefficients[:, column], label="refit, each turbidity",
                    **style.SIMULATED,
                )  # fmt: skip
            if row == 0:
                panel.set_title(letter)
            if column == 0:
                panel.set_ylabel(f"coefficient, {channel}")
            if row == len(CHANNELS) - 1:
                panel.set_xlabel("turbidity")
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _spread(errors: np.ndarray, low: float, high: float, at: np.ndarray) -> np.ndarray:
    """Standard error of a line from those of slope and intercept, its ends being independent."""
    slope, intercept = errors**2 * (high - low) ** 2
    at_low = np.clip((intercept - slope * low**2) / (high**2 - low**2), 0, slope)
    share = (at - low) / (high - low)
    return np.sqrt((1 - share) ** 2 * at_low + share**2 * (slope - at_low))
