"""Bands of water vapour and oxygen in the visible, as classes of lines.

Averaged over a band, light of such lines does not fade exponentially along its path: the strongest
lines are soon black, the weak ones last. Bird & Riordan (1986), "Simple solar spectral model for
direct and diffuse irradiance on horizontal and tilted planes at the Earth's surface for cloudless
atmospheres", J. Climate Appl. Meteor. 25, 87, have

    T = exp(-0.2385 x / (1 + 20.07 x)^0.45)   for water vapour, and
    T = exp(-1.41 x / (1 + 118.93 x)^0.45)    for mixed gases, here oxygen,

after Leckner (1978), Solar Energy 20, 143, with x the band's absorption coefficient times the
absorber in the path. Both are mixtures of exponentials, Σ w exp(-κ x), and nearly the same one: a
band is described by a few classes of lines, each of which does fade exponentially.

Water vapour and mixed gases share their weights. (Strong lines of the one then coincide with strong
lines of the other, which matters at no wavelength where both absorb much.) The formulas are made
for paths through the whole atmosphere: that lines narrow with height is in them on the average of
such paths, not for the air above a summit.
"""

import numpy as np

from ..._typing import ArrayLike, as_scalar, check
from ...atmosphere import Constituent
from ...bands import Bands
from ...constants import TOP_OF_ATMOSPHERE
from ...errors import InputError
from ...phase import Rayleigh
from ...profile import AbstractProfile, Exponential, StandardAtmosphere
from ...tables import read_table
from .spectra import Wavelengths


# m; Recommendation ITU-R P.835, "Reference standard atmospheres": ρ(h) = 7.5 g/m³ exp(-h / 2 km).
WATER_VAPOUR_HEIGHT = 2e3
LONGEST = 800.0  # nm; the tables end here
# Of x in Bird & Riordan's formulas; times the strengths of the table they are κ.
_WATER_SCALE, _MIXED_SCALE = 20.07, 118.93
_CENTIMETRES = 100.0  # in a metre
MOST_WATER = 0.2  # m; twice what the wettest air holds


def water_vapour(
    wavelengths: ArrayLike,
    precipitable_water: ArrayLike,
    density: AbstractProfile | None = None,
    top_altitude: ArrayLike = TOP_OF_ATMOSPHERE,
) -> Constituent:
    """Water vapour with its bands at 593, 690, 720 and 800 nm, after Bird & Riordan (1986).

    T = exp(-0.2385 x / (1 + 20.07 x)^0.45), x being the band's coefficient (2.5 cm⁻¹ at 724 nm)
    times the water in the path, is met within 0.001 up to x = 500. Without absorption below 580 nm;
    the weak band at 650 nm is not in the table.

    Args:
        wavelengths: Wavelengths of the atmosphere, up to 800 [nm].
        precipitable_water: Depth of all the vapour above the ground as liquid, 0 to 0.2: 0.005 in
            dry winters, 0.05 in the tropics [m].
        density: Exponential with a scale height of 2 km if not given.
        top_altitude: Altitude at which the atmosphere ends [m].

    Raises:
        InputError: There are wavelengths beyond 800 nm, or an amount out of its range.
    """
    density = Exponential(WATER_VAPOUR_HEIGHT) if density is None else density
    bands = water_vapour_bands(wavelengths, 1.0, 1.0)
    water = check(
        as_scalar(precipitable_water, "water_vapour(precipitable_water=...)"),
        lambda depth: ~((depth >= 0) & (depth <= MOST_WATER)),
        f"water_vapour(precipitable_water=...) must lie in [0, {MOST_WATER}] m; 2 cm are 0.02",
    )
    return _absorber(density, bands.scaled(water / density.column(top_altitude)))


def oxygen(
    wavelengths: ArrayLike,
    pressure_ratio: ArrayLike = 1.0,
    density: AbstractProfile | None = None,
    top_altitude: ArrayLike = TOP_OF_ATMOSPHERE,
) -> Constituent:
    """Oxygen with its bands at 690 and 762 nm, after Bird & Riordan (1986).

    T = exp(-1.41 x / (1 + 118.93 x)^0.45), x being the band's coefficient (4 at 762.5 nm) times the
    air mass, is met within 0.001 up to x = 500. Without absorption below 680 nm. Pairs of molecules
    are another constituent, "oxygen_dimer" of campaign files.

    Args:
        wavelengths: Wavelengths of the atmosphere, up to 800 [nm].
        pressure_ratio: Pressure at the ground over the standard's, 0 or more.
        density: Relative density of the gas; that of the U.S. Standard Atmosphere if not given.
        top_altitude: Altitude at which the atmosphere ends [m].

    Raises:
        InputError: There are wavelengths beyond 800 nm, or a negative pressure.
    """
    density = StandardAtmosphere() if density is None else density
    bands = mixed_gas_bands(wavelengths, 1.0)
    pressure = check(
        as_scalar(pressure_ratio, "oxygen(pressure_ratio=...)"),
        lambda ratio: ~((ratio >= 0) & (ratio < np.inf)),
        "oxygen(pressure_ratio=...) must be 0 or more",
    )
    return _absorber(density, bands.scaled(pressure / density.column(top_altitude)))


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


def _absorber(density: AbstractProfile, bands: Bands) -> Constituent:
    return Constituent(density, 0.0, phase=Rayleigh(), bands=bands)


def _bands(scaled: Wavelengths) -> Bands:
    table = read_table("bird1986_band_distribution")
    return Bands(table["weight"], table["strength"][:, None] * scaled)


def _coefficient(column: str, wavelengths: ArrayLike) -> Wavelengths:
    """A column of the table, linear between its wavelengths, of which it leaves some blank."""
    table = read_table("bird1986_line_absorption")
    given = np.isfinite(table[column])
    lam = np.atleast_1d(np.asarray(wavelengths, float))
    if not (lam <= LONGEST).all():
        raise InputError(
            f"bands of water vapour and oxygen are known up to {LONGEST:g} nm; got {lam.max():g}"
        )
    return np.interp(lam, table["wavelength_nm"][given], table[column][given])
