"""What a campaign sweeps, by the kind of its atmosphere."""

import keyword
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..atmosphere import Atmosphere
from ..errors import InputError
from .checks import axis_of
from .description import DescribedAtmosphere, PaperAtmosphere, Sweep
from .description.sweep import GROUND_ALBEDO, OBSERVER_ALTITUDE
from .directions import PAPER_TURBIDITIES, Values
from .given import takes
from .places import SAMPLE


# Names of the dataset's own; a swept parameter needs another.
TAKEN = {
    *("sun_zenith", "view_zenith", "relative_azimuth", "direction", "wavelength", "order", "time"),
    SAMPLE,
    *("radiance", "radiance_by_order", "luminance", "x", "y", "done", "error_estimate"),
    *("reliable", "local_time"),
    # Arguments of the functions that take a swept parameter by its name.
    *("self", "path", "wavelengths"),
}


def is_taken(name: str) -> bool:
    """Whether no swept parameter can have a name: it is the dataset's, or none in Python."""
    return name in TAKEN or not name.isidentifier() or keyword.iskeyword(name)


def find_swept(
    atmosphere: Any, turbidity: Values | None, sweep: Any
) -> tuple[tuple[float, ...], tuple[Sweep, ...]]:
    """The turbidities, and what else is swept; neither where it is a single atmosphere.

    Args:
        atmosphere: A campaign's.
        turbidity: Turbidities that were asked for; None or empty for none.
        sweep: Other parameters that were asked for, as `Campaign` takes them.

    Raises:
        InputError: The atmosphere cannot be swept so, or is no atmosphere.
    """
    asked = None if turbidity is None or np.size(turbidity) == 0 else turbidity
    asked, sweeps = _listed(atmosphere, asked, sweep)
    names = [one.name for one in sweeps] + (["turbidity"] if asked is not None else [])
    for number, name in enumerate(names):
        if name in names[:number]:
            raise InputError(f"Campaign(sweep=...): {name} is swept twice")
    if isinstance(atmosphere, PaperAtmosphere):
        odd = [one.name for one in sweeps if one.key not in (GROUND_ALBEDO, OBSERVER_ALTITUDE)]
        if odd:
            raise InputError(
                "Campaign(sweep=...): the paper's atmosphere is swept over turbidity, "
                f"ground_albedo and observer_altitude; not over {odd[0]}"
            )
        return _turbidities(PAPER_TURBIDITIES if asked is None else asked), sweeps
    if isinstance(atmosphere, DescribedAtmosphere):
        if asked is not None:
            raise InputError(
                "Campaign(turbidity=...): only the paper's atmosphere has one; give sweep=..."
            )
        return (), sweeps
    if isinstance(atmosphere, Atmosphere):
        other = [one.name for one in sweeps if one.key != OBSERVER_ALTITUDE]
        if asked is not None or other:
            name = "turbidity" if asked is not None else "sweep"
            raise InputError(
                f"Campaign({name}=...): an Atmosphere stays the same; give atmosphere=... a "
                "function of what is swept that returns one"
            )
        return (), sweeps
    return _of_function(atmosphere, asked, sweeps)


def _of_function(
    function: Any, turbidity: Values | None, sweeps: tuple[Sweep, ...]
) -> tuple[tuple[float, ...], tuple[Sweep, ...]]:
    if not callable(function):
        raise InputError(
            "Campaign(atmosphere=...): expected an Atmosphere, a function that returns one, or a "
            f"PaperAtmosphere; got {type(function).__name__}"
        )
    names = [one.name for one in sweeps if one.key != OBSERVER_ALTITUDE]
    if turbidity is None and not names:
        turbidity = PAPER_TURBIDITIES
    if turbidity is not None:
        names = ["turbidity", *names]
    if not takes(function, names):
        called = getattr(function, "__name__", type(function).__name__)
        raise InputError(
            "Campaign(atmosphere=...): expected a function that is called with the swept "
            f"{', '.join(names)} alone; {called} cannot be (sweep={{name: values}} names other "
            "parameters)"
        )
    return (() if turbidity is None else _turbidities(turbidity)), sweeps


def _listed(
    atmosphere: Any, turbidity: Values | None, sweep: Any
) -> tuple[Values | None, tuple[Sweep, ...]]:
    """What was asked for besides turbidity, parameter by parameter."""
    if sweep is None or isinstance(sweep, Sweep):
        return turbidity, () if sweep is None else (sweep,)
    if not isinstance(sweep, Mapping):
        sweeps = tuple(sweep)
        if not all(isinstance(one, Sweep) for one in sweeps):
            raise InputError(f"Campaign(sweep=...): expected {{name: values}}; got {sweep!r:.60}")
        return turbidity, sweeps
    if not sweep:
        raise InputError("Campaign(sweep=...): expected a parameter or more; got none")
    others = dict(sweep)
    if turbidity is None and not isinstance(atmosphere, DescribedAtmosphere):
        turbidity = others.pop("turbidity", None)
    return turbidity, tuple(_named(atmosphere, *one) for one in others.items())


def _named(atmosphere: Any, name: str, values: Values) -> Sweep:
    """A parameter by the name that a program gives it."""
    if is_taken(str(name)):
        raise InputError(f"Campaign(sweep=...): {name} is taken, or no name; give another")
    key, low, high = name, -np.inf, np.inf
    if name == "observer_altitude":
        key, low = OBSERVER_ALTITUDE, 0.0
    elif name == "ground_albedo" and isinstance(atmosphere, PaperAtmosphere):
        key, low, high = GROUND_ALBEDO, 0.0, 1.0
    return Sweep(name, key, axis_of(f"sweep={{{name!r}", values, low, high))


def _turbidities(given: Values) -> tuple[float, ...]:
    return axis_of("turbidity", given, 1.0, np.inf)
