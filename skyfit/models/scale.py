"""How bright each channel of a formula is: the zenith formulas of the paper, or a logarithm."""

import abc
import math
from collections.abc import Mapping
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import as_float, as_table
from ..errors import InputError
from .axes import SUN
from .basis import Basis, Quantities, basis_from
from .twilight import TWILIGHT_DECAY, daytime_sun, dimming


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


class AbstractScale(eqx.Module):
    """The factor of every channel, which depends on what was swept and on the sun."""

    @abc.abstractmethod
    def __call__(self, at: Quantities) -> Float[Array, "channel *batch"]:
        """Factor of every channel: the zenith's value where the distribution is relative to it.

        Args:
            at: Swept parameters, held in their ranges, and the sun's zenith angle, by name.
        """

    @abc.abstractmethod
    def describe(self) -> dict[str, Any]:
        """Names and numbers for files; `scale_from` makes the same of it."""


class LogScale(AbstractScale):
    """e to the power of a sum of numbers times terms.

    A sun lower than those of the range dims a channel at a constant rate down to the horizon, and
    below both by a decade for every 2.5°, chromaticities excepted.

    Attributes:
        numbers: Numbers of the logarithm; the unit of e to its power is cd m⁻², or
            W m⁻² sr⁻¹ nm⁻¹ for spectral bands, or none for chromaticities.
        basis: Terms of the logarithm.
        dimming: Fall of the logarithm per radian of a sun lower than the range.
        lowest_sun: Largest zenith angle of the range [rad].
        night: Whether each channel falls at night.
    """

    numbers: Float[Array, "channel term"]
    basis: Basis
    dimming: Float[Array, " channel"]
    lowest_sun: float = eqx.field(static=True)
    night: tuple[bool, ...] = eqx.field(static=True)

    def __call__(self, at):
        """Factor of every channel."""
        sun = at[SUN]
        logarithm = jnp.tensordot(self.numbers, self.basis.terms(at), 1, precision="highest")
        low = jnp.maximum(jnp.clip(sun, max=math.pi / 2) - self.lowest_sun, 0.0)
        depression = jnp.maximum(sun - max(math.pi / 2, self.lowest_sun), 0.0)
        one_each = (-1, *(1,) * sun.ndim)
        decay = TWILIGHT_DECAY * jnp.array(self.night).astype(sun.dtype).reshape(one_each)
        fall = self.dimming.reshape(one_each) * low[None] + decay * depression[None]
        return jnp.exp(logarithm - fall)

    def describe(self):
        """Numbers by channel, and the terms they belong to."""
        return {
            "kind": "logarithm",
            "formula": "e^(sum of numbers times terms)",
            "basis": self.basis.describe(),
            "numbers": np.asarray(self.numbers, float).tolist(),
            "dimming": np.asarray(self.dimming, float).tolist(),
            "lowest_sun": self.lowest_sun,
            "night": list(self.night),
        }


class PaperZenith(AbstractScale):
    """The zenith of Preetham et al. (1999): chromaticities cubic in the sun, a tangent's luminance.

    Below the horizon the zenith keeps its colour of sunset and dims by a decade for every 2.5°. A
    luminance that the formula makes negative is 0.

    Attributes:
        x: Chromaticity of the zenith.
        y: Chromaticity of the zenith.
        luminance: Luminance of the zenith.
        quantity: Name of the parameter that was swept; empty if there is none.
    """

    x: CubicZenith
    y: CubicZenith
    luminance: TangentZenith
    quantity: str = eqx.field(static=True)

    def __call__(self, at):
        """x, y and Y of the zenith."""
        sun = at[SUN]
        swept = at[self.quantity] if self.quantity else jnp.zeros_like(sun)
        day = daytime_sun(sun)
        luminance = dimming(sun) * jnp.maximum(self.luminance(swept, day), 0.0)
        return jnp.stack([self.x(swept, day), self.y(swept, day), luminance])

    def numbers(self) -> dict[str, dict[str, Any]]:
        """Numbers by channel and name."""
        return {
            "x": {"matrix": self.x.matrix},
            "y": {"matrix": self.y.matrix},
            "Y": {"linear": self.luminance.linear, "angle": self.luminance.angle},
        }

    def describe(self):
        """Numbers by channel and name, and what they belong to."""
        return {
            "kind": "paper zenith",
            "formula": "x, y = [T^2 T 1] matrix [s^3 s^2 s 1]^T; Y = (a T + b) tan chi + c T + d, "
            "chi = (p + q T) (pi - 2 s), a to d linear, p and q angle; s the sun's zenith angle",
            "quantity": self.quantity,
            "numbers": {
                name: {part: np.asarray(value, float).tolist() for part, value in parts.items()}
                for name, parts in self.numbers().items()
            },
        }


def scale_from(description: Mapping[str, Any]) -> AbstractScale:
    """The scale that `AbstractScale.describe` described.

    Raises:
        ValueError: A kind that is unknown, or numbers of the wrong shape.
        KeyError: A number is missing.
    """
    kind, numbers = description["kind"], description["numbers"]
    if kind == "paper zenith":
        x, y, linear, angle = (
            as_float(as_table(numbers[name][part], f"{name}.{part}", shape))
            for name, part, shape in (
                ("x", "matrix", (3, 4)), ("y", "matrix", (3, 4)),
                ("Y", "linear", (4,)), ("Y", "angle", (2,)),
            )
        )  # fmt: skip
        luminance = TangentZenith(linear, angle)
        return PaperZenith(CubicZenith(x), CubicZenith(y), luminance, description["quantity"])
    if kind == "logarithm":
        basis, night = basis_from(description["basis"]), tuple(description["night"])
        return LogScale(
            as_float(as_table(numbers, "numbers", (len(night), basis.num_terms))),
            basis,
            as_float(as_table(description["dimming"], "dimming", (len(night),))),
            float(description["lowest_sun"]),
            night,
        )
    raise InputError(f"expected a scale of kind 'paper zenith' or 'logarithm'; got {kind!r}")
