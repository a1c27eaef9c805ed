"""How well a fit is determined: covariance, condition number, combinations that are not."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..models.distribution import AbstractDistribution
from .problem import FitProblem, by_free, linearise


# A free coordinate known no better than this has not been identified: it is a factor of e^±0.5 in
# a rate, or half the zenith's value in a slope.
LOOSE = 0.5
_MOST_NAMED = 8
# Eigenvalues of a scaled normal matrix below this share of the largest are rounding errors.
_ROUNDING = 1e-15


@dataclass(frozen=True)
class Diagnostics:
    """What a sceptic asks of one channel's fit.

    Attributes:
        rms: Root mean square of the weighted residuals within `max_view_zenith`.
        worst: Largest absolute residual of these.
        condition: Condition number of the Jacobian with respect to the numbers that were fitted,
            its columns scaled to unit length.
        unidentified: Combinations of coefficients that the skies leave open, in words.
        converged: Whether the solver met its tolerance.
        steps: Number of Levenberg-Marquardt steps.
    """

    rms: float
    worst: float
    condition: float
    unidentified: tuple[str, ...]
    converged: bool
    steps: int


class Examined(NamedTuple):
    """A fit at its solution: residuals, scales, and normal matrices without the prior's share.

    Attributes:
        residual: Weighted relative residuals [sky, direction].
        scale: Scale of each sky [sky].
        by_number: Normal matrix by the numbers of the formula [number, number].
        by_free: Normal matrix by the free coordinates [number, number].
    """

    residual: Any
    scale: Any
    by_number: Any
    by_free: Any


@eqx.filter_jit
def examine(free: Float[Array, " free"], problem: FitProblem) -> Examined:
    """Residuals and normal matrices of one fit at its solution."""
    made = linearise(problem.numbers(free), problem)
    matrix = made.gram
    if not problem.linked:
        matrix, _ = by_free(problem.distribution, problem.rows(free), made.gram, made.slope)
    square = (free.size, free.size)
    return Examined(made.residual, made.scale, made.gram.reshape(square), matrix.reshape(square))


def lane(problem: FitProblem, k: int, num_terms: int) -> FitProblem:
    """One fit of a batch, without the terms it was filled up with."""
    one = jax.tree.map(lambda array: jnp.asarray(array)[k], problem)
    parts = one.terms[:, :num_terms], one.pull[:, :num_terms], one.centre[:num_terms]
    return eqx.tree_at(lambda p: (p.terms, p.pull, p.centre), one, parts)


class Spectrum(NamedTuple):
    """A normal matrix scaled to a unit diagonal: eigenvalues, and eigenvectors unscaled.

    A number that the residuals do not see at all has eigenvectors of 0.
    """

    values: Float[np.ndarray, " number"]
    vectors: Float[np.ndarray, "number number"]

    @property
    def condition(self) -> float:
        """Condition number of the Jacobian, its columns scaled to unit length."""
        return float(np.sqrt(self.values[-1] / self.values[0]))

    def covariance(self) -> Float[np.ndarray, "number number"]:
        """Covariance of the numbers, for residuals of variance 1 that are independent."""
        return (self.vectors / self.values) @ self.vectors.T


def spectrum(matrix: Float[np.ndarray, "number number"]) -> Spectrum:
    """Decompose a normal matrix."""
    diagonal = np.diag(matrix)
    seen = diagonal > 0
    size = np.sqrt(np.where(seen, diagonal, 1.0))
    values, vectors = np.linalg.eigh(matrix / size / size[:, None] + np.diag(~seen).astype(float))
    vectors = vectors / size[:, None] * seen[:, None]
    return Spectrum(np.maximum(values, _ROUNDING * values[-1]), vectors)


def variance(residual: Float[np.ndarray, "..."], num_numbers: int) -> float:
    """Variance of residuals that have a weight.

    Misfit of a formula is not independent from direction to direction, so true uncertainties are
    larger than those that follow from it.
    """
    return float((residual**2).sum() / max(residual.size - num_numbers, 1))


def loose_combinations(
    found: Spectrum,
    noise: float,
    distribution: AbstractDistribution,
    places: tuple[str, ...],
) -> tuple[str, ...]:
    """Name the combinations whose standard deviation in free coordinates exceeds `LOOSE`.

    Args:
        found: Spectrum by the free coordinates, terms before coefficients.
        noise: Variance of the residuals.
        distribution: Says what each coordinate loosens.
        places: Where each term is, as in "turbidity 2"; empty if terms have no place.

    Returns:
        At most eight, the loosest first, each with its standard deviation.
    """
    length = np.linalg.norm(found.vectors, axis=0)
    error = np.sqrt(noise / found.values) * length
    named: dict[str, str] = {}
    for k in np.argsort(error)[::-1]:
        if error[k] <= LOOSE or len(named) == _MOST_NAMED:
            break
        table = (found.vectors[:, k] ** 2).reshape(-1, len(distribution.names)) / length[k] ** 2
        words = _words(table.sum(0), distribution)
        if places:
            words += f" at {places[int(table.max(1).argmax())]}"
        named.setdefault(words, f"{words} (±{error[k]:.2g})")
    return tuple(named.values())


def _words(share: Float[np.ndarray, " coefficient"], distribution: AbstractDistribution) -> str:
    """What is loose, by each coordinate's share."""
    first, *others = np.argsort(share)[::-1]
    words = distribution.loosened
    if words != distribution.names or not others or share[others[0]] <= 0.1:
        return words[first]
    return f"{words[first]} with {words[others[0]]}"
