"""Exported skies, compiled and run, against the models they were written from."""

import dataclasses
import json

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from exported import LANGUAGES, run, validate_shader
from model_skies import model_skies

import skyfit
from skyfit import cli
from skyfit.angles import unit_vector
from skyfit.colour import xyz_to_rgb, xyz_to_xyY
from skyfit.export import FORMATS, TARGETS, export_fit
from skyfit.export.description import Function
from skyfit.export.dialect import AbstractDialect
from skyfit.export.languages import Glsl, JavaScript, Python
from skyfit.models.basis import Basis
from skyfit.models.scale import CubicZenith, PaperZenith, TangentZenith


PUBLISHED = skyfit.preetham_sky(3.0)
SHADERS = ("glsl", "hlsl")
EDGES = np.radians([0.0, 1e-6, 45.0, 89.9999, 90.0, 90.0001, 100.0, 180.0])


@pytest.fixture(scope="module")
def fit():
    return skyfit.fit_sky(model_skies())


@pytest.fixture(scope="module")
def one_sky():
    """The published sky at one turbidity: nothing is swept, and no decimal is round."""

    def fixed(numbers, powers):
        last = jnp.tensordot(jnp.asarray(powers), numbers, axes=1)
        return jnp.zeros_like(numbers).at[-1].set(last)

    turbidity = np.pi
    zenith = PUBLISHED.scale
    a, b, c, d = zenith.luminance.linear
    p, q = zenith.luminance.angle
    cubic = [turbidity**2, turbidity, 1.0]
    return dataclasses.replace(
        PUBLISHED,
        swept={},
        ranges=(),
        basis=Basis(),
        numbers=preetham_coefficients(turbidity)[..., None],
        scale=PaperZenith(
            CubicZenith(fixed(zenith.x.matrix, cubic)),
            CubicZenith(fixed(zenith.y.matrix, cubic)),
            TangentZenith(
                jnp.stack([0.0, a * turbidity + b, 0.0, c * turbidity + d]),
                jnp.stack([p + q * turbidity, 0.0]),
            ),
            "",
        ),
    )


def preetham_coefficients(turbidity):
    """A to E of the published sky."""
    return skyfit.preetham_sky(turbidity).coefficients(0.5)


def rows(sun, view, azimuth, turbidity=None):
    """Input of an exported sky: vectors and angles of the same directions."""
    angles = np.broadcast_arrays(sun, view, azimuth)
    sun, view, azimuth = (np.ravel(angle) for angle in angles)
    north = 0.7
    zeniths, azimuths = jnp.stack([view, sun]), jnp.stack([azimuth + north, 0 * sun + north])
    towards, sunwards = np.asarray(unit_vector(zeniths, azimuths))
    columns = [*towards.T, *sunwards.T, sun, view, azimuth]
    if turbidity is not None:
        columns.append(np.broadcast_to(turbidity, sun.shape))
    return np.stack(columns, axis=1)


def random_rows(seed=0, count=10_000, deepest_sun=96.0, swept=True):
    """Directions over the whole sphere, suns into the night, turbidities beyond their range."""
    rng = np.random.default_rng(seed)
    view = np.arccos(rng.uniform(-1, 1, count))
    sun = np.radians(rng.uniform(0, deepest_sun, count))
    turbidity = rng.uniform(1.5, 12.0, count) if swept else None
    return rows(sun, view, rng.uniform(0, 2 * np.pi, count), turbidity)


def expected(model, data):
    """What the model gives, in the form of the program's output."""
    xyz = np.asarray(model.xyz(data[:, 0:3], data[:, 3:6]))
    xyY = np.asarray(xyz_to_xyY(xyz))
    by_angles = np.asarray(model.xyY(*data[:, 6:9].T))
    return np.concatenate([xyY, xyz, np.asarray(xyz_to_rgb(xyz)), by_angles], axis=1)


def worst(got, want):
    """Largest relative error; of linear RGB relative to the largest of the three."""
    scale = np.abs(want)
    scale[:, 6:9] = scale[:, 6:9].max(axis=1, keepdims=True)
    return np.max(np.abs(got - want) / scale)


def at_turbidity(data):
    """The published sky at the turbidities of the rows."""
    return eqx.tree_at(lambda sky: sky.swept["turbidity"], PUBLISHED, jnp.asarray(data[:, 9]))


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_ten_thousand_directions_have_the_models_colours(language, tmp_path):
    data = random_rows(deepest_sun=89.0 if language in SHADERS else 96.0)
    got = run(export_fit(PUBLISHED, language), language, data, tmp_path)
    # Doubles differ by the twelve digits that are written out.
    assert worst(got, expected(at_turbidity(data), data)) < (1e-5 if language in SHADERS else 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("language", SHADERS)
def test_a_shaders_dusk_has_the_models_colours(language, tmp_path):
    data = random_rows(1, 20_000)
    data = data[data[:, 6] > np.radians(89.0)]
    got = run(export_fit(PUBLISHED, language), language, data, tmp_path)
    # Single precision holds the sun's zenith angle within 3e-7. Twilight falls by 53 times that,
    # and the published zenith under a setting sun at turbidity 10 by 140 times.
    assert worst(got, expected(at_turbidity(data), data)) < 5e-5


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_a_sky_without_a_swept_parameter_takes_none(language, one_sky, tmp_path):
    data = random_rows(2, 1000, deepest_sun=89.0, swept=False)
    got = run(export_fit(one_sky, language), language, data, tmp_path)
    assert worst(got, expected(one_sky, data)) < (1e-5 if language in SHADERS else 1e-9)


@pytest.mark.slow
def test_a_fit_is_exported_with_its_own_coefficients(fit, tmp_path):
    data = random_rows(3, 1000)
    got = run(export_fit(fit, "c"), "c", data, tmp_path)
    model = fit.sky(turbidity=np.clip(data[:, 9], 2.0, 6.0))
    assert worst(got, expected(model, data)) < 1e-9


@pytest.mark.parametrize("language", LANGUAGES)
def test_nothing_breaks_at_the_horizon_at_the_sun_and_at_night(language, tmp_path):
    # Every pair of edges, towards the sun and away from it: the sun itself and its opposite too.
    sun, view, azimuth = np.meshgrid(EDGES, EDGES, [0.0, np.pi])
    got = run(export_fit(PUBLISHED, language), language, rows(sun, view, azimuth, 3.0), tmp_path)
    assert np.isfinite(got).all()
    assert got[:, 3:6].min() >= 0
    # Across the horizon and through sunset nothing jumps: 0.0002° changes little.
    grid = got.reshape(*sun.shape, 12)
    tolerance = {"rtol": 3e-4, "atol": 1e-3}
    np.testing.assert_allclose(grid[3], grid[5], **tolerance)
    np.testing.assert_allclose(grid[:, 3], grid[:, 5], **tolerance)


@pytest.mark.parametrize(
    "version", ["#version 450", "#version 300 es\nprecision highp float;", "#version 110"]
)
def test_glslang_takes_the_glsl_of_every_age(version, fit, tmp_path):
    main = (
        "void main() { gl_FragColor = vec4(sky_rgb(vec3(0.0, 0.6, 0.8), vec3(0, 0, 1), 3.0), 1); }"
        if version.endswith("110")
        else "layout(location = 0) out vec4 colour;\n"
        "void main() { colour = vec4(sky_rgb(vec3(0.0, 0.6, 0.8), vec3(0, 0, 1), 3.0), 1); }"
    )
    for sky in (PUBLISHED, fit):
        code = export_fit(sky, "glsl")
        done = validate_shader(f"{version}\n{code}\n{main}\n", tmp_path)
        assert done.returncode == 0, done.stdout
    broken = validate_shader(f"{version}\n{code.replace('exp(', 'exq(')}\n{main}\n", tmp_path)
    assert broken.returncode != 0
    assert "exq" in broken.stdout


def test_glslang_compiles_the_hlsl(fit, tmp_path):
    main = (
        "float4 main(float3 view : TEXCOORD0) : SV_Target {\n"
        "    return float4(sky_rgb(view, float3(0, 0, 1), 3.0), 1.0);\n}\n"
    )
    options = ("-D", "-V", "-e", "main", "-S", "frag", "-o", "shader.spv")
    for sky in (PUBLISHED, fit):
        code = export_fit(sky, "hlsl")
        done = validate_shader(code + main, tmp_path, *options)
        assert done.returncode == 0, done.stdout
    assert (tmp_path / "shader.spv").stat().st_size > 1000
    broken = validate_shader(code.replace("float3", "vec3", 1) + main, tmp_path, *options)
    assert broken.returncode != 0


def test_json_has_the_numbers_of_the_fit(fit):
    document = json.loads(export_fit(fit, "json"))
    assert document["schema"] == "skyfit/sky/1"
    assert document["parameter"] == {"name": "turbidity", "range": [2.0, 6.0]}
    for channel in ("x", "y", "Y"):
        found = list(document["coefficients"][channel].values())
        np.testing.assert_array_equal(found, fit.coefficients[channel])
    np.testing.assert_array_equal(document["zenith"]["Y"]["angle"], fit.zenith["Y"]["angle"])


@pytest.mark.slow
def test_every_language_says_where_the_numbers_are_from(fit):
    for language in (*FORMATS, *TARGETS):
        code = export_fit(fit, language)
        assert code.isascii()
        for words in ("skies of a model", "RMS error of the fit", "turbidity 2 to 6, sun 5 to 75"):
            assert words in code
    assert "appendix A.2" in export_fit(PUBLISHED, "c")


@pytest.mark.usefixtures("float32")
def test_published_coefficients_are_written_as_printed_whatever_the_precision():
    code = export_fit(skyfit.preetham_sky(3.0), "glsl")
    assert "float A_Y = 0.1787 * held_turbidity - 1.463;" in code


def test_another_name_begins_every_function():
    code = export_fit(PUBLISHED, "c", name="mars")
    assert "mars_xyz" in code
    assert "sky_" not in code


@pytest.mark.parametrize(
    ("text", "c", "python"),
    [
        ("1 + a * -2", "1.0 + a * -2.0", "1.0 + a * -2.0"),
        ("a + -2", "a - 2.0", "a - 2.0"),
        ("a + -2 * b", "a - 2.0 * b", "a - 2.0 * b"),
        ("a - (b - c)", "a - (b - c)", "a - (b - c)"),
        ("a / (b * c) * d", "a / (b * c) * d", "a / (b * c) * d"),
        ("-(a + b) / 3", "-(a + b) / 3.0", "-(a + b) / 3.0"),
        ("where(a < 1e-9, a, b)", "(a < 1e-9 ? a : b)", "np.where(a < 1e-9, a, b)"),
        ("max(colour.y, 0)", "Math.max(colour[1], 0.0)", "np.maximum(colour[..., 1], 0.0)"),
        ("f(vector(a, 0, 1))", "sky_f([a, 0.0, 1.0])",
         "sky_f(np.stack(np.broadcast_arrays(a, 0.0, 1.0), axis=-1))"),
    ],
)  # fmt: skip
def test_expressions_are_what_they_are_in_every_language(text, c, python):
    functions = (Function("f", "", ("colour",), (), "colour.x"),)
    assert JavaScript("sky", functions).expression(text) == c
    assert Python("sky", functions).expression(text) == python


def test_an_expression_outside_the_descriptions_syntax_is_refused():
    for text in ("a ** 2", "a if b else c", "gamma_function(a)", "a.z"):
        with pytest.raises(ValueError, match="not in the syntax"):
            Glsl("sky", ()).expression(text)


def test_wrong_formats_and_names_are_refused():
    with pytest.raises(ValueError, match=r"format=...\): expected one of .*glsl.*; got 'fortran'"):
        export_fit(PUBLISHED, "fortran")
    for name in ("2sky", "gl_sky", "my sky", "a__b", ""):
        with pytest.raises(ValueError, match="single underscores"):
            export_fit(PUBLISHED, "c", name=name)


def test_the_command_writes_what_the_function_returns(fit, tmp_path, capsys):
    fit.save(tmp_path / "fit.json")
    out = tmp_path / "sky.glsl"
    command = ["export", str(tmp_path / "fit.json"), "--format", "glsl", "--out", str(out)]
    assert cli.run([*command, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["out"] == str(out)
    assert out.read_text() == export_fit(fit, "glsl")
    assert cli.run(command) == 2  # it is there now
    assert "exists already" in capsys.readouterr().err
    header = tmp_path / "published.h"
    assert cli.run(["export", "published", "--format", "c", "--out", str(header)]) == 0
    assert header.read_text() == export_fit(PUBLISHED, "c")
    missing = ["export", "none.json", "--format", "c", "--out", str(tmp_path / "n.h")]
    assert cli.run(missing) == 2
    assert "none.json" in capsys.readouterr().err


def test_the_command_knows_every_format():
    option = next(o for o in cli.commands.commands["export"].params if o.name == "language")
    assert list(option.type.choices) == [*FORMATS, *TARGETS]
    assert all(issubclass(d, AbstractDialect) for d in FORMATS.values() if d)
