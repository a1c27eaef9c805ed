"""The sun: where it stands, and its light at the ground."""

from .position import SunPosition as SunPosition, sun_position as sun_position
