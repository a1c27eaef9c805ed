"""An atmosphere laid out on a planet, with its densities made cheap to integrate."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import Scalar
from ..atmosphere import Atmosphere
from .geometry import AbstractPlanet
from .quadrature import gauss


class Medium(eqx.Module):
    """What light crosses: an atmosphere, its planet, and shells in which densities are smooth.

    Attributes:
        atmosphere: What scatters and absorbs.
        planet: Its shape.
        edges: Altitudes of the shells' edges, from the ground to the top [m].
        cubics: Coefficients of the densities in each shell, by powers of the share of its depth.
    """

    atmosphere: Atmosphere
    planet: AbstractPlanet
    edges: Float[Array, " edge"]
    cubics: Float[Array, "species 4 shell"]

    def density_in_shells(self, share: Float[Array, " shell"]) -> Float[Array, "species shell"]:
        """Relative densities at one point in every shell, given as a share of its depth."""
        c0, c1, c2, c3 = (self.cubics[:, power] for power in range(4))
        share = share[None, :]
        return c0 + share * (c1 + share * (c2 + share * c3))

    def sight(self) -> tuple[Scalar, Scalar]:
        """How far and how closely rays must be looked at, by what dims them.

        Returns:
            Distance past which nothing is seen: 2000 optical depths at ground density [m]; only a
            flat planet's grazing rays are that long. Where spectra differ more than a hundredfold
            the densest wavelength counts.
            Distance over which the densest wavelength fades at ground density [m].
        """
        total = jnp.sum(self.atmosphere.extinction, axis=0)
        densest = jnp.maximum(jnp.max(total), 1e-12)
        slowest = jnp.maximum(jnp.min(total), 0.01 * densest)
        return 2000 / slowest, 1 / densest


def make_medium(atmosphere: Atmosphere, planet: AbstractPlanet) -> Medium:
    """Lay an atmosphere out on a planet.

    Shells end where a density has a kink, and are thin enough besides: a cubic through four Gauss
    nodes follows exponentials of 1 km or more to 1e-6 of their value at the ground.
    """
    x = np.linspace(0, 1, 41)
    base = planet.top * jnp.asarray(np.expm1(6 * x) / np.expm1(6), planet.top.dtype)
    edges = jnp.sort(jnp.concatenate([base, atmosphere.knots()]))
    nodes = gauss(4)[0]
    depth = jnp.diff(edges)[:, None]
    density = atmosphere.density(edges[:-1, None] + depth * jnp.asarray(nodes, edges.dtype)[None])
    to_powers = jnp.asarray(np.linalg.inv(np.vander(nodes, 4, increasing=True)), edges.dtype)
    cubics = jnp.einsum("pn,kns->spk", to_powers, density)
    return Medium(atmosphere, planet, edges, cubics)
