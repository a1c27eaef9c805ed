"""Closed formulas of the sky, all behind one interface."""

from .all_weather import (
    perez_all_weather_sky as perez_all_weather_sky,
    perez_clear_sky as perez_clear_sky,
)
from .base import AbstractSkyModel as AbstractSkyModel
from .blend import BlendedSky as BlendedSky, overcast_blend_sky as overcast_blend_sky
from .cie import (
    cie_clear_sky as cie_clear_sky,
    cie_general_sky as cie_general_sky,
    cie_intermediate_sky as cie_intermediate_sky,
    cie_overcast_sky as cie_overcast_sky,
)
from .day import (
    DayCourse as DayCourse,
    DaySky as DaySky,
    day_course as day_course,
    day_sky as day_sky,
)
from .formula import FormulaSky as FormulaSky
from .hoffman import (
    HoffmanPreethamSky as HoffmanPreethamSky,
    hoffman_preetham_sky as hoffman_preetham_sky,
)
from .preetham import preetham_sky as preetham_sky
