"""Fits of a formula to the skies of a dataset: all at once, per swept value, sky by sky."""

from typing import Literal, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from .._typing import as_float
from ..errors import InputError
from ..models.basis import Basis
from .choices import FitSettings, Formula
from .lanes import Solution, solve_from_starts
from .problem import FitProblem, residuals
from .skies import Skies
from .targets import targets, terms_of


# A fit to one sky has several minima: it is begun from so many of the distribution's starts.
SINGLE_SKY_STARTS = 3
# Share of the loss per squared kink of a free number from node to node.
SMOOTHNESS = 3e-4
# Relative misfit that the prior takes skies to have in addition to what is found, where links make
# coefficients that depend on the sun: what follows chromaticities to 0.1 % would else be free to go
# astray where there are no skies.
LEAST_MISFIT = 0.07
# Relative decrease of the objective that ends a fit: of one sky, of coefficients linear in the
# parameters, of richer formulas, and of those on the way to them.
SINGLE_RTOL, LINEAR_RTOL, RICH_RTOL, ROUGH_RTOL = 1e-8, 1e-13, 1e-5, 1e-3
SINGLE_STEPS, MAX_STEPS = 64, 128

# Numbers of terms to which the bases on the way to a rich one are filled up: a program serves all
# of a size, and those of other formulas with the same distribution.
_SIZES = (4, 24)

By = Literal["all", "swept", "sky"]


class BatchFit(NamedTuple):
    """Fits of all channels to groups of skies.

    Attributes:
        problem: What was fitted; its lanes are the groups of the first channel, then of the next.
        basis: Terms of the numbers.
        solution: What the solver found.
        numbers: Numbers of the formula in the terms of `basis`.
        rms: Root mean square of the weighted residuals.
        converged: The solver's word.
        starts: Number of starts that a fit took.
    """

    problem: FitProblem
    basis: Basis
    solution: Solution
    numbers: Float[np.ndarray, "channel group term coefficient"]
    rms: Float[np.ndarray, "channel group"]
    converged: Bool[np.ndarray, "channel group"]
    starts: Int[np.ndarray, "channel group"]


def fit_groups(
    skies: Skies,
    formula: Formula,
    settings: FitSettings,
    by: By = "all",
    *,
    use: Bool[np.ndarray, " sky"] | None = None,
    start: Float[np.ndarray, "channel sky coefficient"] | None = None,
    again: bool = True,
) -> BatchFit:
    """Fit every channel to every group of skies.

    A formula that is richer than a line is led there from simple to rich: the same coefficients for
    all skies, from every one of the distribution's starts; then polynomials of rising degree, each
    begun from the one before.

    Args:
        skies: What to fit.
        formula: Distribution and dependence; skies of one group that is not "all" share one set of
            coefficients.
        settings: Weights, residuals, prior, starts.
        by: Which skies share numbers: "all" of them; those of the same "swept" values; none, each
            "sky" having its own.
        use: Skies to fit; all by default.
        start: Sums of numbers times terms of every sky to begin from, in place of the starts.
        again: Whether fits in doubt are given all of the distribution's starts.
    """
    use = np.ones(skies.count, bool) if use is None else use
    seen = skies if use.all() else skies.subset(use)
    path = formula.dependence.path(seen) if by == "all" else [Basis()]
    groups, wanted = skies.groups(by), targets(skies, formula, settings, use)
    centre, starts = _starts(skies, formula, settings)
    single, rich = by == "sky", len(path) > 1
    if single and not settings.starts:
        starts = np.roll(starts, -1, axis=0)
    first = SINGLE_SKY_STARTS + bool(settings.starts) if single else len(starts) if rich else 1
    if start is not None:
        path, first = path[-1:], 1
    rows = starts[:, :, None] if start is None else start[None]
    solution, used, problem = None, None, None
    for basis in path:
        size = _filled_size(basis.num_terms, path[-1].num_terms)
        problem = _problem(skies, wanted, groups, basis, centre, formula, settings, size, use)
        along = terms_of(basis, skies)[use]
        free = _numbers_of(along, rows, use, basis, size)
        free = np.repeat(free, groups.shape[0], axis=1)
        rtol = SINGLE_RTOL if single else RICH_RTOL if rich or start is not None else LINEAR_RTOL
        rtol = rtol if basis is path[-1] else ROUGH_RTOL
        solution, used = solve_from_starts(
            problem,
            free if again else free[:first],
            first=first,
            rtol=max(rtol, float(jnp.finfo(problem.target.dtype).eps)),
            max_steps=SINGLE_STEPS if single else MAX_STEPS,
            at_once=1 if rich or start is not None else None,
        )
        if basis is not path[-1]:
            table = np.asarray(solution.free).reshape(len(skies.channels), size, -1)
            rows = (terms_of(basis, skies) @ table[:, : basis.num_terms])[None]
            first = 1
    return _read(problem, path[-1], solution, used, skies, groups)


def _read(problem, basis, solution, used, skies, groups) -> BatchFit:
    shape = len(skies.channels), groups.shape[0]
    numbers = np.asarray(_numbers(problem, as_float(solution.free)), float)
    count = np.count_nonzero(np.asarray(problem.weight), axis=(-2, -1))
    return BatchFit(
        problem=problem,
        basis=basis,
        solution=solution,
        numbers=numbers.reshape(*shape, *numbers.shape[1:]),
        rms=np.sqrt(2 * np.asarray(solution.loss, float) / count).reshape(shape),
        converged=np.asarray(solution.converged).reshape(shape),
        starts=used.reshape(shape),
    )


def _filled_size(num_terms: int, last: int) -> int:
    """Number of terms that a basis is filled up to, on the way to one with `last` terms."""
    return min([size for size in _SIZES if num_terms <= size < last], default=last)


def _problem(skies, wanted, groups, basis, centre, formula, settings, size, use) -> FitProblem:
    """Arrays of a batch; terms are filled up with zeros to `size`, which share a program."""
    padding = groups < 0
    num_channels, num_groups = len(skies.channels), len(groups)
    terms = terms_of(basis, skies)
    filled = np.pad(terms, ((0, 0), (0, size - basis.num_terms)))

    def lanes(array):
        return as_float(array.reshape(-1, *array.shape[2:]))

    def repeat(array):
        picked = array[groups]
        return lanes(np.broadcast_to(picked, (num_channels, *picked.shape)))

    def same(array):
        return as_float(np.broadcast_to(array, (num_channels * num_groups, *array.shape)))

    weight = np.where(padding[..., None], 0.0, wanted.weight[:, groups])
    least = LEAST_MISFIT if formula.dependence.linked else 0.0
    floor = (least**2 * (weight**2).sum((2, 3))).ravel()
    constant = np.pad(basis.constant(), (0, size - basis.num_terms))
    centres = constant[:, None] * centre[:, None, :]
    return FitProblem(
        distribution=formula.distribution,
        cos_view=repeat(np.cos(skies.view_zenith)),
        gamma=repeat(skies.gamma),
        sun_zenith=repeat(skies.sun_zenith),
        terms=repeat(filled),
        target=lanes(wanted.target[:, groups]),
        weight=lanes(weight),
        pull=same(_pull(formula, settings, basis, terms[use], size)),
        floor=as_float(floor),
        centre=as_float(np.repeat(centres, num_groups, axis=0)),
        linked=formula.dependence.linked,
        free_scale=wanted.free_scale,
    )


def _pull(formula, settings, basis, terms, size):
    """Square root of the prior: of free coordinates at ends, or of the free numbers of each sky."""
    if not formula.dependence.linked:
        return np.sqrt(settings.prior) * np.eye(size)
    prior, unit = np.sqrt(settings.prior), formula.distribution.unit
    rows = [prior * terms / np.sqrt(len(terms)), np.sqrt(SMOOTHNESS) * basis.bends()]
    table = np.concatenate(rows) / unit
    # The QR factor has as many rows as terms, however many skies and kinks there are.
    factor = np.linalg.qr(table, mode="r")
    filled = np.zeros((size, size))
    filled[: len(factor), : basis.num_terms] = factor
    return filled


def _starts(skies: Skies, formula: Formula, settings: FitSettings):
    """The prior's centre [channel, free], and starts [start, channel, free]."""
    distribution, given = formula.distribution, dict(settings.starts or {})
    unknown = set(given) - set(skies.channels)
    if unknown:
        raise InputError(
            f"fit_sky(starts=...): expected channels of {skies.channels}; got {sorted(unknown)}"
        )
    own = [distribution.starts(name) for name in skies.channels]
    rows = [
        [given.get(name, table[0]), *table] for name, table in zip(skies.channels, own, strict=True)
    ]
    for name, row in given.items():
        if len(row) != len(distribution.names):
            raise InputError(
                f"fit_sky(starts=...): {name} expected {len(distribution.names)} coefficients; "
                f"got {len(row)}"
            )
    release = _release_linked if formula.dependence.linked else _release
    free = np.asarray(release(distribution, as_float(np.array(rows, float))), float)
    for name, row, coordinates in zip(skies.channels, rows, free, strict=True):
        if not np.isfinite(coordinates[0]).all():
            raise InputError(
                f"fit_sky(starts=...): {name} starts out of bounds; got {list(row[0])}"
            )
    return free[:, 1], np.delete(free, 1, axis=1).swapaxes(0, 1)


def _numbers_of(terms, rows, use, basis, size):
    """Free coordinates [start, channel, term × coefficient] whose sums are given rows.

    Rows are those of every sky, or one for all [start, channel, sky or 1, coefficient].
    """
    if rows.shape[2] == 1:
        found = basis.constant()[:, None] * rows
    else:
        solution = np.linalg.pinv(terms, rcond=1e-12)
        found = solution @ rows[:, :, use]
    filled = np.pad(found, ((0, 0), (0, 0), (0, size - basis.num_terms), (0, 0)))
    return filled.reshape(*filled.shape[:2], -1)


@eqx.filter_jit
def _release(distribution, coefficients):
    return distribution.release(coefficients)


@eqx.filter_jit
def _release_linked(distribution, coefficients):
    return jnp.moveaxis(distribution.free_numbers(jnp.moveaxis(coefficients, -1, 0)), 0, -1)


@eqx.filter_jit
def _numbers(problem, free):
    return jax.vmap(lambda problem, free: problem.numbers(free))(problem, free)


@eqx.filter_jit
def evaluate(
    numbers: Float[Array, "lane term coefficient"], problem: FitProblem
) -> tuple[Float[Array, "lane sky direction"], Float[Array, "lane sky"]]:
    """Residuals and scales of a batch at given numbers."""
    return jax.vmap(residuals)(numbers, problem)
