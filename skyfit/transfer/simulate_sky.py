"""Simulate the radiance of a sky: the public verb."""

from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float

from .._typing import Scalar, as_float, check, is_traced
from ..angles import cos_view_sun_angle
from ..atmosphere import Atmosphere, Constituent
from .columns import SunColumns, sun_columns
from .compiling import compile_quickly
from .field import first_field, make_grid
from .geometry import AbstractPlanet, Flat, Ray, Spherical, SunDirection
from .medium import Medium, make_medium
from .optics import Optics
from .orders import gather, next_field, scatter, straight_beam
from .paths import Kind
from .quality import (
    ALL_SUNS_DEG,
    LOW_SUN_OFFSETS_DEG,
    QUALITIES,
    TWILIGHT_OFFSETS_DEG,
    Quality,
)
from .single import first_order
from .solve import sum_of_orders
from .views import Views, group


Suns = Literal["near", "low", "twilight", "all"]
"""For which suns the field is kept; see `quality`."""

LOW_SUN = np.radians(86.0)
HIGH_UP = 20e3  # m
PAPER_FLAT_BELOW = np.radians(70.0)  # view zenith; Preetham et al. (1999), section 3.2


class Sky(eqx.Module):
    """Spectral radiance of the sky by order of scattering.

    Attributes:
        by_order: Orders 1, 2, … one by one [W m⁻² sr⁻¹ nm⁻¹]. A reflection by the ground counts
            as one.
        tail: All orders beyond, as a geometric series; 0 unless all orders were asked for.
    """

    by_order: Float[Array, "order *batch wavelength"]
    tail: Float[Array, "*batch wavelength"]

    @property
    def radiance(self) -> Float[Array, "*batch wavelength"]:
        """Sum of the orders and the tail [W m⁻² sr⁻¹ nm⁻¹]."""
        return jnp.sum(self.by_order, axis=0) + self.tail


def simulate(
    atmosphere: Atmosphere,
    sun_zenith: ArrayLike,
    view_zenith: ArrayLike,
    relative_azimuth: ArrayLike,
    orders: int | None = 2,
    geometry: str = "spherical",
    quality: str | Quality = "default",
    observer_altitude: ArrayLike = 0.0,
) -> Sky:
    """Simulate the radiance of a sky, without the sun's disc.

    Angles and altitude broadcast. Directions that share a sun cost little beside one more sun: for
    many skies give suns of shape [sun, 1] and directions of shape [direction].

    Args:
        atmosphere: What scatters and absorbs, and the sunlight above it.
        sun_zenith: Zenith angle of the sun at the observer, in [0, π]; beyond π/2 it is below the
            horizontal [rad].
        view_zenith: Zenith angle of the direction, in [0, π] [rad].
        relative_azimuth: View azimuth minus sun azimuth, 0 towards the sun [rad].
        orders: How many orders of scattering, 1 or more; None for all.
        geometry: "spherical"; "flat" for a plane-parallel atmosphere; "paper" for flat where the
            view zenith is below 70° and spherical above, as Preetham et al. (1999) did.
        quality: "draft", "default" or "high"; see `skyfit.transfer.quality`.
        observer_altitude: 0 or more; above the atmosphere as well [m].

    Returns:
        The sky; its spectra have the atmosphere's wavelengths.

    Raises:
        ValueError: An angle or altitude out of its range, an unknown geometry or quality.
    """
    sizes = _sizes(orders, geometry, quality)
    sun = _checked(sun_zenith, "sun_zenith", "must lie in [0, pi] rad", 0.0, np.pi)
    view = _checked(view_zenith, "view_zenith", "must lie in [0, pi] rad", 0.0, np.pi)
    azimuth = _checked(relative_azimuth, "relative_azimuth", "must be finite, in rad")
    altitude = _checked(observer_altitude, "observer_altitude", "must be 0 m or more", 0.0)
    if geometry == "paper":
        flat, spherical = (
            simulate(atmosphere, sun, view, azimuth, orders, one, quality, altitude)
            for one in ("flat", "spherical")
        )
        near = view < PAPER_FLAT_BELOW
        return jax.tree.map(lambda a, b: _choose(near, a, b), flat, spherical)
    views, shape = group(sun, view, azimuth, altitude)
    # Inside a caller's `jit` known directions are constants, with which XLA would compute at length
    # while compiling.
    views = jax.lax.optimization_barrier(views)
    rising = _known(view, lambda v: v <= np.pi / 2 + 1e-6) and _known(altitude, lambda h: h == 0)
    day = rising and _known(sun, lambda s: s <= np.pi / 2)
    suns: Suns = "all"
    if _known(altitude, lambda h: h <= HIGH_UP):
        suns = "near" if _known(sun, lambda s: s <= LOW_SUN) else "low" if day else "twilight"
    if suns in ("twilight", "all") and geometry != "flat":
        sizes = sizes.at_dusk()
    by_order, total = _simulate(
        _widened(atmosphere), views, count=orders,
        flat=geometry == "flat", quality=sizes, kind="rising" if rising else "any",
        suns=suns, split=not day,
    )  # fmt: skip
    by_order, total = shape.restore(by_order), shape.restore(total)[0]
    return Sky(by_order, total - jnp.sum(by_order, axis=0) if orders is None else 0 * total)


def _widened(atmosphere: Atmosphere) -> Atmosphere:
    """The same with every coefficient at every wavelength, however it was given: one program."""

    def wide(one: Constituent) -> Constituent:
        shape = atmosphere.wavelengths.shape
        spectra = jnp.broadcast_to(one.scattering, shape), jnp.broadcast_to(one.absorption, shape)
        return eqx.tree_at(lambda c: (c.scattering, c.absorption), one, spectra)

    constituents = tuple(wide(one) for one in atmosphere.constituents)
    return eqx.tree_at(lambda a: a.constituents, atmosphere, constituents)


@compile_quickly
def _simulate(
    atmosphere: Atmosphere,
    views: Views,
    *,
    count: int | None,
    flat: bool,
    quality: Quality,
    kind: Kind,
    suns: Suns,
    split: bool,
) -> tuple[
    Float[Array, "order sun ray out wavelength"], Float[Array, "1 sun ray out wavelength"]
]:
    """Orders one by one, and all that were asked for together; for every sun in turn."""
    radius, top = atmosphere.planet_radius, atmosphere.top_altitude
    planet = Flat(top) if flat else Spherical(radius, top)
    exact = Optics.cut(atmosphere, quality.first.degree, quality.sharpest)
    # All orders are summed where what goes straight on counts as not scattered.
    rough = Optics.cut(atmosphere, quality.higher.degree, quality.sharpest).scaled()
    optics = exact.beside(rough.up_to(quality.first.degree)) if count is None else exact
    medium = make_medium(atmosphere, planet, optics)
    columns = sun_columns(medium, quality.column_angles)
    width = atmosphere.wavelengths.size

    def under_one_sun(view: Views):
        eyes = _eyes(planet, view, kind)
        first, again = _first(medium, columns, view, eyes, quality, kind, split)
        if count == 1:
            return first[None], first[None]
        nodes = _suns(view.sun, suns, flat, quality)
        grid = make_grid(medium, nodes, quality.levels, quality.first)
        higher = make_grid(medium, nodes, quality.levels, quality.higher)
        field = first_field(columns, grid, quality)

        def look(source):
            def along(ray, sun, meets):
                light = gather(
                    medium, grid, source, ray, sun, kind=kind,
                    panels=quality.view_panels, kinks=quality.view_kinks,
                )
                return jnp.where(meets, light, 0.0)

            return jax.vmap(along)(*eyes)

        if count is None:
            scaled = eqx.tree_at(lambda m: m.optics, medium, rough)
            once = jax.tree.map(lambda a: a[..., width:], field)

            def further(field):
                return next_field(scaled, higher, scatter(rough, field), quality)

            more = sum_of_orders(further, once.up_to(quality.higher), quality.tolerance)
            light = look(scatter(optics, field.plus(more, width)))
            second = light[..., :width] + again[..., :width]
            total = first[..., width:] + light[..., width:]
            return jnp.stack([first[..., :width], second]), total[None]

        second = look(scatter(optics, field)) + again
        orders = [first, second]
        # Light once scattered has no peaks any more: of what it meets nothing need be cut off.
        whole = exact.whole()
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
    sunshine = atmosphere.solar_irradiance[None, None, None, None, :]
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
) -> tuple[Float[Array, "ray out channel"], Float[Array, "ray out channel"]]:
    """The first order along every line of sight; and of the second what went straight on once."""
    cos_gamma = cos_view_sun_angle(view.view[:, None], view.sun, view.azimuth)
    optics, width = medium.optics, medium.atmosphere.wavelengths.size

    def along(ray, suns, meets):
        found = first_order(
            medium, columns, ray, suns, kind=kind, panels=quality.view_panels, kinks=quality.view_kinks,
            split=split
        )
        return jax.tree.map(lambda a: jnp.where(meets, a, 0.0), found)

    strength, light = jax.vmap(along)(*eyes)
    first, again = light[:, :, 0], light[:, :, 1]
    for number, one in enumerate(medium.atmosphere.constituents):
        phase = one.phase.spectral(cos_gamma)
        scattering = optics.scattering[number]
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
        first = first.at[..., width:].add((scattering * blurred * twice * _fewer(depth))[..., width:])
    return first, again


def _fewer(x: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """2 (x - 1 + e^{-x}) / x²: 1 at 0, where its series is used."""
    small = x < 0.05
    safe = jnp.where(small, 1.0, x)
    return jnp.where(small, 1 - x / 3 + x**2 / 12, 2 * (safe - 1 + jnp.exp(-safe)) / safe**2)


def _choose(near, a, b):
    """`a` where near, along the trailing batch axes of `[..., wavelength]` arrays."""
    batch = near.reshape((1,) * (a.ndim - 1 - near.ndim) + near.shape)
    return jnp.where(batch[..., None], a, b)


def _known(values: Float[Array, "..."], test) -> bool:
    """Whether values are known before compiling and all pass."""
    return not is_traced(values) and bool(np.all(test(np.asarray(values))))


def _checked(value: ArrayLike, name: str, what: str, low=-np.inf, high=np.inf):
    values = as_float(value)
    slack = 1e-6 * (high < np.inf)  # rad: float32's π is larger than π
    return check(
        values,
        lambda v: ~((v >= low) & (v <= high + slack) & (abs(v) < np.inf)),
        f"simulate({name}=...) {what}",
    )


def _sizes(orders: int | None, geometry: str, quality: str | Quality) -> Quality:
    if orders is not None and (not isinstance(orders, int) or orders < 1):
        raise ValueError(
            f"simulate(orders=...): expected 1 or more, or None for all; got {orders!r}"
        )
    if geometry not in ("spherical", "flat", "paper"):
        raise ValueError(
            f"simulate(geometry=...): expected 'spherical', 'flat' or 'paper'; got {geometry!r}"
        )
    if isinstance(quality, Quality):
        first, higher = quality.first, quality.higher
        if higher.degree > first.degree or higher.modes > first.modes:
            raise ValueError(
                "simulate(quality=...): expected degree and modes of `higher` no larger than those "
                f"of `first`; got {higher.degree}, {higher.modes} and {first.degree}, {first.modes}"
            )
        return quality
    if quality not in QUALITIES:
        names = ", ".join(repr(name) for name in QUALITIES)
        raise ValueError(f"simulate(quality=...): expected one of {names}; got {quality!r}")
    return QUALITIES[quality]
