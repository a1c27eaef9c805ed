"""The reality check: the measured skies of Cornell against formulas and simulation."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from ..campaign import Campaign
from ..colour import luminance
from ..dataset.measurements import cornell_skies
from ..dataset.runner import run_campaign
from ..models import AbstractSkyModel
from ..render.half_dome import grid_axes, on_dome


# Of that day, as published comparisons on these skies take it. It is Linke's turbidity; their haze,
# by Ångström's law with 0.04 and 0.8, is 1.56 as Preetham et al. define turbidity.
TURBIDITY = 2.53
# As many as the paper's campaign has, so that one compiled program serves both; the error is taken
# over those up to 720 nm, as in published comparisons.
WAVELENGTHS = 360 + 11.75 * np.arange(41)
COMPARED = WAVELENGTHS <= 720


@dataclass(frozen=True)
class Reality:
    """Measured skies, and what models make of them.

    Attributes:
        skies: The measured, reliable directions only.
        measured: Their radiance at `WAVELENGTHS`, [time, direction, wavelength].
        modelled: Radiance of each model, by its name [W m⁻² sr⁻¹ nm⁻¹].
    """

    skies: xr.Dataset
    measured: np.ndarray
    modelled: dict[str, np.ndarray]

    def rmse_over_time(self) -> dict[str, np.ndarray]:
        """Root mean square error over directions and wavelengths [mW m⁻² sr⁻¹ nm⁻¹], [time]."""
        return {
            name: 1e3 * np.sqrt(np.mean((guess - self.measured)[..., COMPARED] ** 2, axis=(1, 2)))
            for name, guess in self.modelled.items()
        }

    def rmse(self) -> dict[str, float]:
        """Root mean square error over directions, wavelengths and times [mW m⁻² sr⁻¹ nm⁻¹]."""
        return {
            name: float(np.sqrt(np.mean(errors**2)))
            for name, errors in self.rmse_over_time().items()
        }

    def luminance_ratio(self) -> dict[str, float]:
        """Mean luminance over directions and times, over the measured one."""
        truth = np.mean(np.asarray(luminance(self.measured, WAVELENGTHS)))
        return {
            name: float(np.mean(np.asarray(luminance(guess, WAVELENGTHS))) / truth)
            for name, guess in self.modelled.items()
        }

    def record(self) -> dict[str, object]:
        """For report.json."""
        times, directions = self.measured.shape[:2]
        return {
            "skies": f"{self.skies.attrs['title']}: {times} times, {directions} directions",
            "turbidity": TURBIDITY,
            "rmse_mW_m-2_sr-1_nm-1": self.rmse(),
            "luminance_ratio": self.luminance_ratio(),
        }


def compare_with_cornell(
    models: Mapping[str, AbstractSkyModel], simulation: np.ndarray | None = None
) -> Reality:
    """Set models, and a simulation, beside the measured skies.

    Args:
        models: Models of the day's turbidity, by name.
        simulation: Skies of `simulate_cornell`.
    """
    skies = _reliable_skies()
    suns, views = skies["sun_zenith"].values[:, None], skies["view_zenith"].values[None, :]
    azimuths = skies["relative_azimuth"].values
    modelled = {
        name: np.asarray(model.radiance(suns, views, azimuths, WAVELENGTHS))
        for name, model in models.items()
    }
    if simulation is not None:
        modelled["simulated"] = simulation
    measured = skies["radiance"].interp(wavelength=WAVELENGTHS).values
    return Reality(skies, measured, modelled)


def simulate_cornell(template: Campaign, workers: int = 1) -> np.ndarray:
    """Simulate the paper's atmosphere under the measured suns.

    The directions of the campaign are simulated and interpolated between. Below 380 nm the paper's
    tables are held at their ends.

    Args:
        template: Campaign whose directions, atmosphere, orders, geometry and quality are taken.
        workers: Threads.

    Returns:
        [time, direction, wavelength] in W m⁻² sr⁻¹ nm⁻¹.
    """
    skies = _reliable_skies()
    suns = skies["sun_zenith"].values
    campaign = Campaign(
        turbidity=TURBIDITY,
        sun_zenith=np.sort(suns),
        view_zenith=template.view_zenith,
        relative_azimuth=template.relative_azimuth,
        wavelengths=WAVELENGTHS,
        atmosphere=template.atmosphere,
        orders=template.orders,
        geometry=template.geometry,
        quality=template.quality,
    )
    dataset = run_campaign(campaign, workers=workers, suns_per_call=len(template.sun_zenith))
    axes = grid_axes(dataset)
    view = skies["view_zenith"].values
    light = np.empty((suns.size, view.size, WAVELENGTHS.size))
    for time, azimuth in enumerate(skies["relative_azimuth"].values):
        sky = dataset["radiance"].isel(turbidity=0).sel(sun_zenith=suns[time])
        for number, values in enumerate(np.log(sky.values).T):
            light[time, :, number] = np.exp(on_dome(*axes, values)(view, azimuth))
    return light


def _reliable_skies() -> xr.Dataset:
    skies = cornell_skies()
    return skies.isel(direction=skies["reliable"].values)
