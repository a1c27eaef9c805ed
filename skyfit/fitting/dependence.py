"""Kinds of dependence on the swept parameters and the sun, and the bases that they make."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Literal

import numpy as np
from jaxtyping import Float

from ..errors import InputError
from ..models.axes import SUN, Chebyshev, Line, Tents
from ..models.basis import Basis
from .skies import Skies, distinct


# Functions of the sun by the names that users know, and as an axis of a basis calls them.
SUN_FUNCTIONS = {
    "zenith angle": "identity",
    "cosine": "cosine",
    "cube root of elevation": "cube root of elevation",
    "cube root through the horizon": "cube root through the horizon",
}
PARAMETER_FUNCTIONS = ("identity", "reciprocal")
KINDS = ("linear", "polynomial", "nodes")
_ON_THE_WAY = ((0, 0), (1, 1), (2, 3))  # degrees fitted before those asked for


@dataclass(frozen=True)
class Dependence:
    """How coefficients depend on the swept parameters and on the sun.

    Attributes:
        kind: "linear" for coefficients linear in every parameter, as Preetham et al. (1999) have
            them; "polynomial", or "nodes" for linear interpolation between the values of the data,
            of the free numbers whose links are the coefficients, over parameters and sun.
        parameter_degree: Degree of the polynomial in every parameter, or by the parameter's name;
            no more than the data have values, less one.
        sun_degree: Degree of the polynomial in a function of the sun, with the same limit.
        sun_function: "zenith angle", "cosine", "cube root of elevation", or "cube root through the
            horizon" for suns on both sides of it.
        parameter_function: What the polynomial in every parameter is one of, or by the parameter's
            name: "identity", or "reciprocal" of what is above 0, which suits turbidity.
        total_degree: Whether only terms of a polynomial are kept whose degrees, each over its
            highest, add up to 1 or less: far fewer where several parameters were swept.
    """

    kind: Literal["linear", "polynomial", "nodes"] = "polynomial"
    parameter_degree: int | Mapping[str, int] = 3
    sun_degree: int = 5
    sun_function: str = "zenith angle"
    parameter_function: str | Mapping[str, str] = "identity"
    total_degree: bool = False

    def __post_init__(self):
        """Refuse what is no choice."""
        if self.kind not in KINDS:
            raise InputError(f"Dependence(kind=...): expected one of {KINDS}; got {self.kind!r}")
        given = self.parameter_degree
        degrees = given.values() if isinstance(given, Mapping) else (given,)
        if min((self.sun_degree, *degrees)) < 0:
            raise InputError("Dependence: expected degrees of 0 or more")
        given = self.parameter_function
        functions = given.values() if isinstance(given, Mapping) else (given,)
        for one in functions:
            if one not in PARAMETER_FUNCTIONS:
                raise InputError(
                    f"Dependence(parameter_function=...): expected one of {PARAMETER_FUNCTIONS}; "
                    f"got {one!r}"
                )
        if self.sun_function not in SUN_FUNCTIONS:
            raise InputError(
                f"Dependence(sun_function=...): expected one of {tuple(SUN_FUNCTIONS)}; "
                f"got {self.sun_function!r}"
            )

    @property
    def linked(self) -> bool:
        """Whether sums of numbers times terms are free numbers, and links make the coefficients."""
        return self.kind != "linear"

    def basis(self, skies: Skies) -> Basis:
        """Basis of the formula over the ranges of some skies."""
        if self.kind == "linear":
            return Basis(tuple(Line(name, ends) for name, ends in _varied(skies)))
        return self.fitted_basis(skies)

    def fitted_basis(self, skies: Skies) -> Basis:
        """Basis in which the formula is fitted.

        Coefficients that are linear between ends where they are within bounds are so in between,
        and numbers at the ends are far less correlated than slope and intercept.
        """
        if self.kind == "linear":
            return Basis(tuple(Tents(name, ends) for name, ends in _varied(skies)))
        if self.kind == "nodes":
            values = {name: distinct(v) for name, v in skies.quantities.items()}
            return Basis(tuple(Tents(n, v) for n, v in values.items() if v.size > 1))
        return self._polynomial(skies)

    def from_fitted(self, skies: Skies) -> Float[np.ndarray, "term fitted_term"]:
        """Numbers of `basis` from those of `fitted_basis`."""
        if self.kind != "linear":
            return np.eye(self.basis(skies).num_terms)
        lines = [np.linalg.inv(np.stack([ends, np.ones(2)], axis=1)) for _, ends in _varied(skies)]
        return reduce(np.kron, lines, np.ones((1, 1)))

    def path(self, skies: Skies) -> list[Basis]:
        """Bases to fit one after another, from simple to rich; the last is `fitted_basis`."""
        last = self.fitted_basis(skies)
        if self.kind == "linear":
            return [last]
        before = (self._polynomial(skies, *degrees) for degrees in self._on_the_way())
        return [*(one for one in before if one.num_terms < last.num_terms), last]

    def describe(self) -> str:
        """The choice in a few words."""
        if self.kind != "polynomial":
            return self.kind
        suns = f" in {self.sun_function}" if self.sun_function != "zenith angle" else ""
        given = self.parameter_degree
        named = isinstance(given, Mapping)
        degrees = ", ".join(f"{k} {v}" for k, v in given.items()) if named else str(given)
        total = "total degree " if self.total_degree else ""
        return f"polynomial {total}{degrees} × {self.sun_degree}{suns}"

    def _on_the_way(self) -> list[tuple[int, int]]:
        """Highest degrees in a parameter and in the sun of what is fitted before."""
        if self.kind == "nodes":
            return list(_ON_THE_WAY)
        given = self.parameter_degree
        top = max(given.values(), default=0) if isinstance(given, Mapping) else given
        return list(dict.fromkeys((min(p, top), min(q, self.sun_degree)) for p, q in _ON_THE_WAY))

    def _degree_in(self, name: str) -> int:
        if name == SUN:
            return self.sun_degree
        given = self.parameter_degree
        return int(given.get(name, 3) if isinstance(given, Mapping) else given)

    def _function_of(self, name: str) -> str:
        given = self.parameter_function
        return str(given.get(name, "identity") if isinstance(given, Mapping) else given)

    def _polynomial(
        self, skies: Skies, parameter_limit: int | None = None, sun_limit: int | None = None
    ) -> Basis:
        axes = []
        for name, values in skies.quantities.items():
            at_sun = name == SUN
            most = distinct(values).size - 1
            limit = sun_limit if at_sun else parameter_limit
            degree = min(self._degree_in(name), most if limit is None else min(limit, most))
            function = SUN_FUNCTIONS[self.sun_function] if at_sun else self._function_of(name)
            if degree:
                axes.append(Chebyshev(name, (values.min(), values.max()), degree, function))
        return Basis(tuple(axes), self.total_degree)


def _varied(skies: Skies) -> list[tuple[str, tuple[float, float]]]:
    """Swept parameters that have more than one value, and their ends."""
    return [(name, ends) for name, ends in skies.ranges.items() if ends[0] < ends[1]]


NAMED = {kind: Dependence(kind) for kind in KINDS} | {
    # For several parameters and suns on both sides of the horizon; turbidity is above 0, and skies
    # change most where it is low.
    "total degree": Dependence(
        parameter_degree=3,
        sun_degree=12,
        sun_function="cube root through the horizon",
        parameter_function={"turbidity": "reciprocal"},
        total_degree=True,
    )
}
