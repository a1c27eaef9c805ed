"""Bands, for programs that know of none: one channel for every wavelength and class of lines.

Light of a band is the mean over classes of lines, each of which dims light exponentially. So an
atmosphere with bands is taken for one without, whose wavelengths are repeated for each class; what
comes out is averaged again. Wavelengths without a band are not repeated.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..atmosphere import Atmosphere, Constituent
from ..phase import AbstractPhaseFunction


class LineClasses(eqx.Module):
    """Where the channels of an atmosphere with bands belong.

    The first channels are the wavelengths, those with bands as the first class sees them; then come
    the latter as the second class sees them, and so on.

    Attributes:
        weights: Of the classes.
        place: Numbers of the wavelengths with bands.
        width: Number of wavelengths.
    """

    weights: Float[Array, " line_class"]
    place: tuple[int, ...] = eqx.field(static=True)
    width: int = eqx.field(static=True)

    @property
    def _further(self) -> int:
        """Classes that have channels of their own."""
        return self.weights.size - 1 if self.place else 0

    @property
    def wavelength(self) -> np.ndarray:
        """Number of each channel's wavelength."""
        again = np.tile(np.array(self.place, int), self._further)
        return np.concatenate([np.arange(self.width), again])

    @property
    def line_class(self) -> np.ndarray:
        """Number of each channel's class; 0 where there is no band."""
        again = np.repeat(np.arange(1, self._further + 1), len(self.place))
        return np.concatenate([np.zeros(self.width, int), again])

    def repeated(self, spectrum: Float[Array, "*batch #wavelength"]) -> Float[Array, "*batch _"]:
        """A spectrum, the last axis, for every channel; what is grey stays so."""
        if not self.place or spectrum.shape[-1] == 1:
            return spectrum
        return spectrum[..., self.wavelength]

    def mean(self, light: Float[Array, "*batch channel"]) -> Float[Array, "*batch wavelength"]:
        """Mean over the classes of what is linear in light, channels being the last axis."""
        if not self.place:
            return light
        at, weights = np.array(self.place), self.weights.astype(light.dtype)
        first, rest = light[..., : self.width], light[..., self.width :]
        by_class = rest.reshape(*light.shape[:-1], self._further, at.size)
        shape = (1,) * (light.ndim - 1)
        rest = jnp.sum(weights[1:].reshape(*shape, -1, 1) * by_class, axis=-2)
        share = jnp.ones(self.width, light.dtype).at[at].set(weights[0])
        return (share.reshape(*shape, -1) * first).at[..., at].add(rest)


class Repeated(AbstractPhaseFunction):
    """A phase function for every channel.

    Args:
        base: The phase function for every wavelength.
        classes: Which channels there are.
    """

    base: AbstractPhaseFunction
    classes: LineClasses

    @property
    def is_grey(self) -> bool:
        """Whether the function is the same at every wavelength."""
        return self.base.is_grey

    @property
    def max_degree(self) -> int | None:
        """Highest degree with a Legendre coefficient other than 0; None without end."""
        return self.base.max_degree

    def spectral(self, cos_angle: Float[Array, "*batch"]) -> Float[Array, "*batch #channel"]:
        """Density [sr⁻¹] at cosines of the scattering angle, channel last."""
        return self.classes.repeated(self.base.spectral(cos_angle))

    def legendre(self, degree: int) -> Float[Array, "{degree}+1 #channel"]:
        """Legendre coefficients χ₀…χ_degree."""
        return self.classes.repeated(self.base.legendre(degree))


def by_line_class(atmosphere: Atmosphere) -> tuple[Atmosphere, LineClasses]:
    """An atmosphere without bands, its channels repeated for the classes of lines.

    Its `wavelengths` repeat as well and do not increase: it is for programs that do not ask for
    them. An atmosphere without bands is returned as it is.
    """
    lam = atmosphere.wavelengths
    bands = [one.bands for one in atmosphere.constituents if one.bands is not None]
    if not bands:
        return atmosphere, LineClasses(jnp.ones(1, lam.dtype), (), lam.size)
    place = tuple(sorted({at for some in bands for at in some.place}))
    classes = LineClasses(bands[0].weights, place, lam.size)

    def without_bands(one: Constituent) -> Constituent:
        absorption = classes.repeated(one.absorption)
        if one.bands is not None:
            by_class = one.bands.absorption
            absorption = absorption + by_class[classes.line_class, classes.wavelength]
        return eqx.tree_at(
            lambda c: (c.scattering, c.absorption, c.phase, c.bands),
            one,
            (classes.repeated(one.scattering), absorption, Repeated(one.phase, classes), None),
            is_leaf=lambda x: x is None or isinstance(x, jax.Array),
        )

    return eqx.tree_at(
        lambda a: (a.wavelengths, a.solar_irradiance, a.ground_albedo, a.constituents),
        atmosphere,
        (
            classes.repeated(lam),
            classes.repeated(atmosphere.solar_irradiance),
            classes.repeated(atmosphere.ground_albedo),
            tuple(map(without_bands, atmosphere.constituents)),
        ),
    ), classes
