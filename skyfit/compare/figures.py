"""The numbers of each sky: a few luminances and chromaticities, and the light on the ground."""

import math
import warnings
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import Any

import numpy as np
from jaxtyping import Float

from .._typing import as_scalar, check
from ..errors import InputError
from ..fitting import SkyFit
from .models import MODELS, Conditions, Entry, HasColour


# Directions by name: view zenith and azimuth from the sun [rad].
VIEWS = {
    "zenith": (0.0, 0.0),
    "sun_side": (math.radians(45), 0.0),
    "aside": (math.radians(45), math.pi / 2),
    "opposite": (math.radians(45), math.pi),
    "horizon": (math.radians(85), math.pi / 2),
}


def compare_skies(
    sun_zenith: float,
    turbidity: float,
    *,
    fits: Mapping[str, SkyFit] | None = None,
    parameters: Mapping[str, float] | None = None,
    models: Sequence[Entry] = MODELS,
) -> list[dict[str, Any]]:
    """Describe the same sky as every model sees it.

    Args:
        sun_zenith: Zenith angle of the sun, in [0, π] [rad].
        turbidity: Turbidity, 1 or more.
        fits: Fits to be rows as well, by name.
        parameters: Values of what the fits were made for, by name: all that is not turbidity.
        models: Names of the models; all that are known by default. Those whose package is not
            installed are left out.

    Returns:
        For each model its `model` name; `luminance` [cd m⁻²] at the zenith, at 45° on the sun's
        side, aside and opposite, and at 85° aside, the `horizon`; `sun_side_ratio`, that of the sun
        side to the opposite; `chromaticity` of the zenith and the horizon; `diffuse_illuminance`
        of the ground by the sky alone [lx]; `outside`, the conditions that are out of the model's
        valid range; `white`, what counts as luminance 1 where the model knows no cd m⁻², or None.

    Raises:
        InputError: A sun or turbidity out of range; a parameter of a fit without a value, or a
            value of a parameter that no fit has.
    """
    sun = as_scalar(sun_zenith, "compare_skies(sun_zenith=...)")
    haze = as_scalar(turbidity, "compare_skies(turbidity=...)")
    check(sun, _no_zenith, "compare_skies(sun_zenith=...) must lie in [0, pi]")
    check(haze, lambda v: ~(v >= 1), "compare_skies(turbidity=...) must be 1 or more")
    at = Conditions(float(sun), float(haze))
    entries = [entry for entry in models if not entry.package or find_spec(entry.package)]
    given = {"turbidity": float(haze)} | dict(parameters or {})
    entries += [_entry(name, fit, given) for name, fit in (fits or {}).items()]
    known = {"turbidity"}.union(*(fit.swept for fit in (fits or {}).values()))
    if (unknown := sorted(set(given) - known)) or "turbidity" in (parameters or {}):
        raise InputError(
            "compare_skies(parameters=...): expected what fits are over, turbidity apart; got "
            f"{', '.join(unknown or ['turbidity'])}"
        )
    return [_row(entry, at) for entry in entries]


def _entry(name: str, fit: SkyFit, given: Mapping[str, float]) -> Entry:
    if missing := [parameter for parameter in fit.swept if parameter not in given]:
        values = ", ".join(f"{parameter}=VALUE" for parameter in missing)
        raise InputError(
            f"compare_skies(fits=...): {name} is a fit over {', '.join(fit.swept)}; expected "
            f"{values} (--set, parameters=...)"
        )
    return Entry(name, lambda _: fit.sky(**{n: given[n] for n in fit.swept}))


def _row(entry: Entry, at: Conditions) -> dict[str, Any]:
    with warnings.catch_warnings():
        # What is out of a model's range is said in the row.
        warnings.simplefilter("ignore", UserWarning)
        sky = entry.sky(at)
    view, azimuth, weights = _dome()
    named = np.array(list(VIEWS.values()))
    colours = np.asarray(
        sky.xyY(at.sun_zenith, np.r_[named[:, 0], view], np.r_[named[:, 1], azimuth])
    )
    x, y, luminance = (dict(zip(VIEWS, column.tolist(), strict=False)) for column in colours.T)
    opposite = luminance["opposite"]
    return {
        "model": entry.name,
        "luminance": luminance,
        "sun_side_ratio": luminance["sun_side"] / opposite if opposite > 0 else None,
        "chromaticity": {name: [x[name], y[name]] for name in ("zenith", "horizon")},
        "diffuse_illuminance": float(weights @ colours[len(VIEWS) :, 2]),
        "outside": _outside(sky, at),
        "white": entry.white or None,
    }


def _outside(sky: HasColour, at: Conditions) -> list[str]:
    """The conditions that are out of a model's valid range, in words."""
    valid, said = getattr(sky, "valid_range", {}), []
    values = getattr(sky, "swept", {}) | {"turbidity": at.turbidity}
    for name, (low, high) in valid.items():
        if name in values and not low <= float(values[name]) <= high:
            said.append(f"{name} is valid from {low:.6g} to {high:.6g}")
    if "sun_zenith" in valid:
        low, high = valid["sun_zenith"]
        if not low - 1e-6 <= at.sun_zenith <= high + 1e-6:
            said.append(
                f"sun is valid from {math.degrees(low):.4g} to {math.degrees(high):.4g} degrees"
            )
    return said


def _dome() -> tuple[Float[np.ndarray, " node"], ...]:
    """View zenith, azimuth and weight of directions over half of the dome.

    The illuminance of the ground is the integral of luminance over cos² θ and azimuth. 12 nodes of
    Gauss-Legendre by 18 midpoints give that of the published sky within 0.05 %.
    """
    nodes, weights = np.polynomial.legendre.leggauss(12)
    azimuth = (np.arange(18) + 0.5) * np.pi / 18
    view = np.arccos(np.sqrt((nodes + 1) / 2))
    view, azimuth = (a.ravel() for a in np.meshgrid(view, azimuth, indexing="ij"))
    return view, azimuth, np.repeat(weights / 2, 18) * np.pi / 18


def _no_zenith(value):
    return ~((value >= 0) & (value <= np.pi))
