"""From a file, or from none, to what a picture can show."""

from pathlib import Path

from ..fitting import load_fit
from ..models import preetham_sky
from ..preetham_air import preetham_atmosphere
from .sources import AbstractSource, ModelSource


def load_source(path: Path | None, turbidity: float | None) -> AbstractSource:
    """The sky of a file, or the published model.

    Args:
        path: A fit (.json); None for the published model.
        turbidity: Of the published model, and of a fit that was swept over it.

    Raises:
        ValueError: The file is none of these; the turbidity is missing, or out of place.
    """
    if path is None:
        value = _needed(turbidity, "the published model")
        name = f"Preetham, Shirley & Smits (1999), turbidity {value:g}"
        return ModelSource(preetham_sky(value), preetham_atmosphere(value), name)
    if path.suffix == ".json":
        return _fitted(path, turbidity)
    raise ValueError(f"{path}: expected a fit (.json)")


def _fitted(path: Path, turbidity: float | None) -> ModelSource:
    fit = load_fit(path)
    if fit.parameter_name == "turbidity":
        value = _needed(turbidity, str(path))
        name = f"{path.name}, turbidity {value:g}"
        return ModelSource(fit.sky(turbidity=value), preetham_atmosphere(value), name)
    if fit.parameter_name is not None:
        raise ValueError(f"{path}: swept over {fit.parameter_name}; expected turbidity or nothing")
    air = None if turbidity is None else preetham_atmosphere(turbidity)
    return ModelSource(fit.sky(), air, path.name)


def _needed(turbidity: float | None, what: str) -> float:
    if turbidity is None:
        raise ValueError(f"{what}: expected a turbidity; got none")
    return turbidity
