"""The paper's reason for fitting x and y: whether X and Z take the formula as well."""

import numpy as np
import xarray as xr

from .._typing import as_float
from ..fitting import SkyFit
from ..fitting.channels import read_channels
from ..fitting.fit import fit_formula
from ..judging import shape_error


def tristimulus_comparison(dataset: xr.Dataset, fit: SkyFit) -> dict[str, dict[str, float]]:
    """Fit X and Z like Y, and set the colours that follow beside those from x and y.

    Args:
        dataset: Simulated skies.
        fit: Fit of the skies' Y, x and y.

    Returns:
        `shape_error` of X, Z, Y, x and y, and `chromaticity_rms`: the root mean square error of
        (x, y) from fits of X, Y, Z and from fits of x, y; with the simulated zenith, and over the
        directions that `shape_error` counts.
    """
    x, y, luminance = (dataset[name] for name in ("x", "y", "luminance"))
    skies = {
        "X": dataset.assign(luminance=x / y * luminance),
        "Z": dataset.assign(luminance=(1 - x - y) / y * luminance),
    }
    fits = {name: fit_formula(read_channels(one, "Yxy")) for name, one in skies.items()}
    errors = {name: shape_error(fits[name], skies[name])["Y"] for name in fits}

    def rebuilt(one: SkyFit, name: str, channel: int, sky: xr.Dataset) -> np.ndarray:
        """Fitted shape times simulated zenith."""
        values = sky[name].values
        zenith = values[..., int(np.argmin(sky["view_zenith"].values)), None]
        return _shapes(sky, one)[..., channel] * zenith

    tristimulus = [
        rebuilt(fits["X"], "luminance", 2, skies["X"]),
        rebuilt(fit, "luminance", 2, dataset),
        rebuilt(fits["Z"], "luminance", 2, skies["Z"]),
    ]
    total = sum(tristimulus)
    detour = np.stack([part / total for part in tristimulus[:2]])
    direct = np.stack([rebuilt(fit, "x", 0, dataset), rebuilt(fit, "y", 1, dataset)])
    truth = np.stack([x.values, y.values])
    counted = dataset["view_zenith"].values <= fit.settings["max_view_zenith"] + 1e-6

    def rms(guess: np.ndarray) -> float:
        return float(np.sqrt(np.mean((guess - truth)[..., counted] ** 2)))

    return {
        "shape_error": errors | shape_error(fit, dataset),
        "chromaticity_rms": {"from X, Y, Z": rms(detour), "from x, y": rms(direct)},
    }


def _shapes(dataset: xr.Dataset, fit: SkyFit) -> np.ndarray:
    """F / F(0, θₛ) of a fit for every sky, [turbidity, sun, direction, channel]."""
    sun = as_float(dataset["sun_zenith"].values)[:, None]
    view, azimuth = (as_float(dataset[n].values)[None] for n in ("view_zenith", "relative_azimuth"))
    skies = [fit.sky(turbidity=turbidity) for turbidity in dataset["turbidity"].values]
    return np.stack([np.asarray(sky.relative(sun, view, azimuth)) for sky in skies])
