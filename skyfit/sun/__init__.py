"""The sun: where it stands, and its light at the ground."""

from .irradiance import (
    Irradiance as Irradiance,
    clear_sky_irradiance as clear_sky_irradiance,
)
from .light import (
    sun_irradiance as sun_irradiance,
    sun_xyY as sun_xyY,
    sunlight as sunlight,
)
from .position import SunPosition as SunPosition, sun_position as sun_position
from .times import sun_at as sun_at, sun_table as sun_table
