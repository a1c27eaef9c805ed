"""Exports of every shape, dependence and kind of channel, compiled and run against their models."""

import itertools
import json

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from exported import run, validate_shader
from test_export import EDGES, expected, random_rows, rows, worst
from test_models_formula import BASES, free_start, sky_of

from skyfit.export import export_fit
from skyfit.models.axes import Chebyshev
from skyfit.models.basis import Basis
from skyfit.models.domes import DISTRIBUTIONS, distribution_from


WAVELENGTHS = [420.0, 520.5, 640.0]
# Every shape and every dependence, each with each kind of channel somewhere
CASES = [
    ("perez", "nodes", "Yxy"),
    ("cie", "cosine", "XYZ"),
    ("hosek-wilkie", "root", "RGB"),
    ("series", "polynomial", "bands"),
    ("hosek-wilkie", "polynomial", "Yxy"),
    ("series", "nodes", "XYZ"),
    ("series", "total", "XYZ"),
]


# Which of a distribution's starts for a chromaticity is nearly uniform.
NEARLY_UNIFORM = {"perez": 0, "cie": -1, "hosek-wilkie": -1, "series": 0}


def sky(shape, basis, kind):
    bands = WAVELENGTHS if kind == "bands" else None
    model = sky_of(distribution_from({"name": shape}), BASES[basis], kind, bands)
    if kind != "Yxy":
        return model
    # Chromaticities are nearly uniform, around 0.3.
    only = BASES[basis].constant()
    start = free_start(model.distribution, NEARLY_UNIFORM[shape], "x")
    numbers = model.numbers.at[:2].set(start[:, None] * only)
    scales = model.scale.numbers.at[:2].set(np.log(0.3) * only)
    return eqx.tree_at(lambda m: (m.numbers, m.scale.numbers), model, (numbers, scales))


def at_turbidity(model, data):
    return eqx.tree_at(lambda m: m.swept["turbidity"], model, jnp.asarray(data[:, 9]))


def compared(model, language, where, seed, deepest_sun):
    """Largest relative error of an exported sky where there is light and colour to speak of."""
    data = random_rows(seed, 10_000, deepest_sun=deepest_sun)
    want = expected(at_turbidity(model, data), data)
    xyz = want[:, 3:6]
    lit = (want[:, 1] > 0.05) & (xyz.min(axis=1) > 0.02 * xyz.max(axis=1)) & (xyz[:, 1] > 0)
    assert lit.sum() > 3000
    return worst(run(export_fit(model, language), language, data, where)[lit], want[lit])


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "basis", "kind"), CASES)
@pytest.mark.parametrize("language", ["c", "glsl"])
def test_directions_have_the_models_colours(shape, basis, kind, language, tmp_path):
    model, single = sky(shape, basis, kind), language == "glsl"
    found = compared(model, language, tmp_path, 7, 88.0 if single else 100.0)
    # Numbers are written with twelve digits; sums of many terms of both signs lose some.
    assert found < (1e-4 if single else 1e-7)


@pytest.mark.parametrize("language", ["hlsl", "js", "python"])
def test_other_languages_have_the_models_colours(language, tmp_path):
    found = compared(sky("hosek-wilkie", "root", "XYZ"), language, tmp_path, 8, 88.0)
    assert found < (1e-4 if language == "hlsl" else 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "basis"), list(itertools.product(DISTRIBUTIONS, BASES)))
def test_every_formula_is_taken_by_glslang(shape, basis, tmp_path):
    code = export_fit(sky(shape, basis, "XYZ"), "glsl")
    main = (
        "layout(location = 0) out vec4 colour;\n"
        "void main() { colour = vec4(sky_rgb(vec3(0.0, 0.6, 0.8), vec3(0, 0, 1), 3.0), 1); }"
    )
    done = validate_shader(f"#version 450\n{code}\n{main}\n", tmp_path)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(("shape", "basis", "kind"), CASES)
def test_nothing_breaks_at_the_horizon_at_the_sun_and_at_night(shape, basis, kind, tmp_path):
    sun, view, azimuth = np.meshgrid(EDGES, EDGES, [0.0, np.pi])
    code = export_fit(sky(shape, basis, kind), "c")
    got = run(code, "c", rows(sun, view, azimuth, 3.0), tmp_path)
    assert np.isfinite(got).all()
    grid = got.reshape(*sun.shape, 12)[..., 3:6]
    size = np.abs(grid).max()
    # √cos θ falls from 0.0013 to its least value, 0.01, within 0.0001° of the horizon.
    np.testing.assert_allclose(grid[3], grid[5], atol=2e-3 * size)
    np.testing.assert_allclose(grid[:, 3], grid[:, 5], atol=2e-3 * size)


@pytest.mark.slow
def test_a_formula_of_one_sky_takes_no_parameter(tmp_path):
    basis = Basis((Chebyshev("sun_zenith", (0.1, 1.4), 2),))
    model = sky_of(distribution_from({"name": "cie"}), basis)
    data = random_rows(9, 1000, swept=False)
    got = run(export_fit(model, "c"), "c", data, tmp_path)
    assert worst(got, expected(model, data)) < 1e-9


def test_json_has_every_number_and_the_bands():
    model = sky("hosek-wilkie", "nodes", "bands")
    document = json.loads(export_fit(model, "json"))
    assert document["distribution"]["name"] == "hosek-wilkie"
    assert [axis["kind"] for axis in document["basis"]] == ["tents", "tents"]
    table = document["numbers"]["radiance_420nm"]
    np.testing.assert_array_equal(table, model.numbers[0])
    assert "radiance_520_5nm" in document["numbers"]
    np.testing.assert_array_equal(document["scale"]["numbers"], model.scale.numbers)
