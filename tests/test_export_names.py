"""Swept parameters with names that a program cannot have, or has already."""

import dataclasses

import numpy as np
import pytest
from exported import LANGUAGES, run, validate_shader
from test_export import PUBLISHED, at_turbidity, expected, random_rows, worst

from skyfit.export import export_fit
from skyfit.models.basis import Basis, Line


# Types, keywords, coefficients, angles, vectors, functions; what is no name in any language.
TAKEN = ("half", "lambda", "A", "gamma", "direction", "exp", "swept_0")
NO_NAMES = ("2 x", "haze.depth", "τ")


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


@pytest.mark.parametrize("name", TAKEN + NO_NAMES)
def test_a_parameter_of_any_name_is_the_same_sky_in_python(name, tmp_path):
    data = random_rows(3, 500)
    got = run(export_fit(renamed(name), "python"), "python", data, tmp_path)
    assert worst(got, expected(at_turbidity(data), data)) < 1e-9


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
