"""Differentiable simulation of clear skies, and refitting of analytic sky models.

The road: `Atmosphere` → `simulate` / `run_campaign` → sky dataset → `fit_sky` → `SkyFit` → a sky
model with `xyY`, `radiance` and `rgb`. Published models need no dataset: `preetham_sky`.

Units are SI, angles in radians, wavelengths in nm; a spectral result has its wavelength axis last.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any


# Every name is loaded when it is first asked for: fitting, files and pictures bring optimistix,
# xarray and matplotlib with them, which a user of the formulas alone should not wait for.
if TYPE_CHECKING:
    __version__: str
    from . import (
        angles as angles,
        marcher as marcher,
        models as models,
        phase as phase,
        plots as plots,
        profile as profile,
        render as render,
        surfaces as surfaces,
        turbidity as turbidity,
    )
    from .aerial import (
        AerialPerspective as AerialPerspective,
        ConstantAmbient as ConstantAmbient,
        aerial_perspective as aerial_perspective,
        hoffman_preetham_aerial as hoffman_preetham_aerial,
        ward_larson_aerial as ward_larson_aerial,
    )
    from .atmosphere import (
        Atmosphere as Atmosphere,
        Constituent as Constituent,
        Refraction as Refraction,
    )
    from .bands import Bands as Bands
    from .benchmark import run_benchmarks as run_benchmarks
    from .campaign import Campaign as Campaign, PaperAtmosphere as PaperAtmosphere
    from .campaign.description.bands import oxygen as oxygen, water_vapour as water_vapour
    from .campaign.file import load_atmosphere as load_atmosphere, load_campaign as load_campaign
    from .compare import compare_skies as compare_skies
    from .dataset import load_dataset as load_dataset, save_dataset as save_dataset
    from .dataset.aeronet import aeronet_aerosol as aeronet_aerosol, read_aeronet as read_aeronet
    from .dataset.measurements import (
        cornell_skies as cornell_skies,
        read_sky_scanner as read_sky_scanner,
    )
    from .dataset.runner import run_campaign as run_campaign
    from .errors import InputError as InputError
    from .export import export_fit as export_fit, radiance_scene as radiance_scene
    from .fitting import (
        Dependence as Dependence,
        SkyFit as SkyFit,
        fit_sky as fit_sky,
        load_fit as load_fit,
        positivity as positivity,
    )
    from .judging import (
        colour_claim as colour_claim,
        compare_weights as compare_weights,
        ladder as ladder,
        recovery_error as recovery_error,
        shape_error as shape_error,
    )
    from .marcher import (
        scs_air as scs_air,
        scs_atmosphere as scs_atmosphere,
        scs_sky as scs_sky,
    )
    from .models import (
        cie_clear_sky as cie_clear_sky,
        cie_general_sky as cie_general_sky,
        cie_intermediate_sky as cie_intermediate_sky,
        cie_overcast_sky as cie_overcast_sky,
        day_course as day_course,
        day_sky as day_sky,
        hoffman_preetham_sky as hoffman_preetham_sky,
        overcast_blend_sky as overcast_blend_sky,
        perez_all_weather_sky as perez_all_weather_sky,
        perez_clear_sky as perez_clear_sky,
        preetham_sky as preetham_sky,
    )
    from .preetham_air import preetham_atmosphere as preetham_atmosphere
    from .report.coefficients import coefficient_table as coefficient_table
    from .report.pipeline import reproduce as reproduce
    from .retrieval import (
        AerosolFit as AerosolFit,
        Sensitivity as Sensitivity,
        coefficient_sensitivity as coefficient_sensitivity,
        fit_aerosol as fit_aerosol,
    )
    from .sun import (
        clear_sky_irradiance as clear_sky_irradiance,
        sun_at as sun_at,
        sun_irradiance as sun_irradiance,
        sun_position as sun_position,
        sun_table as sun_table,
        sun_xyY as sun_xyY,
        sunlight as sunlight,
    )
    from .transfer.simulate_sky import simulate as simulate
    from .transfer.trust import AccuracyWarning as AccuracyWarning
    from .weather import read_weather as read_weather, weather_table as weather_table

_MODULES = (
    "angles",
    "marcher",
    "models",
    "phase",
    "plots",
    "profile",
    "render",
    "surfaces",
    "turbidity",
)
_NAMES = {
    "aerial": (
        "AerialPerspective",
        "ConstantAmbient",
        "aerial_perspective",
        "hoffman_preetham_aerial",
        "ward_larson_aerial",
    ),
    "atmosphere": ("Atmosphere", "Constituent", "Refraction"),
    "bands": ("Bands",),
    "benchmark": ("run_benchmarks",),
    "campaign": ("Campaign", "PaperAtmosphere"),
    "campaign.description.bands": ("oxygen", "water_vapour"),
    "campaign.file": ("load_atmosphere", "load_campaign"),
    "compare": ("compare_skies",),
    "dataset": ("load_dataset", "save_dataset"),
    "dataset.aeronet": ("aeronet_aerosol", "read_aeronet"),
    "dataset.measurements": ("cornell_skies", "read_sky_scanner"),
    "dataset.runner": ("run_campaign",),
    "errors": ("InputError",),
    "export": ("export_fit", "radiance_scene"),
    "fitting": ("Dependence", "SkyFit", "fit_sky", "load_fit", "positivity"),
    "judging": ("colour_claim", "compare_weights", "ladder", "recovery_error", "shape_error"),
    "marcher": ("scs_air", "scs_atmosphere", "scs_sky"),
    "models": (
        "cie_clear_sky",
        "cie_general_sky",
        "cie_intermediate_sky",
        "cie_overcast_sky",
        "day_course",
        "day_sky",
        "hoffman_preetham_sky",
        "overcast_blend_sky",
        "perez_all_weather_sky",
        "perez_clear_sky",
        "preetham_sky",
    ),
    "preetham_air": ("preetham_atmosphere",),
    "report.coefficients": ("coefficient_table",),
    "report.pipeline": ("reproduce",),
    "retrieval": ("AerosolFit", "Sensitivity", "coefficient_sensitivity", "fit_aerosol"),
    "sun": (
        "clear_sky_irradiance",
        "sun_at",
        "sun_irradiance",
        "sun_position",
        "sun_table",
        "sun_xyY",
        "sunlight",
    ),
    "transfer.simulate_sky": ("simulate",),
    "transfer.trust": ("AccuracyWarning",),
    "weather": ("read_weather", "weather_table"),
}
_HOME = {name: home for home, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        value = import_module(".provenance", __name__).package_version("skyfit")
    elif name in _HOME:
        value = getattr(import_module(f".{_HOME[name]}", __name__), name)
    elif name in _MODULES:
        value = import_module(f".{name}", __name__)
    else:
        raise AttributeError(f"module 'skyfit' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_MODULES, *_HOME})
