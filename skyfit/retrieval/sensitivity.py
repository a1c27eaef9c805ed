"""How the coefficients of a fit change with the atmosphere: derivatives through simulation and fit.

A fit is the place where the gradient of its objective vanishes, so by the implicit function theorem
its derivative follows from those of that gradient, whatever the way there. It holds at the optimum
only: where skies hardly determine a coefficient, the distance at which a solver stops is amplified,
and Newton's method goes the rest of the way first.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Bool, Float

from .._typing import ArrayLike, as_float, as_parameter, as_scalar, check
from ..atmosphere import Atmosphere
from ..campaign import PAPER_SUN_ZENITHS_DEG, paper_directions
from ..colour import spectrum_to_xyY
from ..errors import InputError
from ..fitting.batch import fit_groups
from ..fitting.choices import PUBLISHED, FitSettings
from ..fitting.lanes import least_norm
from ..fitting.problem import FitProblem, objective
from ..fitting.skies import ZENITH, Skies, zenith_values
from ..models.formula import CHANNELS
from ..transfer.quality import Quality
from ..transfer.simulate_sky import simulate


_NEWTON_STEPS = 8


@dataclass(frozen=True)
class Sensitivity:
    """Perez's coefficients of one atmosphere, and how they change with it.

    Attributes:
        at: The quantities of the atmosphere, in the units of their maker.
        coefficients: A to E, by channel.
        derivatives: Derivatives of A to E (rows) by each quantity (columns, in the order of `at`),
            by channel; per unit of the quantity.
        converged: Whether the optimum was found, by channel. Elsewhere derivatives mean nothing.
    """

    at: dict[str, float]
    coefficients: dict[str, Float[np.ndarray, "coefficient"]]
    derivatives: dict[str, Float[np.ndarray, "coefficient quantity"]]
    converged: dict[str, bool]

    def relative(self) -> dict[str, Float[np.ndarray, "coefficient quantity"]]:
        """By channel, the derivatives times quantity over coefficient: d ln c / d ln q.

        By so many per cent does a coefficient grow with 1 % more of a quantity. A coefficient that
        is all but 0, such as Perez's E in the chromaticities, has large ones that matter little.
        """
        amounts = np.array(list(self.at.values()))
        return {
            channel: table * amounts / self.coefficients[channel][:, None]
            for channel, table in self.derivatives.items()
        }


class _Views(eqx.Module):
    """Suns, and the directions in which the sky is looked at under each."""

    sun_zenith: Float[Array, " sky"]
    view_zenith: Float[Array, " direction"]
    relative_azimuth: Float[Array, " direction"]


def coefficient_sensitivity(
    atmosphere: Callable[..., Atmosphere],
    at: Mapping[str, ArrayLike],
    *,
    sun_zenith: ArrayLike | None = None,
    view_zenith: ArrayLike | None = None,
    relative_azimuth: ArrayLike | None = None,
    orders: int | None = 2,
    quality: str | Quality = "default",
) -> Sensitivity:
    """Derivatives of Perez's coefficients with respect to anything that the air is made of.

    The skies of one atmosphere under some suns are simulated and turned into x, y and Y, each of
    which is fitted as `fit_sky` does: A to E shared by all suns, values over the zenith's, relative
    residuals, no direction beyond 85°. The derivatives go through all of it: tangents of the
    simulation, then the implicit function theorem at the optimum.

    Args:
        atmosphere: Called as `atmosphere(**at)`, with arrays for numbers; what it does with them
            it must do with `jax.numpy`.
        at: Names and values of the quantities to vary.
        sun_zenith: Suns that share the coefficients, in [0, π/2]; the paper's by default [rad].
        view_zenith: Zenith angle of every direction; the paper's by default [rad].
        relative_azimuth: Azimuth of every direction, as many as `view_zenith` [rad].
        orders: Orders of scattering, as for `simulate`.
        quality: Quality of the simulation, as for `simulate`.

    Raises:
        ValueError: No quantity is given, one of them is not a number, or an angle is impossible.
    """
    where = "coefficient_sensitivity(at=...)"
    if not at:
        raise InputError(f"{where}: expected one quantity or more; got none")
    point = {name: as_scalar(value, f"{where}: {name}") for name, value in at.items()}
    views = _views(sun_zenith, view_zenith, relative_azimuth)

    def sky(point):
        return _colours(atmosphere(**point), views, orders, quality)

    values, changes = None, []
    # One after another by one program: all at once it takes half as long again to compile.
    for chosen in point:
        along = {name: as_parameter(float(name == chosen)) for name in point}
        values, change = jax.jvp(sky, (point,), (along,))
        changes.append(change)
    problem, start = _fit(views, np.asarray(values, float))
    found = _at_optimum(problem, start, jnp.stack(changes))
    coefficients, slopes, converged = (np.asarray(field) for field in found)
    return Sensitivity(
        at={name: float(value) for name, value in point.items()},
        coefficients=_by_channel(coefficients.astype(float)),
        derivatives=_by_channel(np.moveaxis(slopes.astype(float), 0, -1)),
        converged=_by_channel(converged.tolist()),
    )


def _views(sun_zenith, view_zenith, relative_azimuth) -> _Views:
    """The angles asked for, or the paper's."""
    where = "coefficient_sensitivity"
    if (view_zenith is None) != (relative_azimuth is None):
        raise InputError(
            f"{where}: view_zenith and relative_azimuth describe the directions together; "
            "got only one of them"
        )
    if sun_zenith is None:
        sun_zenith = np.radians(PAPER_SUN_ZENITHS_DEG)
    if view_zenith is None:
        view_zenith, relative_azimuth = paper_directions()
    sun, view, azimuth = map(
        jnp.atleast_1d, map(as_float, (sun_zenith, view_zenith, relative_azimuth))
    )
    if view.ndim != 1 or sun.ndim != 1 or view.shape != azimuth.shape:
        raise InputError(
            f"{where}: expected one axis of suns, and as many view_zenith as relative_azimuth; "
            f"got shapes {sun.shape}, {view.shape} and {azimuth.shape}"
        )
    low = f"{where}(sun_zenith=...) must lie in [0, pi/2] rad, the sun above the horizon"
    sun = check(sun, lambda v: ~((v >= 0) & (v <= np.pi / 2 + 1e-6)), low)
    return _Views(sun, view, azimuth)


def _colours(
    air: Atmosphere, views: _Views, orders: int | None, quality: str | Quality
) -> Float[Array, "channel sky direction"]:
    """x, y and Y of simulated skies; over the zenith's, where a direction is the zenith."""
    sky = simulate(
        air,
        views.sun_zenith[:, None],
        views.view_zenith[None, :],
        views.relative_azimuth[None, :],
        orders=orders,
        quality=quality,
    )
    values = jnp.moveaxis(spectrum_to_xyY(sky.radiance, air.wavelengths), -1, 0)
    overhead = np.flatnonzero(np.asarray(views.view_zenith) <= ZENITH)
    return values / values[..., overhead].mean(-1, keepdims=True) if overhead.size else values


def _fit(views: _Views, values: Float[np.ndarray, "channel sky direction"]):
    """The problem of all channels, one lane each, and free coordinates close to its optimum."""
    if not (values > 0).all():
        raise InputError(
            "coefficient_sensitivity: expected light from every direction; "
            f"{np.count_nonzero(~(values[-1] > 0))} of {values[-1].size} are dark"
        )
    sun, view, azimuth = (np.asarray(a, float) for a in jax.tree.leaves(views))
    grid = (sun.size, view.size)
    view, azimuth = np.broadcast_to(view, grid), np.broadcast_to(azimuth, grid)
    skies = Skies(
        swept={},
        sun_zenith=sun,
        view_zenith=view,
        relative_azimuth=azimuth,
        values=values,
        zenith=zenith_values(view, values),
        shape=sun.shape,
    )
    fit = fit_groups(skies, PUBLISHED, FitSettings())
    return fit.problem, as_float(np.asarray(fit.solution.free))


@eqx.filter_jit
def _at_optimum(
    problem: FitProblem,
    start: Float[Array, "channel free"],
    changes: Float[Array, "quantity channel sky direction"],
) -> tuple[
    Float[Array, "channel coefficient"],
    Float[Array, "quantity channel coefficient"],
    Bool[Array, " channel"],
]:
    """Coefficients where the gradient vanishes, and their slopes along changes of the target."""
    tolerance = 1e5 * float(jnp.finfo(start.dtype).eps)
    newton = optx.Newton(rtol=tolerance, atol=tolerance)
    adjoint = optx.ImplicitAdjoint(linear_solver=least_norm())

    def one(problem, start):
        found = optx.root_find(
            _gradient, newton, start, problem, max_steps=_NEWTON_STEPS, adjoint=adjoint, throw=False
        )
        return problem.numbers(found.value)[0], found.result == optx.RESULTS.successful

    def coefficients(target):
        return jax.vmap(one)(eqx.tree_at(lambda p: p.target, problem, target), start)

    nodes, slopes, converged = jax.vmap(
        lambda change: jax.jvp(coefficients, (problem.target,), (change,), has_aux=True),
        out_axes=(None, 0, None),
    )(changes)
    return nodes, slopes, converged


def _gradient(free: Float[Array, " free"], problem: FitProblem) -> Float[Array, " free"]:
    return jax.grad(lambda free: 0.5 * jnp.sum(objective(free, problem) ** 2))(free)


def _by_channel(table) -> dict[str, Any]:
    return {name: row for name, row in zip(CHANNELS, table, strict=True)}
