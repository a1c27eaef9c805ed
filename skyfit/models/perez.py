"""Perez's distribution over the sky, in coordinates that stay finite where its coefficients do not.

Sources: Perez, Seals & Michalsky (1993), "All-weather model for sky luminance distribution", Solar
Energy 50(3); Preetham, Shirley & Smits (1999), equations 3 and 4.
"""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .distribution import AbstractDistribution


COEFFICIENTS = ("A", "B", "C", "D", "E")

# At cos θ below this, e^{B/cos θ} is 0 in float64 for any B below -1e-6: the limit is exact there.
LEAST_COSINE = 1e-9


def perez(
    coefficients: Float[Array, "5 *#batch"],
    cos_view: Float[Array, "*#batch"],
    gamma: Float[Array, "*#batch"],
    cos_gamma: Float[Array, "*#batch"],
) -> Float[Array, "*batch"]:
    """F = (1 + A e^{B/cos θ}) (1 + C e^{D γ} + E cos²γ).

    Args:
        coefficients: A, B, C, D, E on the first axis; B below 0.
        cos_view: Cosine of the view zenith angle; at 0 and below, the horizon's limit is returned.
        gamma: Angle between view and sun [rad].
        cos_gamma: Cosine of that angle.
    """
    a, b, c, d, e = coefficients
    airmass = 1 / jnp.maximum(cos_view, LEAST_COSINE)
    gradation = 1 + a * jnp.exp(b * airmass)
    indicatrix = 1 + c * jnp.exp(d * gamma) + e * cos_gamma**2
    return gradation * indicatrix


class Perez(AbstractDistribution):
    """(1 + A e^{B/cos θ}) (1 + C e^{Dγ} + E cos²γ): Perez, Seals & Michalsky (1993).

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

    name = "perez"
    formula = "F = (1 + A e^(B/cos θ)) (1 + C e^(D γ) + E cos² γ)"
    relative = True

    least: float = eqx.field(static=True, default=1e-4)

    @property
    def names(self):
        """A to E."""
        return COEFFICIENTS

    @property
    def links(self):
        """Rates B and D are negative."""
        return ("identity", "-exp", "identity", "-exp", "identity")

    @property
    def loosened(self):
        """Words for what each free coordinate moves."""
        return (
            "A with B",
            "A and B at a given slope near the zenith",
            "C with D",
            "C, D and E at a given slope near the sun",
            "E",
        )

    def value(self, coefficients, cos_view, gamma, cos_gamma):
        """F(θ, γ)."""
        return perez(coefficients, cos_view, gamma, cos_gamma)

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
