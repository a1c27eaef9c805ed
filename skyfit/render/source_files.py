"""From a file, or from none, to what a picture can show."""

from os import PathLike
from pathlib import Path

import numpy as np

from ..campaign.file import load_campaign
from ..campaign.file.load import PAPER_TURBIDITY
from ..dataset import SUFFIXES, load_dataset
from ..dataset.measurements import cornell_skies
from ..errors import InputError
from ..fitting import load_fit
from ..models import AbstractSkyModel, preetham_sky
from .recorded import RecordedSource, select_sky
from .simulated import SimulatedSource
from .sources import AbstractSource, ModelSource


MEASURED = "cornell"


def load_source(
    path: str | PathLike[str] | None,
    turbidity: float | None = None,
    sun_zenith: float | None = None,
    observer_altitude: float = 0.0,
) -> AbstractSource:
    """The sky of a file, the published model, or a measured sky.

    Args:
        path: A fit (.json), a campaign file (.toml) whose sky is simulated, a dataset (.zarr or
            .nc), "cornell" for the measured skies; None for the published model.
        turbidity: Turbidity of the published model, 3 by default; of a fit or campaign or dataset
            that has several (or the value of what else it sweeps); and of the air before the sun
            where the sky does not know it. A model's is held within its range, which its name says.
        sun_zenith: Zenith angle of the sun that tells a dataset's skies apart [rad].
        observer_altitude: Altitude of the eye, for simulated skies [m].

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
    if path is None:
        value = PAPER_TURBIDITY if turbidity is None else turbidity
        sky = preetham_sky(value)
        used, held = _held(sky, "turbidity", value)
        return ModelSource(sky, used, f"Preetham, Shirley & Smits (1999), {held}")
    if path.suffix == ".json":
        return _fitted(path, turbidity)
    if path.suffix == ".toml":
        return _simulated(path, turbidity, observer_altitude)
    if path.suffix in SUFFIXES:
        sky = select_sky(load_dataset(path), str(path), turbidity, sun_zenith)
        return RecordedSource(sky, path.name, turbidity)
    if str(path) == MEASURED:
        sky = select_sky(cornell_skies(), MEASURED, None, sun_zenith)
        minutes = int(sky["local_time"])
        name = f"Ithaca, 2013-05-27 {minutes // 60:02d}:{minutes % 60:02d}"
        return RecordedSource(sky, f"{name}, measured by Kider et al. (2014)", turbidity)
    raise InputError(
        f"{path}: expected a fit (.json), a campaign (.toml), a dataset (.zarr, .nc) or {MEASURED}"
    )


def _fitted(path: Path, turbidity: float | None) -> ModelSource:
    fit = load_fit(path)
    if len(fit.swept) > 1:
        raise InputError(
            f"{path}: a fit over {', '.join(fit.swept)}; expected one parameter, or none"
        )
    if fit.parameter_name == "turbidity":
        value = _needed(turbidity, str(path))
        sky = fit.sky(turbidity=value)
        used, held = _held(sky, "turbidity", value)
        return ModelSource(sky, used, f"{path.name}, {held}")
    if (name := fit.parameter_name) is not None:
        value = _needed(turbidity, str(path), name)
        sky = fit.sky(**{name: value})
        return ModelSource(sky, None, f"{path.name}, {_held(sky, name, value)[1]}")
    return ModelSource(fit.sky(), turbidity, path.name)


def _held(sky: AbstractSkyModel, name: str, value: float) -> tuple[float, str]:
    """The value that is used of a parameter, which differs outside its range; and both in words."""
    low, high = sky.valid_range[name]
    used = min(max(value, low), high)
    return used, f"{name} {value:g}" + ("" if used == value else f" taken as {used:g}")


def _simulated(path: Path, value: float | None, altitude: float) -> SimulatedSource:
    campaign = load_campaign(path)
    swept, values = campaign.swept
    if value is None:
        if len(values) > 1:
            there = ", ".join(f"{one:g}" for one in values)
            raise InputError(
                f"{path}: expected one {swept} (turbidity=...), such as one of {there}; got none"
            )
        value = float(next(iter(values)))
    elif swept is None:
        raise InputError(f"{path}: sweeps nothing; got the value {value:g}")
    if campaign.geometry != "spherical":
        raise InputError(f"{path}: pictures are spherical; got the geometry {campaign.geometry!r}")
    name = f"{path.name}, simulated" + ("" if swept is None else f", {swept} {value:g}")
    return SimulatedSource(
        campaign.build_atmosphere(value), name, campaign.orders, campaign.quality,
        altitude or campaign.observer_altitude_at(value),
    )  # fmt: skip


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
