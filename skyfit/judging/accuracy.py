"""How far skies differ in shape, and how well a fit gives known coefficients back."""

from collections.abc import Callable
from typing import Any

import numpy as np
from jaxtyping import Float

from ..angles import as_zenith
from ..campaign import PAPER_SUN_ZENITHS_DEG, PAPER_TURBIDITIES, paper_directions
from ..errors import InputError
from ..fitting import SkyFit
from ..fitting.choices import MAX_VIEW_ZENITH
from ..fitting.fit import fit_formula
from ..fitting.skies import Skies, read_skies
from ..models import AbstractSkyModel, FormulaSky, preetham_sky
from ..models.formula import CHANNELS
from ..models.preetham import published_coefficients


Sky = Any  # an xarray.Dataset, a fit, a model, or a function from turbidity to a model


def shape_error(
    value: Sky, reference: Sky, *, max_view_zenith: float = float(MAX_VIEW_ZENITH)
) -> dict[str, float]:
    """Relative RMS of F / F₀, each value over the zenith's, of one sky against another.

    Every direction, sun and value of the swept parameter counts equally.

    Args:
        value: A dataset, a `SkyFit`, a sky model, or a function of the parameter that gives one,
            such as `skyfit.preetham_sky`.
        reference: Sky of the same kinds to which the error is relative.
        max_view_zenith: Leave out directions closer to the horizon [rad].

    Returns:
        For "Y", "x" and "y". The directions are those of the dataset, or of the paper's campaign
        where both are models.

    Raises:
        ValueError: A dataset has no zenith direction, or two have different skies.
    """
    as_zenith(max_view_zenith, "shape_error(max_view_zenith=...)")
    tables = [read_skies(d, "shape_error") if _is_dataset(d) else None for d in (value, reference)]
    sampling = tables[1] or tables[0] or paper_skies(preetham_sky)
    shapes = [
        _dataset_shape(table, sampling) if table else _model_shape(sky, sampling)
        for sky, table in zip((value, reference), tables, strict=True)
    ]
    inside = sampling.view_zenith <= max_view_zenith + 1e-6
    error = (shapes[0] / shapes[1] - 1)[:, inside]
    rms = np.sqrt(np.mean(error**2, axis=-1))
    return {name: float(rms[CHANNELS.index(name)]) for name in ("Y", "x", "y")}


def recovery_error() -> dict[str, float]:
    """Largest absolute error of the coefficients when the published model is fitted.

    Skies of the published model at the paper's 5 turbidities, 12 suns and 343 directions are
    fitted jointly from the cold starts of `Perez`: A -1, B -0.32, C 10, D -3, E 0.45
    for Y, and A -0.3, B -0.2, C 0.2, D -1.2, E 0.04 for x and y, at every turbidity. Below 1e-9 in
    float64; float32, where x64 is off, cannot promise better than some percent.

    Returns:
        For "Y", "x" and "y", over the slopes and intercepts of A to E.
    """
    fit = fit_formula(paper_skies(preetham_sky))
    published = dict(zip(CHANNELS, published_coefficients(), strict=True))
    return {
        name: float(np.abs(fit.coefficients[name] - published[name]).max())
        for name in ("Y", "x", "y")
    }


def paper_skies(model_at: Callable[[float], AbstractSkyModel]) -> Skies:
    """Skies of a model at the turbidities, suns and directions of the paper's campaign."""
    view, azimuth = paper_directions()
    suns, turbidities = np.radians(PAPER_SUN_ZENITHS_DEG), np.array(PAPER_TURBIDITIES)
    count = turbidities.size * suns.size, view.size
    colours = [
        np.asarray(model_at(float(t)).xyY(suns[:, None], view, azimuth), float) for t in turbidities
    ]
    values = np.moveaxis(np.concatenate(colours), -1, 0)
    return Skies(
        swept={"turbidity": np.repeat(turbidities, suns.size)},
        sun_zenith=np.tile(suns, turbidities.size),
        view_zenith=np.broadcast_to(view, count),
        relative_azimuth=np.broadcast_to(azimuth, count),
        values=values,
        zenith=values[..., 0],
        shape=(turbidities.size, suns.size),
    )


def _relative(model, sun_zenith, view_zenith, relative_azimuth):
    if isinstance(model, FormulaSky) and model.kind == "Yxy":
        return model.relative(sun_zenith, view_zenith, relative_azimuth)
    zenith = model.xyY(sun_zenith, np.zeros_like(view_zenith), relative_azimuth)
    return model.xyY(sun_zenith, view_zenith, relative_azimuth) / zenith


def _is_dataset(sky: Sky) -> bool:
    return hasattr(sky, "data_vars")


def _dataset_shape(table: Skies, sampling: Skies) -> Float[np.ndarray, "channel sky direction"]:
    if table.zenith is None:
        raise InputError("shape_error: a dataset without a zenith direction has no F / F₀")
    pairs = [(getattr(table, n), getattr(sampling, n)) for n in ("view_zenith", "relative_azimuth")]
    pairs += [(table.sun_zenith, sampling.sun_zenith)]
    pairs += [(table.swept.get(name), values) for name, values in sampling.swept.items()]
    same = len(table.swept) == len(sampling.swept) and all(
        one is not None and one.shape == other.shape and np.allclose(one, other)
        for one, other in pairs
    )
    if not same:
        raise InputError("shape_error: expected datasets of the same skies and directions")
    return table.values / table.zenith[..., None]


def _model_shape(sky: Sky, sampling: Skies) -> Float[np.ndarray, "channel sky direction"]:
    shape = np.empty((len(CHANNELS), *sampling.view_zenith.shape))
    table = np.stack([np.zeros(sampling.count), *sampling.swept.values()], axis=1)
    for values in np.unique(table, axis=0):
        rows = (table == values).all(axis=1)
        model = _model_at(sky, dict(zip(sampling.swept, values[1:].tolist(), strict=True)))
        views = sampling.view_zenith[rows], sampling.relative_azimuth[rows]
        relative = _relative(model, sampling.sun_zenith[rows][:, None], *views)
        shape[:, rows] = np.moveaxis(np.asarray(relative, float), -1, 0)
    return shape


def _model_at(sky: Sky, at: dict[str, float]) -> AbstractSkyModel:
    if isinstance(sky, SkyFit):
        return sky.sky(**{name: at[name] for name in sky.swept})
    return sky if isinstance(sky, AbstractSkyModel) else sky(*at.values())
