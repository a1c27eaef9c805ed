"""Altitudes over which bent rays are straight, and densities over them; see `refraction`."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import Scalar, as_float
from ..atmosphere import Refraction
from ..profile import AbstractProfile


_NEWTON = 12  # steps to an altitude


class Unbending(eqx.Module):
    """From altitudes h to those over which rays are straight, h', and back.

    Attributes:
        refraction: Refraction of the atmosphere.
        radius: Radius of the planet [m].
        top: Above it there is nothing [m].
    """

    refraction: Refraction
    radius: Scalar
    top: Scalar

    def index(self, altitude: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """Index of refraction at altitudes [m]; 1 above the top."""
        return 1 + jnp.where(altitude <= self.top, self._excess(altitude), 0.0)

    def straighten(self, altitude: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """Over which rays are straight, h' of altitudes [m].

        Outside, where nothing bends, as far above the top as before.
        """
        inside = jnp.minimum(altitude, self.top)
        excess = self._excess(inside)
        below = excess - self._excess(jnp.zeros_like(inside))
        return altitude + excess * inside + below * self.radius

    def restore(self, straight: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """Altitudes [m] of h'."""
        still = jax.tree.map(jax.lax.stop_gradient, self)
        goal = jax.lax.stop_gradient(straight)

        def nearer(_, altitude):
            return altitude + (goal - still.straighten(altitude)) * still.shrinking(altitude)

        found = jax.lax.fori_loop(0, _NEWTON, nearer, goal)
        # One more step, which knows the slopes.
        return found + (straight - self.straighten(found)) * still.shrinking(found)

    def shrinking(self, altitude: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """dh/dh' at altitudes [m]: 1/(n + r dn/dr)."""
        excess, slope = self._with_slope(altitude)
        return 1 / (1 + excess + (self.radius + altitude) * slope)

    def turning(self, altitude: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """K at altitudes [m]: how much faster the vertical turns than on a straight ray."""
        excess, slope = self._with_slope(altitude)
        steep = (self.radius + altitude) * slope / (1 + excess)
        return -steep / (1 + steep)

    def _excess(self, altitude):
        return self.refraction.refractivity * self.refraction.density(altitude)

    def _with_slope(self, altitude):
        return jax.jvp(self._excess, (altitude,), (jnp.ones_like(altitude),))


class Straightened(AbstractProfile):
    """A density over h', by which columns along straight rays are those along bent ones."""

    base: AbstractProfile
    over: Unbending
    bends: Float[Array, " knot"]

    def __call__(self, altitude):
        """Relative density [1] times dr/dr'."""
        true = self.over.restore(as_float(altitude))
        return self.base(true) * self.over.shrinking(true)

    def knots(self):
        """Of the density, and where the refraction has some of its own, over h' [m]."""
        both = self.base.knots(), self.bends
        return self.over.straighten(jnp.minimum(jnp.concatenate(both), self.over.top))


class Turning(AbstractProfile):
    """K (R'/r')² over h': what turns the vertical, as a density."""

    over: Unbending
    radius: Scalar

    def __call__(self, altitude):
        """Relative density [1]."""
        straight = as_float(altitude)
        return self.over.turning(self.over.restore(straight)) / (1 + straight / self.radius) ** 2

    def knots(self):
        """Of the refraction, over h' [m]."""
        knots = self.over.refraction.density.knots()
        return self.over.straighten(jnp.minimum(knots, self.over.top))
