"""Atmospheres in plain words and numbers, as campaign files hold them, and what is made of them."""

from .atmosphere import DescribedAtmosphere as DescribedAtmosphere
from .paper import PaperAtmosphere as PaperAtmosphere
from .sweep import Sweep as Sweep
