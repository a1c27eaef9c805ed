"""From skies back to what they are made of: aerosol fits, and how coefficients change with air."""

from .aerosol_fit import AerosolFit as AerosolFit, fit_aerosol as fit_aerosol
from .sensitivity import (
    Sensitivity as Sensitivity,
    coefficient_sensitivity as coefficient_sensitivity,
)
