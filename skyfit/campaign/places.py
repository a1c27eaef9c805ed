"""Where the atmospheres of a campaign lie among the swept parameters: a grid, or a sample."""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from ..errors import InputError
from .description.sweep import OBSERVER_ALTITUDE, Sweep


SAMPLE = "sample"  # dimension of the dataset whose skies are no grid


def grid(swept: Mapping[str, Sequence[float]]) -> tuple[dict[str, float], ...]:
    """Every combination of the values; those of the last parameter vary fastest."""
    return tuple(
        dict(zip(swept, values, strict=True)) for values in itertools.product(*swept.values())
    )


def sample(swept: Mapping[str, Sequence[float]], count: int) -> tuple[dict[str, float], ...]:
    """Places that fill the ranges of the parameters evenly, the same in every run.

    The corners come first, then Halton's sequence: a fit to the sample extrapolates nowhere, and
    more places refine fewer.

    Args:
        swept: Values of every parameter, of which the first and the last count.
        count: Number of places; more than there are corners.

    Raises:
        InputError: Too few places; nothing swept, or a parameter of a single value.
    """
    from scipy.stats import qmc

    single = [name for name, values in swept.items() if len(values) < 2]
    if single or not swept:
        came = f"the single value of {single[0]}" if single else "nothing"
        raise InputError(f"Campaign(samples=...): expected a range to fill; got {came}")
    corners = np.array(list(itertools.product((0.0, 1.0), repeat=len(swept))))
    if count <= len(corners):
        raise InputError(
            f"Campaign(samples=...): expected more than the {len(corners)} corners of what is "
            f"swept; got {count}"
        )
    halton = qmc.Halton(len(swept), scramble=False)
    halton.fast_forward(1)  # its first point is a corner
    shares = np.concatenate([corners, halton.random(count - len(corners))])
    low, high = (np.array([values[at] for values in swept.values()]) for at in (0, -1))
    places = np.where(shares == 1.0, high, low + shares * (high - low))
    return tuple(dict(zip(swept, place.tolist(), strict=True)) for place in places)


def swept_by_name(
    turbidity: Sequence[float], sweeps: Sequence[Sweep]
) -> dict[str, tuple[float, ...]]:
    """Values of every swept parameter by its name, turbidity first."""
    first = {"turbidity": tuple(turbidity)} if len(turbidity) else {}
    return first | {one.name: tuple(one.values) for one in sweeps}


def places_of(
    turbidity: Sequence[float], sweeps: Sequence[Sweep], samples: int | None
) -> tuple[dict[str, float], ...]:
    """Places of a campaign: one, of no parameters, where nothing is swept."""
    swept = swept_by_name(turbidity, sweeps)
    return grid(swept) if samples is None else sample(swept, samples)


def without_observer(place: Mapping[str, float], sweeps: Sequence[Sweep]) -> dict[str, float]:
    """What an atmosphere depends on of a place, all but the observer's altitude."""
    observer = [one.name for one in sweeps if one.key == OBSERVER_ALTITUDE]
    return {name: value for name, value in place.items() if name not in observer}
