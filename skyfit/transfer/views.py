"""Directions grouped by sun and by line of sight, so that what they share is computed once."""

from functools import partial
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import is_traced


class Views(eqx.Module):
    """Suns, and under each the same number of lines of sight with the same number of azimuths.

    Attributes:
        sun: Zenith angles [rad].
        view: Zenith angles of the lines of sight [rad].
        altitude: Altitude of the eye [m].
        azimuth: Relative azimuths on each line of sight [rad].
    """

    sun: Float[Array, " sun"]
    view: Float[Array, "sun ray"]
    altitude: Float[Array, "sun ray"]
    azimuth: Float[Array, "sun ray out"]


class Shape(NamedTuple):
    """The way back from `Views` to the caller's arrays.

    Attributes:
        place: Line of sight and azimuth of each direction; [direction, 2].
        axes: The caller's axes in the order sun, direction.
        sizes: Their lengths in that order.
    """

    place: np.ndarray
    axes: tuple[int, ...]
    sizes: tuple[int, ...]

    def restore(
        self, by_order: Float[Array, "order sun ray out wavelength"]
    ) -> Float[Array, "order *batch wavelength"]:
        """Put results into the shape of the caller's arguments."""
        back = tuple(1 + int(k) for k in np.argsort(self.axes))
        return _restored(by_order, self.place, self.sizes, back)


@partial(jax.jit, static_argnums=(2, 3))
def _restored(by_order, place, sizes, back):
    """One small program where each step would be one."""
    picked = by_order[:, :, place[:, 0], place[:, 1]]
    wide = picked.reshape(by_order.shape[0], *sizes, by_order.shape[-1])
    return wide.transpose(0, *back, wide.ndim - 1)


def group(
    sun: Float[Array, "*#batch"],
    view: Float[Array, "*#batch"],
    azimuth: Float[Array, "*#batch"],
    altitude: Float[Array, "*#batch"],
) -> tuple[Views, Shape]:
    """Group arguments that broadcast.

    Axes along which the sun changes are axes of suns, the others are axes of directions. Lines
    of sight are told apart where the values are known before compiling; traced, each direction is
    a line of its own.
    """
    full = jnp.broadcast_shapes(sun.shape, view.shape, azimuth.shape, altitude.shape)
    rank = len(full)
    sun_shape = (1,) * (rank - sun.ndim) + sun.shape
    sun_axes = [k for k in range(rank) if sun_shape[k] != 1]
    axes = (*sun_axes, *(k for k in range(rank) if k not in sun_axes))
    suns = int(np.prod([full[k] for k in sun_axes], dtype=int))

    def arrange(values):
        # What is known stays known inside a caller's `jit`.
        xp, values = (jnp, values) if is_traced(values) else (np, np.asarray(values))
        padded = values.reshape((1,) * (rank - values.ndim) + values.shape)
        return xp.broadcast_to(padded, full).transpose(axes).reshape(suns, -1)

    flat_view, flat_azimuth, flat_altitude = arrange(view), arrange(azimuth), arrange(altitude)
    place = _lines_of_sight(flat_view, flat_altitude)
    rays, outs = place.max(axis=0) + 1
    # A line of sight with fewer azimuths than the others repeats its first.
    first = np.zeros(rays, dtype=int)
    starts = place[:, 1] == 0
    first[place[starts, 0]] = np.flatnonzero(starts)
    source = np.repeat(first[:, None], outs, axis=1)
    source[place[:, 0], place[:, 1]] = np.arange(len(place))
    laid_out = flat_view[:, first], flat_altitude[:, first], flat_azimuth[:, source]
    views = Views(sun.reshape(-1), *map(jnp.asarray, laid_out))
    return views, Shape(place, axes, tuple(full[k] for k in axes))


def _lines_of_sight(view, altitude) -> np.ndarray:
    """Line of sight and place on it, of each direction; [direction, 2]."""
    count = view.shape[1]
    alone = np.stack([np.arange(count), np.zeros(count, dtype=int)], axis=1)
    if is_traced(view, altitude):
        return alone
    keys = np.concatenate([np.asarray(view), np.asarray(altitude)])
    _, line = np.unique(keys, axis=1, return_inverse=True)
    line = line.reshape(-1)
    order = np.argsort(line, kind="stable")
    sizes = np.bincount(line)
    place = np.empty(count, dtype=int)
    place[order] = np.arange(count) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    if sizes.size * sizes.max() > 1.5 * count:
        return alone  # too uneven: padding would cost more than sharing saves
    return np.stack([line, place], axis=1)
