"""What the package promises by name."""

import ast
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import skyfit
from skyfit.provenance import versions


ROOT = Path(__file__).parent.parent
PUBLIC = {
    "AerosolFit",
    "AccuracyWarning",
    "AerialPerspective",
    "Atmosphere",
    "Bands",
    "Campaign",
    "ConstantAmbient",
    "Constituent",
    "Dependence",
    "InputError",
    "PaperAtmosphere",
    "Refraction",
    "Sensitivity",
    "SkyFit",
    "aerial_perspective",
    "aeronet_aerosol",
    "cie_clear_sky",
    "cie_general_sky",
    "cie_intermediate_sky",
    "cie_overcast_sky",
    "clear_sky_irradiance",
    "coefficient_sensitivity",
    "coefficient_table",
    "colour_claim",
    "compare_weights",
    "compare_skies",
    "cornell_skies",
    "day_course",
    "day_sky",
    "export_fit",
    "fit_aerosol",
    "fit_sky",
    "load_atmosphere",
    "ladder",
    "hoffman_preetham_aerial",
    "hoffman_preetham_sky",
    "load_campaign",
    "load_dataset",
    "load_fit",
    "overcast_blend_sky",
    "oxygen",
    "perez_all_weather_sky",
    "perez_clear_sky",
    "positivity",
    "preetham_atmosphere",
    "preetham_sky",
    "radiance_scene",
    "read_aeronet",
    "read_sky_scanner",
    "read_weather",
    "recovery_error",
    "reproduce",
    "run_benchmarks",
    "run_campaign",
    "save_dataset",
    "scs_air",
    "scs_atmosphere",
    "scs_sky",
    "shape_error",
    "simulate",
    "sun_at",
    "sun_irradiance",
    "sun_position",
    "sun_table",
    "sun_xyY",
    "sunlight",
    "ward_larson_aerial",
    "water_vapour",
    "weather_table",
}
MODULES = {
    "angles",
    "marcher",
    "models",
    "phase",
    "plots",
    "profile",
    "render",
    "surfaces",
    "turbidity",
}


def test_public_names_change_only_on_purpose():
    names = {name for name in dir(skyfit) if not name.startswith("_")}
    things = {name for name in names if not isinstance(getattr(skyfit, name), ModuleType)}
    assert things - {"TYPE_CHECKING", "Any", "import_module"} == PUBLIC
    assert names >= MODULES


def test_type_checkers_see_the_names_that_are_loaded_on_demand():
    tree = ast.parse(Path(skyfit.__file__).read_text())
    block = next(node for node in tree.body if isinstance(node, ast.If))
    imports = [node for node in block.body if isinstance(node, ast.ImportFrom)]
    assert {alias.asname for node in imports for alias in node.names} == PUBLIC | MODULES


def test_an_unknown_name_is_refused_like_any_attribute():
    with pytest.raises(AttributeError, match="no attribute 'sky_of_mars'"):
        skyfit.sky_of_mars  # noqa: B018


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_every_public_name_is_documented(name):
    assert getattr(skyfit, name).__doc__


def test_the_version_is_that_of_the_installed_package():
    declared = re.search(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(), re.M)
    assert declared
    # From a source tree that nobody installed there is none to tell.
    assert skyfit.__version__ in (declared[1], "unreleased")
    assert skyfit.__version__ == versions()["skyfit"]


def test_type_checkers_of_programs_that_use_it_are_told_of_its_annotations():
    assert (Path(skyfit.__file__).parent / "py.typed").exists()


@pytest.mark.slow
def test_importing_skyfit_loads_nothing_heavy():
    heavy = "optimistix xarray matplotlib pydantic colour zarr rich"
    code = (
        "import sys, skyfit; skyfit.simulate; skyfit.preetham_sky; skyfit.Campaign\n"
        f"print([name for name in {heavy.split()} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
def test_importing_skyfit_leaves_the_precision_of_jax_alone():
    code = "import jax, skyfit; skyfit.simulate; print(jax.config.jax_enable_x64)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
