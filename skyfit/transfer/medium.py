"""An atmosphere laid out on a planet: shells, columns, and where things happen in it.

Everything here follows the medium itself. A density of 1 has no special meaning: a density a
thousand times larger with a coefficient a thousand times smaller is the same medium.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .._typing import Scalar
from ..atmosphere import Atmosphere
from .geometry import AbstractPlanet, Spherical
from .optics import Optics
from .quadrature import count_passed, running_sum


_SHELLS = 32
_SHELL_GROWTH = 6.0  # shells at (e^{6x} - 1)/(e⁶ - 1) of the top: 30 m to 10 km deep under 60 km
_ALIKE = 0.03  # wavelengths whose optical depths differ by so much count as one
_LEVEL_GROWTH = 5.0  # the same for the coordinate of levels
# Shares of that coordinate: altitude alone, optical depth, what dims light from above and below.
_BY_ALTITUDE, _BY_DEPTH, _BY_DIMMING = 0.5, 0.25, 0.25
_EMPTY = 1e-4  # what altitude counts for where there is nothing, beside 1 where there is air
_FAINT = 1e-6  # of the densest extinction: counts half
_DEEP = 8.0  # optical depth of which half that share's due is given


class Medium(eqx.Module):
    """What light crosses: an atmosphere, its planet, and shells in which densities are smooth.

    Attributes:
        atmosphere: What scatters and absorbs.
        planet: Shape of the planet.
        optics: Coefficients and phase functions as the solver sees them.
        edges: Altitudes of the shells' edges, from the ground to the top [m].
        cubics: Coefficients of the densities in each shell, by powers of the share of its depth.
        above: Vertical columns above each edge [m at relative density 1].
        telling: Extinction at few wavelengths, from the clearest to the densest [m⁻¹].
        filled: Whether there is anything in each shell, from near 0 to 1.
        climbed: Part by altitude of the levels' coordinate, at each edge.
        coordinate: At each edge, from 0 to 1; it rises with altitude and with optical depth, so
            that equal steps of it are about equally important.
        coordinate_scale: What it was divided by to end at 1.
        kink: Jump of the slope of extinction at each edge [m⁻²].
        rows: Row of each shell: edges, what is above it and its cubics, to be looked up at once.
    """

    atmosphere: Atmosphere
    planet: AbstractPlanet
    optics: Optics
    edges: Float[Array, " edge"]
    cubics: Float[Array, "species 4 shell"]
    above: Float[Array, "edge species"]
    telling: Float[Array, "few species"]
    filled: Float[Array, " shell"]
    climbed: Float[Array, " edge"]
    coordinate: Float[Array, " edge"]
    coordinate_scale: Scalar
    kink: Float[Array, " edge"]
    rows: Float[Array, "shell entry"]

    def look_up(
        self, shell: Int[Array, "*b"]
    ) -> tuple[
        Float[Array, "*b"],
        Float[Array, "*b"],
        Float[Array, "*b species"],
        tuple[Float[Array, "*b species"], ...],
    ]:
        """Lower and upper edge of shells [m], the column above them [m], and their cubics."""
        row = self.rows.at[shell].get(mode="promise_in_bounds", wrap_negative_indices=False)
        above, *cubics = jnp.split(row[..., 2:], 5, axis=-1)
        return row[..., 0], row[..., 1], above, tuple(cubics)

    def density_in_shells(
        self, share: Float[Array, "look shell"]
    ) -> Float[Array, "species look shell"]:
        """Relative densities at points in every shell, given as shares of its depth."""
        c0, c1, c2, c3 = (self.cubics[:, None, power] for power in range(4))
        share = share[None]
        return c0 + share * (c1 + share * (c2 + share * c3))

    def above_altitude(self, altitude: Float[Array, "*b"]) -> Float[Array, "*b species"]:
        """Vertical columns above altitudes [m at relative density 1]."""
        low, high, above, (c0, c1, c2, c3) = self.look_up(self.shell(altitude))
        depth = jnp.where(high > low, high - low, 1.0)
        x = jnp.clip((altitude - low) / depth, 0.0, 1.0)[..., None]
        below = x * (c0 + x * (c1 / 2 + x * (c2 / 3 + x * c3 / 4)))
        whole = jnp.maximum(c0 + c1 / 2 + c2 / 3 + c3 / 4, 0.0)
        return jnp.maximum(above + (whole - below) * (high - low)[..., None], 0.0)

    def shell(self, altitude: Float[Array, "*b"]) -> Int[Array, "*b"]:
        """Which shell altitudes lie in."""
        return jnp.clip(count_passed(altitude, self.edges) - 1, 0, self.edges.size - 2)

    def level_at(self, altitude: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """The coordinate at altitudes [m]."""
        depth = self.above_altitude(altitude) @ self.telling.T
        shell, grown = self.shell(altitude), _by_altitude(self.edges / self.planet.top)
        low, high = grown[shell], grown[shell + 1]
        apart = jnp.where(high > low, high - low, 1.0)
        part = (_by_altitude(altitude / self.planet.top) - low) / apart
        climbed = self.climbed[shell] + part * (self.climbed[shell + 1] - self.climbed[shell])
        return _mixed(climbed, depth, self.above[0] @ self.telling.T) / self.coordinate_scale

    def dusk(self) -> Scalar:
        """Radius of the planet over the mean altitude of what scatters highest; 0 for a plane."""
        if not isinstance(self.planet, Spherical):
            return jnp.zeros_like(self.planet.top)
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        column = self.above[:-1] - self.above[1:]
        mean = (middle @ column) / jnp.maximum(self.above[0], 1e-30)
        scatters = (jnp.max(self.optics.scattering, axis=1) > 0) & (self.above[0] > 0)
        highest = jnp.max(jnp.where(scatters, mean, 0.0))
        return self.planet.radius / jnp.maximum(highest, 1e3)

    def sight(self) -> Scalar:
        """Distance past which nothing is seen: 2000 optical depths where it is densest [m].

        Only a flat planet's grazing rays are that long. Where spectra differ more than a
        hundredfold the densest wavelength counts.
        """
        density = jnp.max(jnp.maximum(self.cubics[:, 0], 0.0), axis=1)
        total = density @ self.optics.extinction
        densest = jnp.maximum(jnp.max(total), 1e-12)
        return 2000 / jnp.maximum(jnp.min(total), 0.01 * densest)


def make_medium(
    atmosphere: Atmosphere, planet: AbstractPlanet, optics: Optics | None = None
) -> Medium:
    """Lay an atmosphere out on a planet.

    Shells end where a density has a kink, and are thin enough besides: a cubic through four points
    follows exponentials of 1 km or more to 1e-6 of their value at the ground.
    """
    optics = Optics.plain(atmosphere) if optics is None else optics
    x = np.linspace(0, 1, _SHELLS + 1)
    base = planet.top * jnp.asarray(_grown(x, _SHELL_GROWTH), planet.top.dtype)
    edges = jnp.sort(jnp.concatenate([base, atmosphere.knots()]))
    depth = jnp.diff(edges)
    # Both ends are looked at, so that densities are continuous from shell to shell, but from just
    # inside, since a layer may end there.
    inside = float(jnp.finfo(edges.dtype).eps) ** 0.4
    looks = np.array([inside, 0.5 * (1 - 5**-0.5), 0.5 * (1 + 5**-0.5), 1 - inside])
    density = atmosphere.density(
        edges[:-1, None] + depth[:, None] * jnp.asarray(looks, edges.dtype)[None]
    )
    to_powers = jnp.asarray(np.linalg.inv(np.vander(looks, 4, increasing=True)), edges.dtype)
    cubics = jnp.einsum("pn,kns->spk", to_powers, density)
    means = jnp.asarray(1 / np.arange(1, 5), edges.dtype)
    column = jnp.maximum(jnp.einsum("p,spk->ks", means, cubics), 0.0) * depth[:, None]
    none = jnp.zeros_like(column[:1])
    above = jnp.concatenate([running_sum(column, backward=True), none])
    telling = _telling(optics.extinction, above[0])
    is_knot = jnp.any(edges[:, None] == atmosphere.knots()[None, :], axis=1)
    kink = jnp.where(is_knot, _kink(cubics, depth, telling), 0.0)
    # Levels in empty air would be of no use.
    thick = (column @ telling.T).mean(axis=-1) / jnp.where(depth > 0, depth, 1.0)
    filled = thick / (thick + _FAINT * jnp.max(thick) + 1e-30)
    weight = _EMPTY + (1 - _EMPTY) * filled
    climbed = running_sum(weight * jnp.diff(_by_altitude(edges / planet.top)))
    climbed = jnp.concatenate([jnp.zeros_like(climbed[:1]), climbed])
    climbed = climbed / climbed[-1]
    mixed = _mixed(climbed, above @ telling.T, above[0] @ telling.T)
    by_power = jnp.swapaxes(cubics, 0, 1).reshape(-1, depth.size).T
    rows = jnp.concatenate([edges[:-1, None], edges[1:, None], above[1:], by_power], axis=1)
    return Medium(
        atmosphere,
        planet,
        optics,
        edges,
        cubics,
        above,
        telling,
        weight,
        climbed,
        mixed / mixed[-1],
        mixed[-1],
        kink,
        rows,
    )


def _kink(
    cubics: Float[Array, "species 4 shell"],
    depth: Float[Array, " shell"],
    telling: Float[Array, "few species"],
) -> Float[Array, " edge"]:
    """By how much the slope of extinction jumps at each edge, 0 at the ends [m⁻²].

    Where edges coincide, at the first of them.
    """
    count = depth.size
    some = depth > 0
    safe = jnp.where(some, depth, 1.0)[None]
    at_bottom = cubics[:, 1] / safe
    at_top = (cubics[:, 1] + 2 * cubics[:, 2] + 3 * cubics[:, 3]) / safe
    # The next shell above each edge that has a depth.
    above = jax.lax.cummin(jnp.where(some, jnp.arange(count), count - 1), reverse=True)
    jump = jnp.where(some[None, :-1], at_bottom[:, above[1:]] - at_top[:, :-1], 0.0)
    size = jnp.mean(jnp.abs(telling @ jump), axis=0)
    return jnp.pad(size, 1)


def _grown(x, growth):
    return np.expm1(growth * x) / np.expm1(growth)


def _telling(
    extinction: Float[Array, "species wavelength"], column: Float[Array, " species"]
) -> Float[Array, "3 species"]:
    """Extinction about the clearest, a middling and the densest wavelength.

    Means over wavelengths of nearly that depth: a choice of one would jump from one to another.
    """
    depth = jnp.log(column @ extinction + 1e-12)
    low, high = jnp.min(depth), jnp.max(depth)
    off = jnp.stack([depth - low, jnp.abs(depth - 0.5 * (low + high)), high - depth])
    return jax.nn.softmax(-off / _ALIKE, axis=1) @ extinction.T


def _by_altitude(share: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """A coordinate that rises fastest near the ground, of altitudes as a share of the top."""
    return jnp.log1p(share * float(np.expm1(_LEVEL_GROWTH))) / _LEVEL_GROWTH


def _mixed(
    climbed: Float[Array, "*b"], depth: Float[Array, "*b few"], total: Float[Array, " few"]
) -> Float[Array, "*b"]:
    """What the coordinate of levels follows; see `Medium`.

    Args:
        climbed: The part by altitude.
        depth: Optical depth above, at few wavelengths.
        total: Above the ground.
    """
    total = total.reshape((1,) * (depth.ndim - 1) + (-1,))
    below = total - depth
    by_depth = below / (1 + total / _DEEP)
    # Light from above and from below fades by these.
    dimmed = jnp.exp(-depth) - jnp.exp(-total) + 1 - jnp.exp(-below)
    return (
        _BY_ALTITUDE * climbed
        + _BY_DEPTH * jnp.mean(by_depth, axis=-1)
        + _BY_DIMMING * 0.5 * jnp.mean(dimmed, axis=-1)
    )
