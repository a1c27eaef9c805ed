"""Simulate the radiance of a sky: the public verb."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Bool, Float

from .._typing import as_float, check, is_traced
from ..angles import as_azimuth
from ..atmosphere import Atmosphere
from ..errors import InputError
from .line_classes import orders_with_bands
from .program import Suns
from .quality import QUALITIES, Quality, coarser
from .trust import (
    estimated_error,
    refuse_impossible,
    warn_of_dark_haze,
    warn_of_darkness,
    warn_of_error,
    warn_of_low_top,
    warn_of_straight_rays,
    warn_of_thick_air,
)
from .views import group


LOW_SUN = np.radians(86.0)
HIGH_UP = 20e3  # m
PROGRAMS = ("auto", "day", "any")
_DARK = 1e-6  # of the sunlight above the air, in a steradian: light is not known better
_NOTICED = 1e-3  # of a radiance: less may be added to it without a word where an order was below 0
PAPER_FLAT_BELOW = np.radians(70.0)  # view zenith; Preetham et al. (1999), section 3.2


class Sky(eqx.Module):
    """Spectral radiance of the sky by order of scattering.

    Attributes:
        by_order: Orders 1, 2, … one by one [W m⁻² sr⁻¹ nm⁻¹]. A reflection by the ground counts
            as one.
        tail: All orders beyond; 0 unless all orders were asked for.
        error_estimate: How far the radiance may be off, relative; None unless asked for.
    """

    by_order: Float[Array, "order *batch wavelength"]
    tail: Float[Array, "*batch wavelength"]
    error_estimate: Float[Array, "*batch wavelength"] | None = None

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
    estimate_error: bool = False,
    program: str = "auto",
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
        orders: How many orders of scattering, 1 or more; None for all, solved for together: then
            `by_order` holds the first two.
        geometry: "spherical"; "flat" for a plane-parallel atmosphere; "paper" for flat where the
            view zenith is below 70° and spherical above, as Preetham et al. (1999) did.
        quality: "draft", "default" or "high"; see `skyfit.transfer.quality`.
        observer_altitude: 0 or more; above the atmosphere as well [m].
        estimate_error: Simulate with the next coarser sizes too and say how far the radiance may be
            off; an estimate above 2 % is warned of. Not inside a caller's `jit`.
        program: "day" promises eyes on the ground, suns up to 86° from the zenith and no view below
            the horizontal, "any" nothing; "auto" chooses by the values that are known, which inside
            `jit` are none: there "day" is the faster program, and outside it "any" is the same one.

    Returns:
        The sky; its spectra have the atmosphere's wavelengths.

    Raises:
        ValueError: An angle or altitude out of its range or of what `program` promises, an unknown
            geometry, quality or program; light that is negative or not finite, where it is known.

    Warns:
        AccuracyWarning: The sun has set and much of the lit air would lie above the top; refraction
            is left out over a plane; the estimated error is large.
    """
    sky = _sky(
        atmosphere, sun_zenith, view_zenith, relative_azimuth, orders, geometry, quality,
        observer_altitude, program,
    )  # fmt: skip
    if is_traced(sky.by_order, sky.tail):
        if estimate_error:
            raise InputError("simulate(estimate_error=True): not inside jit, vmap or grad")
        return _not_below_zero(sky, atmosphere.solar_irradiance, jnp.asarray(False))
    before = np.asarray(sky.radiance)
    night = np.asarray(sun_zenith, float) > np.pi / 2
    night = np.broadcast_to(night, before.shape[:-1])[..., None]
    sky = _not_below_zero(sky, atmosphere.solar_irradiance, jnp.asarray(night))
    radiance = np.asarray(sky.radiance)
    refuse_impossible(radiance, "simulate")
    refuse_impossible(np.asarray(sky.by_order), "simulate: of single orders,")
    raised = radiance - before > _NOTICED * radiance
    warn_of_darkness(int(raised.sum()), radiance.size)
    if orders != 1:
        levels = _sizes(orders, geometry, quality).levels
        warn_of_thick_air(atmosphere, levels)
        warn_of_dark_haze(atmosphere, np.asarray(sun_zenith, float), levels)
    if geometry != "flat":
        warn_of_low_top(atmosphere, np.asarray(sun_zenith, float))
    if geometry != "spherical":
        what = "simulate: refraction is left out where the geometry is flat"
        warn_of_straight_rays(atmosphere, what)
    if not estimate_error:
        return sky
    coarse = coarser_radiance(
        atmosphere, sun_zenith, view_zenith, relative_azimuth, orders, geometry, quality,
        observer_altitude, program,
    )  # fmt: skip
    estimate = estimated_error(radiance, coarse)
    warn_of_error(estimate)
    return eqx.tree_at(
        lambda s: s.error_estimate, sky, as_float(estimate), is_leaf=lambda x: x is None
    )


def coarser_radiance(
    atmosphere: Atmosphere,
    sun_zenith: ArrayLike,
    view_zenith: ArrayLike,
    relative_azimuth: ArrayLike,
    orders: int | None = 2,
    geometry: str = "spherical",
    quality: str | Quality = "default",
    observer_altitude: ArrayLike = 0.0,
    program: str = "auto",
) -> np.ndarray:
    """Radiance at the sizes next coarser than a quality's, as it comes out [W m⁻² sr⁻¹ nm⁻¹].

    Takes what `simulate` takes; for `estimated_error`.
    """
    sky = _sky(
        atmosphere, sun_zenith, view_zenith, relative_azimuth, orders, geometry,
        coarser(_sizes(orders, geometry, quality)), observer_altitude, program,
    )  # fmt: skip
    return np.asarray(sky.radiance)


@jax.jit
def _not_below_zero(
    sky: Sky, sunlight: Float[Array, " wavelength"], night: Bool[Array, "..."]
) -> Sky:
    """Light that came out below 0, but by less than can be told, taken for none.

    Args:
        sky: As it was computed.
        sunlight: Above the air, which darkness is measured by [W m⁻² nm⁻¹].
        night: Where the sun has set: there all light below 0 is taken for none; [*batch, 1].
    """
    radiance = sky.radiance
    dark = jnp.broadcast_to(-_DARK * sunlight, radiance.shape)
    dark = jnp.where(jnp.broadcast_to(night, radiance.shape), -jnp.inf, dark)
    black = (radiance <= 0) & (radiance > dark)
    below = (sky.by_order < 0) & (sky.by_order > dark[None])
    return Sky(jnp.where(black[None] | below, 0.0, sky.by_order), jnp.where(black, 0.0, sky.tail))


def _sky(
    atmosphere: Atmosphere,
    sun_zenith: ArrayLike,
    view_zenith: ArrayLike,
    relative_azimuth: ArrayLike,
    orders: int | None,
    geometry: str,
    quality: str | Quality,
    observer_altitude: ArrayLike,
    program: str,
) -> Sky:
    """`simulate` without its judgement of what comes out."""
    sizes = _sizes(orders, geometry, quality)
    if program not in PROGRAMS:
        raise InputError(f"simulate(program=...): expected one of {PROGRAMS}; got {program!r}")
    sun = _checked(sun_zenith, "sun_zenith", "must lie in [0, pi] rad", 0.0, np.pi)
    view = _checked(view_zenith, "view_zenith", "must lie in [0, pi] rad", 0.0, np.pi)
    azimuth = as_azimuth(relative_azimuth, "simulate(relative_azimuth=...)")
    azimuth = _checked(azimuth, "relative_azimuth", "must be finite, in rad")
    altitude = _checked(observer_altitude, "observer_altitude", "must be 0 m or more", 0.0)
    if program == "day":
        sun = _checked(sun, "sun_zenith", "must lie in [0, 86 degrees] by day", 0.0, LOW_SUN)
        view = _checked(view, "view_zenith", "must lie in [0, pi/2] by day", 0.0, np.pi / 2)
        altitude = _checked(altitude, "observer_altitude", "must be 0 by day", 0.0, 0.0)
    full = np.broadcast_shapes(sun.shape, view.shape, azimuth.shape, altitude.shape)
    if 0 in full:
        none = jnp.zeros((2 if orders is None else orders, *full, atmosphere.wavelengths.size))
        return Sky(none, none[0])
    if geometry == "paper":
        flat, spherical = (
            _sky(atmosphere, sun, view, azimuth, orders, one, quality, altitude, program)
            for one in ("flat", "spherical")
        )
        near = view < PAPER_FLAT_BELOW
        return jax.tree.map(lambda a, b: _choose(near, a, b), flat, spherical)
    views, shape = group(sun, view, azimuth, altitude)
    # Inside a caller's `jit` known directions are constants, with which XLA would compute at length
    # while compiling.
    views = jax.lax.optimization_barrier(views)
    rising, day, suns = _promised(program, sun, view, altitude)
    if suns != "near" and geometry != "flat":
        sizes = sizes.at_sunset() if suns == "low" else sizes.at_dusk()
    by_order, total = orders_with_bands(
        _unbent_if_idle(atmosphere, geometry), views, count=orders,
        flat=geometry == "flat", quality=sizes, kind="rising" if rising else "any",
        suns=suns, split=not day,
    )  # fmt: skip
    by_order, total = shape.restore(by_order), shape.restore(total)[0]
    return Sky(by_order, total - jnp.sum(by_order, axis=0) if orders is None else 0 * total)


def _promised(program: str, sun, view, altitude) -> tuple[bool, bool, Suns]:
    """Whether rays rise, whether it is day, and under which suns the field is kept."""
    if program != "auto":
        return (True, True, "near") if program == "day" else (False, False, "all")
    rising = _known(view, lambda v: v <= np.pi / 2 + 1e-6) and _known(altitude, lambda h: h == 0)
    day = rising and _known(sun, lambda s: s <= np.pi / 2)
    if not _known(altitude, lambda h: h <= HIGH_UP):
        return rising, day, "all"
    low: Suns = "low" if day else "twilight"
    return rising, day, "near" if _known(sun, lambda s: s <= LOW_SUN) else low


def _unbent_if_idle(atmosphere: Atmosphere, geometry: str) -> Atmosphere:
    """Without a refraction that is known to do nothing; a plane's is left out."""
    refraction = atmosphere.refraction
    if refraction is None:
        return atmosphere
    if geometry == "flat" or _known(refraction.refractivity, lambda n: n == 0):
        return eqx.tree_at(lambda a: a.refraction, atmosphere, None)
    return atmosphere


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
        raise InputError(
            f"simulate(orders=...): expected 1 or more, or None for all; got {orders!r}"
        )
    if geometry not in ("spherical", "flat", "paper"):
        raise InputError(
            f"simulate(geometry=...): expected 'spherical', 'flat' or 'paper'; got {geometry!r}"
        )
    if isinstance(quality, Quality):
        first, higher = quality.first, quality.higher
        if higher.degree > first.degree or higher.modes > first.modes:
            raise InputError(
                "simulate(quality=...): expected degree and modes of `higher` no larger than those "
                f"of `first`; got {higher.degree}, {higher.modes} and {first.degree}, {first.modes}"
            )
        return quality
    if quality not in QUALITIES:
        names = ", ".join(repr(name) for name in QUALITIES)
        raise InputError(f"simulate(quality=...): expected one of {names}; got {quality!r}")
    return QUALITIES[quality]
