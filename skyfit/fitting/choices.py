"""The choices that make a fit: distribution, dependence, scale; weights, residuals, prior."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Literal

import numpy as np
from jaxtyping import Float

from ..errors import InputError
from ..models.axes import SUN, Chebyshev, Line, Tents
from ..models.basis import Basis
from ..models.distribution import AbstractDistribution
from ..models.domes import DISTRIBUTIONS
from ..models.perez import Perez
from .skies import RESIDUALS, WEIGHTS, Skies, distinct


# Directions closer to the horizon are left out: over the last degrees a hazy horizon darkens by an
# order of magnitude, which no formula in 1/cos θ follows, and a fit to it spoils the rest.
MAX_VIEW_ZENITH = np.radians(85.0)
# A fit may lose this share of itself per squared unit of a free coordinate to stay near its start.
PRIOR = 2e-4

# Functions of the sun by the names that users know, and as an axis of a basis calls them.
SUN_FUNCTIONS = {
    "zenith angle": "identity",
    "cosine": "cosine",
    "cube root of elevation": "cube root of elevation",
    "cube root through the horizon": "cube root through the horizon",
}
PARAMETER_FUNCTIONS = ("identity", "reciprocal")
KINDS = ("linear", "polynomial", "nodes")
ZENITHS = ("paper", "logarithm")
_ON_THE_WAY = ((0, 0), (1, 1), (2, 3))  # degrees fitted before those asked for

Starts = Mapping[str, Sequence[float]]


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
# Of the scale's logarithm, which everything else is multiplied by.
SCALE = Dependence("polynomial", 3, 7)
# So much higher than the coefficients' are the scale's degrees where the total degree counts.
_HIGHER = (2, 6)


@dataclass(frozen=True)
class Formula:
    """What is fitted: a distribution, and how its coefficients depend on parameters and sun.

    Attributes:
        distribution: Formula of the dome.
        dependence: Dependence of its coefficients.
        zenith: Zenith of the published form, one of `ZENITHS`.
    """

    distribution: AbstractDistribution
    dependence: Dependence
    zenith: str = "paper"

    @property
    def scale_dependence(self) -> Dependence:
        """Dependence of the scale's logarithm."""
        own = self.dependence
        if not own.total_degree:
            return SCALE
        more, given = _HIGHER[0], own.parameter_degree
        named = isinstance(given, Mapping)
        degrees = {k: v + more for k, v in given.items()} if named else given + more
        return dataclasses.replace(
            own, parameter_degree=degrees, sun_degree=own.sun_degree + _HIGHER[1]
        )

    @property
    def by_day_alone(self) -> bool:
        """Whether the formula has the paper's zenith, which knows no sun below the horizon."""
        published = self.distribution.name == Perez.name and self.dependence.kind == "linear"
        return published and self.zenith == "paper"

    def has_paper_zenith(self, skies: Skies) -> bool:
        """Whether the scale is the zenith of Preetham et al.: that belongs to their own form."""
        return self.by_day_alone and skies.kind == "Yxy" and len(skies.swept) <= 1


PUBLISHED = Formula(Perez(), NAMED["linear"])


def chosen_formula(
    distribution: str | AbstractDistribution,
    dependence: str | Dependence,
    caller: str = "fit_sky",
    *,
    zenith: str = "paper",
) -> Formula:
    """The formula of its names, or of the values given.

    Raises:
        ValueError: A name is unknown.
    """
    if isinstance(distribution, str):
        if distribution not in DISTRIBUTIONS:
            raise InputError(
                f"{caller}(distribution=...): expected one of {tuple(DISTRIBUTIONS)}; "
                f"got {distribution!r}"
            )
        distribution = DISTRIBUTIONS[distribution]()
    if isinstance(dependence, str):
        if dependence not in NAMED:
            raise InputError(
                f"{caller}(dependence=...): expected one of {tuple(NAMED)} or a Dependence; "
                f"got {dependence!r}"
            )
        dependence = NAMED[dependence]
    if not isinstance(distribution, AbstractDistribution):
        raise InputError(
            f"{caller}(distribution=...): expected a name or a distribution; got {distribution!r}"
        )
    if not isinstance(dependence, Dependence):
        raise InputError(
            f"{caller}(dependence=...): expected a name or a Dependence; got {dependence!r}"
        )
    if zenith not in ZENITHS:
        raise InputError(f"{caller}(zenith=...): expected one of {ZENITHS}; got {zenith!r}")
    return Formula(distribution, dependence, zenith)


@dataclass(frozen=True)
class FitSettings:
    """Choices that a fit depends on besides the formula.

    Attributes:
        weights: "equal" for every direction, or by "solid angle".
        residuals: "relative" (model / data - 1), or "absolute" (over the RMS of the data).
        max_view_zenith: View zenith angle beyond which directions keep the `horizon_weight` of the
            distribution, none for Perez's and the CIE's [rad].
        prior: Share of the loss per squared unit that a free coordinate is away from the first of
            the distribution's own starts.
        starts: Coefficients to start from, by channel; channels not named start from the
            distribution's own.
    """

    weights: str = "equal"
    residuals: str = "relative"
    max_view_zenith: float = float(MAX_VIEW_ZENITH)
    prior: float = PRIOR
    starts: Starts | None = None

    def __post_init__(self):
        """Refuse what is no choice."""
        for name, allowed in (("weights", WEIGHTS), ("residuals", RESIDUALS)):
            got = getattr(self, name)
            if got not in allowed:
                raise InputError(f"fit_sky({name}=...): expected one of {allowed}; got {got!r}")
        if not 0 < self.max_view_zenith <= np.pi / 2:
            raise InputError(
                "fit_sky(max_view_zenith=...) must lie in 0 to π/2 rad; "
                f"got {self.max_view_zenith:.6g}"
            )
        if not self.prior >= 0:
            raise InputError(f"fit_sky(prior=...) must be 0 or more; got {self.prior:.6g}")
