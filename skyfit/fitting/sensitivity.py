"""How the coefficients of a fit change with the atmosphere: derivatives through simulation and fit.

A fit is the place where the gradient of its objective vanishes, so by the implicit function theorem
its derivative needs the derivatives of that gradient alone, not those of the way there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .. import constants
from .._typing import ArrayLike, as_float, as_parameter
from ..angles import view_sun_angle
from ..atmosphere import Atmosphere, Constituent
from ..campaign import half_dome
from ..colour import spectrum_to_xyY
from ..models.perez import CHANNELS
from ..phase import HenyeyGreenstein
from ..preetham_air import preetham_atmosphere
from ..profile import Exponential
from ..transfer.simulate_sky import simulate
from .distribution import PerezDistribution
from .groups import MAX_VIEW_ZENITH, PRIOR
from .shape import ShapeProblem, solve_shapes
from .starts import solve_from_starts


# What is varied, where, and its unit.
QUANTITIES: Mapping[str, tuple[float, str]] = {
    "haze_amount": (1.0, "1"),  # times the haze of the turbidity
    "haze_scale_height": (1200.0, "m"),  # at the same optical thickness
    "asymmetry": (0.7, "1"),
    "ozone": (3.5, "mm"),
    "ground_albedo": (0.15, "1"),
}
_SUNS_DEG = (10.0, 40.0, 65.0)
_RINGS_DEG, _AZIMUTHS_DEG = (20.0, 40.0, 60.0, 75.0, 85.0), (0.0, 20.0, 50.0, 90.0, 135.0, 180.0)
_WAVELENGTHS = (400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0)


@dataclass(frozen=True)
class Sensitivity:
    """Perez's coefficients of one atmosphere, and their derivatives.

    Attributes:
        at: The quantities, in the units of `QUANTITIES`.
        coefficients: A to E of each channel.
        derivatives: Of A to E (rows) with respect to each quantity (columns, in the order of
            `at`), by channel, per unit of the quantity.
    """

    at: dict[str, float]
    coefficients: dict[str, Float[np.ndarray, "coefficient"]]
    derivatives: dict[str, Float[np.ndarray, "coefficient quantity"]]

    def relative(self) -> dict[str, Float[np.ndarray, "coefficient quantity"]]:
        """Change of each coefficient for a change of a quantity by its own amount."""
        amounts = np.array(list(self.at.values()))
        return {name: table * amounts for name, table in self.derivatives.items()}


class _Views(eqx.Module):
    """The skies that are simulated and fitted."""

    sun_zenith: Float[Array, " sky"]
    view_zenith: Float[Array, " direction"]
    relative_azimuth: Float[Array, " direction"]


def coefficient_sensitivity(
    turbidity: ArrayLike = 3.0,
    *,
    at: Mapping[str, float] | None = None,
    sun_zenith: Sequence[float] | None = None,
    wavelengths: Sequence[float] = _WAVELENGTHS,
    orders: int = 2,
    quality: str = "draft",
) -> Sensitivity:
    """Derivatives of Perez's coefficients with respect to haze, ozone and ground.

    A small campaign under a few suns is simulated, turned into colour and fitted, five
    coefficients a channel, all in one differentiable function. The haze of the turbidity has
    its own spectrum, an exponential profile and Henyey and Greenstein's phase function.

    Args:
        turbidity: T of the atmosphere.
        at: Quantities to take elsewhere than in `QUANTITIES`.
        sun_zenith: Suns that share the coefficients [rad]; 10°, 40° and 65° by default.
        wavelengths: Of the simulation [nm].
        orders: Of scattering.
        quality: Of the simulation.

    Raises:
        ValueError: An unknown quantity.
    """
    values = {name: value for name, (value, _) in QUANTITIES.items()} | dict(at or {})
    if unknown := set(values) - set(QUANTITIES):
        raise ValueError(
            f"coefficient_sensitivity(at=...): expected quantities of {tuple(QUANTITIES)}; "
            f"got {sorted(unknown)}"
        )
    view, azimuth = half_dome(
        np.radians([20.0, 40.0, 60.0, 75.0, 85.0]),
        np.radians([0.0, 20.0, 50.0, 90.0, 135.0, 180.0]),
    )
    suns = np.radians(_SUNS_DEG) if sun_zenith is None else sun_zenith
    views = _Views(as_float(suns), as_float(view), as_float(azimuth))
    point = as_parameter(list(values.values()))

    def problem(point):
        air = varied_atmosphere(point, turbidity, wavelengths)
        return shape_problem_of(air, views, orders, quality)

    first = problem(point)
    start = solve_start(first)
    coefficients = fitted_coefficients(first, start)
    # Not compiled as a whole: what is known here would be folded into constants for minutes.
    changes = jax.jacfwd(lambda p: fitted_coefficients(problem(p), start))(point)
    return Sensitivity(
        at=values,
        coefficients=dict(zip(CHANNELS, np.asarray(coefficients, float), strict=True)),
        derivatives=dict(zip(CHANNELS, np.asarray(changes, float), strict=True)),
    )


def varied_atmosphere(
    point: Float[Array, " quantity"], turbidity: ArrayLike, wavelengths: Sequence[float]
) -> Atmosphere:
    """The atmosphere of a turbidity with quantities in the order of `QUANTITIES`."""
    amount, scale_height, asymmetry, ozone, albedo = point
    base = preetham_atmosphere(turbidity, wavelengths=wavelengths, ozone=True)
    air, haze, layer = base.constituents
    profile = Exponential(scale_height)
    top = constants.TOP_OF_ATMOSPHERE
    same_depth = haze.density.column(top) / profile.column(top)
    return Atmosphere(
        base.wavelengths,
        base.solar_irradiance,
        (
            air,
            Constituent(
                profile,
                amount * same_depth * haze.scattering,
                amount * same_depth * haze.absorption,
                phase=HenyeyGreenstein(asymmetry),
            ),
            Constituent(layer.density, 0.0, layer.absorption * ozone / 3.5, phase=layer.phase),
        ),
        albedo,
    )


def shape_problem_of(air: Atmosphere, views: _Views, orders: int, quality: str) -> ShapeProblem:
    """What the fit is given: simulated values over the zenith's, channel by channel."""
    sun, view = views.sun_zenith[:, None], views.view_zenith[None, :]
    azimuth = views.relative_azimuth[None, :]
    sky = simulate(air, sun, view, azimuth, orders=orders, quality=quality)
    colour = jnp.moveaxis(spectrum_to_xyY(sky.radiance, air.wavelengths), -1, 0)
    target = colour / colour[..., :1]  # the first direction is the zenith
    lanes, distribution = len(CHANNELS), PerezDistribution()
    centre = jnp.stack(
        [distribution.release(as_float(distribution.starts(name)[0])) for name in CHANNELS]
    )

    def repeat(array):
        return jnp.broadcast_to(array, (lanes, *array.shape))

    inside = views.view_zenith <= MAX_VIEW_ZENITH + 1e-6
    return ShapeProblem(
        distribution=distribution,
        cos_view=repeat(jnp.broadcast_to(jnp.cos(view), target.shape[1:])),
        gamma=repeat(view_sun_angle(view, sun, azimuth)),
        sun_zenith=repeat(views.sun_zenith),
        basis=jnp.ones((lanes, views.sun_zenith.size, 1), target.dtype),
        target=target,
        weight=jnp.broadcast_to(inside.astype(target.dtype), target.shape),
        prior=jnp.full(lanes, PRIOR, target.dtype),
        centre=centre.astype(target.dtype),
        free_zenith=False,
    )


def solve_start(problem: ShapeProblem) -> Float[Array, "channel coefficient"]:
    """Free coordinates of the best fit from all of the distribution's starts."""
    distribution = problem.distribution
    table = as_float(np.stack([distribution.starts(name) for name in CHANNELS], axis=1))
    free = np.asarray(distribution.release(table), float)
    solution, _ = solve_from_starts(problem, free, first=len(free), rtol=1e-13, max_steps=128)
    return as_float(solution.free)


def fitted_coefficients(
    problem: ShapeProblem, start: Float[Array, "channel coefficient"]
) -> Float[Array, "channel coefficient"]:
    """A to E of each channel, differentiable by the implicit function theorem."""
    solution = solve_shapes(problem, jax.lax.stop_gradient(start), rtol=1e-13, max_steps=64)
    return problem.distribution.constrain(jnp.asarray(solution.free))
