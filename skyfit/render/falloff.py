"""How light falls off around the sun: functions of the angle to it alone, as sharp as they are."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline

from ..phase import AbstractPhaseFunction


GLOW_ENDS = float(np.radians(60.0))  # from the sun: farther off, light follows no function of this
_GLOW_FADES = float(np.radians(20.0))  # from here on
_NODES = 4096
_DARKEST = 1e-9  # of the brightest, below which a glow is not followed


def crowding(count: int, last: float = np.pi) -> Float[np.ndarray, " node"]:
    """Angles to the sun from 0 to the last, crowding at 0 as squares do [rad]."""
    return last * np.linspace(0, 1, count) ** 2


class Falloff:
    """Functions of the angle to the sun above 0, one for each channel; log-linear between nodes.

    Args:
        logarithm: Logarithm of the falloff at the angles of `crowding`.
    """

    def __init__(self, logarithm: Float[np.ndarray, "node channel"]):
        self._logarithm = logarithm

    def __call__(self, gamma: Float[np.ndarray, "*ray"]) -> Float[np.ndarray, "*ray channel"]:
        """Values at angles to the sun [rad]."""
        # Squares crowd, so roots are evenly spaced.
        nodes = np.linspace(0, np.sqrt(np.pi), len(self._logarithm))
        roots = np.sqrt(gamma)
        channels = [np.interp(roots, nodes, column) for column in self._logarithm.T]
        return np.exp(np.stack(channels, axis=-1))

    def __mul__(self, other: "Falloff") -> "Falloff":
        """The product, angle by angle."""
        return Falloff(self._logarithm + other._logarithm)


def phase_of_light(
    phase: AbstractPhaseFunction,
    spectrum: Float[np.ndarray, " wavelength"],
    weights: Float[np.ndarray, "wavelength channel"],
) -> Falloff:
    """A phase function [sr⁻¹] as each channel sees it, under light of one spectrum.

    Args:
        phase: Phase function of the constituent that scatters.
        spectrum: None of it below 0.
        weights: Weight of each wavelength in each channel. A channel without light takes the plain
            mean.
    """
    share = weights * spectrum[:, None]
    total = share.sum(axis=0)
    lit = total > 0
    share = np.where(lit, share / np.where(lit, total, 1.0), 1 / len(share))
    values = np.asarray(phase.spectral(jnp.cos(jnp.asarray(crowding(_NODES)))))
    values = np.broadcast_to(values, (_NODES, len(share))) @ share
    return Falloff(np.log(np.maximum(values, 1e-30)))


def beside_the_sun(count: int, sun_zenith: float) -> Float[np.ndarray, "2 direction"]:
    """Zenith angles and azimuths from the sun's, on the great circle that crosses its vertical.

    There light changes with the angle to the sun alone, as far as light can: not with the depth of
    the air, which changes to both sides of the sun alike.

    Args:
        count: Number of directions, at `crowding` angles to the sun up to `GLOW_ENDS`.
        sun_zenith: Zenith angle of the sun [rad].
    """
    gamma = crowding(count, GLOW_ENDS)
    view = np.arccos(np.cos(gamma) * np.cos(sun_zenith))
    return np.stack([view, np.arctan2(np.sin(gamma), np.cos(gamma) * np.sin(sun_zenith))])


def glow(light: Float[np.ndarray, "direction channel"]) -> Falloff | None:
    """The shape of a glow around the sun, 1 far from it; None where a channel has no light.

    Args:
        light: Light in the directions of `beside_the_sun`.
    """
    darkest = _DARKEST * light.max(axis=0)
    if not (darkest > 0).all():
        return None
    logarithm = np.log(np.maximum(light, darkest))
    roots = np.sqrt(crowding(len(light), GLOW_ENDS))
    ends: Any = ("clamped", "not-a-knot")  # even in the angle, which is the square of the root
    spline = CubicSpline(roots, logarithm - logarithm[-1], bc_type=ends)
    gamma = crowding(_NODES)
    share = np.clip((GLOW_ENDS - gamma) / (GLOW_ENDS - _GLOW_FADES), 0, 1)
    near = share**2 * (3 - 2 * share)
    return Falloff(near[:, None] * spline(np.sqrt(np.minimum(gamma, GLOW_ENDS))))
