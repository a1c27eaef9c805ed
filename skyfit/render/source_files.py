"""From a file, or from none, to what a picture can show."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path

import numpy as np

from ..campaign.file import load_campaign
from ..campaign.file.load import PAPER_TURBIDITY
from ..dataset import SUFFIXES, load_dataset
from ..dataset.measurements import cornell_skies
from ..errors import InputError
from ..fitting import SkyFit, load_fit, paper_refit
from ..models import AbstractSkyModel, preetham_sky
from .recorded import RecordedSource, refuse_others, select_sky
from .simulated import SimulatedSource
from .sources import AbstractSource, ModelSource


MEASURED, PUBLISHED, REFIT = "cornell", "published", "refit"


def load_source(
    path: str | PathLike[str] | None,
    turbidity: float | None = None,
    sun_zenith: float | None = None,
    observer_altitude: float = 0.0,
    parameters: Mapping[str, float] | None = None,
) -> AbstractSource:
    """The sky of a file, the published model, or a measured sky.

    Args:
        path: A fit (.json), a campaign file (.toml) whose sky is simulated, a dataset (.zarr or
            .nc), "cornell" for the measured skies, "refit" for the paper's formula fitted to its
            campaign; None or "published" for the published model.
        turbidity: Turbidity of the published model, 3 by default; of a fit or campaign or dataset
            that has several (or the value of what else it sweeps); and of the air before the sun
            where the sky does not know it. A model's is held within its range, which its name says.
        sun_zenith: Zenith angle of the sun that tells a dataset's skies apart [rad].
        observer_altitude: Altitude of the eye, for simulated skies [m].
        parameters: Values of what a fit was made for, or a campaign or dataset sweeps, by name; the
            turbidity may be among them.

    Raises:
        FileNotFoundError: There is no such file.
        InputError: The file is none of these; the turbidity is missing, or out of place.
    """
    path = None if path is None else Path(path)
    if observer_altitude and (path is None or path.suffix != ".toml"):
        raise InputError(
            f"{path or 'the published model'}: only simulated skies (.toml) can be seen from an "
            f"altitude; got {observer_altitude:g} m"
        )
    words, given = str(path), dict(parameters or {})
    if turbidity is not None and "turbidity" in given:
        raise InputError(f"{path or 'the published model'}: expected one turbidity; got two")
    if path is None or words == PUBLISHED:
        asked = given.pop("turbidity", turbidity)
        value = PAPER_TURBIDITY if asked is None else asked
        refuse_others(given, "the published model", ["turbidity"])
        sky = preetham_sky(value)
        used, held = _held(sky, "turbidity", value)
        return ModelSource(sky, used, f"Preetham, Shirley & Smits (1999), {held}")
    if words == REFIT or path.suffix == ".json":
        fit = paper_refit() if words == REFIT else load_fit(path)
        return _fitted(fit, path, turbidity, given)
    if path.suffix == ".toml":
        return _simulated(path, turbidity, observer_altitude, given)
    if path.suffix in SUFFIXES:
        sky = select_sky(load_dataset(path), str(path), turbidity, sun_zenith, given)
        return RecordedSource(sky, path.name, given.get("turbidity", turbidity))
    refuse_others(given, words, [])
    if words == MEASURED:
        sky = select_sky(cornell_skies(), MEASURED, None, sun_zenith)
        minutes = int(sky["local_time"])
        name = f"Ithaca, 2013-05-27 {minutes // 60:02d}:{minutes % 60:02d}"
        return RecordedSource(sky, f"{name}, measured by Kider et al. (2014)", turbidity)
    raise InputError(
        f"{path}: expected a fit (.json), a campaign (.toml), a dataset (.zarr, .nc), {PUBLISHED}, "
        f"{REFIT} or {MEASURED}"
    )


def _fitted(
    fit: SkyFit, path: Path, turbidity: float | None, given: dict[str, float]
) -> ModelSource:
    names = list(fit.swept)
    refuse_others(given, str(path), names)
    values, haze = dict(given), turbidity
    if "turbidity" in names and turbidity is not None:
        values.setdefault("turbidity", turbidity)
    elif len(names) == 1 and names[0] not in values:
        # The value of what else is swept; then nothing is known of the air before the sun.
        values[names[0]], haze = _needed(turbidity, str(path), names[0]), None
    if missing := [name for name in names if name not in values]:
        ours = ", ".join(f"{name}=VALUE" for name in missing)
        raise InputError(
            f"{path}: a fit over {', '.join(names)}; expected {ours} (--set, parameters=...)"
        )
    sky = fit.sky(**values)
    told = [_held(sky, name, values[name])[1] for name in names]
    if "turbidity" in names:
        haze = _held(sky, "turbidity", values["turbidity"])[0]
    return ModelSource(sky, haze, ", ".join([path.name, *told]))


def _held(sky: AbstractSkyModel, name: str, value: float) -> tuple[float, str]:
    """The value that is used of a parameter, which differs outside its range; and both in words."""
    low, high = sky.valid_range[name]
    used = min(max(value, low), high)
    return used, f"{name} {value:g}" + ("" if used == value else f" taken as {used:g}")


def _simulated(
    path: Path, turbidity: float | None, altitude: float, given: Mapping[str, float]
) -> SimulatedSource:
    campaign = load_campaign(path)
    place = _chosen(path, campaign.swept, turbidity, given)
    if campaign.geometry != "spherical":
        raise InputError(f"{path}: pictures are spherical; got the geometry {campaign.geometry!r}")
    told = [f"{name} {value:g}" for name, value in place.items()]
    return SimulatedSource(
        campaign.build_atmosphere(**place), ", ".join([f"{path.name}, simulated", *told]),
        campaign.orders, campaign.quality, altitude or campaign.observer_altitude_at(**place),
    )  # fmt: skip


def _chosen(
    path: Path,
    swept: Mapping[str, tuple[float, ...]],
    turbidity: float | None,
    given: Mapping[str, float],
) -> dict[str, float]:
    """A value of every swept parameter: the one given, or the only one there is."""
    refuse_others(given, str(path), list(swept))
    place = dict(given)
    if turbidity is not None:
        if not swept:
            raise InputError(f"{path}: sweeps nothing; got the value {turbidity:g}")
        name = "turbidity" if "turbidity" in swept else next(iter(swept))
        if len(swept) > 1 and name != "turbidity":
            raise InputError(
                f"{path}: sweeps {', '.join(swept)}; expected NAME=VALUE of each (--set, "
                f"parameters=...); got the value {turbidity:g}"
            )
        place.setdefault(name, turbidity)
    for name, values in swept.items():
        if name not in place and len(values) > 1:
            there = ", ".join(f"{one:g}" for one in values)
            how = "turbidity=..." if len(swept) == 1 else "--set, parameters=..."
            raise InputError(
                f"{path}: expected one {name} ({how}), such as one of {there}; got none"
            )
        place.setdefault(name, next(iter(values)))
    return {name: place[name] for name in swept}


def _needed(value: float | None, what: str, name: str = "turbidity") -> float:
    if value is None:
        ours = "a turbidity" if name == "turbidity" else f"a value of {name} (as turbidity)"
        raise InputError(f"{what}: expected {ours}; got none")
    return value


def sun_of(source: AbstractSource, sun_zenith: float | None) -> float:
    """The sun's zenith angle [rad]: the one given, else that of a recorded sky, else 45°."""
    if sun_zenith is not None:
        return sun_zenith
    return source.sun_zenith if isinstance(source, RecordedSource) else float(np.radians(45.0))
