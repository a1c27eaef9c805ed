"""Spectra of light over wavelength."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from . import style


def spectrum_chart(
    spectra: Mapping[str, Float[np.ndarray, " wavelength"]],
    wavelengths: Float[np.ndarray, " wavelength"],
    *,
    quantity: str = "radiance",
    unit: str = "W m$^{-2}$ sr$^{-1}$ nm$^{-1}$",
    log: bool = False,
) -> Figure:
    """Spectra on one axis.

    Args:
        spectra: Spectra by name, as many values as wavelengths.
        wavelengths: Wavelengths of the spectra [nm].
        quantity: Name of what the values are.
        unit: Theirs.
        log: Logarithmic values.
    """
    with style.house_style():
        figure = style.new_figure(6.0, 3.6)
        panel = figure.subplots()
        for number, (name, values) in enumerate(spectra.items()):
            panel.plot(wavelengths, values, label=name, **style.cycle(number))
        panel.set_xlabel("wavelength [nm]")
        panel.set_ylabel(f"{quantity} [{unit}]")
        panel.set_xlim(wavelengths[0], wavelengths[-1])
        if log:
            panel.set_yscale("log")
        else:
            panel.set_ylim(bottom=0)
        panel.legend()
    return figure
