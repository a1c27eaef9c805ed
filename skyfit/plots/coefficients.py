"""Fitted coefficients over turbidity, with their errors."""

import numpy as np
from matplotlib.figure import Figure

from ..colour import PAPER_CHANNELS
from ..errors import InputError
from ..fitting import SkyFit
from ..models.formula import CHANNELS as MODEL_CHANNELS
from ..models.perez import COEFFICIENTS
from ..models.preetham import published_coefficients
from . import style


def coefficient_chart(fit: SkyFit) -> Figure:
    """Coefficients over the swept parameter: refit with its errors, two-stage fit, published.

    Args:
        fit: The published lines are drawn if it was swept over turbidity.

    Raises:
        InputError: Nothing was swept.
    """
    if fit.parameter_name is None:
        raise InputError("coefficient_chart(fit=...): expected a fit over a parameter; got none")
    with style.house_style():
        return _drawn(fit, fit.parameter_name)


def _drawn(fit: SkyFit, swept: str) -> Figure:
    figure = style.new_figure(11.0, 5.4)
    panels = figure.subplots(len(PAPER_CHANNELS), len(COEFFICIENTS), sharex=True)
    low, high = fit.parameter_range or (0.0, 1.0)
    turbidity = np.linspace(low, high, 41)
    published = published_coefficients()
    for row, channel in enumerate(PAPER_CHANNELS):
        for column, letter in enumerate(COEFFICIENTS):
            panel = panels[row, column]
            line = np.polyval(fit.coefficients[channel][column], turbidity)
            spread = 2 * _spread(fit.standard_errors[channel][column], low, high, turbidity)
            panel.fill_between(
                turbidity, line - spread, line + spread, color=style.REFIT["color"],
                alpha=0.2, linewidth=0, label="± 2 standard errors",
            )  # fmt: skip
            panel.plot(turbidity, line, label="refit, all at once", **style.REFIT)
            if swept == "turbidity":
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
                panel.set_ylabel(f"coefficient of {channel} [1]")
            if row == len(PAPER_CHANNELS) - 1:
                panel.set_xlabel(swept.replace("_", " "))
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _spread(errors: np.ndarray, low: float, high: float, at: np.ndarray) -> np.ndarray:
    """Standard error of a line from those of slope and intercept, its ends being independent."""
    slope, intercept = errors**2 * (high - low) ** 2
    at_low = np.clip((intercept - slope * low**2) / (high**2 - low**2), 0, slope)
    share = (at - low) / (high - low)
    return np.sqrt((1 - share) ** 2 * at_low + share**2 * (slope - at_low))
