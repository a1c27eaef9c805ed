"""What a formula of how light spreads over the dome is: values, links, and bounds.

A distribution is a function of view zenith angle θ and view-sun angle γ with some coefficients.
Coefficients have bounds: a rate is negative, an asymmetry lies between 0 and 1. Two maps from any
real numbers keep them: links, from one number to one coefficient, for numbers that change from sky
to sky; and `constrain`, which may mix coefficients, for fits of the coefficients themselves.
"""

import abc
from typing import Any, ClassVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


LINKS = ("identity", "-exp", "logistic")


class AbstractDistribution(eqx.Module):
    """A function of view zenith angle and view-sun angle with some coefficients."""

    name: ClassVar[str]
    formula: ClassVar[str]
    # Whether a value is the scale times F(θ, γ) / F(0, θₛ), the scale being the zenith's value,
    # or the scale times F(θ, γ).
    relative: ClassVar[bool]
    # Whether F is linear in the free numbers.
    linear: ClassVar[bool] = False
    # Share of their weight that directions beyond a fit's `max_view_zenith` keep: a formula that
    # nothing bounds towards the horizon would turn negative there.
    horizon_weight: ClassVar[float] = 0.0
    # What is a large change of a free number.
    unit: ClassVar[float] = 1.0

    @property
    @abc.abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of the coefficients."""

    @property
    @abc.abstractmethod
    def links(self) -> tuple[str, ...]:
        """Link of every coefficient, one of `LINKS`."""

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
    def starts(self, channel: str) -> tuple[tuple[float, ...], ...]:
        """Coefficients to start a channel's fit from; the first is also the prior's centre."""

    def coefficients(
        self, free: Float[Array, "coefficient *batch"]
    ) -> Float[Array, "coefficient *batch"]:
        """Coefficients of free numbers, by their links."""
        return jnp.stack([_link(row, kind) for row, kind in zip(free, self.links, strict=True)])

    def free_numbers(
        self, coefficients: Float[Array, "coefficient *batch"]
    ) -> Float[Array, "coefficient *batch"]:
        """Free numbers of coefficients within the bounds; inverse of `coefficients`."""
        pairs = zip(coefficients, self.links, strict=True)
        return jnp.stack([_unlink(row, kind) for row, kind in pairs])

    @property
    def loosened(self) -> tuple[str, ...]:
        """Words for the coefficients that each coordinate of `constrain` moves."""
        return self.names

    def constrain(
        self, free: Float[Array, "*batch coefficient"]
    ) -> Float[Array, "*batch coefficient"]:
        """Coefficients of free coordinates, each on a scale of about 1."""
        return jnp.moveaxis(self.coefficients(jnp.moveaxis(free, -1, 0)), 0, -1)

    def release(
        self, coefficients: Float[Array, "*batch coefficient"]
    ) -> Float[Array, "*batch coefficient"]:
        """Free coordinates of coefficients within the bounds; inverse of `constrain`."""
        return jnp.moveaxis(self.free_numbers(jnp.moveaxis(coefficients, -1, 0)), 0, -1)

    def fixed(self) -> dict[str, Any]:
        """Numbers of the formula that are not fitted."""
        return {}

    def describe(self) -> dict[str, Any]:
        """Names and numbers for files; `distribution_from` makes the same of it."""
        return {
            "name": self.name,
            "formula": self.formula,
            "relative_to_zenith": self.relative,
            "coefficients": list(self.names),
            "links": list(self.links),
            "fixed": self.fixed(),
        }


def _link(free, kind):
    if kind == "-exp":
        return -jnp.exp(free)
    return jax.nn.sigmoid(free) if kind == "logistic" else free


def _unlink(coefficient, kind):
    if kind == "-exp":
        return jnp.log(-coefficient)
    return jnp.log(coefficient / (1 - coefficient)) if kind == "logistic" else coefficient
