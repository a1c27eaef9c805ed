"""What a campaign sweeps, by the kind of its atmosphere."""

import keyword
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..atmosphere import Atmosphere
from ..errors import InputError
from .checks import axis_of
from .description import DescribedAtmosphere, PaperAtmosphere, Sweep
from .description.sweep import OBSERVER_ALTITUDE
from .directions import PAPER_TURBIDITIES, Values
from .given import takes


# Names of the dataset's own; a swept parameter needs another.
TAKEN = {
    *("sun_zenith", "view_zenith", "relative_azimuth", "direction", "wavelength", "order", "time"),
    *("radiance", "radiance_by_order", "luminance", "x", "y", "done", "error_estimate"),
    *("reliable", "local_time"),
    # Arguments of the functions that take a swept parameter by its name.
    *("self", "path", "wavelengths"),
}


def is_taken(name: str) -> bool:
    """Whether no swept parameter can have a name: it is the dataset's, or none in Python."""
    return name in TAKEN or not name.isidentifier() or keyword.iskeyword(name)


def find_swept(
    atmosphere: Any, turbidity: Values | None, sweep: Sweep | Mapping[str, Values] | None
) -> tuple[tuple[float, ...], Sweep | None]:
    """The turbidities, or what else is swept; neither where it is a single atmosphere.

    Args:
        atmosphere: A campaign's.
        turbidity: Turbidities that were asked for; None or empty for none.
        sweep: Another parameter that was asked for.

    Raises:
        InputError: The atmosphere cannot be swept so, or is no atmosphere.
    """
    asked = None if turbidity is None or np.size(turbidity) == 0 else turbidity
    if isinstance(sweep, Mapping):
        asked, sweep = _of_mapping(asked, sweep)
    if isinstance(atmosphere, PaperAtmosphere):
        if sweep is not None:
            raise InputError("Campaign(sweep=...): the paper's atmosphere is swept over turbidity")
        return _turbidities(PAPER_TURBIDITIES if asked is None else asked), None
    if isinstance(atmosphere, DescribedAtmosphere):
        if asked is not None:
            raise InputError(
                "Campaign(turbidity=...): only the paper's atmosphere has one; give sweep=..."
            )
        return (), sweep
    if isinstance(atmosphere, Atmosphere):
        if asked is not None or (sweep is not None and sweep.key != OBSERVER_ALTITUDE):
            name = "turbidity" if sweep is None else "sweep"
            raise InputError(
                f"Campaign({name}=...): an Atmosphere stays the same; give atmosphere=... a "
                "function of what is swept that returns one"
            )
        return (), sweep
    return _of_function(atmosphere, asked, sweep)


def _of_function(
    function: Any, turbidity: Values | None, sweep: Sweep | None
) -> tuple[tuple[float, ...], Sweep | None]:
    if not callable(function):
        raise InputError(
            "Campaign(atmosphere=...): expected an Atmosphere, a function that returns one, or a "
            f"PaperAtmosphere; got {type(function).__name__}"
        )
    name = "turbidity" if sweep is None else sweep.name
    if sweep is not None and (turbidity is not None or sweep.key == OBSERVER_ALTITUDE):
        raise InputError(
            "Campaign(sweep=...): expected one parameter, and that of the function; got "
            f"{name}{'' if turbidity is None else ' beside turbidity'}"
        )
    if not takes(function, name):
        called = getattr(function, "__name__", type(function).__name__)
        raise InputError(
            f"Campaign(atmosphere=...): expected a function that is called with the swept {name} "
            f"alone; {called} cannot be (sweep={{name: values}} names another parameter)"
        )
    if sweep is not None:
        return (), sweep
    return _turbidities(PAPER_TURBIDITIES if turbidity is None else turbidity), None


def _of_mapping(
    turbidity: Values | None, sweep: Mapping[str, Values]
) -> tuple[Values | None, Sweep | None]:
    """The mapping's one parameter, as turbidity or as a `Sweep`."""
    if len(sweep) != 1:
        came = ", ".join(map(str, sweep)) or "none"
        raise InputError(f"Campaign(sweep=...): expected one parameter; got {came}")
    ((name, values),) = sweep.items()
    if name == "turbidity" and turbidity is None:
        return values, None
    if is_taken(str(name)):
        raise InputError(f"Campaign(sweep=...): {name} is taken, or no name; give another")
    key = OBSERVER_ALTITUDE if name == "observer_altitude" else name
    low = 0.0 if key == OBSERVER_ALTITUDE else -np.inf
    return turbidity, Sweep(name, key, axis_of(f"sweep={{{name!r}", values, low, np.inf))


def _turbidities(given: Values) -> tuple[float, ...]:
    return axis_of("turbidity", given, 1.0, np.inf)
