"""What one fit is given, its residuals, and their normal equations.

The coefficients of a sky are sums of numbers times the sky's terms, so the normal equations of all
numbers are sums over skies of those of one sky's few coefficients, multiplied by its terms. Only
the small ones need derivatives: a thousand numbers cost hardly more than the five of a sky.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..models.distribution import AbstractDistribution


class FitProblem(eqx.Module):
    """One channel of skies whose coefficients share numbers.

    What is solved for are free coordinates, a row for every term. Where the formula is linked they
    are its numbers, and the links of each sky's sums its coefficients. Elsewhere coefficients are
    what is summed, and `distribution.constrain` makes them, row by row, of the free coordinates.

    Attributes:
        distribution: Formula of the dome.
        cos_view: Cosine of the view zenith angle.
        gamma: Angle between view and sun [rad].
        sun_zenith: Zenith angle of the sun [rad].
        terms: Terms of the basis for each sky.
        target: Values over the scale, or values whose scale is free; above 0.
        weight: Weight of each relative residual; 0 leaves it out.
        pull: Square root of the prior: its rows times the free coordinates' distance from
            `centre`, squared and summed, are the share by which the loss grows.
        floor: Twice the loss that the prior takes the skies to have in addition; 0 where perfect
            data are to be fitted perfectly.
        centre: Free coordinates towards which the prior draws.
        linked: Whether links make the coefficients.
        free_scale: Whether each sky has a scale of its own, the one that fits best.
    """

    distribution: AbstractDistribution
    cos_view: Float[Array, "*lane sky direction"]
    gamma: Float[Array, "*lane sky direction"]
    sun_zenith: Float[Array, "*lane sky"]
    terms: Float[Array, "*lane sky term"]
    target: Float[Array, "*lane sky direction"]
    weight: Float[Array, "*lane sky direction"]
    pull: Float[Array, "*lane row term"]
    floor: Float[Array, "*lane"]
    centre: Float[Array, "*lane term coefficient"]
    linked: bool = eqx.field(static=True)
    free_scale: bool = eqx.field(static=True)

    def rows(self, free: Float[Array, " free"]) -> Float[Array, "term coefficient"]:
        """Free coordinates, a row for every term."""
        return free.reshape(self.terms.shape[-1], -1)

    def numbers(self, free: Float[Array, " free"]) -> Float[Array, "term coefficient"]:
        """Numbers of the formula in the terms that are fitted."""
        rows = self.rows(free)
        return rows if self.linked else self.distribution.constrain(rows)


class Linearised(NamedTuple):
    """Residuals of a fit and their derivatives by the numbers of the formula.

    Attributes:
        residual: Weighted relative residuals.
        scale: Scale of each sky.
        gram: JᵀJ by numbers, terms before coefficients.
        slope: Jᵀr by numbers.
    """

    residual: Float[Array, "sky direction"]
    scale: Float[Array, " sky"]
    gram: Float[Array, "term coefficient term coefficient"]
    slope: Float[Array, "term coefficient"]


def _sky_residual(mixed, sky: FitProblem):
    """Weighted relative residuals of one sky, model / data - 1, and its scale."""
    distribution = sky.distribution
    coefficients = distribution.coefficients(mixed) if sky.linked else mixed
    views = sky.cos_view, sky.gamma, jnp.cos(sky.gamma)
    value = distribution.value(coefficients[:, None], *views)
    if distribution.relative:
        sun = sky.sun_zenith
        value = value / distribution.value(coefficients, jnp.ones_like(sun), sun, jnp.cos(sun))
    ratio = value / sky.target
    scale = jnp.ones_like(sky.sun_zenith)
    if sky.free_scale:
        square = sky.weight**2
        total = (square * ratio**2).sum()
        # Skies that are left out have no weight at all.
        scale = (square * ratio).sum() / jnp.where(total > 0, total, 1.0)
    return sky.weight * (scale * ratio - 1), scale


# What differs from sky to sky in a problem.
_BY_SKY = ("cos_view", "gamma", "sun_zenith", "target", "weight")


def _each_sky(function, mixed, problem: FitProblem):
    """A function of one sky's sums and its part of the problem, for all skies."""

    def one(row, *parts):
        sky = eqx.tree_at(lambda p: [getattr(p, name) for name in _BY_SKY], problem, list(parts))
        return function(row, sky)

    return jax.vmap(one)(mixed, *(getattr(problem, name) for name in _BY_SKY))


def residuals(
    numbers: Float[Array, "term coefficient"], problem: FitProblem
) -> tuple[Float[Array, "sky direction"], Float[Array, " sky"]]:
    """Weighted relative residuals of all skies, model / data - 1, and the scale of each."""
    return _each_sky(_sky_residual, _product(problem.terms, numbers), problem)


def linearise(numbers: Float[Array, "term coefficient"], problem: FitProblem) -> Linearised:
    """Residuals and normal equations by the numbers of the formula."""

    def equations(row, sky):
        def residual(row):
            value, scale = _sky_residual(row, sky)
            return value, (value, scale)

        jacobian, (value, scale) = jax.jacfwd(residual, has_aux=True)(row)
        return value, scale, _product(jacobian.T, jacobian), _product(value, jacobian)

    terms = problem.terms
    value, scale, gram, slope = _each_sky(equations, _product(terms, numbers), problem)
    pairs = terms[:, :, None] * terms[:, None, :]
    total = jnp.einsum("sij,skl->ikjl", pairs, gram, precision="highest")
    return Linearised(value, scale, total, _product(terms.T, slope))


def objective(free: Float[Array, " free"], problem: FitProblem) -> Float[Array, " residual"]:
    """Residuals of the fit and of the prior: half their sum of squares is minimised.

    The prior multiplies the loss L of the skies, L + (L + L₀) |P (u - c)|², P being `pull` and L₀
    half of `floor`: it decides where the skies do not, and where L₀ is 0 it vanishes where a fit is
    perfect.
    """
    residual, _ = residuals(problem.numbers(free), problem)
    tiny = jnp.finfo(residual.dtype).tiny
    misfit = jnp.sqrt(jnp.sum(residual**2) + problem.floor + tiny)
    away = _product(problem.pull, problem.rows(free) - problem.centre)
    return jnp.concatenate([residual.ravel(), misfit * away.ravel()])


def normal_equations(
    free: Float[Array, " free"], problem: FitProblem
) -> tuple[Float[Array, ""], Float[Array, "free free"], Float[Array, " free"]]:
    """Half the sum of squares of `objective`, its JᵀJ and its Jᵀr, in closed form."""
    rows = problem.rows(free)
    made = linearise(problem.numbers(free), problem)
    gram, slope = made.gram, made.slope
    if not problem.linked:
        gram, slope = by_free(problem.distribution, rows, gram, slope)
    size = free.size
    gram, slope = gram.reshape(size, size), slope.ravel()
    loss = jnp.sum(made.residual**2)
    total = loss + problem.floor + jnp.finfo(free.dtype).tiny
    away = rows - problem.centre
    force = _product(problem.pull.T, _product(problem.pull, away)).ravel()
    growth = force @ away.ravel()
    penalty = _product(problem.pull.T, problem.pull)
    count = rows.shape[1]
    spread = penalty[:, None, :, None] * jnp.eye(count, dtype=free.dtype)[None, :, None, :]
    # The prior's residual is m P (u - c), m² = |r|² + floor: m has the tangent rᵀJ / m.
    cross = force[:, None] * slope[None, :]
    gram = gram + total * spread.reshape(size, size) + cross + cross.T
    gram = gram + growth / total * slope[:, None] * slope[None, :]
    return 0.5 * (loss + total * growth), gram, slope * (1 + growth) + total * force


def by_free(
    distribution: AbstractDistribution,
    rows: Float[Array, "term coefficient"],
    gram: Float[Array, "term coefficient term coefficient"],
    slope: Float[Array, "term coefficient"],
) -> tuple[Float[Array, "term coefficient term coefficient"], Float[Array, "term coefficient"]]:
    """Normal equations by free coordinates from those by coefficients."""
    stretch = jax.vmap(jax.jacfwd(distribution.constrain))(rows)
    gram = jnp.einsum("ika,ikjl,jlb->iajb", stretch, gram, stretch, precision="highest")
    return gram, jnp.einsum("ika,ik->ia", stretch, slope, precision="highest")


def _product(first, second):
    return jnp.matmul(first, second, precision="highest")
