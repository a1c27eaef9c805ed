"""Formulas of the dome: the CIE's form, Hosek-Wilkie's, a series; and all of them by name."""

import math
from collections.abc import Mapping
from typing import Any

import equinox as eqx
import jax.numpy as jnp

from ..errors import InputError
from .distribution import AbstractDistribution
from .perez import LEAST_COSINE, Perez


# The square root of cos θ is infinitely steep at the horizon: it is held below this cosine.
LEAST_ROOT = 1e-4
SOFT = 0.01  # added to cos θ by Hosek and Wilkie, so that the airmass ends at 100


class CIE(AbstractDistribution):
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

    def starts(self, channel):
        """The CIE's clear sky (type 12), then nearly uniform."""
        return ((-1.0, -0.32, 10.0, -3.0, 0.45), (-0.3, -0.2, 0.2, -1.2, 0.04))


class HosekWilkie(AbstractDistribution):
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
    horizon_weight = 0.05
    # Nine numbers trade more than five: at 1, one of them runs away where there are no skies.
    unit = 0.5

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

    def starts(self, channel):
        """A glow around the sun, wide or narrow; nearly uniform."""
        return (
            (-1.0, -0.3012, 1.0, 3.0, -2.718, 0.5, 0.05, 0.8022, 0.1),
            (-1.0, -0.6065, 0.1, 6.0, -4.055, 0.0, 0.5, 0.3775, 0.2),
            (-0.3, -0.3012, 1.0, 0.1, -1.35, 0.1, 0.01, 0.8022, 0.1),
        )


class Series(AbstractDistribution):
    """A sum of products gᵢ(θ) hⱼ(γ), linear in its coefficients.

    The gᵢ are 1 and e^{-r/(cos θ + 0.01)}, the light that is left over slant paths of some optical
    thicknesses r, the hⱼ powers of cos γ, exponentials e^{-kγ} and χ(g, γ) of `HosekWilkie`.
    As only the weights of the products are fitted, a fit is one linear least squares problem.

    Attributes:
        thicknesses: Optical thickness r of every gᵢ after the first.
        powers: Powers of cos γ.
        decays: Decay k of each exponential.
        asymmetries: Asymmetry g of each χ.
    """

    name = "series"
    formula = (
        "F = Σ w_ij g_i(θ) h_j(γ), j fastest, g = 1, e^(-r/(cos θ + 0.01)) for each r of "
        "thicknesses, h = cos^p γ for each p of powers, e^(-k γ) for each k of decays, "
        "(1 + cos² γ) / (1 + g² - 2 g cos γ)^(3/2) for each g of asymmetries"
    )
    relative = False
    horizon_weight = 0.05
    linear = True
    unit = 10.0

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

    def starts(self, channel):
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


DISTRIBUTIONS: dict[str, Any] = {one.name: one for one in (Perez, CIE, HosekWilkie, Series)}


def distribution_from(description: Mapping[str, Any]) -> AbstractDistribution:
    """The distribution that `AbstractDistribution.describe` described.

    Raises:
        ValueError: A name that is unknown.
    """
    name = description["name"]
    if name not in DISTRIBUTIONS:
        raise InputError(f"expected a distribution of {tuple(DISTRIBUTIONS)}; got {name!r}")
    fixed = {key: tuple(value) for key, value in description.get("fixed", {}).items()}
    return DISTRIBUTIONS[name](**fixed)


def _airmass(cos_view):
    return 1 / (jnp.maximum(cos_view, 0.0) + SOFT)


def _chi(asymmetry, cos_gamma):
    square = 1 + asymmetry**2 - 2 * asymmetry * cos_gamma
    return (1 + cos_gamma**2) / (square * jnp.sqrt(square))
