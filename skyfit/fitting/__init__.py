"""Fitting closed formulas to skies, by Levenberg-Marquardt, with what a sceptic asks of a fit."""

from .accuracy import recovery_error as recovery_error, shape_error as shape_error
from .choices import Dependence as Dependence
from .files import load_fit as load_fit
from .formula_record import FormulaFit as FormulaFit
from .ladder import colour_claim as colour_claim, ladder as ladder
from .positivity import Positivity as Positivity, positivity as positivity
from .record import SkyFit as SkyFit
from .sensitivity import (
    Sensitivity as Sensitivity,
    coefficient_sensitivity as coefficient_sensitivity,
)
from .shipped import paper_refit as paper_refit
from .sky_fit import EachSky as EachSky, fit_each_sky as fit_each_sky, fit_sky as fit_sky
from .weighting import compare_weights as compare_weights
