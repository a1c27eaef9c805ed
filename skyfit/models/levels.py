"""How bright a sky is as a whole: from the luminance of its zenith, or from its illuminance."""

import abc
import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .scale import TangentZenith
from .standard_skies import AbstractLuminanceForm, Parameters, Sight, overhead
from .twilight import daytime_sun, dimming


# Of the sum over the hemisphere: within 2e-4 for every type of the general sky.
ZENITH_NODES, AZIMUTH_NODES = 32, 48


class AbstractLevel(eqx.Module):
    """The factor that makes a distribution absolute."""

    @abc.abstractmethod
    def __call__(
        self,
        distribution: AbstractLuminanceForm,
        sun_zenith: Float[Array, "..."],
        parameters: Parameters,
    ) -> Float[Array, "..."]:
        """Luminance [cd m⁻²] where the distribution is 1; never negative."""


class AbstractQuantity(eqx.Module):
    """Something that depends on the sun by day, such as the luminance of the zenith."""

    @abc.abstractmethod
    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> Float[Array, "..."]:
        """Value for a sun above the horizon or on it."""


class ByZenith(AbstractLevel):
    """Brightness from the luminance of the zenith.

    Attributes:
        luminance: Luminance of the zenith [cd m⁻²].
    """

    luminance: AbstractQuantity

    def __call__(
        self,
        distribution: AbstractLuminanceForm,
        sun_zenith: Float[Array, "..."],
        parameters: Parameters,
    ) -> Float[Array, "..."]:
        """Luminance [cd m⁻²] where the distribution is 1; never negative."""
        zenith = jnp.maximum(self.luminance(daytime_sun(sun_zenith), parameters), 0.0)
        return dimming(sun_zenith) * zenith / distribution(overhead(sun_zenith), parameters)


class ByIlluminance(AbstractLevel):
    """Brightness from the light of the sky on the ground.

    Attributes:
        illuminance: Illuminance of a horizontal plane by the sky without its sun [lx].
    """

    illuminance: AbstractQuantity

    def __call__(
        self,
        distribution: AbstractLuminanceForm,
        sun_zenith: Float[Array, "..."],
        parameters: Parameters,
    ) -> Float[Array, "..."]:
        """Luminance [cd m⁻²] where the distribution is 1; never negative."""
        light = jnp.maximum(self.illuminance(daytime_sun(sun_zenith), parameters), 0.0)
        ground = on_the_ground(distribution, sun_zenith, parameters)
        # A distribution that is nowhere above 0 leaves the sky black.
        some = ~(ground <= 0)
        return dimming(sun_zenith) * jnp.where(some, light / jnp.where(some, ground, 1.0), 0.0)


@eqx.filter_jit
def on_the_ground(
    distribution: AbstractLuminanceForm, sun_zenith: Float[Array, "..."], parameters: Parameters
) -> Float[Array, "..."]:
    """Integral of a distribution, cut off at 0 as skies are, times cos θ over the hemisphere."""
    # cos θ dω is half of d(cos²θ) dφ; the two halves of the sky are alike.
    x, w = np.polynomial.legendre.leggauss(ZENITH_NODES)
    cosines = jnp.asarray(np.sqrt(0.5 + 0.5 * x), sun_zenith.dtype)
    weights = jnp.asarray(0.5 * w * math.pi / AZIMUTH_NODES, sun_zenith.dtype)
    azimuth = (np.arange(AZIMUTH_NODES) + 0.5) * math.pi / AZIMUTH_NODES
    sun = sun_zenith[..., None]
    shape = (1,) * (sun.ndim - 1) + (AZIMUTH_NODES,)
    across = jnp.asarray(np.cos(azimuth), sun_zenith.dtype).reshape(shape)
    held = {name: value[..., None] for name, value in parameters.items()}

    def add(total, node):
        cosine, weight = node
        angle = jnp.arccos(cosine)
        cos_gamma = cosine * jnp.cos(sun) + jnp.sin(angle) * jnp.sin(sun) * across
        square = jnp.maximum(1 - cos_gamma**2, 1e-12)
        gamma = jnp.arctan2(jnp.sqrt(square), cos_gamma)
        ones = jnp.ones_like(cos_gamma)
        sight = Sight(angle * ones, cosine * ones, gamma, cos_gamma, sun * ones)
        return total + weight * jnp.maximum(distribution(sight, held), 0.0).sum(axis=-1), None

    start = jnp.zeros(
        jnp.broadcast_shapes(sun_zenith.shape, *(value.shape for value in parameters.values())),
        sun_zenith.dtype,
    )
    total, _ = jax.lax.scan(add, start, (cosines, weights))
    return total


class PublishedZenith(AbstractQuantity):
    """The zenith luminance of Preetham et al. (1999), appendix A.2 [cd m⁻²].

    Attributes:
        formula: Over turbidity and sun.
    """

    formula: TangentZenith

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> Float[Array, "..."]:
        """Luminance [cd m⁻²]."""
        return self.formula(parameters["turbidity"], sun_zenith)


class ClearZenith(AbstractQuantity):
    """(1.376 T - 1.81) tan h + 0.38 kcd/m² for a sun of elevation h, held above 87°.

    Source: Karayel, Navvab, Ne'eman & Selkowitz (1984), "Zenith luminance and sky luminance
    distributions for daylighting calculations", Energy and Buildings 6(3); T is Linke's turbidity.
    """

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> Float[Array, "..."]:
        """Luminance [cd m⁻²]."""
        elevation = jnp.minimum(math.pi / 2 - sun_zenith, math.radians(87.0))
        return 1e3 * ((1.376 * parameters["turbidity"] - 1.81) * jnp.tan(elevation) + 0.38)


class OvercastZenith(AbstractQuantity):
    """123 + 8600 sin h cd/m²; Krochmann & Seidl (1974), "Quantitative data on daylight"."""

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> Float[Array, "..."]:
        """Luminance [cd m⁻²]."""
        return 123.0 + 8600.0 * jnp.cos(sun_zenith)


class MeanOf(AbstractQuantity):
    """The mean of two quantities.

    Attributes:
        first: One of them.
        second: The other.
    """

    first: AbstractQuantity
    second: AbstractQuantity

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> Float[Array, "..."]:
        """Half of the sum."""
        return (self.first(sun_zenith, parameters) + self.second(sun_zenith, parameters)) / 2


class SkyIlluminance(AbstractQuantity):
    """a + b (sin h)^c: the sky's light on the ground for a sun of elevation h [lx].

    Source: IES (1984), "Recommended practice for the calculation of daylight availability", Journal
    of the IES 13(4), 381.

    Attributes:
        coefficients: a and b [lx], c.
    """

    coefficients: Float[Array, "3"]

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> Float[Array, "..."]:
        """Illuminance [lx]."""
        a, b, c = self.coefficients
        # Above 0, so that a root has a finite slope at sunset.
        return a + b * jnp.maximum(jnp.cos(sun_zenith), 1e-6) ** c


class Given(AbstractQuantity):
    """A quantity that the caller gave, whatever the sun.

    Attributes:
        name: Name of the parameter.
    """

    name: str = eqx.field(static=True)

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> Float[Array, "..."]:
        """The parameter."""
        return parameters[self.name] + 0 * sun_zenith
