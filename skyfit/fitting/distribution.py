"""Distribution functions to fit: how a value spreads over the dome relative to the zenith.

A distribution is fitted through free coordinates: any real numbers, each on a scale of about 1,
that map smoothly and one to one onto coefficients within bounds. How the coefficients change with
a swept parameter is another matter: `skyfit.fitting.dependence`.
"""

import abc
import math
from typing import ClassVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..models.perez import COEFFICIENTS, perez


class AbstractDistribution(eqx.Module):
    """A function of view zenith angle and view-sun angle with some coefficients."""

    names: ClassVar[tuple[str, ...]]
    loosened: ClassVar[tuple[str, ...]]

    @abc.abstractmethod
    def relative(
        self,
        coefficients: Float[Array, "coefficient *#batch"],
        cos_view: Float[Array, "*#batch"],
        gamma: Float[Array, "*#batch"],
        sun_zenith: Float[Array, "*#batch"],
    ) -> Float[Array, "*batch"]:
        """Value over that of the zenith, F(θ, γ) / F(0, θₛ)."""

    @abc.abstractmethod
    def constrain(
        self, free: Float[Array, "*batch coefficient"]
    ) -> Float[Array, "*batch coefficient"]:
        """Coefficients, within their bounds, of free coordinates."""

    @abc.abstractmethod
    def release(
        self, coefficients: Float[Array, "*batch coefficient"]
    ) -> Float[Array, "*batch coefficient"]:
        """Free coordinates of coefficients that lie within the bounds; inverse of `constrain`."""

    @abc.abstractmethod
    def starts(self, channel: str) -> tuple[tuple[float, ...], ...]:
        """Coefficients to start a channel's fit from; the first is also the prior's centre."""


class PerezDistribution(AbstractDistribution):
    """Perez's five coefficients, in coordinates that stay finite where they do not.

    Two ways lead to infinite coefficients at a fit that hardly changes: C and E grow together while
    the constant 1 in 1 + C e^{Dγ} + E cos²γ fades beside them, and A e^B tends to -1 while B tends
    to 0, when the gradation becomes linear in 1/cos θ. Along both ways the slope of a factor at its
    origin stays what it is, so the free coordinates are

    - the slope of the gradation at the zenith, B·A e^B / (1 + A e^B), against 1/cos θ,
    - ln of what is left of -B when a falling slope is taken away,
    - the slope of the indicatrix at the sun, D·C / (1 + C), against γ,
    - ln of what is left of -D when a falling slope is taken away,
    - E / (1 + C).

    For a falling slope k, what is left is q = -D - |k| and C = |k| / q. Bounds: q is between
    `least` and 20 for both factors, so that B and D are below 0.

    Attributes:
        least: Lower bound of q. A fit that rests there says that C, or A, is not identified.
    """

    names: ClassVar[tuple[str, ...]] = COEFFICIENTS
    loosened: ClassVar[tuple[str, ...]] = (
        "A with B",
        "A and B at a given slope near the zenith",
        "C with D",
        "C, D and E at a given slope near the sun",
        "E",
    )

    least: float = eqx.field(static=True, default=1e-4)

    def relative(self, coefficients, cos_view, gamma, sun_zenith):
        """F(θ, γ) / F(0, θₛ); see `skyfit.models.perez`."""
        value = perez(coefficients, cos_view, gamma, jnp.cos(gamma))
        overhead = jnp.ones_like(sun_zenith)
        return value / perez(coefficients, overhead, sun_zenith, jnp.cos(sun_zenith))

    def constrain(self, free):
        """A to E from free coordinates."""
        slope_a, log_b, slope_c, log_d, e = jnp.moveaxis(free, -1, 0)
        bounds = math.log(self.least), math.log(_STEEPEST)
        a, b = _exponential(slope_a, jnp.exp(_squash(log_b, *bounds)))
        c, d = _exponential(slope_c, jnp.exp(_squash(log_d, *bounds)))
        return jnp.stack([a * jnp.exp(-b), b, c, d, e * (1 + c)], axis=-1)

    def release(self, coefficients):
        """Free coordinates from A to E."""
        a, b, c, d, e = jnp.moveaxis(coefficients, -1, 0)
        bounds = math.log(self.least), math.log(_STEEPEST)
        slope_a, rest_b = _slope(a * jnp.exp(b), b)
        slope_c, rest_d = _slope(c, d)
        free = [
            slope_a,
            _stretch(jnp.log(rest_b), *bounds),
            slope_c,
            _stretch(jnp.log(rest_d), *bounds),
            e / (1 + c),
        ]
        return jnp.stack(free, axis=-1)

    def starts(self, channel):
        """Coefficients to start from: a cold start, then what covers the local minima.

        The first is the start of joint fits and the prior's centre. From the next three a fit to a
        single sky all but always reaches its lowest minimum: a wide and a very narrow aureole, and
        the limits of large C and steep B.
        """
        if channel in ("x", "y"):
            return (
                (-0.3, -0.2, 0.2, -1.2, 0.04),
                (-0.3, -0.2, 5.0, -0.05, 0.3),
                (-0.35, -0.4, 0.15, -17.0, 0.12),
                (-0.3, -0.3, 1000.0, -0.25, -80.0),
                (-0.25, -0.25, 1.0, -0.1, 0.08),
                (-0.3, -0.2, 0.02, -3.5, 0.08),
            )
        return (
            (-1.0, -0.32, 10.0, -3.0, 0.45),
            (-1.2, -0.3, 50.0, -2.2, 0.0),
            (5.0, -0.3, 10.0, -2.2, 1.0),
            (-50.0, -4.5, 14.0, -2.7, -1.5),
            (-1.0, -0.3, 1000.0, -2.4, -50.0),
            (-4405.0, -10.0, 6.0, -1.6, 0.3),
        )


_STEEPEST = 20.0


def _exponential(slope, rest):
    """Weight w and rate r of (1 + w e^{r s}) / (1 + w), whose slope at s = 0 is given."""
    rate = -(rest + _falling(slope))
    share = slope / rate
    return share / (1 - share), rate


def _slope(weight, rate):
    """Inverse of `_exponential`."""
    slope = rate * weight / (1 + weight)
    return slope, -rate - _falling(slope)


def _falling(slope):
    """How much a slope falls, 0 if it rises; smooth, and never less."""
    return 0.5 * (jnp.sqrt(slope**2 + 1e-8) - slope)


def _squash(free, low, high):
    """Map the real line onto (low, high), leaving what is well inside where it is."""
    return low + jax.nn.softplus(free - low) - jax.nn.softplus(free - high)


def _stretch(value, low, high):
    """Inverse of `_squash`."""
    return low + jnp.log(jnp.expm1(value - low)) - jnp.log(-jnp.expm1(value - high))
