"""Which pictures a report has, and what their captions say."""

from pathlib import Path

import numpy as np
import xarray as xr

from .._progress import Progress
from ..fitting import SkyFit
from ..models import preetham_sky
from ..plots import style
from ..plots.charts import chromaticity_sections, luminance_sections, zenith_chart
from ..plots.coefficients import coefficient_chart
from ..plots.domes import dome_gallery, error_maps
from ..plots.skies import Source, modelled, simulated
from ..render.half_dome import grid_axes
from .reality import TURBIDITY, Reality
from .reality_chart import reality_chart


ERROR_SCALE = 3.0  # end of the colour scale of error maps: three times too bright


def draw_pictures(
    directory: Path,
    dataset: xr.Dataset,
    fit: SkyFit,
    reality: Reality,
    progress: Progress,
) -> dict[str, tuple[Path, str]]:
    """Draw all pictures into a directory.

    Args:
        directory: Directory that the PNG files go into.
        dataset: Simulated skies, directions on a half dome with the zenith.
        fit: Their fit.
        reality: The comparison with measured skies.
        progress: Called as `progress("pictures", done, total)`.

    Returns:
        By name, the file and its caption.
    """
    turbidities = [float(t) for t in dataset["turbidity"].values]
    sources = {t: _sources(dataset, fit, t) for t in turbidities}
    suns = dataset["sun_zenith"].values
    chosen = [float(suns[k]) for k in _spread(suns.size, 3)]
    angles = ", ".join(f"{np.degrees(sun):.0f}°" for sun in chosen)
    middle = turbidities[len(turbidities) // 2]
    clear = turbidities[len(turbidities) // 3]
    few = sorted({turbidities[0], middle, turbidities[-1]})
    ends = {t: sources[t] for t in (turbidities[0], turbidities[-1])}
    step = float(grid_axes(dataset)[0][1])
    truth = sources[clear]["simulated"]
    models = {name: sources[clear][name] for name in ("refit", "published")}
    fine = np.linspace(suns[0], suns[-1], 45)
    plan = {
        "coefficients": (
            lambda: coefficient_chart(fit),
            "Coefficients over turbidity. The band takes the errors at both ends of the range as "
            "independent. Points: the paper's way, each turbidity fitted by itself.",
        ),
        "luminance_sections": (
            lambda: luminance_sections(ends, chosen, step),
            "Luminance through the sun and the zenith; the grey line marks the sun.",
        ),
        "chromaticity_sections": (
            lambda: chromaticity_sections(sources[middle], middle, chosen, step),
            f"Chromaticity through the sun and the zenith at turbidity {middle:g}.",
        ),
        "domes": (
            lambda: dome_gallery(sources[clear], clear, chosen),
            f"Whole skies at turbidity {clear:g}, the sun {angles} from the zenith. The zenith is "
            "in the middle, the sun's side up; the circle is the sun. Each sun has its own scale "
            "and exposure, the same for the three skies.",
        ),
        "error_maps": (
            lambda: error_maps(truth, models, clear, chosen, ERROR_SCALE),
            f"Luminance of refit and published model over the simulated at turbidity {clear:g}, "
            "laid out as above; below each its root mean square error. The fit leaves out the last "
            "5° above the horizon.",
        ),
        "zenith": (
            lambda: zenith_chart({t: sources[t] for t in few}, suns, fine),
            "Luminance and chromaticity of the zenith over the sun's zenith angle.",
        ),
        "cornell": (
            lambda: reality_chart(reality),
            "Measured skies (Kider et al. 2014): luminance in each direction under the lowest sun, "
            "its side up, rings at zenith angles; mean spectrum over directions and times; error "
            f"over the day. Models at turbidity {TURBIDITY:g}, the refit at its nearest.",
        ),
    }
    pictures = {}
    for done, (name, (draw, caption)) in enumerate(plan.items()):
        progress("pictures", done, len(plan))
        path = directory / f"{name}.png"
        path.write_bytes(style.png(draw()))
        pictures[name] = (path, caption)
    progress("pictures", len(plan), len(plan))
    return pictures


def _sources(dataset: xr.Dataset, fit: SkyFit, turbidity: float) -> dict[str, Source]:
    return {
        "simulated": simulated(dataset, turbidity),
        "refit": modelled(fit.sky(turbidity=turbidity)),
        "published": modelled(preetham_sky(turbidity)),
    }


def _spread(count: int, wanted: int) -> list[int]:
    """Places in a row of so many, from about its first third to its last."""
    return sorted({round(k) for k in np.linspace((count - 1) / 3, count - 1, wanted)})
