"""The models that are compared: one line each in `MODELS`."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike
from ..colour import spectrum_to_xyY
from ..fitting import paper_refit
from ..marcher import scs_sky
from ..models import (
    cie_clear_sky,
    cie_general_sky,
    cie_intermediate_sky,
    cie_overcast_sky,
    day_sky,
    hoffman_preetham_sky,
    overcast_blend_sky,
    perez_clear_sky,
    preetham_sky,
)
from ..preetham_air import preetham_atmosphere
from ..transfer.simulate_sky import Sky, simulate
from .peers import HosekWilkieSky


@runtime_checkable
class HasColour(Protocol):
    """What a model must have to be compared: `xyY` as in `skyfit.models.base`."""

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]."""
        ...


@dataclass(frozen=True)
class Conditions:
    """The sky that is looked at.

    Attributes:
        sun_zenith: Zenith angle of the sun [rad].
        turbidity: 1 or more.
    """

    sun_zenith: float
    turbidity: float


@dataclass(frozen=True)
class Entry:
    """A row of the table.

    Attributes:
        name: Name of the row.
        sky: Makes the model for the conditions; its `valid_range`, if it has one, is heeded.
        package: Package that must be installed beside skyfit, if any.
        white: Words for what counts as luminance 1 in a model that knows no cd/m².
    """

    name: str
    sky: Callable[[Conditions], HasColour]
    package: str = ""
    white: str = ""


# The simulation is by draft quality and 20 nm, within 1 or 2 % of the converged one.
WAVELENGTHS = np.arange(380.0, 781.0, 20.0)


class SimulatedSky:
    """The paper's air and haze simulated, up to an order of scattering."""

    def __init__(self, turbidity: float, orders: int | None):
        self.turbidity, self.orders = turbidity, orders

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]."""
        views = (tuple(np.ravel(angle).tolist()) for angle in (view_zenith, relative_azimuth))
        sky = _simulated(self.turbidity, float(np.asarray(sun_zenith)), *views)
        light = sky.radiance if self.orders is None else sky.by_order[: self.orders].sum(axis=0)
        return spectrum_to_xyY(light, WAVELENGTHS)


@lru_cache(maxsize=2)  # one simulation serves the rows of every order
def _simulated(turbidity: float, sun: float, view: tuple, azimuth: tuple) -> Sky:
    air = preetham_atmosphere(turbidity, wavelengths=WAVELENGTHS)
    return simulate(air, sun, np.array(view), np.array(azimuth), orders=None, quality="draft")


MODELS = (
    Entry("simulated, single scattering", lambda at: SimulatedSky(at.turbidity, 1)),
    Entry("simulated, two orders", lambda at: SimulatedSky(at.turbidity, 2)),
    Entry("simulated, all orders", lambda at: SimulatedSky(at.turbidity, None)),
    Entry("refit of the paper's form", lambda at: paper_refit().sky(turbidity=at.turbidity)),
    Entry("Preetham 1999, published", lambda at: preetham_sky(at.turbidity)),
    Entry(
        "Preetham for a screen, DAY",
        lambda at: day_sky(at.turbidity),
        white="the published zenith's luminance under an overhead sun",
    ),
    Entry("Hoffman & Preetham 2002", lambda at: hoffman_preetham_sky(at.turbidity)),
    Entry("Nishita 1993, 16 × 8 steps", lambda at: scs_sky()),
    Entry("Hosek–Wilkie 2012", lambda at: HosekWilkieSky(at.turbidity), package="mitsuba"),
    Entry("Preetham, overcast from 10", lambda at: overcast_blend_sky(at.turbidity)),
    Entry("CIE clear", lambda at: cie_clear_sky(at.turbidity)),
    Entry("CIE general 12: clear", lambda at: cie_general_sky(12)),
    Entry("Perez 1993, clear air", lambda at: perez_clear_sky(at.turbidity)),
    Entry("CIE intermediate", lambda at: cie_intermediate_sky(at.turbidity)),
    Entry("CIE overcast", lambda at: cie_overcast_sky()),
)
