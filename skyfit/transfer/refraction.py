"""Refraction: rays that bend, made straight.

Where the index n depends on altitude alone, n r sin θ is the same all along a ray (Bouguer's law).
Over r' = n r in place of r rays are therefore straight, with the same zenith angles θ at every
point, and a stretch ds of a ray is ds' dr/dr' long. So an atmosphere whose densities are taken
over h' = n r - n₀ R and multiplied by dr/dr', on a planet of radius n₀ R, has the true columns
along straight rays, and all that is written for straight rays holds.

What straight rays do not tell is where in the sky the sun stands. Along a ray the vertical turns
by dφ = dφ' (1 + K), K = -(r/n dn/dr) / (1 + r/n dn/dr): the excess ∫ K dφ' is how much the ray has
been bent. It is n r sin θ / R'² times the column of a matter of density K (R'/r')², and known to
`SunColumns`. The sun stands where it would without air, turned by the whole angle φ; light from
there arrives from nearer to the zenith (`Refracting.appear`), and spread: a ring of rays about the
sun's axis has the irradiance n² d(cos apparent)/d(cos true).

Radiance is radiance over n² here (which bending leaves alone), and irradiance too.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..atmosphere import Atmosphere
from .columns import SunColumns, sun_columns
from .geometry import AbstractPlanet, Ray, Spherical, SunDirection
from .medium import make_medium
from .quadrature import even_stencil
from .unbending import Straightened, Turning, Unbending


_ROWS, _ANGLES = 40, 112  # of the table of bending: altitudes, zenith angles of the sun
_NARROW, _WIDE = 0.01, 1.85  # rad above the horizon: half as fine as at it; where the table ends
_NEWTON = 12  # steps; what is found changes by its square
_LOOKS, _HALVINGS = 48, 44  # for the shadow's edges on a ray


class Refracting(Spherical):
    """A sphere over whose altitudes h' rays are straight, and what it takes to find the sun.

    Attributes:
        bending: Columns of `Turning`.
        by_sun: How much light is bent up to each altitude, over the sine of the true zenith angle
            of the sun; over what that angle is less than the horizon's.
        at_horizon: How much light is bent that just passes the ground [rad].
    """

    bending: SunColumns
    by_sun: Float[Array, "row angle"]
    at_horizon: Float[Array, " row"]

    def turn_sun(self, sun, ray, distance):
        """The sun after a distance along the bent ray; see `AbstractPlanet`."""
        turned = Spherical.turn_sun(self, sun, ray, distance)
        bent = self._bent(ray, distance)
        cosine, sine = jnp.cos(bent), jnp.sin(bent)
        up = cosine * turned.up + sine * turned.ahead
        return SunDirection(up, cosine * turned.ahead - sine * turned.up, turned.aside)

    def appear(
        self, sun: SunDirection, altitude: Float[Array, "*#b"]
    ) -> tuple[SunDirection, Float[Array, "*b"]]:
        """Where light of the sun comes from at altitudes, and its irradiance over n² E.

        Below the horizon light comes from nowhere: the sun is then as far below the apparent
        horizon as it is below the true one.
        """
        true = sun.zenith()
        above = self._above_horizon(true, altitude)
        by_sun, rate = self._by_sun(altitude, above)
        up, sine = sun.up, jnp.sin(true)
        # A sine of at most 0.02, to rounding.
        angle = by_sun * sine
        sinc = by_sun * (1 - angle**2 / 6 * (1 - angle**2 / 20))
        cosine = jnp.cos(angle)
        narrower = cosine - up * sinc
        spread = narrower * (1 - by_sun * up + rate * sine)
        seen = SunDirection(up * cosine + sine**2 * sinc, sun.ahead * narrower,
                            sun.aside * narrower)  # fmt: skip
        return seen, jnp.maximum(spread, 0.0)

    def shadow(self, sun, ray):
        """Where a ray is in the shadow, by halving; see `AbstractPlanet`."""
        strikes = ray.mu < self.horizon(ray.altitude)
        end = jnp.where(
            strikes,
            self.to_ground(ray.altitude, jnp.where(strikes, ray.mu, -1.0)),
            self.to_top(ray.altitude, ray.mu),
        )

        def lit(planet, sun, ray, distance):
            here = planet.turn_sun(sun, ray, distance)
            altitude = planet.advance(ray.altitude, ray.mu, distance)[0]
            return planet._above_horizon(here.zenith(), altitude)

        planet, still_sun, still_ray, still_end = jax.tree.map(
            jax.lax.stop_gradient, (self, sun, ray, end)
        )
        looks = still_end * jnp.linspace(0, 1, _LOOKS, dtype=end.dtype)
        seen = lit(planet, still_sun, still_ray, looks)
        darkest = jnp.argmin(seen)
        # In the dark first, so that both edges are where light begins.
        dark = jnp.stack([looks[darkest]] * 2)
        bright = jnp.stack([looks[0], looks[-1]])
        begins = jnp.stack([seen[0], seen[-1]]) > 0

        def halve(_, ends):
            dark, bright = ends
            middle = 0.5 * (dark + bright)
            shines = lit(planet, still_sun, still_ray, middle) > 0
            return jnp.where(shines, dark, middle), jnp.where(shines, middle, bright)

        edge, _ = jax.lax.fori_loop(0, _HALVINGS, halve, (dark, bright))
        _, rate = jax.jvp(
            lambda t: lit(planet, still_sun, still_ray, t), (edge,), (jnp.ones_like(edge),)
        )
        # One step of Newton's, which knows the slopes, where the edge is sharp.
        sharp = jnp.abs(rate) > 1e-12
        step = lit(self, sun, ray, edge) / jnp.where(sharp, rate, 1.0)
        edge = jnp.clip(edge - jnp.where(sharp, step, 0.0), 0.0, end)
        shaded = seen[darkest] < 0
        enter = jnp.where(begins[0], edge[0], 0.0)
        leave = jnp.where(begins[1], edge[1], jnp.inf)
        return jnp.where(shaded, enter, jnp.inf), jnp.where(shaded, leave, jnp.inf)

    def _above_horizon(self, true, altitude):
        """How far the sun is above the lowest true place from which it is seen [rad]."""
        first, weights = self._rows(altitude)
        bent = sum(w * _at(self.at_horizon, first + k) for k, w in enumerate(weights))
        return _zenith_of(self.horizon(altitude)) + bent - true

    def _by_sun(self, altitude, above):
        """Bending over the sine of the true zenith angle, and how it changes with `above`."""
        row, across = self._rows(altitude)

        def look(above):
            held = jnp.clip(above, 0.0, _WIDE)
            position = jnp.log1p(held / _NARROW) / float(np.log1p(_WIDE / _NARROW))
            return even_stencil(position * (_ANGLES - 1), _ANGLES, 4)

        (column, along), (_, slopes) = jax.jvp(look, (above,), (jnp.ones_like(above),))
        first = row * _ANGLES + column
        steps = np.arange(4)[:, None] * _ANGLES + np.arange(4)[None]
        near = _at(
            self.by_sun.ravel(),
            jnp.reshape(first, (*first.shape, 1, 1)) + steps.reshape((1,) * first.ndim + (4, 4)),
        )
        near = jnp.sum(near * _last(across)[..., None], axis=-2)
        return jnp.sum(near * _last(along), axis=-1), jnp.sum(near * _last(slopes), axis=-1)

    def _rows(self, altitude):
        return even_stencil(self.stretch(jnp.minimum(altitude, self.top)) * (_ROWS - 1), _ROWS, 4)

    def _bent(self, ray, distance):
        """By how much a ray has been bent after a distance [rad]."""
        altitude, mu = self.advance(ray.altitude, ray.mu, distance)
        along = (self.radius + ray.altitude) * ray.sine / self.radius**2
        falls = ray.mu < 0
        _, lowest = self.lowest(ray.altitude, jnp.where(falls, ray.mu, 0.0))
        # Both at once: less to compile.
        begin = jnp.stack([ray.altitude, lowest]), jnp.stack([ray.mu, jnp.zeros_like(lowest)])
        start, under = self._column(*begin)
        end = self._column(altitude, mu)
        passed = jnp.where(mu < 0, end - start, 2 * under - start - end)
        return along * jnp.where(falls, passed, start - end)

    def _column(self, altitude, mu):
        """Of what turns the vertical, outwards along a ray [m]."""
        return self.bending(altitude, jnp.abs(mu))[0][..., 0]


def apparent(
    planet: AbstractPlanet, sun: SunDirection, altitude: Float[Array, "*#b"]
) -> tuple[SunDirection, Float[Array, "*b"] | None]:
    """Where light of the sun comes from at altitudes, and how far it is spread; None if not."""
    return planet.appear(sun, altitude) if isinstance(planet, Refracting) else (sun, None)


def cos_to_sun(mu: Float[Array, "*#b"], sine: Float[Array, "*#b"], sun: SunDirection) -> Array:
    """Cosine of the angle between a direction, in whose frame the sun is, and the sun."""
    return 1 - 0.5 * ((mu - sun.up) ** 2 + (sine - sun.ahead) ** 2 + sun.aside**2)


def cos_at_start(planet: AbstractPlanet, ray: Ray, sun: SunDirection) -> Array:
    """Cosine of the angle between a line of sight and the apparent sun at its start."""
    seen, _ = apparent(planet, sun, ray.altitude + 0 * sun.up)
    return cos_to_sun(ray.mu, ray.sine, seen)


def straightened(atmosphere: Atmosphere, angles: int) -> tuple[Atmosphere, Refracting, Unbending]:
    """An atmosphere in which rays are straight, its planet, and the way there.

    Args:
        atmosphere: One with refraction.
        angles: Angles of the table of columns.
    """
    assert atmosphere.refraction is not None
    over = Unbending(atmosphere.refraction, atmosphere.planet_radius, atmosphere.top_altitude)
    none = jnp.zeros_like(over.top)
    radius, top = over.index(none) * over.radius, over.straighten(over.top)
    # Knots of the refraction that no density has; a knot twice would look like a strong kink.
    knots, others = atmosphere.refraction.density.knots(), atmosphere.knots()
    known = jnp.any(knots[:, None] == others[None], axis=1)
    own = jnp.where(known, over.top, knots)
    constituents = tuple(
        eqx.tree_at(lambda c: c.density, one, Straightened(one.density, over, bends))
        for one, bends in zip(
            atmosphere.constituents, [own] + [own[:0]] * len(atmosphere.constituents), strict=False
        )
    )
    straight = eqx.tree_at(
        lambda a: (a.constituents, a.planet_radius, a.top_altitude), atmosphere,
        (constituents, radius, top),
    )  # fmt: skip
    turning = eqx.tree_at(lambda c: c.density, constituents[0], Turning(over, radius))
    matter = eqx.tree_at(lambda a: a.constituents, straight, (turning,))
    plain = Spherical(radius, top)
    columns = sun_columns(make_medium(matter, plain), angles)
    return straight, Refracting(radius, top, columns, *_tables(plain, columns)), over


def _tables(
    planet: Spherical, columns: SunColumns
) -> tuple[Float[Array, "row angle"], Float[Array, " row"]]:
    """`by_sun` and `at_horizon` of `Refracting`."""

    def bent(columns, altitude, zenith):
        """From a point to space, by the apparent zenith angle."""
        mu = jnp.cos(zenith)
        rising = columns(altitude, jnp.abs(mu))[0][..., 0]
        falls = mu < 0
        _, lowest = planet.lowest(altitude, jnp.where(falls, mu, 0.0))
        under = columns(lowest, jnp.zeros_like(lowest))[0][..., 0]
        column = jnp.where(falls, 2 * under - rising, rising)
        return (planet.radius + altitude) * jnp.sin(zenith) / planet.radius**2 * column

    dtype = planet.radius.dtype
    altitude = planet.unstretch(jnp.linspace(0, 1, _ROWS, dtype=dtype))
    altitude = jnp.clip(altitude, 0.0, planet.top)
    lowest = _zenith_of(planet.horizon(altitude))
    at_horizon = bent(columns, altitude, lowest)
    share = np.linspace(0, 1, _ANGLES)
    above = jnp.asarray(_NARROW * np.expm1(share * np.log1p(_WIDE / _NARROW)), dtype)
    true = (lowest + at_horizon)[:, None] - above[None]
    wide = jnp.broadcast_to(altitude[:, None], true.shape)
    still = jax.tree.map(jax.lax.stop_gradient, (columns, wide, true, lowest[:, None]))

    def rate(found):
        columns, altitude, true, _ = still
        return jax.jvp(
            lambda z: bent(columns, altitude, z), (true - found,), (jnp.ones_like(true),)
        )

    def nearer(_, found):
        here, slope = rate(found)
        # Never farther down than the horizon.
        return jnp.maximum(found + (here - found) / (1 + slope), still[2] - still[3])

    start = jnp.maximum(still[2] - still[3], 0.0)
    found = jax.lax.fori_loop(0, _NEWTON, nearer, start)
    found = found + (bent(columns, wide, true - found) - found) / (1 + rate(found)[1])
    sine = jnp.sin(true)
    some = jnp.abs(sine) > 1e-9
    return jnp.where(some, found, 0.0) / jnp.where(some, sine, 1.0), at_horizon


def _zenith_of(horizon):
    """Zenith angle of a horizon by its cosine, which is small [rad]."""
    return np.pi / 2 - jnp.arcsin(horizon)


def _last(parts):
    return jnp.stack(parts, axis=-1)


def _at(table, index):
    return table.at[index].get(mode="promise_in_bounds", wrap_negative_indices=False)
