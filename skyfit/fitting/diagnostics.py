"""How well a fit is determined: covariance, condition number, combinations that are not."""

from dataclasses import dataclass
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import as_float
from .dependence import AbstractDependence
from .distribution import AbstractDistribution
from .shape import ShapeProblem, shape_residuals


# A free coordinate known no better than this has not been identified: it is a factor of e^±0.5 in
# a rate, or half the zenith's value in a slope.
LOOSE = 0.5


@dataclass(frozen=True)
class Diagnostics:
    """What a sceptic asks of one channel's fit.

    Attributes:
        rms: Root mean square of the weighted relative residuals.
        worst: Largest absolute residual that has a weight.
        condition: Of the Jacobian with respect to the coefficients at the nodes, its columns
            scaled to unit length.
        unidentified: Combinations of coefficients that the skies leave open, in words.
        converged: Whether the solver met its tolerance.
        steps: Levenberg-Marquardt steps.
    """

    rms: float
    worst: float
    condition: float
    unidentified: tuple[str, ...]
    converged: bool
    steps: int


def covariance(
    jacobian: Float[np.ndarray, "residual parameter"], residual: Float[np.ndarray, " residual"]
) -> Float[np.ndarray, "parameter parameter"]:
    """Covariance of least-squares parameters, as if residuals were independent.

    A direction that the residuals do not see at all is left out (0). Misfit of a formula is not
    independent from direction to direction, so true uncertainties are larger.
    """
    length = np.linalg.norm(jacobian, axis=0)
    length = np.where(length > 0, length, 1.0)
    _, singular, rows = np.linalg.svd(jacobian / length, full_matrices=False)
    seen = singular > 1e-14 * singular[0]
    inverse = rows[seen].T / singular[seen] / length[:, None]
    used = np.count_nonzero(residual) or 1
    variance = residual @ residual / max(used - jacobian.shape[1], 1)
    return variance * inverse @ inverse.T


class Jacobians(NamedTuple):
    """Of the residuals: with respect to the coefficients at the nodes, to the free coordinates."""

    nodes: Float[Array, "lane residual parameter"]
    free: Float[Array, "lane residual parameter"]
    residual: Float[Array, "lane residual"]


@eqx.filter_jit
def jacobians(free: Float[Array, "lane parameter"], problem: ShapeProblem) -> Jacobians:
    """Both Jacobians of a batch of fits at their solutions."""

    def one(free, problem):
        coordinates = problem.per_node(free)
        nodes = problem.distribution.constrain(coordinates)

        def residual(nodes):
            value = shape_residuals(nodes, problem)[0].ravel()
            return value, value

        by_node, residual_there = jax.jacfwd(residual, has_aux=True)(nodes)
        stretch = jax.vmap(jax.jacfwd(problem.distribution.constrain))(coordinates)
        by_free = jnp.einsum("rnc,ncf->rnf", by_node, stretch)
        flat = (residual_there.size, free.size)
        return Jacobians(by_node.reshape(flat), by_free.reshape(flat), residual_there)

    return jax.vmap(one)(free, problem)


def condition_number(jacobian: Float[np.ndarray, "residual parameter"]) -> float:
    """Condition number with columns scaled to unit length."""
    length = np.linalg.norm(jacobian, axis=0)
    return float(np.linalg.cond(jacobian / np.where(length > 0, length, 1.0)))


def loose_combinations(
    spread: Float[np.ndarray, "free free"],
    distribution: AbstractDistribution,
    node_names: tuple[str, ...],
) -> tuple[str, ...]:
    """Name the combinations whose standard deviation in free coordinates exceeds `LOOSE`.

    Args:
        spread: Covariance of the free coordinates of all nodes.
        distribution: Says what each coordinate loosens.
        node_names: Where each node is, as in "turbidity 2"; one empty name if there is one node.
    """
    variance, vectors = np.linalg.eigh(spread)
    found = []
    for value, vector in zip(variance[::-1], vectors.T[::-1], strict=True):
        if value <= LOOSE**2:
            break
        strongest = np.abs(vector).reshape(len(node_names), -1)
        node, coordinate = np.unravel_index(strongest.argmax(), strongest.shape)
        place = f" at {node_names[node]}" if node_names[node] else ""
        found.append(f"{distribution.loosened[coordinate]}{place} (±{np.sqrt(value):.2g})")
    return tuple(found)


def line_with_errors(
    nodes: Float[np.ndarray, "node coefficient"],
    spread: Float[np.ndarray, "parameter parameter"],
    dependence: AbstractDependence,
) -> tuple[Float[np.ndarray, "coefficient 2"], Float[np.ndarray, "coefficient 2"]]:
    """Slopes and intercepts, and their standard errors from the covariance at the nodes."""
    unit = np.eye(nodes.size).reshape(-1, *nodes.shape)
    lines = np.asarray(_lines(dependence, as_float(unit)), float)
    line = np.einsum("p,pci->ci", nodes.ravel(), lines)
    return line, np.sqrt(np.einsum("pci,pq,qci->ci", lines, spread, lines))


@eqx.filter_jit
def _lines(dependence, nodes):
    return jax.vmap(dependence.line)(nodes)
