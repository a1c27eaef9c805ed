"""Bands, for programs that know of none: light of one class of lines at a time, and its mean.

Light of a band is the mean over classes of lines, each of which dims light exponentially. So an
atmosphere with bands is taken for several without, one for each class; what comes out is averaged.
Wavelengths without a band are the same in all classes, and are computed with the first alone.
"""

from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .._typing import as_float
from ..atmosphere import Atmosphere, Constituent
from ..phase import AbstractPhaseFunction
from .program import orders_under_suns
from .views import Views


Orders = tuple[
    Float[Array, "order sun ray out wavelength"], Float[Array, "1 sun ray out wavelength"]
]


class LineClasses(eqx.Module):
    """Classes of lines of an atmosphere, and the wavelengths at which they matter.

    Attributes:
        weights: Weights of the classes.
        place: Numbers of the wavelengths with bands.
        width: Number of wavelengths.
    """

    weights: Float[Array, " line_class"]
    place: tuple[int, ...] = eqx.field(static=True)
    width: int = eqx.field(static=True)

    def mean(self, light: Float[Array, "*batch channel"]) -> Float[Array, "*batch wavelength"]:
        """Mean over the classes of what is linear in light; channels as `side_by_side` has them."""
        if not self.place:
            return light
        at, weights = np.array(self.place), self.weights.astype(light.dtype)
        first, rest = light[..., : self.width], light[..., self.width :]
        by_class = rest.reshape(*light.shape[:-1], -1, at.size)
        ones = (1,) * (light.ndim - 1)
        further = jnp.sum(weights[1:].reshape(*ones, -1, 1) * by_class, axis=-2)
        share = jnp.ones(self.width, light.dtype).at[at].set(weights[0])
        return (share.reshape(*ones, -1) * first).at[..., at].add(further)

    def repeated(self, light: Float[Array, "*batch wavelength"]) -> Float[Array, "*batch channel"]:
        """Light that is the same in all classes, for every channel."""
        return light[..., self.wavelength] if self.place else light

    @property
    def wavelength(self) -> Int[np.ndarray, " channel"]:
        """Number of the wavelength of each channel."""
        again = np.tile(np.array(self.place, int), self.weights.size - 1)
        return np.concatenate([np.arange(self.width), again])

    @property
    def number(self) -> Int[np.ndarray, " channel"]:
        """Number of the class of each channel; 0 without a band."""
        again = np.repeat(np.arange(1, self.weights.size), len(self.place))
        return np.concatenate([np.zeros(self.width, int), again])


class Picked(AbstractPhaseFunction):
    """A phase function at some of its wavelengths.

    Args:
        base: At all wavelengths.
        wavelength: Numbers of some, in any order and repeated at will.
    """

    base: AbstractPhaseFunction
    wavelength: tuple[int, ...] = eqx.field(static=True)

    @property
    def is_grey(self) -> bool:
        """Whether the function is the same at every wavelength."""
        return self.base.is_grey

    @property
    def max_degree(self) -> int | None:
        """Highest degree with a Legendre coefficient other than 0; None without end."""
        return self.base.max_degree

    def spectral(self, cos_angle: Float[Array, "*batch"]) -> Float[Array, "*batch #wavelength"]:
        """Density [sr⁻¹] at cosines of the scattering angle, wavelength last."""
        return self._pick(self.base.spectral(cos_angle))

    def legendre(self, degree: int) -> Float[Array, "{degree}+1 #wavelength"]:
        """Legendre coefficients χ₀…χ_degree."""
        return self._pick(self.base.legendre(degree))

    def _pick(self, values):
        return values if values.shape[-1] == 1 else values[..., np.array(self.wavelength)]


def line_classes(atmosphere: Atmosphere) -> LineClasses:
    """The classes of an atmosphere's bands; a single one if it has none."""
    bands = [one.bands for one in atmosphere.constituents if one.bands is not None]
    place = tuple(sorted({at for some in bands for at in some.place}))
    width = atmosphere.wavelengths.size
    return LineClasses(bands[0].weights, place, width) if place else all_alike(width)


def all_alike(width: int) -> LineClasses:
    """The one class of wavelengths or colours without bands."""
    return LineClasses(as_float([1.0]), (), width)


def side_by_side(atmosphere: Atmosphere) -> tuple[Atmosphere, LineClasses]:
    """An atmosphere without bands, all classes in it: first every wavelength in the first class.

    Then come the wavelengths with bands in the second class, in the third, and so on. Its own
    `wavelengths` do not increase: this is for programs that do not ask for them.
    """
    classes = line_classes(atmosphere)
    return without_bands(atmosphere, classes.number, classes.wavelength), classes


def without_bands(
    atmosphere: Atmosphere,
    line_class: Int[np.ndarray, " channel"],
    wavelength: Int[np.ndarray, " channel"],
) -> Atmosphere:
    """The atmosphere at some of its wavelengths, as one class of lines sees it.

    Every coefficient is there for every channel, however it was given.

    Args:
        atmosphere: With bands or without.
        line_class: Number of the class of each channel.
        wavelength: Number of the wavelength of each channel.
    """
    same = np.array_equal(wavelength, np.arange(atmosphere.wavelengths.size))
    width = atmosphere.wavelengths.shape

    def pick(spectrum: Float[Array, " #wavelength"]) -> Float[Array, " channel"]:
        spectrum = jnp.broadcast_to(spectrum, width)
        return spectrum if same else spectrum[wavelength]

    def plain(one: Constituent) -> Constituent:
        absorption = pick(one.absorption)
        if one.bands is not None and one.bands.place:
            absorption = absorption + one.bands.absorption[line_class, wavelength]
        phase = one.phase if same else Picked(one.phase, tuple(wavelength.tolist()))
        return eqx.tree_at(
            lambda c: (c.scattering, c.absorption, c.phase, c.bands),
            one,
            (pick(one.scattering), absorption, phase, None),
            is_leaf=lambda x: x is None,
        )

    return eqx.tree_at(
        lambda a: (a.wavelengths, a.solar_irradiance, a.ground_albedo, a.constituents),
        atmosphere,
        (
            pick(atmosphere.wavelengths),
            pick(atmosphere.solar_irradiance),
            pick(atmosphere.ground_albedo),
            tuple(map(plain, atmosphere.constituents)),
        ),
    )


def orders_with_bands(atmosphere: Atmosphere, views: Views, **program: Any) -> Orders:
    """Orders one by one, and all together: `orders_under_suns`, averaged over classes of lines.

    The first class is laid out by itself: those in which air is black would take nodes from the
    wavelengths without bands. The others are laid out together, which leaves them within 0.2 % of
    what each is by itself (suns up to 85°).

    Args:
        atmosphere: With bands or without.
        views: As `orders_under_suns` takes them.
        **program: Its other arguments.
    """
    classes = line_classes(atmosphere)
    number, wavelength = classes.number, classes.wavelength
    first, further = slice(None, classes.width), slice(classes.width, None)
    plain = without_bands(atmosphere, number[first], wavelength[first])
    light = orders_under_suns(plain, views, **program)
    if wavelength.size == classes.width:
        return light
    plain = without_bands(atmosphere, number[further], wavelength[further])
    pairs = zip(light, orders_under_suns(plain, views, **program), strict=True)
    by_order, total = (classes.mean(jnp.concatenate(pair, axis=-1)) for pair in pairs)
    return by_order, total
