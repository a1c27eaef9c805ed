"""Aerial perspective: what the air between eye and object takes from its light and adds to it."""

from .constant import ConstantAmbient as ConstantAmbient, ward_larson_aerial as ward_larson_aerial
from .perspective import (
    AerialPerspective as AerialPerspective,
    aerial_perspective as aerial_perspective,
)
from .sunset import Airlight as Airlight, Sunset as Sunset, sunset_airlight as sunset_airlight
from .uniform import UniformAir as UniformAir, hoffman_preetham_aerial as hoffman_preetham_aerial
