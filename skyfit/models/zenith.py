"""Luminance and chromaticity of the zenith over the sun's zenith angle and a swept parameter."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float


class TangentZenith(eqx.Module):
    """Zenith luminance (a T + b) tan χ + c T + d with χ = (p + q T)(π - 2 θₛ).

    Source: Preetham et al. (1999), appendix A.2, where p = 4/9 and q = -1/120.

    Attributes:
        linear: a, b, c, d [cd m⁻²].
        angle: p, q.
    """

    linear: Float[Array, " 4"]
    angle: Float[Array, " 2"]

    def __call__(
        self, parameter: Float[Array, "*#batch"], sun_zenith: Float[Array, "*#batch"]
    ) -> Float[Array, "*batch"]:
        """Luminance [cd m⁻²]; negative where the formula is."""
        a, b, c, d = self.linear
        p, q = self.angle
        chi = (p + q * parameter) * (jnp.pi - 2 * sun_zenith)
        return (a * parameter + b) * jnp.tan(chi) + c * parameter + d


class CubicZenith(eqx.Module):
    """Zenith chromaticity [T² T 1] M [θₛ³ θₛ² θₛ 1]ᵀ.

    Source: Preetham et al. (1999), appendix A.2.

    Attributes:
        matrix: M.
    """

    matrix: Float[Array, "3 4"]

    def __call__(
        self, parameter: Float[Array, "*#batch"], sun_zenith: Float[Array, "*#batch"]
    ) -> Float[Array, "*batch"]:
        """One chromaticity coordinate."""
        total = jnp.zeros_like(parameter * sun_zenith)
        for row in self.matrix:
            along_sun = jnp.zeros_like(sun_zenith)
            for entry in row:
                along_sun = along_sun * sun_zenith + entry
            total = total * parameter + along_sun
        return total
