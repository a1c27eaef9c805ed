"""What a simulated sky is worth: refusals and warnings in one line, an estimate of its error."""

import warnings

import numpy as np

from .._typing import is_traced
from ..atmosphere import Atmosphere
from ..errors import InputError


class AccuracyWarning(UserWarning):
    """A number may be farther off than is stated; the message names the cause in one line."""


TOLERANCE = 0.02  # of radiance; an estimated error above it is warned of
# Of the distance from the next coarser quality. No bound: of quality "default" at turbidity 4
# a tenth of the radiances are farther from "high".
SHARE_OF_DISTANCE = 0.5
_DIM = 1e-4  # of the brightest direction; darker ones are compared with this
_MISSING = 0.02  # share of the lit air; more above the top is warned of
# Vertical optical depth of scattering that a level is worth. Uniform haze of asymmetry 0.76 and
# depth 0.66 a level is 2 % off with 16 levels, of depth 1 a level 8 %.
_DEPTH_OF_LEVEL = 0.66
# Fewer levels lose the light of deep twilight in haze: with 10, quality "draft", the zenith is
# 17 % too dark at turbidity 7.5 with the sun 8° below the horizon, at turbidity 10 3.7 times too
# bright; 3.5 and 36 % off at 6°, 1 and 4 % at 4° (against "default").
_LEVELS_AT_DUSK, _DUSK, _HAZY = 16, np.radians(94.5), 1.0
_FAR = 100e3  # m above the top; what is higher scatters nothing one could see


def refuse_impossible(radiance: np.ndarray, what: str) -> None:
    """Refuse light that is not finite or negative.

    Raises:
        ValueError: Some is; says how much.
    """
    if not np.isfinite(radiance).all():
        count = int((~np.isfinite(radiance)).sum())
        raise InputError(f"{what}: {count} of {radiance.size} radiances are not finite")
    if (radiance < 0).any():
        count, least = int((radiance < 0).sum()), float(radiance.min())
        raise InputError(
            f"{what}: {count} of {radiance.size} radiances are negative, down to {least:.3g}; "
            "expected 0 or more: a higher quality may simulate this atmosphere"
        )


def warn_of_darkness(count: int, size: int) -> None:
    """Warn of radiances, if any, in which light that came out below 0 is taken for none."""
    if count:
        _warn(
            f"simulate: {count} of {size} radiances are darker than can be told; what came out "
            "below 0 in them is 0; a higher quality tells more"
        )


def relative_difference(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    """How much two results differ, of the finer one; by wavelength of `[..., wavelength]`.

    What is darker than a ten-thousandth of the brightest direction is compared with that; where
    all directions are black, the difference is 1 unless both results are.
    """
    brightest = np.max(fine, axis=tuple(range(fine.ndim - 1)), keepdims=True, initial=0.0)
    floor, off = np.maximum(fine, _DIM * brightest), np.abs(fine - coarse)
    return np.where(floor > 0, off / np.where(floor > 0, floor, 1.0), off > 0)


def estimated_error(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    """Estimate of a radiance's relative error from that at the next coarser sizes.

    Half of `relative_difference`: no bound, and blind to what all sizes have in common.

    Args:
        fine: Radiances of one or more skies, [..., wavelength].
        coarse: Radiances at the next coarser sizes, in the same shape.

    Raises:
        ValueError: The coarser radiance is not finite.
    """
    if not np.isfinite(coarse).all():
        count = int((~np.isfinite(coarse)).sum())
        raise InputError(
            f"simulate: {count} of {coarse.size} radiances at the coarser sizes are not finite; "
            "the error cannot be estimated by them"
        )
    return SHARE_OF_DISTANCE * relative_difference(fine, coarse)


def warn_of_error(estimate: np.ndarray) -> None:
    """Warn where the estimated error of a sky exceeds what is tolerated."""
    worst = float(estimate.max(initial=0.0))
    if worst > TOLERANCE:
        share = float(np.mean(estimate > TOLERANCE))
        _warn(
            f"simulate: the estimated error is up to {worst:.1%} and exceeds {TOLERANCE:.0%} in "
            f"{share:.0%} of the radiances; a higher quality lowers it"
        )


def warn_of_thick_air(atmosphere: Atmosphere, levels: int) -> None:
    """Warn where air scatters too often for the levels at which light is kept.

    Args:
        atmosphere: What scatters; its vertical optical depth of scattering counts.
        levels: How many altitudes there are at which light is kept.
    """
    depth = np.asarray(atmosphere.vertical_column() @ atmosphere.scattering)
    thickest = int(np.argmax(depth))
    most = _DEPTH_OF_LEVEL * levels
    if depth[thickest] > most:
        _warn(
            f"simulate: light is scattered in {depth[thickest]:.3g} optical depths at "
            f"{float(atmosphere.wavelengths[thickest]):.0f} nm; {levels} levels follow it within "
            f"2 % through up to {most:.3g}: a higher quality has more"
        )


def warn_of_dark_haze(atmosphere: Atmosphere, sun_zenith: np.ndarray, levels: int) -> None:
    """Warn of haze in deep twilight where light is kept at few levels.

    Args:
        atmosphere: What scatters; its vertical optical depth of scattering counts.
        sun_zenith: Zenith angle of the sun at the observer [rad].
        levels: How many altitudes there are at which light is kept.
    """
    lowest = float(np.max(sun_zenith, initial=0.0))
    if lowest <= _DUSK or levels >= _LEVELS_AT_DUSK:
        return
    depth = float(np.max(atmosphere.vertical_column() @ atmosphere.scattering))
    if depth > _HAZY:
        _warn(
            f"simulate: light is scattered in {depth:.3g} optical depths with the sun "
            f"{np.degrees(lowest) - 90:.1f} degrees below the horizontal, where {levels} levels "
            "may be wrong by a factor: a higher quality has more"
        )


def warn_of_low_top(atmosphere: Atmosphere, sun_zenith: np.ndarray) -> None:
    """Warn where the sun has set so far that much of the lit air lies above the top."""
    lowest = float(np.max(sun_zenith, initial=0.0))
    missing = missing_above(atmosphere, lowest)
    if missing > _MISSING:
        top = float(atmosphere.top_altitude)
        _warn(
            f"simulate: the atmosphere ends at {top / 1e3:.0f} km; with the sun "
            f"{np.degrees(lowest) - 90:.1f} degrees below the horizontal {missing:.0%} of the lit "
            "air overhead would lie higher: raise top_altitude"
        )


def warn_of_straight_rays(atmosphere: Atmosphere, what: str) -> None:
    """Warn, where an atmosphere refracts, of what is computed with straight rays.

    Args:
        atmosphere: With refraction or without.
        what: The whole sentence.
    """
    refraction = atmosphere.refraction
    if refraction is None or is_traced(refraction.refractivity) or refraction.refractivity == 0:
        return
    _warn(what)


def missing_above(atmosphere: Atmosphere, sun_zenith: float) -> float:
    """Share of the air overhead and lit by the sun that lies above the top, were there no top.

    Of what scatters and has a density there: exponential profiles go on, tables end.

    Args:
        atmosphere: What scatters.
        sun_zenith: Zenith angle of the sun at the observer [rad].
    """
    if not np.pi / 2 < sun_zenith < np.pi:
        return 0.0
    radius, top = float(atmosphere.planet_radius), float(atmosphere.top_altitude)
    shadow = radius * (1 / np.sin(sun_zenith) - 1)
    highest = max(top, shadow) + _FAR
    altitude = np.linspace(min(shadow, highest), highest, 2001)
    scattering = np.asarray(atmosphere.scattering).max(axis=1)
    air = sum(
        strength * np.asarray(one.density(altitude))
        for strength, one in zip(scattering, atmosphere.constituents, strict=True)
    )
    lit = np.trapezoid(air, altitude)
    above = np.trapezoid(np.where(altitude > top, air, 0.0), altitude)
    return float(above / lit) if lit > 0 else 0.0


def _warn(message: str) -> None:
    warnings.warn(message, AccuracyWarning, stacklevel=4)
