"""Fits that come with the package."""

from functools import cache
from importlib import resources

from .files import load_fit
from .record import SkyFit


@cache
def paper_refit() -> SkyFit:
    """The paper's formula fitted to the paper's campaign, as `skyfit reproduce` fits it.

    5 turbidities by 12 suns by 343 directions, two orders of scattering in U.S. Standard air and
    Elterman's haze: the default `skyfit.Campaign`.
    """
    file = resources.files("skyfit") / "data" / "preetham1999_refit.fit.json"
    with resources.as_file(file) as path:
        return load_fit(path)
