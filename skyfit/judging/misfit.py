"""How far values are off, and where: over the dome, the suns and the swept parameter."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from ..fitting.skies import Skies, distinct


Values = Mapping[str, Float[np.ndarray, "sky direction"]]


@dataclass(frozen=True)
class Misfit:
    """How far one quantity is off over directions, suns and values of the parameter.

    Attributes:
        rms: Root mean square error over all skies and directions judged.
        worst: Largest absolute error.
        worst_at: Sun and view [rad], and the swept parameters, of that.
        by_sun: Root mean square error at every sun judged, highest first, with its zenith angle
            [rad].
        by_parameter: Root mean square error at every value of each swept parameter.
        relative_rms: Root mean square relative error.
    """

    rms: float
    worst: float
    worst_at: dict[str, float]
    by_sun: tuple[tuple[float, float], ...]
    by_parameter: dict[str, tuple[tuple[float, float], ...]]
    relative_rms: float


def misfits(
    parts: Sequence[tuple[Values, Bool[np.ndarray, " sky"]]],
    skies: Skies,
    table: Skies,
    max_view_zenith: float,
) -> dict[str, Misfit]:
    """Errors of every channel over the skies that each part has not seen.

    Args:
        parts: A fit's values by channel, and which skies to judge it on.
        skies: The truth in x, y, Y.
        table: The truth in the channels that were fitted.
        max_view_zenith: Leave out directions closer to the horizon [rad].
    """
    truth = dict(zip(skies.channels, skies.values, strict=True))
    truth |= dict(zip(table.channels, table.values, strict=True))
    inside = np.maximum(skies.view_zenith, table.view_zenith) <= max_view_zenith + 1e-6
    return {
        name: _misfit(
            [(v[name] - t, rows) for v, rows in parts],
            t,
            name not in ("x", "y"),
            inside,
            skies,
        )
        for name, t in truth.items()
    }


def _misfit(parts, truth, is_light, inside, skies: Skies) -> Misfit:
    difference = np.concatenate([np.where(inside, e, np.nan)[rows] for e, rows in parts])
    sky = np.concatenate([np.flatnonzero(rows) for _, rows in parts])
    relative = difference / truth[sky]
    error = relative if is_light else difference
    i, j = np.unravel_index(np.nanargmax(np.abs(error)), error.shape)
    place = {name: float(values[sky[i]]) for name, values in skies.swept.items()}

    def along(axis):
        values = axis[sky]
        return tuple(
            (
                float(value),
                float(np.sqrt(np.nanmean(error[np.isclose(values, value, 1e-9, 0)] ** 2))),
            )
            for value in distinct(values)
        )

    return Misfit(
        rms=float(np.sqrt(np.nanmean(error**2))),
        worst=float(np.abs(error[i, j])),
        worst_at=place
        | {
            "sun_zenith": float(skies.sun_zenith[sky[i]]),
            "view_zenith": float(skies.view_zenith[sky[i], j]),
            "relative_azimuth": float(skies.relative_azimuth[sky[i], j]),
        },
        by_sun=along(skies.sun_zenith),
        by_parameter={name: along(values) for name, values in skies.swept.items()},
        relative_rms=float(np.sqrt(np.nanmean(relative**2))),
    )
