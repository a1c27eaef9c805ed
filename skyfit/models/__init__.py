"""Closed formulas of the sky, all behind one interface."""

from .base import AbstractSkyModel as AbstractSkyModel
from .perez import PerezSky as PerezSky
from .preetham import preetham_sky as preetham_sky
