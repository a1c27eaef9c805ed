"""Files for renderers: by the compilers of their shaders, node and a stand-in for Blender."""

import re
import subprocess
import sys
from types import ModuleType

import numpy as np
import pytest
from exported import node, run, validate_shader
from test_export import PUBLISHED, at_turbidity, expected, random_rows, worst
from test_export_formula import sky
from test_export_names import renamed

import skyfit
from skyfit.colour import xyY_to_xyz, xyz_to_rgb
from skyfit.constants import SUN_SOLID_ANGLE
from skyfit.export import TARGETS, export_fit, radiance_scene
from skyfit.export.formula import describe_formula
from skyfit.export.frame import framed
from skyfit.export.languages import Godot
from skyfit.render.cameras import direction_of


SHADERTOY = (
    "#version 300 es\nprecision highp float;\nuniform vec3 iResolution;\nuniform vec4 iMouse;\n"
)
# What Godot gives to a sky's shader, and how its text differs from GLSL
GODOT = (
    "#version 450\nin vec3 EYEDIR;\nout vec3 COLOR;\nuniform vec3 LIGHT0_DIRECTION;\n"
    "uniform bool LIGHT0_ENABLED, AT_CUBEMAP_PASS;\n"
)
UNITY = (
    "float4x4 unity_ObjectToWorld, view;\nfloat4 _WorldSpaceLightPos0;\n"
    "float4 UnityObjectToClipPos(float4 place) { return mul(view, place); }\n"
    "float3 LinearToGammaSpace(float3 light) { return pow(light, 1.0 / 2.2); }\n"
)
UNREAL = (
    "float3 node(float3 Direction, float3 SunDirection, float White, float Disc{more}) {{\n"
    "{code}}}\n"
    "float4 main(float3 at : TEXCOORD0) : SV_Target {{\n"
    "    return float4(node(at, float3(0, 0, 1), 20000.0, 1.0{values}), 1.0);\n}}\n"
)
HLSL = ("-D", "-V", "-S", "frag", "-o", "shader.spv")
# Types and letters that renderers have taken, in a parameter's name; and a sky without one
SKIES = {
    "published": lambda: PUBLISHED,
    "E": lambda: renamed("E"),
    "sun": lambda: renamed("sun"),
    "bands": lambda: sky("series", "nodes", "bands"),
    "nodes": lambda: sky("perez", "nodes", "Yxy"),
}


def shadertoy(code):
    return (
        f"{SHADERTOY}out vec4 seen;\n{code}\nvoid main() {{ mainImage(seen, gl_FragCoord.xy); }}\n"
    )


def godot(code):
    assert "shader_type sky;\n" in code
    code = code.replace("shader_type sky;\n", "")
    code = re.sub(
        r"^(uniform float \w+) : hint_range\([-\d.e]+, [-\d.e]+\)", r"\1", code, flags=re.M
    )
    # These are constants of Godot's, which no name may be.
    assert not re.search(r"^(?!\s*//).*\b(PI|TAU|E)\b", code, flags=re.M)
    return f"{GODOT}{code.replace('void sky()', 'void main()')}"


def unity(code):
    start, end = code.index("HLSLPROGRAM"), code.index("ENDHLSL")
    properties = re.findall(r'^\s+(?:\[Toggle\] )?(\w+) \("', code[:start], flags=re.M)
    body = code[start + len("HLSLPROGRAM") : end].replace('#include "UnityCG.cginc"', UNITY)
    assert set(properties) == set(re.findall(r"^float (given_\w+);", body, flags=re.M))
    return body


def unreal(code):
    inputs = list(dict.fromkeys(re.findall(r"\bgiven_\w+", code)))
    more = "".join(f", float {name}" for name in inputs)
    return UNREAL.format(code=code, more=more, values=", 3.0" * len(inputs))


def fragment(code):
    """The fragment shader of a three.js module, as three.js completes it."""
    text = code.split("const fragmentShader = /* glsl */ `")[1].split("`;")[0]
    text = re.sub(r"#include <\w+>", "", text).replace("varying", "in")
    text = text.replace("gl_FragColor", "seen")
    return f"#version 300 es\nprecision highp float;\nout vec4 seen;\n{text}"


@pytest.mark.slow
@pytest.mark.parametrize("name", SKIES)
@pytest.mark.parametrize(
    ("target", "completed", "options"),
    [
        ("threejs", fragment, ()),
        ("shadertoy", shadertoy, ()),
        ("godot", godot, ()),
        ("unity", unity, (*HLSL, "-e", "frag")),
        ("unity", unity, ("-D", "-V", "-S", "vert", "-e", "vert", "-o", "shader.spv")),
        ("unreal", unreal, (*HLSL, "-e", "main")),
    ],
)
def test_glslang_compiles_what_renderers_do(target, completed, options, name, tmp_path):
    code = completed(export_fit(SKIES[name](), target))
    done = validate_shader(code, tmp_path, *options)
    assert done.returncode == 0, done.stdout
    broken = validate_shader(code.replace("sqrt(", "sqrd("), tmp_path, *options)
    assert "sqrd" in broken.stdout


def test_godots_functions_have_the_models_colours(tmp_path):
    functions = framed(describe_formula(PUBLISHED), single=True)
    data = random_rows(11, 2000, deepest_sun=89.0)
    got = run(Godot("sky", functions).body(functions), "glsl", data, tmp_path)
    assert worst(got, expected(at_turbidity(data), data)) < 1e-5


@pytest.mark.slow
def test_unreals_lines_have_the_models_colours_and_the_suns(tmp_path):
    """The node beside the exported GLSL, whose functions stand in for the others of the program."""
    code = export_fit(PUBLISHED, "unreal")
    lines = code[: code.index("return")].replace("float3 light =", "vec3 light =")
    glsl = export_fit(PUBLISHED, "glsl")
    node = (
        "\n#define sky_rgb replaced\nvec3 replaced(vec3 Direction, vec3 SunDirection, "
        f"float given_turbidity) {{\nfloat Disc = 1.0;\n{lines}return light;\n}}\n"
    )
    data = random_rows(12, 2000, deepest_sun=89.0)
    got = run(glsl + node, "glsl", data, tmp_path)
    assert worst(got, expected(at_turbidity(data), data)) < 1e-5
    data[:, 0:3] = data[:, 3:6]  # into the sun
    got = run(glsl + node, "glsl", data, tmp_path)[:, 6:9]
    sun = xyz_to_rgb(xyY_to_xyz(skyfit.sun_xyY(np.clip(data[:, 9], 1.9, 10), data[:, 6])))
    high = data[:, 6] < np.radians(80.0)
    size = np.abs(sun).max(axis=1, keepdims=True)
    np.testing.assert_allclose((got / (1.254 * size))[high], (sun / size)[high], atol=0.03)


THREE = """
export const BackSide = 1;
export class BoxGeometry {}
export class Vector3 {
    constructor(x = 0, y = 0, z = 0) { this.set(x, y, z); }
    set(x, y, z) { this.x = x; this.y = y; this.z = z; }
    length() { return Math.hypot(this.x, this.y, this.z); }
}
export class ShaderMaterial { constructor(parts) { Object.assign(this, parts); } }
export class Mesh { constructor(geometry, material) { this.material = material; } }
"""
MAIN = """
import { Vector3 } from "three";
import { SkyDome, sky_frame_rgb } from "./sky.mjs";
const sky = new SkyDome();
sky.setSun(new Vector3(2, 1, -2), 4);  // east, up, north
const { frame, sun_direction: { value: sun }, sun_rgb: { value: light } } = sky.material.uniforms;
const seen = sky_frame_rgb(frame.value, [0.48, 0.6, 0.64], [sun.x, sun.y, sun.z]);
const fields = Object.keys(frame.value);
console.log(JSON.stringify([fields, [sun.x, sun.y, sun.z], [light.x, light.y, light.z], seen]));
"""


def test_three_js_is_given_one_suns_numbers(tmp_path):
    package = tmp_path / "node_modules" / "three"
    package.mkdir(parents=True)
    (package / "package.json").write_text('{"type": "module", "main": "three.js"}')
    (package / "three.js").write_text(THREE)
    code = export_fit(PUBLISHED, "threejs")
    (tmp_path / "sky.mjs").write_text(code)
    (tmp_path / "main.mjs").write_text(MAIN)
    done = subprocess.run([node(), "main.mjs"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    fields, sun, light, seen = eval(done.stdout)
    # Names of the shader's structure, in which three.js looks for them
    members = fragment(code).split("struct sky_frame {")[1].split("}")[0]
    assert fields == re.findall(r"\b[A-E]_[xyY]|scale_[xyY]", members)
    np.testing.assert_allclose(sun, [2 / 3, 2 / 3, 1 / 3], rtol=1e-9)
    model = skyfit.preetham_sky(4.0)
    want = xyz_to_rgb(model.xyz(np.array([0.48, 0.6, 0.64]), np.array(sun)))
    np.testing.assert_allclose(seen, want, rtol=1e-9)
    disc = xyz_to_rgb(xyY_to_xyz(skyfit.sun_xyY(4.0, np.arccos(1 / 3))))
    np.testing.assert_allclose(light, disc, rtol=0.04)


class Anything:
    """Stands for Blender: whatever is asked of it, it has, and what is called is on record."""

    def __init__(self, calls, path=""):
        self.__dict__.update(calls=calls, path=path, items={})

    def __getattr__(self, name):
        return self.items.setdefault(name, Anything(self.calls, f"{self.path}.{name}"))

    def __getitem__(self, name):
        return self.__getattr__(name)

    def __call__(self, *arguments, **options):
        self.calls.append((self.path, arguments, options))
        return self.items.setdefault("()", Anything(self.calls, self.path))


def test_blender_is_given_the_panorama_and_the_sun(tmp_path, monkeypatch):
    calls, vectors = [], ModuleType("mathutils")
    blender = Anything(calls)
    monkeypatch.setitem(sys.modules, "bpy", blender)
    vectors.Vector = lambda values: Anything(calls, ".vector")  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "mathutils", vectors)
    code = export_fit(PUBLISHED, "blender").replace("ROWS = 1024", "ROWS = 32")
    exec(compile(code, "sky.py", "exec"), {})
    (pixels,) = next(arguments for path, arguments, _ in calls if path.endswith("foreach_set"))
    assert pixels.dtype == np.float32
    rgba = pixels.reshape(32, 64, 4)
    assert np.all(rgba[..., 3] == 1)
    # Blender's panorama: the first row at the nadir, the middle column along x, the first quarter
    # along y; by a rendering of Blender's, see docs/renderers/blender.md.
    height = np.pi * ((np.arange(32) + 0.5) / 32 - 0.5)
    compass = np.pi / 2 + 2 * np.pi * ((np.arange(64) + 0.5) / 64 - 0.5)
    view = direction_of(np.pi / 2 - height[:, None], compass[None, :])
    light = xyz_to_rgb(PUBLISHED.xyz(view, direction_of(np.radians(45.0), np.pi)))
    np.testing.assert_allclose(rgba[..., :3], np.maximum(light, 0) / 20000, rtol=2e-6, atol=1e-7)
    lamp = blender.data.lights.new.items["()"]
    direct = np.asarray(xyz_to_rgb(xyY_to_xyz(skyfit.sun_xyY(3.0, np.radians(45.0)))))
    got = np.asarray(lamp.color) * lamp.energy
    np.testing.assert_allclose(got, direct * SUN_SOLID_ANGLE / 20000, rtol=0.04)


def test_every_target_is_ascii_and_of_the_name_that_is_given():
    for target in TARGETS:
        code = export_fit(PUBLISHED, target, name="mars")
        assert code.isascii()
        assert ("mars_" in code) == (target != "unreal")  # whose lines have no functions
        assert not re.search(r"\bsky_", code)
        assert code.endswith("\n")


@pytest.mark.parametrize("target", TARGETS)
def test_a_heading_says_nothing_of_functions_that_are_not_there(target):
    code = export_fit(PUBLISHED, target)
    top = code[: code.index("goes on with the sky")]
    assert "Valid range: turbidity 1.9 to 10" in top
    assert "sky_" not in top


@pytest.mark.parametrize("target", [*TARGETS, "scene"])
def test_names_of_a_file_stay_out_of_the_code(target):
    """A name that would end a line, a string and a comment: none of it is code."""
    model = renamed('a"}\n#error */ `; oops("')
    scene = target == "scene"
    code = radiance_scene(model, 0.5) if scene else export_fit(model, target)
    body = code[code.index("Here:" if scene else "goes on with the sky") :]
    assert "#error" not in body
    assert "oops(" not in body


def test_a_wrong_target_is_refused_with_all_that_are_known():
    with pytest.raises(skyfit.InputError, match=r"'json', 'threejs', .*'radiance'\]; got 'maya'"):
        export_fit(PUBLISHED, "maya")
