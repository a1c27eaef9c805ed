"""Swept parameters with names that a program cannot have, or has already."""

import dataclasses
import subprocess

import numpy as np
import pytest
from exported import LANGUAGES, node, run, validate_shader
from test_export import PUBLISHED, at_turbidity, expected, random_rows, worst

from skyfit.export import export_fit
from skyfit.models.axes import Line
from skyfit.models.basis import Basis


# Types, keywords, coefficients, angles, vectors, functions; what is no name in any language.
TAKEN = ("half", "lambda", "A", "gamma", "direction", "exp", "swept_0")
NO_NAMES = ("2 x", "haze.depth", "τ", '"""\nraise SystemExit\n"""', "*/")


def renamed(name):
    """The published sky with its parameter called otherwise."""
    swept = {name: PUBLISHED.swept["turbidity"]}
    ends = PUBLISHED.ranges[0][1]
    return dataclasses.replace(
        PUBLISHED,
        swept=swept,
        ranges=((name, ends),),
        basis=Basis((Line(name, ends),)),
        scale=dataclasses.replace(PUBLISHED.scale, quantity=name),
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", TAKEN + NO_NAMES)
def test_a_parameter_of_any_name_is_the_same_sky_in_python(name, tmp_path):
    data = random_rows(3, 500)
    got = run(export_fit(renamed(name), "python"), "python", data, tmp_path)
    assert worst(got, expected(at_turbidity(data), data)) < 1e-9


# Words of the languages by their standards, and names of the exported programs' own.
_MANY = """
auto break case char const continue default do double else enum extern float for goto if inline int
long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while bool true false and or not class template typename namespace new delete this throw
operator private public friend mutable export explicit virtual using try catch asm constexpr
attribute uniform varying buffer shared coherent readonly writeonly layout centroid flat smooth
noperspective patch sample subroutine in out inout invariant precise discard mat2 mat3 mat4 vec2
vec3 vec4 ivec2 bvec3 uvec4 dvec2 lowp mediump highp precision sampler2D sampler3D samplerCube
texture image2D half fixed superp input output cast filter resource common partition active
float2 float3 float4x4 half3 uint3 min16float cbuffer tbuffer technique pass lerp saturate frac
rsqrt mul ddx row_major matrix vector string numthreads groupshared point line triangle
function var let yield await async arguments eval undefined null NaN Infinity Math super import
instanceof typeof interface package protected implements debugger with from of globalThis
def lambda None True False pass raise global nonlocal elif except finally is match np numpy float64
exp sqrt sin cos tan asin pow min max clamp abs floor mix step length dot cross normalize reflect
direction sun_direction colour gamma cos_view view_zenith relative_azimuth turbidity day
A B C D E X Y Z x y z value0 total safe rise turn root ratio nearer series square distribution
half_angle angle_between xyz rgb xyY held_turbidity M_PI errno main NULL isnan
"""
MANY = dict.fromkeys(_MANY.split())


def of_many(language):
    """A program that has every name of `MANY` for an argument, after the turbidity."""
    ends = PUBLISHED.ranges[0][1]
    names = [name for name in MANY if name != "turbidity"]
    assert len(names) > 160
    ranges = (*PUBLISHED.ranges, *((name, ends) for name in names))
    return export_fit(dataclasses.replace(PUBLISHED, ranges=ranges), language)


def test_many_names_are_no_trouble_to_c(tmp_path):
    (tmp_path / "all.c").write_text(of_many("c") + "\nint main(void) { return 0; }\n")
    for command in (["gcc", "-std=c99"], ["g++", "-x", "c++"]):
        subprocess.run([*command, "-fsyntax-only", "all.c"], cwd=tmp_path, check=True)


def test_many_names_are_no_trouble_to_shaders(tmp_path):
    for language, options in (("glsl", ()), ("hlsl", ("-D", "-V", "-e", "main", "-S", "frag"))):
        top = "#version 450\n" if language == "glsl" else ""
        main = "void main() { }" if language == "glsl" else "void main() : SV_Target { }"
        done = validate_shader(f"{top}{of_many(language)}\n{main}\n", tmp_path, *options)
        assert done.returncode == 0, done.stdout


def test_many_names_are_no_trouble_to_javascript_and_python(tmp_path):
    (tmp_path / "all.mjs").write_text(of_many("js"))
    subprocess.run([node(), "--check", "all.mjs"], cwd=tmp_path, check=True)
    found: dict = {}
    exec(of_many("python"), found)
    function = found["sky_xyY_of_angles"]
    unused = [np.nan] * (function.__code__.co_argcount - 4)
    got = function(np.cos(0.6), found["sky_gamma"](0.5, 0.6, 0.7), 0.5, 3.0, *unused)
    np.testing.assert_allclose(got, PUBLISHED.xyY(0.5, 0.6, 0.7), rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("language", [one for one in LANGUAGES if one != "python"])
def test_names_that_are_taken_are_free_in_every_language(language, tmp_path):
    data = random_rows(3, 500, deepest_sun=88.0)
    want = expected(at_turbidity(data), data)
    for name in ("half", "A", "gamma", "float", "lambda", "sample"):
        got = run(export_fit(renamed(name), language), language, data, tmp_path)
        assert worst(got, np.array(want)) < (1e-5 if language in ("glsl", "hlsl") else 1e-9)


def test_names_that_are_taken_are_taken_by_glslang(tmp_path):
    for name in ("half", "sample", "vec3", "A"):
        code = export_fit(renamed(name), "glsl")
        main = (
            "layout(location = 0) out vec4 colour;\n"
            "void main() { colour = vec4(sky_rgb(vec3(0.0, 0.6, 0.8), vec3(0, 0, 1), 3.0), 1); }"
        )
        done = validate_shader(f"#version 450\n{code}\n{main}\n", tmp_path)
        assert done.returncode == 0, done.stdout


def test_ordinary_names_stay():
    assert "turbidity" in export_fit(PUBLISHED, "c")
    assert "turbidity_swept" not in export_fit(PUBLISHED, "c")
