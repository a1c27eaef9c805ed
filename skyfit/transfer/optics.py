"""Coefficients and phase functions as the solver sees them: forward peaks cut off exactly.

A phase function p is split into f δ + q: a share f that goes straight on, and a smooth rest q that
harmonics up to some degree hold (delta-M: Wiscombe 1977, J. Atmos. Sci. 34, 1408). With χ_l the
Legendre coefficients of p, q has χ_l - f, and f is the first coefficient left out.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..atmosphere import Atmosphere
from ..legendre import legendre_polynomials


class Optics(eqx.Module):
    """What a solver multiplies light with, where densities are 1.

    Attributes:
        extinction: [m⁻¹].
        scattering: Multiplies phase functions as they are [m⁻¹].
        straight: Part of scattering that goes straight on [m⁻¹].
        harmonics: Of each constituent, scattering times the Legendre coefficients of the rest,
            up to its degree [m⁻¹].
        ground_albedo: Lambertian.
        blur: Difference of forward peaks that meet twice from one met once as it is: Legendre
            coefficients of (r⋆r/2 - f r)/f with r = p - q, where phase functions do not end.
        endless: Whether harmonics of a constituent end only because they were cut.
    """

    extinction: Float[Array, "species channel"]
    scattering: Float[Array, "species channel"]
    straight: Float[Array, "species channel"]
    harmonics: tuple[Float[Array, "_degree channel"], ...]
    ground_albedo: Float[Array, " channel"]
    blur: Float[Array, "species l channel"]
    endless: tuple[bool, ...] = eqx.field(static=True)

    @classmethod
    def plain(cls, atmosphere: Atmosphere) -> "Optics":
        """Without harmonics: all that the first order needs."""
        none = jnp.zeros_like(atmosphere.extinction)
        scattering, extinction = atmosphere.scattering, atmosphere.extinction
        endless = tuple(False for _ in atmosphere.constituents)
        albedo = atmosphere.ground_albedo
        return cls(extinction, scattering, none, (), albedo, none[:, None], endless)

    @classmethod
    def cut(cls, atmosphere: Atmosphere, degree: int, sharpest: int) -> "Optics":
        """With forward peaks cut off, in which order by order still counts every interaction.

        Args:
            atmosphere: What scatters and absorbs.
            degree: Highest of the harmonics.
            sharpest: Highest degree of what is known of the peaks.
        """
        plain = cls.plain(atmosphere)
        harmonics, straight, blur = [], [], []
        for one, scattering in zip(atmosphere.constituents, atmosphere.scattering, strict=True):
            highest = one.phase.max_degree
            if highest is not None:
                chi = one.phase.legendre(min(degree, highest))
                harmonics.append(chi * scattering[None])
                straight.append(0 * scattering)
                blur.append(jnp.zeros((sharpest + 1, scattering.size), scattering.dtype))
                continue
            chi = one.phase.legendre(sharpest)
            # What is negative is no peak ahead.
            forward = jnp.maximum(chi[degree + 1], 0.0)
            harmonics.append((chi[: degree + 1] - forward[None]) * scattering[None])
            straight.append(jnp.broadcast_to(forward, scattering.shape) * scattering)
            some = forward > 1e-12
            rest = jnp.where(jnp.arange(sharpest + 1)[:, None] > degree, chi, forward[None])
            twice = rest**2 / (2 * jnp.where(some, forward, 1.0)[None]) - rest
            # A smooth end of the series, in place of ripples.
            x = np.clip(3 * np.arange(sharpest + 1) / sharpest - 2, 0, 1)
            taper = jnp.asarray(np.cos(np.pi / 2 * x) ** 2, chi.dtype)[:, None]
            wide = jnp.where(some[None], twice, 0.0) * taper
            blur.append(jnp.broadcast_to(wide, (sharpest + 1, scattering.size)))
        endless = tuple(one.phase.max_degree is None for one in atmosphere.constituents)
        return cls(
            plain.extinction, plain.scattering, jnp.stack(straight), tuple(harmonics),
            plain.ground_albedo, jnp.stack(blur), endless,
        )  # fmt: skip

    def whole(self) -> "Optics":
        """The same with what goes straight on among what is scattered, for light without peaks."""
        harmonics = tuple(
            part + straight[None] if one else part
            for part, straight, one in zip(self.harmonics, self.straight, self.endless, strict=True)
        )
        return eqx.tree_at(lambda o: o.harmonics, self, harmonics)

    def up_to(self, degree: int) -> "Optics":
        """The same with room for harmonics up to a degree that phase functions without end fill."""

        def padded(part, one):
            lacks = degree + 1 - part.shape[0] if one else 0
            return jnp.pad(part, [(0, lacks), (0, 0)])

        harmonics = tuple(map(padded, self.harmonics, self.endless))
        return eqx.tree_at(lambda o: o.harmonics, self, harmonics)

    def scaled(self) -> "Optics":
        """The same where what goes straight on counts as not scattered."""
        return eqx.tree_at(lambda o: o.extinction, self, self.extinction - self.straight)

    def blurred(
        self, number: int, cos_angle: Float[Array, "*batch"]
    ) -> Float[Array, "*batch channel"]:
        """The series of `blur` of one constituent at cosines of the scattering angle [sr⁻¹]."""
        norm = (2 * np.arange(self.blur.shape[1]) + 1) / (4 * np.pi)
        series = self.blur[number] * jnp.asarray(norm, cos_angle.dtype)[:, None]
        polynomials = legendre_polynomials(series.shape[0] - 1, cos_angle.ravel())
        return (polynomials.T @ series).reshape(*cos_angle.shape, -1)

    def beside(self, other: "Optics") -> "Optics":
        """Both, channel after channel."""
        return jax.tree.map(lambda a, b: jnp.concatenate([a, b], axis=-1), self, other)
