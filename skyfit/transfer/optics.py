"""Coefficients and phase functions as the solver sees them: forward peaks cut off exactly.

A phase function p is split into f δ + q: a share f that goes straight on, and a smooth rest q that
harmonics up to some degree hold (delta-M: Wiscombe 1977, J. Atmos. Sci. 34, 1408). With χ_l the
Legendre coefficients of p, q has χ_l - f, and f is the first coefficient left out.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..atmosphere import Atmosphere


class Optics(eqx.Module):
    """What a solver multiplies light with, where densities are 1.

    Attributes:
        extinction: [m⁻¹].
        scattering: Multiplies phase functions as they are [m⁻¹].
        straight: Part of scattering that goes straight on [m⁻¹].
        harmonics: For each constituent scattering times the Legendre coefficients of the rest,
            up to its degree [m⁻¹].
        ground_albedo: Lambertian.
    """

    extinction: Float[Array, "species channel"]
    scattering: Float[Array, "species channel"]
    straight: Float[Array, "species channel"]
    harmonics: tuple[Float[Array, "_degree channel"], ...]
    ground_albedo: Float[Array, " channel"]

    @classmethod
    def plain(cls, atmosphere: Atmosphere) -> "Optics":
        """Without harmonics: all that the first order needs."""
        none = jnp.zeros_like(atmosphere.extinction)
        scattering, extinction = atmosphere.scattering, atmosphere.extinction
        return cls(extinction, scattering, none, (), atmosphere.ground_albedo)

    @classmethod
    def cut(cls, atmosphere: Atmosphere, degree: int) -> "Optics":
        """With forward peaks cut off, in which order by order still counts every interaction."""
        harmonics, straight = [], []
        for one, scattering in zip(atmosphere.constituents, atmosphere.scattering, strict=True):
            highest = one.phase.max_degree
            top = degree if highest is None else min(degree, highest)
            chi = one.phase.legendre(top + 1)
            # What is negative is no peak ahead.
            forward = jnp.maximum(chi[top + 1], 0.0) if highest is None else 0 * chi[0]
            harmonics.append((chi[: top + 1] - forward[None]) * scattering[None])
            straight.append(jnp.broadcast_to(forward, scattering.shape) * scattering)
        plain = cls.plain(atmosphere)
        return cls(
            plain.extinction, plain.scattering, jnp.stack(straight), tuple(harmonics),
            plain.ground_albedo,
        )  # fmt: skip

    def scaled(self) -> "Optics":
        """The same where what goes straight on counts as not scattered."""
        return Optics(
            self.extinction - self.straight, self.scattering, 0 * self.straight, self.harmonics,
            self.ground_albedo,
        )  # fmt: skip

    def beside(self, other: "Optics") -> "Optics":
        """Both, channel after channel."""
        return jax.tree.map(lambda a, b: jnp.concatenate([a, b], axis=-1), self, other)
