"""The compiled program of the simulator: every order, for every sun in turn."""

from functools import partial
from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import Scalar
from ..angles import cos_view_sun_angle
from ..atmosphere import Atmosphere
from .columns import SunColumns, sun_columns
from .compiling import compile_quickly
from .field import first_field, make_grid
from .geometry import AbstractPlanet, Flat, Ray, Spherical, SunDirection
from .medium import Medium, make_medium
from .optics import Optics
from .orders import gather, next_field, scatter, straight_beam
from .paths import Kind
from .quality import ALL_SUNS_DEG, LOW_SUN_OFFSETS_DEG, TWILIGHT_OFFSETS_DEG, Quality
from .refraction import Refracting, cos_at_start, straightened
from .sight import Sight, look_along
from .single import dimming, first_order
from .solve import sum_of_orders
from .views import Views


Suns = Literal["near", "low", "twilight", "all"]
"""For which suns the field is kept; see `quality`."""


@compile_quickly
def orders_under_suns(
    atmosphere: Atmosphere,
    views: Views,
    *,
    count: int | None,
    flat: bool,
    quality: Quality,
    kind: Kind,
    suns: Suns,
    split: bool,
) -> tuple[Float[Array, "order sun ray out wavelength"], Float[Array, "1 sun ray out wavelength"]]:
    """Orders one by one, and all that were asked for together; for every sun in turn."""
    radius, top = atmosphere.planet_radius, atmosphere.top_altitude
    planet = Flat(top) if flat else Spherical(radius, top)
    into_air = 1.0
    if atmosphere.refraction is not None and not flat:
        atmosphere, planet, air = straightened(atmosphere, quality.column_angles)
        into_air = air.index(views.altitude)[None, :, :, None, None] ** 2
        straight = air.straighten(views.altitude)
        views = eqx.tree_at(lambda v: v.altitude, views, straight)
    exact = Optics.cut(atmosphere, quality.first.degree, quality.sharpest)
    # All orders are summed where what goes straight on counts as not scattered.
    rough = Optics.cut(atmosphere, quality.higher.degree, quality.sharpest).scaled()
    optics = exact.beside(rough.up_to(quality.first.degree)) if count is None else exact
    medium = make_medium(atmosphere, planet, optics)
    columns = sun_columns(medium, quality.column_angles)
    width = atmosphere.wavelengths.size

    def under_one_sun(view: Views):
        eyes = _eyes(planet, view, kind)
        first, again, sights = _first(medium, columns, view, eyes, quality, kind, split)
        if count == 1:
            return first[None], first[None]
        nodes = _suns(view.sun, suns, flat, quality)
        grid = make_grid(medium, nodes, quality.levels, quality.first)
        field = first_field(columns, grid, quality)

        def look(source):
            def along(ray, sun, meets, sight):
                return jnp.where(meets, gather(medium, grid, source, ray, sun, sight), 0.0)

            return jax.vmap(along)(*eyes, sights)

        if count is None:
            scaled = eqx.tree_at(lambda m: m.optics, medium, rough)
            higher = make_grid(scaled, nodes, quality.levels, quality.higher)
            once = jax.tree.map(lambda a: a[..., width:], field)

            def further(air, field):
                medium, grid = air
                return next_field(medium, grid, scatter(medium.optics, field), quality)

            once = once.up_to(quality.higher)
            more = sum_of_orders(further, (scaled, higher), once, quality.tolerance)
            light = look(scatter(optics, field.plus(more, width)))
            second = light[..., :width] + again[..., :width]
            total = first[..., width:] + light[..., width:]
            return jnp.stack([first[..., :width], second]), total[None]

        second = look(scatter(optics, field)) + again
        orders = [first, second]
        # Light once scattered has no peaks any more: of what it meets nothing need be cut off.
        whole = exact.whole()
        higher = make_grid(medium, nodes, quality.levels, quality.higher)
        field = field.up_to(quality.higher)
        for times in range(1, count - 1):
            beam = straight_beam(columns, grid, field, times)
            source = scatter(whole, field).plus(scatter(exact, beam))
            field = next_field(medium, higher, source, quality)
            beam = straight_beam(columns, grid, field, times + 1)
            orders.append(look(scatter(whole, field).plus(scatter(exact, beam))))
        orders = jnp.stack(orders)
        return orders, jnp.sum(orders, axis=0, keepdims=True)

    light = jax.lax.map(under_one_sun, views)  # [sun, order, ray, out, wavelength] both
    sunshine = atmosphere.solar_irradiance[None, None, None, None, :] * into_air
    by_order, total = (jnp.swapaxes(each, 0, 1) * sunshine for each in light)
    return by_order, total


def _suns(sun: Scalar, suns: Suns, flat: bool, quality: Quality) -> Float[Array, " sun"]:
    """Zenith angles of the suns under which the field is kept [rad]."""
    if flat:
        return sun[None]
    if suns == "all":
        return jnp.radians(jnp.asarray(ALL_SUNS_DEG, sun.dtype))
    offsets = {
        "near": quality.sun_offsets_deg,
        "low": max(quality.sun_offsets_deg, LOW_SUN_OFFSETS_DEG, key=len),
        "twilight": TWILIGHT_OFFSETS_DEG,
    }
    return sun + jnp.radians(jnp.asarray(offsets[suns], sun.dtype))


def _eyes(planet: AbstractPlanet, view: Views, kind: Kind):
    """Lines of sight where they enter the atmosphere, the sun of each azimuth, and if they do."""
    mu, sine = jnp.cos(view.view), jnp.sin(view.view)
    if kind == "rising":
        mu = jnp.maximum(mu, 0.0)

    def one(altitude, mu, sine, azimuth):
        ray = Ray(altitude, mu, sine)
        sun = SunDirection.from_angles(view.sun, jnp.cos(azimuth))
        if kind == "rising":
            return ray, sun, jnp.asarray(True)
        return planet.enter(ray, sun)

    return jax.vmap(one)(view.altitude, mu, sine, view.azimuth)


def _first(
    medium: Medium,
    columns: SunColumns,
    view: Views,
    eyes: tuple[Ray, SunDirection, Array],
    quality: Quality,
    kind: Kind,
    split: bool,
) -> tuple[Float[Array, "ray out channel"], Float[Array, "ray out channel"], Sight]:
    """The first order along every line of sight; and of the second what went straight on once.

    And the lines of sight: where nothing is in the shadow, their nodes are where the first order
    needs them, which later orders are content with.
    """
    if isinstance(medium.planet, Refracting):
        cos_gamma = jax.vmap(partial(cos_at_start, medium.planet))(*eyes[:2])
    else:
        cos_gamma = cos_view_sun_angle(view.view[:, None], view.sun, view.azimuth)
    optics, width = medium.optics, medium.atmosphere.wavelengths.size

    panels, kinks = quality.view_panels, quality.view_kinks

    def along(ray, suns, meets):
        middle = jax.tree.map(lambda a: jnp.mean(a)[None], suns)
        shade = None if split else dimming(columns, ray, middle)
        sight = look_along(medium, ray, kind, panels, kinks, shade)
        found = first_order(
            medium, columns, ray, suns, sight, panels=panels, kinks=kinks, split=split
        )
        return jax.tree.map(lambda a: jnp.where(meets, a, 0.0), found), sight

    (strength, light), sights = jax.vmap(along)(*eyes)
    first, again = light[:, :, 0], light[:, :, 1]
    for number, one in enumerate(medium.atmosphere.constituents):
        phase = one.phase.spectral(cos_gamma)
        scattering = optics.scattering[number][None, None]
        if phase.shape[-1] > 1:
            phase = jnp.concatenate([phase] * (scattering.size // phase.shape[-1]), -1)
        once, twice = strength[:, :, 0, number], strength[:, :, 1, number]
        first = first + scattering * phase * once
        if not optics.endless[number]:
            again = again + scattering * phase * twice
            continue
        blurred = optics.blurred(number, cos_gamma)
        again = again + scattering * (phase + blurred) * twice
        # Light of all orders; the more of it goes straight on, the less is left to correct.
        depth = twice / jnp.where(once > 0, once, 1.0)
        first = first.at[..., width:].add(
            (scattering * blurred * twice * _fewer(depth))[..., width:]
        )
    return first, again, sights


def _fewer(x: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """2 (x - 1 + e^{-x}) / x²: 1 at 0, where its series is used."""
    small = x < 0.05
    safe = jnp.where(small, 1.0, x)
    return jnp.where(small, 1 - x / 3 + x**2 / 12, 2 * (safe - 1 + jnp.exp(-safe)) / safe**2)
