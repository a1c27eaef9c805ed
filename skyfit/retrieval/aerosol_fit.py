"""Fit an aerosol, and the ground's brightness, to measured skies, by gradients of the simulator.

Radiances of many directions determine well how much haze there is, how that falls with wavelength
and how far forward it scatters; less well how much it absorbs and how bright the ground is.
"""

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .._typing import ArrayLike, as_float
from ..atmosphere import Atmosphere
from ..campaign import Campaign, DescribedAtmosphere
from ..campaign.description.sweep import number_at, replaced
from ..errors import InputError
from ..fitting.solver import NormalEquationsLM
from ..transfer.quality import Quality
from ..transfer.simulate_sky import simulate


if TYPE_CHECKING:
    import xarray as xr

# Numbers of the fit, in the order of its free coordinates.
NUMBERS = (
    "angstrom_exponent",
    "angstrom_beta",
    "asymmetry",
    "single_scattering_albedo",
    "ground_scale",
)
BETA_WAVELENGTH = 1000.0  # nm, where the optical depth is Ångström's β
PIVOT = 550.0  # nm: the optical depth there hardly depends on the exponent


class _Case(eqx.Module):
    """What does not change in a fit: an atmosphere with another aerosol, and the skies."""

    atmosphere: Atmosphere
    column: Float[Array, ""]
    sun: Float[Array, " sky"]
    view: Float[Array, "sky direction"]
    azimuth: Float[Array, "sky direction"]
    measured: Float[Array, "sky direction wavelength"]
    seen: Bool[Array, "sky direction wavelength"]
    place: int = eqx.field(static=True)
    orders: int | None = eqx.field(static=True)
    quality: str | Quality = eqx.field(static=True)


@dataclass(frozen=True)
class AerosolFit:
    """An aerosol fitted to skies.

    Attributes:
        values: Value of every number: Ångström's exponent and β (optical depth at 1 µm), asymmetry,
            single-scattering albedo, and by how much the ground's albedo is multiplied.
        standard_errors: Standard errors as if the residuals were independent; 0 where a number
            does nothing.
        rmse: Root mean square error over skies, directions and wavelengths [W m⁻² sr⁻¹ nm⁻¹].
        steps: Number of the solver's steps.
        converged: The solver's word.
    """

    values: dict[str, float]
    standard_errors: dict[str, float]
    rmse: float
    steps: int
    converged: bool

    def campaign(self, campaign: Campaign, aerosol: str) -> Campaign:
        """The campaign with the fitted numbers in place of its own."""
        described = _described(campaign)
        description = described.description
        for key, name in _keys(aerosol).items():
            description = replaced(description, key, self.values[name])
        return dataclasses.replace(
            campaign, atmosphere=DescribedAtmosphere.from_description(description)
        )


def fit_aerosol(
    skies: "xr.Dataset",
    campaign: Campaign,
    aerosol: str,
    *,
    wavelengths: ArrayLike,
    orders: int | None = 3,
    quality: str | Quality = "draft",
    max_steps: int = 24,
) -> AerosolFit:
    """Fit an aerosol of a campaign to skies by Levenberg-Marquardt through the simulator.

    Five numbers are fitted to the radiance of all skies, directions and wavelengths with equal
    weight: the aerosol's Ångström exponent, optical depth, asymmetry and single-scattering albedo,
    and a factor of the ground's albedo. The campaign's are the start.

    Args:
        skies: Skies in the form of `skyfit.dataset`, with `radiance` over time (or suns),
            direction and wavelength; NaN is left out.
        campaign: Campaign of a file, nothing swept; its suns and directions do not matter.
        aerosol: Name of its constituent of kind "angstrom_aerosol", given by `angstrom_beta`.
        wavelengths: Wavelengths at which the skies are compared, within theirs [nm].
        orders: Orders of scattering, as for `simulate`.
        quality: Quality of the simulation, as for `simulate`.
        max_steps: Largest number of the solver's steps.

    Raises:
        InputError: The campaign has no such aerosol; the skies have no spectral radiance.
    """
    described = _described(campaign)
    description = described.description
    start = {name: number_at(description, key) for key, name in _keys(aerosol).items()}
    for name in ("radiance", "sun_zenith", "view_zenith", "relative_azimuth"):
        if name not in skies.variables:
            raise InputError(f"fit_aerosol(skies=...): expected a variable {name!r}")
    lam = np.atleast_1d(np.asarray(wavelengths, float))
    light = skies["radiance"].interp(wavelength=lam).transpose(..., "direction", "wavelength")
    known = skies["wavelength"].values
    if lam.min() < known.min() or lam.max() > known.max() or np.isinf(light.values).any():
        raise InputError("fit_aerosol(wavelengths=...): expected them within those of the skies")
    one = light.isel(wavelength=0, drop=True)
    shape = (-1, light.sizes["direction"])
    view, azimuth = (
        skies[name].broadcast_like(one).values.reshape(shape)
        for name in ("view_zenith", "relative_azimuth")
    )
    measured = light.values.reshape(*shape, lam.size)
    seen = ~(np.isnan(measured) | np.isnan(view + azimuth)[..., None])
    if not seen.any():
        raise InputError("fit_aerosol(skies=...): expected radiance somewhere; all of it is NaN")
    atmosphere = dataclasses.replace(campaign, wavelengths=lam).build_atmosphere()
    parts = description["constituents"]
    place = [part["name"] for part in parts].index(aerosol)
    if parts[place]["kind"] != "angstrom_aerosol" or np.ndim(parts[place]["asymmetry"]):
        raise InputError(f"fit_aerosol: expected {aerosol} to be an angstrom_aerosol")
    case = _Case(
        atmosphere=atmosphere,
        column=atmosphere.vertical_column()[place],
        sun=as_float(skies["sun_zenith"].broadcast_like(one.isel(direction=0)).values.ravel()),
        view=as_float(np.nan_to_num(view)),
        azimuth=as_float(np.nan_to_num(azimuth)),
        measured=as_float(np.where(seen, measured, 0.0)),
        seen=jnp.asarray(seen),
        place=place,
        orders=orders,
        quality=quality,
    )
    free = _free(start)
    found = _solve(free, case, max_steps)
    count = int(seen.sum())
    variance = 2 * float(found.loss) / max(count - len(NUMBERS), 1)
    numbers, change = _values(found.free), np.asarray(jax.jacfwd(_value_row)(found.free), float)
    spread = change @ np.linalg.pinv(np.asarray(found.gram, float)) @ change.T
    scale = float(_scale(case))
    return AerosolFit(
        values=numbers,
        standard_errors=dict(
            zip(NUMBERS, np.sqrt(variance * np.diag(spread)).tolist(), strict=True)
        ),
        rmse=scale * float(np.sqrt(2 * found.loss / count)),
        steps=found.steps,
        converged=found.converged,
    )


def _described(campaign: Campaign) -> DescribedAtmosphere:
    if not isinstance(campaign.atmosphere, DescribedAtmosphere) or campaign.sweep:
        raise InputError(
            "fit_aerosol(campaign=...): expected one of a file that lists constituents and sweeps "
            "nothing"
        )
    return campaign.atmosphere


def _keys(aerosol: str) -> dict[str, str]:
    """Key of the description for each number."""
    prefix = f"constituents.{aerosol}."
    keys = {prefix + name: name for name in NUMBERS[:-1]}
    return keys | {"ground.scale": NUMBERS[-1]}


def _free(start: dict[str, float]) -> Float[Array, " number"]:
    """Free coordinates: nothing a step can reach is impossible."""
    albedo = np.clip(start["single_scattering_albedo"], 0.01, 0.99)
    depth = start["angstrom_beta"] * (BETA_WAVELENGTH / PIVOT) ** start["angstrom_exponent"]
    return as_float(
        np.array(
            [
                start["angstrom_exponent"],
                np.log(max(depth, 1e-4)),
                np.arctanh(start["asymmetry"]),
                np.log(albedo / (1 - albedo)),
                np.log(max(start["ground_scale"], 1e-3)),
            ]
        )
    )


def _numbers(free: Float[Array, " number"]) -> Float[Array, " number"]:
    """The numbers of free coordinates; the second is the optical depth at 550 nm."""
    exponent, depth, asymmetry, albedo, ground = free
    return jnp.stack(
        [exponent, jnp.exp(depth), jnp.tanh(asymmetry), jax.nn.sigmoid(albedo), jnp.exp(ground)]
    )


def _value_row(free: Float[Array, " number"]) -> Float[Array, " number"]:
    """The numbers as they are reported, with β for the optical depth at 550 nm."""
    numbers = _numbers(free)
    return numbers.at[1].multiply((PIVOT / BETA_WAVELENGTH) ** numbers[0])


def _values(free: Float[Array, " number"]) -> dict[str, float]:
    return dict(zip(list(NUMBERS), np.asarray(_value_row(free), float).tolist(), strict=True))


def _atmosphere(free: Float[Array, " number"], case: _Case) -> Atmosphere:
    """The atmosphere with the aerosol and ground of free coordinates."""
    exponent, depth, asymmetry, albedo, ground = _numbers(free)
    base = case.atmosphere
    extinction = depth / case.column * (PIVOT / base.wavelengths) ** exponent
    lobe: Any = base.constituents[case.place].phase
    bright = jnp.minimum(ground * base.ground_albedo, 1.0)
    return eqx.tree_at(
        lambda a: (
            a.constituents[case.place].scattering,
            a.constituents[case.place].absorption,
            a.constituents[case.place].phase.g,
            a.ground_albedo,
        ),
        base,
        (
            albedo * extinction,
            (1 - albedo) * extinction,
            jnp.broadcast_to(asymmetry, lobe.g.shape),
            bright,
        ),
    )


def _residuals(free, case: _Case):
    """Simulated less measured radiance, over the measured one's root mean square."""
    sky = simulate(
        _atmosphere(free, case),
        case.sun[:, None],
        case.view,
        case.azimuth,
        orders=case.orders,
        quality=case.quality,
    )
    return jnp.where(case.seen, (sky.radiance - case.measured) / _scale(case), 0.0).ravel()


def _scale(case: _Case):
    """Root mean square of the measured radiance."""
    return jnp.sqrt(jnp.mean(case.measured**2, where=case.seen))


class _Solution(NamedTuple):
    """Where the solver stopped."""

    free: Float[Array, " number"]
    gram: Float[Array, "number number"]
    loss: Float[Array, ""]
    steps: int
    converged: bool


def _solve(free: Float[Array, " number"], case: _Case, max_steps: int) -> _Solution:
    """Step by step: a whole solver around the simulator would take twice as long to compile."""
    solver = NormalEquationsLM(rtol=1e-5, atol=1e-4)
    nothing: Any = frozenset()
    state = solver.init(_residuals, free, case, {}, None, None, nothing)
    for number in range(1, max_steps + 1):
        free, state = _step(solver, free, case, state)
        done, _ = solver.terminate(_residuals, free, case, {}, state, nothing)
        if done:
            return _Solution(free, state.gram, state.loss, number, True)
    return _Solution(free, state.gram, state.loss, max_steps, False)


@eqx.filter_jit
def _step(solver, free, case, state):
    nothing: Any = frozenset()
    free, state, _ = solver.step(_with_nothing, free, case, {}, state, nothing)
    return free, state


def _with_nothing(free, case):
    return _residuals(free, case), None
