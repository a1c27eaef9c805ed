"""The choices of a ladder of formulas: which distribution, and how its coefficients depend."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..models.basis import SUN_FUNCTIONS, AbstractBasis, Nodes, Polynomial
from ..models.shapes import SHAPES, AbstractShape
from .skies import Skies


@dataclass(frozen=True)
class Dependence:
    """How coefficients depend on the swept parameter and on the sun.

    Attributes:
        kind: "polynomial", or "nodes" for linear interpolation between the values of the data.
        parameter_degree: Of the polynomial; no more than the data have values, less one.
        sun_degree: The same, in a function of the sun.
        sun_function: "zenith angle", "cosine" or "cube root of elevation".
    """

    kind: Literal["polynomial", "nodes"] = "polynomial"
    parameter_degree: int = 3
    sun_degree: int = 5
    sun_function: str = "zenith angle"

    def __post_init__(self):
        """Refuse what is no choice."""
        if self.kind not in ("polynomial", "nodes"):
            raise ValueError(
                f"Dependence(kind=...): expected 'polynomial' or 'nodes'; got {self.kind!r}"
            )
        if min(self.parameter_degree, self.sun_degree) < 0:
            raise ValueError("Dependence: expected degrees of 0 or more")
        if self.sun_function not in SUN_FUNCTIONS:
            raise ValueError(
                f"Dependence(sun_function=...): expected one of {SUN_FUNCTIONS}; "
                f"got {self.sun_function!r}"
            )

    def basis(self, skies: Skies) -> AbstractBasis:
        """The basis over the range of some skies."""
        values, suns = np.unique(skies.parameter), np.unique(skies.sun_zenith.round(9))
        if self.kind == "nodes":
            return Nodes(values, suns)
        return Polynomial(
            skies.parameter_range,
            skies.sun_zenith_range,
            min(self.parameter_degree, values.size - 1),
            min(self.sun_degree, suns.size - 1),
            self.sun_function,
        )

    def describe(self) -> str:
        """In a few words."""
        if self.kind == "nodes":
            return "nodes"
        if self == NAMED["linear"]:
            return "linear"
        suns = f" in {self.sun_function}" if self.sun_function != "zenith angle" else ""
        return f"polynomial {self.parameter_degree} × {self.sun_degree}{suns}"


NAMED = {
    "linear": Dependence("polynomial", 1, 0),
    "polynomial": Dependence(),
    "nodes": Dependence("nodes"),
}
# Of the scale's logarithm, which everything else is multiplied by.
SCALE = Dependence("polynomial", 3, 7)


def chosen_shape(distribution: str | AbstractShape) -> AbstractShape:
    """The distribution of a name, or the one given."""
    if isinstance(distribution, AbstractShape):
        return distribution
    if distribution not in SHAPES:
        raise ValueError(
            f"fit_sky(distribution=...): expected one of {tuple(SHAPES)}; got {distribution!r}"
        )
    return SHAPES[distribution]()


def chosen_dependence(dependence: str | Dependence) -> Dependence:
    """The dependence of a name, or the one given."""
    if isinstance(dependence, Dependence):
        return dependence
    if dependence not in NAMED:
        raise ValueError(
            f"fit_sky(dependence=...): expected one of {tuple(NAMED)} or a Dependence; "
            f"got {dependence!r}"
        )
    return NAMED[dependence]
