"""Bands of water vapour and oxygen: absorption by lines too narrow for the spectrum's sampling.

Averaged over a band, light of such lines does not fade exponentially along its path: the strongest
lines are soon black, the weak ones last. Bird & Riordan (1986), "Simple solar spectral model for
direct and diffuse irradiance on horizontal and tilted planes at the Earth's surface for cloudless
atmospheres", J. Climate Appl. Meteor. 25, 87, have

    T = exp(-0.2385 x / (1 + 20.07 x)^0.45)   for water vapour, and
    T = exp(-1.41 x / (1 + 118.93 x)^0.45)    for mixed gases, here oxygen,

after Leckner (1978), Solar Energy 20, 143, with x the band's absorption coefficient times the
absorber in the path. Both are mixtures of exponentials, Σ w exp(-κ x), and nearly the same one: a
band is described by a few classes of lines, each of which does fade exponentially.

To simulate a sky, simulate it once per class, with that class's absorption added as that of an
absorber that does not scatter, and take the mean of the radiances (and of the transmittances)
weighted with `weights`. That is, the wavelength axis is repeated for every class; one copy is
enough where the absorption is 0. Water vapour and mixed gases share their weights: one set of
copies serves both. (Strong lines of the one then coincide with strong lines of the other, which
matters at no wavelength where both absorb much.)
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from .._typing import ArrayLike
from ..tables import read_table
from .spectra import Wavelengths


Weights = Float[np.ndarray, " line_class"]

# Of x in Bird & Riordan's formulas; times the strengths of the table they are κ.
_WATER_SCALE, _MIXED_SCALE = 20.07, 118.93
_CENTIMETRES = 100.0  # in a metre


class Bands(NamedTuple):
    """An absorber by classes of its lines.

    Attributes:
        weights: Share of the spectrum that each class has; adds up to 1.
        absorption: Of each class, where the relative density is 1 [m⁻¹].
    """

    weights: Weights
    absorption: Float[np.ndarray, "line_class wavelength"]

    def transmittance(self, column: float) -> Wavelengths:
        """Mean over the classes of what a column [m at relative density 1] lets pass."""
        return self.weights @ np.exp(-column * self.absorption)


def water_vapour_bands(wavelengths: ArrayLike, precipitable_water: float, column: float) -> Bands:
    """Absorption by water vapour, six classes of lines.

    The formula is met within 0.001 for all x up to 500 (cm of water times cm⁻¹): 2 cm of water have
    5 at most, upwards. Thin paths (x below 0.01) lose a quarter too little. The bands at 593, 690,
    720 and 800 nm are in the table, that at 650 nm is not.

    Args:
        wavelengths: Up to 800 [nm]; no absorption below 580.
        precipitable_water: Depth of all the vapour above the ground as liquid, 0 or more [m].
        column: Vertical column of the vapour's profile, above 0 [m at relative density 1].
    """
    depth = _coefficient("water_vapour_cm-1", wavelengths) * _CENTIMETRES * precipitable_water
    return _bands(_WATER_SCALE * depth / column)


def mixed_gas_bands(wavelengths: ArrayLike, column: float, pressure_ratio: float = 1.0) -> Bands:
    """Absorption by uniformly mixed gases, six classes of lines: oxygen's bands at 690 and 760 nm.

    The formula is met within 0.001 for all x up to 500; the standard atmosphere has 4 at most,
    upwards.

    Args:
        wavelengths: Up to 800 [nm]; no absorption below 680.
        column: Vertical column of the air's profile, above 0 [m at relative density 1].
        pressure_ratio: Pressure at the ground over the standard's.
    """
    depth = _coefficient("mixed_gases", wavelengths) * pressure_ratio
    return _bands(_MIXED_SCALE * depth / column)


def _bands(scaled: Wavelengths) -> Bands:
    table = read_table("bird1986_band_distribution")
    return Bands(table["weight"], table["strength"][:, None] * scaled)


def _coefficient(column: str, wavelengths: ArrayLike) -> Wavelengths:
    """A column of the table, linear between its wavelengths, of which it leaves some blank."""
    table = read_table("bird1986_line_absorption")
    given = np.isfinite(table[column])
    lam = np.atleast_1d(np.asarray(wavelengths, float))
    return np.interp(lam, table["wavelength_nm"][given], table[column][given])
