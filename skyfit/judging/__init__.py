"""Judging fits: how far off they are where nobody looked, and what the choices do to them."""

from .accuracy import recovery_error as recovery_error, shape_error as shape_error
from .ladder import colour_claim as colour_claim, ladder as ladder
from .weighting import compare_weights as compare_weights
