"""Straight rays over a planet. Lengths in metres, angles by their cosines.

A ray starts at an altitude with the cosine μ of its zenith angle there. Two planets answer the
same questions: `Spherical` and `Flat`. Nothing forms the difference of a radius and an altitude:
in float32 that would be off by half a metre.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .._typing import Scalar
from .quadrature import safe_sqrt


class Ray(eqx.Module):
    """A line of sight where it starts.

    Attributes:
        altitude: [m].
        mu: Cosine of its zenith angle.
        sine: Sine of it; kept beside the cosine so that slopes at the zenith are right.
    """

    altitude: Float[Array, "*batch"]
    mu: Float[Array, "*batch"]
    sine: Float[Array, "*batch"]


class SunDirection(eqx.Module):
    """The sun as seen from a point on a ray, in the frame of that ray.

    Attributes:
        up: Cosine of the sun's zenith angle.
        ahead: Component along the ray's horizontal direction.
        aside: Component across it; the same all along a ray.
    """

    up: Float[Array, "*batch"]
    ahead: Float[Array, "*batch"]
    aside: Float[Array, "*batch"]

    @classmethod
    def from_angles(
        cls, sun_zenith: Float[Array, "*#batch"], cos_azimuth: Float[Array, "*#batch"]
    ) -> "SunDirection":
        """From the sun's zenith angle [rad] and the cosine of the relative azimuth."""
        sine = jnp.sin(sun_zenith)
        aside = sine * safe_sqrt(1 - cos_azimuth**2)
        return cls(jnp.cos(sun_zenith) + 0 * aside, sine * cos_azimuth, aside)

    def zenith(self) -> Float[Array, "*batch"]:
        """Zenith angle of the sun [rad], 0 or more."""
        return jnp.arctan2(self._horizontal(), self.up)

    def cos_azimuth(self) -> Float[Array, "*batch"]:
        """Cosine of the azimuth between ray and sun; 1 where the sun is overhead."""
        horizontal = self._horizontal()
        overhead = horizontal < 1e-6
        cosine = self.ahead / jnp.where(overhead, 1.0, horizontal)
        return jnp.clip(jnp.where(overhead, 1.0, cosine), -1.0, 1.0)

    def _horizontal(self):
        return safe_sqrt(self.ahead**2 + self.aside**2)


_OFFSET = 100.0  # m, of distances to the horizon


class AbstractPlanet(eqx.Module):
    """What a simulator asks of a planet's shape."""

    top: eqx.AbstractVar[Scalar]

    @abc.abstractmethod
    def horizon(self, altitude: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """Cosine of the zenith angle of the horizon seen from an altitude [m]."""

    @abc.abstractmethod
    def stretch(self, altitude: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """Altitude [m] to a coordinate in [0, 1] in which columns are smooth."""

    @abc.abstractmethod
    def unstretch(self, share: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """Inverse of `stretch`."""

    @abc.abstractmethod
    def to_top(self, altitude, mu) -> Float[Array, "*batch"]:
        """Distance to the top of the atmosphere, from inside it, past the ground if need be [m]."""

    @abc.abstractmethod
    def to_ground(self, altitude, mu) -> Float[Array, "*batch"]:
        """Distance to the ground, for rays below the horizon [m]."""

    @abc.abstractmethod
    def lowest(self, altitude, mu) -> tuple[Float[Array, "*batch"], Float[Array, "*batch"]]:
        """Distance to and altitude of the lowest point of a ray that misses the ground [m]."""

    @abc.abstractmethod
    def advance(self, altitude, mu, distance) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        """Altitude [m] and cosine of the zenith angle after a distance [m]; none are negative."""

    @abc.abstractmethod
    def mu_at_level(self, altitude, mu, level) -> Float[Array, "*batch"]:
        """Absolute cosine of the zenith angle where a ray crosses a level; 0 where it does not."""

    @abc.abstractmethod
    def sine_at_level(self, ray: Ray, level) -> Float[Array, "*batch"]:
        """Sine of the zenith angle where a ray crosses a level; 1 where it does not."""

    @abc.abstractmethod
    def to_level(self, altitude, mu, level) -> Float[Array, "*batch"]:
        """Distance outwards to where a ray crosses a level [m]; see `mu_at_level`."""

    @abc.abstractmethod
    def turn_sun(self, sun: SunDirection, ray: Ray, distance) -> SunDirection:
        """The sun seen after a distance, since the vertical turns on the way."""

    @abc.abstractmethod
    def shadow(self, sun: SunDirection, ray: Ray) -> tuple[Float[Array, "*b"], ...]:
        """Distances at which a ray enters and leaves the planet's shadow; equal if it does not."""

    @abc.abstractmethod
    def enter(self, ray: Ray, sun: SunDirection) -> tuple[Ray, SunDirection, Bool[Array, "*b"]]:
        """Where a ray from anywhere enters the atmosphere, the sun there, and whether it does."""


class Spherical(AbstractPlanet):
    """A sphere; see `AbstractPlanet` for the questions it answers."""

    radius: Scalar
    top: Scalar

    def horizon(self, altitude):  # noqa: D102
        return -self._to_horizon(altitude) / (self.radius + altitude)

    def stretch(self, altitude):  # noqa: D102
        here, top = self._to_horizon(altitude), self._to_horizon(self.top)
        return (here - _OFFSET) / (top - _OFFSET)

    def unstretch(self, share):  # noqa: D102
        here = _OFFSET + share * (self._to_horizon(self.top) - _OFFSET)
        excess = (here - _OFFSET) * (here + _OFFSET)
        return excess / (jnp.sqrt(self.radius**2 + excess) + self.radius)

    def to_top(self, altitude, mu):  # noqa: D102
        return self._to_shell(altitude, mu, self.top)

    def to_ground(self, altitude, mu):  # noqa: D102
        b = (self.radius + altitude) * -mu
        root = safe_sqrt(b**2 - self._excess(altitude))
        return self._excess(altitude) / jnp.where(b + root > 0, b + root, 1.0)

    def lowest(self, altitude, mu):  # noqa: D102
        r = self.radius + altitude
        distance = -r * mu
        excess = jnp.maximum(self._excess(altitude) - distance**2, 0.0)
        return distance, excess / (jnp.sqrt(self.radius**2 + excess) + self.radius)

    def advance(self, altitude, mu, distance):  # noqa: D102
        r = self.radius + altitude
        excess = distance * (distance + 2 * r * mu) + self._excess(altitude)
        excess = jnp.maximum(excess, 0.0)
        new = jnp.sqrt(self.radius**2 + excess)
        return excess / (new + self.radius), (r * mu + distance) / new

    def mu_at_level(self, altitude, mu, level):  # noqa: D102
        # 1 - (r/r')² (1 - μ²), with the difference of squares as a product.
        rise = (level - altitude) * (2 * self.radius + level + altitude)
        r = self.radius + altitude
        return safe_sqrt((r**2 * mu**2 + rise) / (self.radius + level) ** 2)

    def to_level(self, altitude, mu, level):  # noqa: D102
        crossing = self.mu_at_level(altitude, mu, level)
        return (self.radius + level) * crossing - (self.radius + altitude) * mu

    def sine_at_level(self, ray, level):  # noqa: D102
        ratio = (self.radius + ray.altitude) / (self.radius + level)
        return jnp.minimum(ratio * ray.sine, 1.0)

    def turn_sun(self, sun, ray, distance):  # noqa: D102
        r = self.radius + ray.altitude
        inverse = 1 / (self.radius + self.advance(ray.altitude, ray.mu, distance)[0])
        cosine = (r + distance * ray.mu) * inverse
        sine = distance * ray.sine * inverse
        up = cosine * sun.up + sine * sun.ahead
        ahead = cosine * sun.ahead - sine * sun.up
        return SunDirection(up, ahead, sun.aside + 0 * up)

    def shadow(self, sun, ray):  # noqa: D102
        # The shadow is a cylinder about the sun's axis, on the side away from the sun.
        r = self.radius + ray.altitude
        cos_gamma = ray.mu * sun.up + ray.sine * sun.ahead
        a = jnp.maximum(1 - cos_gamma**2, 1e-9)
        b = r * (ray.mu - sun.up * cos_gamma)
        c = self._excess(ray.altitude) - (r * sun.up) ** 2
        discriminant = b**2 - a * c
        root = safe_sqrt(discriminant)
        enter, leave = (-b - root) / a, (-b + root) / a
        # Behind the planet's centre plane: r up + t cosγ < 0.
        away = jnp.where(jnp.abs(cos_gamma) > 1e-9, cos_gamma, 1e-9)
        plane = -r * sun.up / away
        enter = jnp.where(away < 0, jnp.maximum(enter, plane), enter)
        leave = jnp.where(away > 0, jnp.minimum(leave, plane), leave)
        enter = jnp.maximum(enter, 0.0)
        shaded = (discriminant > 0) & (leave > enter)
        return jnp.where(shaded, enter, jnp.inf), jnp.where(shaded, leave, jnp.inf)

    def enter(self, ray, sun):  # noqa: D102
        outside = ray.altitude > self.top
        b = (self.radius + ray.altitude) * ray.mu
        c = (ray.altitude - self.top) * (2 * self.radius + self.top + ray.altitude)
        discriminant = b**2 - c
        meets = (discriminant > 0) & (b < 0)
        gap = jnp.where(outside & meets, -b - safe_sqrt(discriminant), 0.0)
        turned = self.turn_sun(sun, ray, gap)
        # A ray that meets nothing is sent up from the top, where there is nothing left to see.
        entered = Ray(
            jnp.minimum(ray.altitude, self.top),
            jnp.where(
                outside,
                jnp.where(meets, -safe_sqrt(discriminant) / (self.radius + self.top), 1.0),
                ray.mu,
            ),
            jnp.where(outside, jnp.where(meets, self.sine_at_level(ray, self.top), 0.0), ray.sine),
        )
        return entered, turned, ~outside | meets

    def _to_horizon(self, altitude):
        """Distance to the horizon [m]; the offset keeps its slope at the ground finite.

        It lowers the horizon there by 1.6e-5 rad, a tenth of a millimetre per kilometre.
        """
        return jnp.sqrt(self._excess(altitude) + _OFFSET**2)

    def _excess(self, altitude):
        """r² - R² [m²]."""
        return altitude * (2 * self.radius + altitude)

    def _to_shell(self, altitude, mu, shell):
        b = (self.radius + altitude) * mu
        c = (shell - altitude) * (2 * self.radius + shell + altitude)
        root = safe_sqrt(b**2 + c)
        upward = b > 0
        return jnp.where(upward, c / jnp.where(upward, root + b, 1.0), root - b)


class Flat(AbstractPlanet):
    """A plane without end; see `AbstractPlanet` for the questions it answers."""

    top: Scalar

    def horizon(self, altitude):  # noqa: D102
        return jnp.zeros_like(altitude)

    def stretch(self, altitude):  # noqa: D102
        # Square root, as on a sphere near the ground, with a finite slope at 0.
        return jnp.sqrt(altitude / self.top * 1.02 + 1e-4) - 0.01

    def unstretch(self, share):  # noqa: D102
        return self.top * share * (share + 0.02) / 1.02

    def to_top(self, altitude, mu):  # noqa: D102
        return (self.top - altitude) / jnp.maximum(mu, 1e-9)

    def to_ground(self, altitude, mu):  # noqa: D102
        return altitude / jnp.maximum(-mu, 1e-9)

    def lowest(self, altitude, mu):  # noqa: D102
        return 0 * mu + 0 * altitude, altitude + 0 * mu

    def advance(self, altitude, mu, distance):  # noqa: D102
        return jnp.maximum(altitude + mu * distance, 0.0), mu + 0 * distance

    def mu_at_level(self, altitude, mu, level):  # noqa: D102
        return jnp.abs(mu) + 0 * level

    def to_level(self, altitude, mu, level):  # noqa: D102
        return (level - altitude) / jnp.maximum(mu, 1e-9)

    def sine_at_level(self, ray, level):  # noqa: D102
        return ray.sine + 0 * level

    def turn_sun(self, sun, ray, distance):  # noqa: D102
        still = 0 * distance
        return SunDirection(sun.up + still, sun.ahead + still, sun.aside + still)

    def shadow(self, sun, ray):  # noqa: D102
        night = jnp.where(sun.up > 0, jnp.inf, 0.0) + 0 * ray.mu
        return night, jnp.full_like(night, jnp.inf)

    def enter(self, ray, sun):  # noqa: D102
        outside = ray.altitude > self.top
        entered = Ray(jnp.minimum(ray.altitude, self.top), ray.mu, ray.sine)
        return entered, sun, ~outside | (ray.mu < 0)
