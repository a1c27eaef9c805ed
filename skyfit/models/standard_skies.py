"""Relative luminance over the sky: CIE clear, overcast, intermediate, and the general sky.

A distribution has any scale; `skyfit.models.levels` sets it. Below the horizon each is held at the
horizon's limit.
"""

import abc
import math
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import as_parameter
from ..tables import read_table
from .perez import perez


SKY_TYPES = range(1, 16)  # of ISO 15469

Parameters = dict[str, Float[Array, "..."]]


class Sight(NamedTuple):
    """A line of sight and the sun; arrays that broadcast against one another.

    Attributes:
        view_zenith: Zenith angle of the view, at most π/2 [rad].
        cos_view: Cosine of that angle, 0 or more.
        gamma: Angle between view and sun [rad].
        cos_gamma: Cosine of that angle.
        sun_zenith: Zenith angle of the sun; any [rad].
    """

    view_zenith: Float[Array, "..."]
    cos_view: Float[Array, "..."]
    gamma: Float[Array, "..."]
    cos_gamma: Float[Array, "..."]
    sun_zenith: Float[Array, "..."]


def overhead(sun_zenith: Float[Array, "..."]) -> Sight:
    """The line of sight to the zenith."""
    flat = jnp.zeros_like(sun_zenith)
    return Sight(flat, flat + 1, sun_zenith, jnp.cos(sun_zenith), sun_zenith)


class AbstractLuminanceForm(eqx.Module):
    """Relative luminance over the sky."""

    @abc.abstractmethod
    def __call__(self, sight: Sight, parameters: Parameters) -> Float[Array, "..."]:
        """Luminance up to a factor.

        Args:
            sight: Where to look.
            parameters: What the sky depends on besides the sun; most distributions need none.
        """


class PerezForm(AbstractLuminanceForm):
    """(1 + A e^{B / cos θ}) (1 + C e^{D γ} + E cos²γ): Kittler's form, and Perez's.

    Attributes:
        coefficients: A to E; B below 0.
    """

    coefficients: Float[Array, "5"]

    def __call__(self, sight: Sight, parameters: Parameters) -> Float[Array, "..."]:
        """Luminance up to a factor."""
        return perez(self.coefficients, sight.cos_view, sight.gamma, sight.cos_gamma)


class Overcast(AbstractLuminanceForm):
    """(1 + 2 cos θ) / 3, by Moon & Spencer (1942); Preetham et al. (1999), equation 2."""

    def __call__(self, sight: Sight, parameters: Parameters) -> Float[Array, "..."]:
        """Luminance over the zenith's."""
        return (1 + 2 * sight.cos_view) / 3 + 0 * sight.gamma


class Intermediate(AbstractLuminanceForm):
    """The CIE's intermediate sky, after Nakamura, Oki & Hayashi (1985); CIE 110-1994.

    [1.35 (sin(3.59 α - 0.009) + 2.31) sin(2.6 h + 0.316) + α + 4.799] / 2.326
    · exp(-0.563 γ [(h - 0.008) (α + 1.059) + 0.812]), α and h being the elevations of view and sun.
    """

    def __call__(self, sight: Sight, parameters: Parameters) -> Float[Array, "..."]:
        """Luminance up to a factor."""
        view = math.pi / 2 - sight.view_zenith
        sun = math.pi / 2 - jnp.clip(sight.sun_zenith, 0.0, math.pi / 2)
        wave = 1.35 * (jnp.sin(3.59 * view - 0.009) + 2.31) * jnp.sin(2.6 * sun + 0.316)
        decay = 0.563 * ((sun - 0.008) * (view + 1.059) + 0.812)
        return (wave + view + 4.799) / 2.326 * jnp.exp(-decay * sight.gamma)


def clear_distribution(*, turbid: bool = False) -> PerezForm:
    """The CIE's clear sky; Preetham et al. (1999), equation 1.

    (0.91 + 10 e^{-3γ} + 0.45 cos²γ) (1 - e^{-0.32 / cos θ})

    Args:
        turbid: The variant for polluted air of CIE 110-1994: 0.856 + 16 e^{-3γ} + 0.3 cos²γ.
    """
    offset, *around = (0.856, 16.0, -3.0, 0.3) if turbid else (0.91, 10.0, -3.0, 0.45)
    return _perez_form(-1.0, -0.32, offset, *around)


def general_distribution(sky_type: int) -> PerezForm:
    """One of the 15 types of ISO 15469:2004 / CIE S 011, equations 1 to 3.

    (1 + a e^{b / cos θ}) (1 + c (e^{dγ} - e^{dπ/2}) + e cos²γ)
    """
    table = read_table("iso15469_general_sky")
    row = list(table["type"]).index(sky_type)
    a, b, c, d, e = (float(table[name][row]) for name in "abcde")
    return _perez_form(a, b, 1 - c * math.exp(d * math.pi / 2), c, d, e)


def _perez_form(a, b, offset, c, d, e):
    """With an offset in place of Perez's 1: the scale is free."""
    return PerezForm(as_parameter([a, b, c / offset, d, e / offset]))
