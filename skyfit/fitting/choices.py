"""The choices that make a fit: formula, scale; weights, residuals, prior."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..models.distribution import AbstractDistribution
from ..models.domes import DISTRIBUTIONS
from ..models.perez import Perez
from .dependence import NAMED, Dependence
from .skies import RESIDUALS, WEIGHTS, Skies


# Directions closer to the horizon are left out: over the last degrees a hazy horizon darkens by an
# order of magnitude, which no formula in 1/cos θ follows, and a fit to it spoils the rest.
MAX_VIEW_ZENITH = np.radians(85.0)
# A fit may lose this share of itself per squared unit of a free coordinate to stay near its start.
PRIOR = 2e-4

ZENITHS = ("paper", "logarithm")

Starts = Mapping[str, Sequence[float]]


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
