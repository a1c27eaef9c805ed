"""Fitting closed formulas to skies, by Levenberg-Marquardt, with what a sceptic asks of a fit."""

from .choices import Dependence as Dependence
from .each_sky import EachSky as EachSky, fit_each_sky as fit_each_sky
from .files import load_fit as load_fit
from .fit import fit_sky as fit_sky
from .positivity import Positivity as Positivity, positivity as positivity
from .record import SkyFit as SkyFit
from .shipped import paper_refit as paper_refit
