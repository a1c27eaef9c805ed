"""Sky datasets made from a model, small enough for tests."""

import numpy as np
import xarray as xr

from skyfit.campaign import half_dome
from skyfit.models import preetham_sky


TURBIDITIES = (2.0, 3.5, 6.0)
SUNS = np.radians([5.0, 30.0, 55.0, 75.0])
DIRECTIONS = half_dome(
    np.radians(np.arange(10.0, 91.0, 10.0)), np.radians([0.0, 15.0, 50.0, 100.0, 180.0])
)


def model_skies(model_at=preetham_sky, turbidities=TURBIDITIES, suns=SUNS, directions=DIRECTIONS):
    """Skies of a model over turbidity and sun, in the form that fits take."""
    view, azimuth = directions
    colours = np.stack(
        [np.asarray(model_at(t).xyY(np.asarray(suns)[:, None], view, azimuth)) for t in turbidities]
    )
    dims = ("turbidity", "sun_zenith", "direction")
    return xr.Dataset(
        {name: (dims, colours[..., k]) for k, name in enumerate(("x", "y", "luminance"))},
        {
            "turbidity": list(turbidities),
            "sun_zenith": np.asarray(suns),
            "view_zenith": ("direction", view),
            "relative_azimuth": ("direction", azimuth),
        },
        {"title": "skies of a model"},
    )


def noisy(data, size, seed=0):
    """The same with independent relative noise, the zenith's own excepted."""
    rng = np.random.default_rng(seed)
    data = data.copy(deep=True)
    away = data["view_zenith"].values > 0
    for name in ("x", "y", "luminance"):
        data[name] = data[name] * (1 + size * away * rng.standard_normal(data[name].shape))
    return data
