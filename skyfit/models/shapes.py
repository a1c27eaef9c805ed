"""Formulas of how light spreads over the dome: Perez, the CIE's form, Hosek-Wilkie's, a series.

A shape is a function of view zenith angle θ and view-sun angle γ with some coefficients. Its
coefficients are links of free numbers: what is swept changes the numbers, and a link keeps a rate
negative, or an asymmetry between 0 and 1, whatever they are.
"""

import abc
import math
from collections.abc import Mapping
from typing import Any, ClassVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .perez import COEFFICIENTS, LEAST_COSINE, perez


LINKS = ("identity", "-exp", "logistic")
# The square root of cos θ is infinitely steep at the horizon: it is held below this cosine.
LEAST_ROOT = 1e-4
SOFT = 0.01  # added to cos θ by Hosek and Wilkie, so that the airmass ends at 100


class AbstractShape(eqx.Module):
    """A function of view zenith angle and view-sun angle with some coefficients."""

    name: ClassVar[str]
    formula: ClassVar[str]
    # Whether a value is the scale times F(θ, γ) / F(0, θₛ), the scale being the zenith's value,
    # or the scale times F(θ, γ).
    relative: ClassVar[bool]
    # Whether F is linear in the free numbers.
    linear: ClassVar[bool] = False

    @property
    @abc.abstractmethod
    def names(self) -> tuple[str, ...]:
        """Of the coefficients."""

    @property
    @abc.abstractmethod
    def links(self) -> tuple[str, ...]:
        """From a free number to its coefficient, one of `LINKS` each."""

    @abc.abstractmethod
    def value(
        self,
        coefficients: Float[Array, "coefficient *#batch"],
        cos_view: Float[Array, "*#batch"],
        gamma: Float[Array, "*#batch"],
        cos_gamma: Float[Array, "*#batch"],
    ) -> Float[Array, "*batch"]:
        """F(θ, γ); below the horizon, with the horizon's gradation."""

    @abc.abstractmethod
    def starts(self) -> tuple[tuple[float, ...], ...]:
        """Free numbers to start a fit from; the first is also the prior's centre."""

    def coefficients(
        self, free: Float[Array, "coefficient *batch"]
    ) -> Float[Array, "coefficient *batch"]:
        """Coefficients of free numbers."""
        return jnp.stack([_link(row, kind) for row, kind in zip(free, self.links, strict=True)])

    def fixed(self) -> dict[str, Any]:
        """Numbers of the formula that are not fitted."""
        return {}

    def describe(self) -> dict[str, Any]:
        """As names and numbers, for files; `shape_from` makes the same shape of it."""
        return {
            "name": self.name,
            "formula": self.formula,
            "relative_to_zenith": self.relative,
            "coefficients": list(self.names),
            "links": list(self.links),
            "fixed": self.fixed(),
        }


class PerezShape(AbstractShape):
    """(1 + A e^{B/cos θ}) (1 + C e^{Dγ} + E cos²γ): Perez, Seals & Michalsky (1993)."""

    name = "perez"
    formula = "F = (1 + A e^(B/cos θ)) (1 + C e^(D γ) + E cos² γ)"
    relative = True

    @property
    def names(self):
        """A to E."""
        return COEFFICIENTS

    @property
    def links(self):
        """Rates B and D are negative."""
        return ("identity", "-exp", "identity", "-exp", "identity")

    def value(self, coefficients, cos_view, gamma, cos_gamma):
        """F(θ, γ)."""
        return perez(coefficients, cos_view, gamma, cos_gamma)

    def starts(self):
        """Bright around the sun, as luminance; nearly uniform, as chromaticity."""
        return (
            (-1.0, math.log(0.32), 10.0, math.log(3.0), 0.45),
            (-0.3, math.log(0.2), 0.2, math.log(1.2), 0.04),
        )


class CIEShape(AbstractShape):
    """(1 + a e^{b/cos θ}) (1 + c (e^{dγ} - e^{dπ/2}) + e cos²γ): the CIE's standard skies.

    Source: CIE S 011/E:2003 (ISO 15469:2004), "Spatial distribution of daylight - CIE standard
    general sky".
    """

    name = "cie"
    formula = "F = (1 + a e^(b/cos θ)) (1 + c (e^(d γ) - e^(d π/2)) + e cos² γ)"
    relative = True

    @property
    def names(self):
        """Letters a to e."""
        return ("a", "b", "c", "d", "e")

    @property
    def links(self):
        """Rates b and d are negative."""
        return ("identity", "-exp", "identity", "-exp", "identity")

    def value(self, coefficients, cos_view, gamma, cos_gamma):
        """F(θ, γ)."""
        a, b, c, d, e = coefficients
        gradation = 1 + a * jnp.exp(b / jnp.maximum(cos_view, LEAST_COSINE))
        glow = c * (jnp.exp(d * gamma) - jnp.exp(d * (math.pi / 2)))
        return gradation * (1 + glow + e * cos_gamma**2)

    def starts(self):
        """The CIE's clear sky (type 12), then nearly uniform."""
        return (
            (-1.0, math.log(0.32), 10.0, math.log(3.0), 0.45),
            (-0.3, math.log(0.2), 0.2, math.log(1.2), 0.04),
        )


class HosekWilkieShape(AbstractShape):
    """Nine coefficients: Hosek & Wilkie (2012).

    F = (1 + A e^{B/(cos θ + 0.01)}) (C + D e^{Eγ} + F cos²γ + G χ(H, γ) + I √cos θ) with
    χ(g, γ) = (1 + cos²γ) / (1 + g² - 2 g cos γ)^{3/2}. The paper's E, for which the exponential
    falls, and H between 0 and 1. √cos θ is held below 1e-4 of cos θ, where it would be too steep.

    Source: Hosek & Wilkie (2012), "An Analytic Model for Full Spectral Sky-Dome Radiance", ACM
    Transactions on Graphics 31(4).
    """

    name = "hosek-wilkie"
    formula = (
        "F = (1 + A e^(B/(cos θ + 0.01))) (C + D e^(E γ) + F cos² γ + G χ(H, γ) + I √(cos θ)), "
        "χ(g, γ) = (1 + cos² γ) / (1 + g² - 2 g cos γ)^(3/2)"
    )
    relative = False

    @property
    def names(self):
        """A to I."""
        return tuple("ABCDEFGHI")

    @property
    def links(self):
        """Rates B and E are negative, the asymmetry H lies between 0 and 1."""
        free = "identity"
        return (free, "-exp", free, free, "-exp", free, free, "logistic", free)

    def value(self, coefficients, cos_view, gamma, cos_gamma):
        """F(θ, γ)."""
        a, b, c, d, e, f, g, h, i = coefficients
        gradation = 1 + a * jnp.exp(b * _airmass(cos_view))
        glow = d * jnp.exp(e * gamma) + f * cos_gamma**2 + g * _chi(h, cos_gamma)
        return gradation * (c + glow + i * jnp.sqrt(jnp.maximum(cos_view, LEAST_ROOT)))

    def starts(self):
        """A glow around the sun, wide or narrow; nearly uniform."""
        return (
            (-1.0, -1.2, 1.0, 3.0, 1.0, 0.5, 0.05, 1.4, 0.1),
            (-1.0, -0.5, 0.1, 6.0, 1.4, 0.0, 0.5, -0.5, 0.2),
            (-0.3, -1.2, 1.0, 0.1, 0.3, 0.1, 0.01, 1.4, 0.1),
        )


class SeriesShape(AbstractShape):
    """A sum of products gᵢ(θ) hⱼ(γ), linear in its coefficients.

    The gᵢ are 1 and e^{-r/(cos θ + 0.01)}, the light that is left over slant paths of some optical
    thicknesses r, the hⱼ powers of cos γ, exponentials e^{-kγ} and χ(g, γ) of `HosekWilkieShape`.
    As only the weights of the products are fitted, a fit is one linear least squares problem.

    Attributes:
        thicknesses: r of every gᵢ after the first.
        powers: Of cos γ.
        decays: k of the exponentials.
        asymmetries: g of the χ.
    """

    name = "series"
    formula = (
        "F = Σ w_ij g_i(θ) h_j(γ), j fastest, g = 1, e^(-r/(cos θ + 0.01)) for each r of "
        "thicknesses, h = cos^p γ for each p of powers, e^(-k γ) for each k of decays, "
        "(1 + cos² γ) / (1 + g² - 2 g cos γ)^(3/2) for each g of asymmetries"
    )
    relative = False
    linear = True

    thicknesses: tuple[float, ...] = eqx.field(static=True, default=(0.15, 0.5, 1.5))
    powers: tuple[int, ...] = eqx.field(static=True, default=(0, 1, 2))
    decays: tuple[float, ...] = eqx.field(static=True, default=(1.0, 4.0))
    asymmetries: tuple[float, ...] = eqx.field(static=True, default=(0.6,))

    @property
    def names(self):
        """w_ij."""
        around = len(self.powers) + len(self.decays) + len(self.asymmetries)
        return tuple(f"w{i}{j}" for i in range(1 + len(self.thicknesses)) for j in range(around))

    @property
    def links(self):
        """None needs one."""
        return ("identity",) * len(self.names)

    def value(self, coefficients, cos_view, gamma, cos_gamma):
        """F(θ, γ)."""
        airmass = _airmass(cos_view)
        glows = [cos_gamma**p if p else jnp.ones_like(cos_gamma) for p in self.powers]
        glows += [jnp.exp(-k * gamma) for k in self.decays]
        glows += [_chi(g, cos_gamma) for g in self.asymmetries]
        rows = coefficients.reshape(-1, len(glows), *coefficients.shape[1:])
        indicatrices = [
            jnp.stack([w * h for w, h in zip(row, glows, strict=True)]).sum(0) for row in rows
        ]
        total = indicatrices[0]
        for r, indicatrix in zip(self.thicknesses, indicatrices[1:], strict=True):
            total = total + jnp.exp(-r * airmass) * indicatrix
        return total

    def starts(self):
        """The constant."""
        return ((1.0, *(0.0,) * (len(self.names) - 1)),)

    def fixed(self):
        """What the products are made of."""
        return {
            "thicknesses": list(self.thicknesses),
            "powers": list(self.powers),
            "decays": list(self.decays),
            "asymmetries": list(self.asymmetries),
        }


_SHAPES = (PerezShape, CIEShape, HosekWilkieShape, SeriesShape)
SHAPES: dict[str, Any] = {shape.name: shape for shape in _SHAPES}


def shape_from(description: Mapping[str, Any]) -> AbstractShape:
    """The shape that `AbstractShape.describe` described.

    Raises:
        ValueError: A name that is unknown.
    """
    name = description["name"]
    if name not in SHAPES:
        raise ValueError(f"expected a distribution of {tuple(SHAPES)}; got {name!r}")
    fixed = {key: tuple(value) for key, value in description.get("fixed", {}).items()}
    return SHAPES[name](**fixed)


def _link(free, kind):
    if kind == "-exp":
        return -jnp.exp(free)
    return jax.nn.sigmoid(free) if kind == "logistic" else free


def _airmass(cos_view):
    return 1 / (jnp.maximum(cos_view, 0.0) + SOFT)


def _chi(asymmetry, cos_gamma):
    square = 1 + asymmetry**2 - 2 * asymmetry * cos_gamma
    return (1 + cos_gamma**2) / (square * jnp.sqrt(square))
