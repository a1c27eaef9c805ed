"""Batches of fits to the skies of a dataset: all at once, per parameter, sky by sky."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from .._typing import as_float
from ..models.perez import CHANNELS
from .dependence import AbstractDependence, Constant, linear_in
from .distribution import AbstractDistribution, PerezDistribution
from .shape import ShapeProblem, ShapeSolution
from .skies import RESIDUALS, WEIGHTS, Skies
from .starts import solve_from_starts


# Directions closer to the horizon are left out: over the last degrees a hazy horizon darkens by an
# order of magnitude, which no formula in 1/cos θ follows, and a fit to it spoils the rest.
MAX_VIEW_ZENITH = np.radians(85.0)
# A fit may lose this share of itself per squared unit of a free coordinate to stay near its start.
PRIOR = 2e-4

# A fit to one sky has several minima: it is begun from so many of the distribution's starts.
SINGLE_SKY_STARTS = 3

Starts = Mapping[str, Sequence[float]]


@dataclass(frozen=True)
class FitSettings:
    """Choices that a fit depends on.

    Attributes:
        weights: "equal" for every direction, or by "solid angle".
        residuals: "relative" (model / data - 1), or "absolute" (over the RMS of the data).
        max_view_zenith: Directions beyond it have no weight [rad].
        prior: Share of the loss per squared unit that a free coordinate is away from the first of
            the distribution's own starts.
        starts: Coefficients A to E to start from, by channel; channels not named start from the
            distribution's own.
    """

    weights: str = "equal"
    residuals: str = "relative"
    max_view_zenith: float = float(MAX_VIEW_ZENITH)
    prior: float = PRIOR
    starts: Starts | None = None

    def __post_init__(self):
        """Refuse what is no choice."""
        for name, allowed in (
            ("weights", WEIGHTS),
            ("residuals", RESIDUALS),
        ):
            got = getattr(self, name)
            if got not in allowed:
                raise ValueError(f"fit_sky({name}=...): expected one of {allowed}; got {got!r}")
        if not 0 < self.max_view_zenith <= np.pi / 2:
            raise ValueError(
                "fit_sky(max_view_zenith=...) must lie in 0 to π/2 rad; "
                f"got {self.max_view_zenith:.6g}"
            )
        if not self.prior >= 0:
            raise ValueError(f"fit_sky(prior=...) must be 0 or more; got {self.prior:.6g}")
        unknown = set(self.starts or ()) - set(CHANNELS)
        if unknown:
            raise ValueError(
                f"fit_sky(starts=...): expected channels of {CHANNELS}; got {sorted(unknown)}"
            )


class BatchFit(NamedTuple):
    """Fits of all channels to groups of skies.

    `nodes` are coefficients [channel, group, node, coefficient]; `rms` is over the weighted
    residuals; `starts` says how many starts a fit took.
    """

    problem: ShapeProblem
    dependence: AbstractDependence
    solution: ShapeSolution
    nodes: Float[np.ndarray, "channel group node coefficient"]
    rms: Float[np.ndarray, "channel group"]
    converged: Bool[np.ndarray, "channel group"]
    starts: Int[np.ndarray, "channel group"]


def fit_groups(
    skies: Skies,
    settings: FitSettings,
    by: Literal["all", "parameter", "sky"],
    *,
    again: bool = True,
    distribution: AbstractDistribution | None = None,
) -> BatchFit:
    """Fit every channel to every group of skies, side by side.

    Args:
        skies: What to fit.
        settings: Weights, residuals, prior, starts.
        by: Which skies share coefficients: "all" of them, linear in the parameter; those of one
            value of the "parameter"; none, each "sky" having its own.
        again: Whether fits in doubt are given all of the distribution's starts.
        distribution: Perez's by default.
    """
    distribution = PerezDistribution() if distribution is None else distribution
    dependence = linear_in(skies.parameter) if by == "all" else Constant()
    groups = skies.groups(by)
    centre, starts = _starts(settings, distribution)
    problem = shape_problem(skies, settings, groups, dependence, distribution, centre)
    single = by == "sky"
    if single and not settings.starts:
        starts = np.roll(starts, -1, axis=0)
    first = SINGLE_SKY_STARTS + bool(settings.starts) if single else 1
    free = np.tile(np.repeat(starts, groups.shape[0], axis=1), dependence.num_nodes)
    rtol = max(1e-8 if single else 1e-13, float(jnp.finfo(problem.target.dtype).eps))
    solution, used = solve_from_starts(
        problem,
        free if again else free[:first],
        first=first,
        rtol=rtol,
        max_steps=64 if single else 128,
    )
    shape = (len(CHANNELS), groups.shape[0])
    coordinates = solution.free.reshape(*shape, dependence.num_nodes, -1)
    count = np.count_nonzero(np.asarray(problem.weight), axis=(-2, -1))
    rms = np.sqrt(2 * np.asarray(solution.loss, float) / count)
    return BatchFit(
        problem=problem,
        dependence=dependence,
        solution=solution,
        nodes=np.asarray(_constrain(distribution, coordinates), float),
        rms=rms.reshape(shape),
        converged=np.asarray(solution.converged).reshape(shape),
        starts=used.reshape(shape),
    )


def shape_problem(
    skies: Skies,
    settings: FitSettings,
    groups: Int[np.ndarray, "group sky"],
    dependence: AbstractDependence,
    distribution: AbstractDistribution,
    centre: Float[np.ndarray, "channel coefficient"],
) -> ShapeProblem:
    """Arrays of a batch, its lanes being the groups of the first channel, then of the next."""
    padding = groups < 0
    channels = len(CHANNELS)
    target = skies.values
    if skies.zenith is not None:
        target = target / skies.zenith[..., None]
    weight = skies.weights(settings.weights, settings.max_view_zenith)
    if not weight.any():
        raise ValueError(
            "fit_sky(max_view_zenith=...): no direction lies within "
            f"{settings.max_view_zenith:.6g} rad of the zenith"
        )
    weight = np.broadcast_to(weight, target.shape)
    if settings.residuals == "absolute":
        typical = np.sqrt((weight * target**2).sum((1, 2)) / weight.sum((1, 2)))
        weight = weight * target / typical[:, None, None]

    def lanes(array):
        return as_float(array.reshape(-1, *array.shape[2:]))

    def repeat(array):
        picked = array[groups]
        return lanes(np.broadcast_to(picked, (channels, *picked.shape)))

    basis = np.asarray(dependence.basis(as_float(skies.parameter)), float)
    return ShapeProblem(
        distribution=distribution,
        cos_view=repeat(np.cos(skies.view_zenith)),
        gamma=repeat(skies.gamma),
        sun_zenith=repeat(skies.sun_zenith),
        basis=repeat(basis),
        target=lanes(target[:, groups]),
        weight=lanes(np.where(padding[..., None], 0.0, weight[:, groups])),
        prior=as_float(np.full(channels * len(groups), settings.prior)),
        centre=as_float(np.repeat(centre, len(groups), axis=0)),
        free_zenith=skies.zenith is None,
    )


def _starts(settings, distribution):
    """The prior's centre [channel, free], and starts [start, channel, free]."""
    own = [distribution.starts(name) for name in CHANNELS]
    given = [(settings.starts or {}).get(n, s[0]) for n, s in zip(CHANNELS, own, strict=True)]
    table = np.concatenate([np.array(given, float)[:, None], np.array(own)], axis=1)
    free = np.asarray(_release(distribution, as_float(table)), float)
    for name, coefficients, coordinates in zip(CHANNELS, given, free[:, 0], strict=True):
        if not np.isfinite(coordinates).all():
            raise ValueError(
                f"fit_sky(starts=...): {name} starts out of bounds; got {list(coefficients)}"
            )
    return free[:, 1], np.delete(free, 1, axis=1).swapaxes(0, 1)


@eqx.filter_jit
def _release(distribution, coefficients):
    return distribution.release(coefficients)


@eqx.filter_jit
def _constrain(distribution, free):
    return distribution.constrain(free)
