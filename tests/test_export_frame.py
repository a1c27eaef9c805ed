"""What a picture needs of an exported sky: frames, the sun's disc, the tone curve and encoding."""

import ast
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest
from exported import LANGUAGES, run_with_picture
from test_export import PUBLISHED, SHADERS, at_turbidity, expected, random_rows, rows

import skyfit
from skyfit.colour import xyY_to_xyz
from skyfit.constants import SUN_ANGULAR_RADIUS
from skyfit.export import export_fit
from skyfit.export.formula import describe_formula
from skyfit.export.frame import framed
from skyfit.export.straight import Straight
from skyfit.render.tone import encode, tone_curve
from skyfit.sun.light import air_mass, visible_fraction
from skyfit.tables import read_table


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_a_frame_made_before_gives_the_sky_and_what_a_screen_shows_of_it(language, tmp_path):
    data = random_rows(5, 2000, deepest_sun=89.0)
    got = run_with_picture(export_fit(PUBLISHED, language), language, data, tmp_path)
    want = expected(at_turbidity(data), data)[:, 6:9]
    size = np.abs(want).max(axis=1, keepdims=True)
    single = language in SHADERS
    assert np.max(np.abs(got[:, 12:15] - want) / size) < (1e-5 if single else 1e-9)
    shown = np.clip(tone_curve(jnp.maximum(want, 0.0) / 20000.0, "aces"), 0, 1)
    np.testing.assert_allclose(got[:, 18:21], shown, atol=2e-5 if single else 1e-9)
    np.testing.assert_allclose(got[:, 18:21], encode(got[:, 15:18]), atol=1e-6 if single else 1e-9)


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_suns_disc_is_as_bright_as_its_light(language, tmp_path):
    sun = np.radians([0.0, 30.0, 60.0, 80.0, 88.0, 90.0])
    inside = np.linspace(0, 1.5, 301) * SUN_ANGULAR_RADIUS
    view = (sun[1] - inside)[None, :]
    data = rows(sun[:, None], np.broadcast_to(view, (6, 301)), 0.0, 3.0)
    found = run_with_picture(export_fit(PUBLISHED, language), language, data, tmp_path)
    whole = np.asarray(xyY_to_xyz(skyfit.sun_xyY(3.0, sun)))
    whole = whole / np.asarray(visible_fraction(jnp.asarray(sun)))[:, None]
    # 2 % of Y; of Z, which falls fastest, 4 % in such haze
    np.testing.assert_allclose(found[::301, 22], whole[:, 1], rtol=0.02)
    np.testing.assert_allclose(found[::301, 21:24], whole, rtol=0.04)
    disc = found[301:602, 24]  # the sun at 30 degrees
    assert disc[0] == pytest.approx(1.254, abs=1e-3)  # Hestroffer & Magnan (1998) at 550 nm
    radius = inside / SUN_ANGULAR_RADIUS
    # The mean over the disc is 1: its light is that of a plain disc.
    assert np.trapezoid(2 * disc * radius, radius) == pytest.approx(1, abs=5e-3)
    assert disc[radius > 1.001].max() == 0


def test_the_suns_powers_are_least_squares():
    suns = np.radians(np.r_[np.linspace(0, 80, 20), np.linspace(81, 90, 20)])
    haze, sun = (a.ravel() for a in np.meshgrid(np.linspace(1.9, 10, 12), suns))
    above = np.asarray(visible_fraction(jnp.asarray(sun)))
    light = np.asarray(xyY_to_xyz(skyfit.sun_xyY(haze, sun))) / above[:, None]
    root, powers = np.sqrt(np.asarray(air_mass(jnp.asarray(sun)))), np.arange(3, -1, -1)
    terms = root[:, None, None] ** powers[:, None] * haze[:, None, None] ** powers
    terms = terms.reshape(len(sun), 16)
    table = read_table("sun_disc_powers")
    rows = np.stack([table[f"haze{k}"] for k in powers], axis=1).reshape(3, 16)
    found = np.linalg.lstsq(terms, np.log(light), rcond=None)[0]
    np.testing.assert_allclose(terms @ rows.T, terms @ found, atol=1e-6)
    error = np.abs(np.exp(terms @ rows.T) / light - 1).max(axis=0)
    assert error[:2].max() < 0.013
    assert error[2] < 0.055


def test_a_disc_below_the_horizon_is_not_seen(tmp_path):
    low = np.radians(90) - 0.5 * SUN_ANGULAR_RADIUS * np.array([1.0, -1.0])
    found = run_with_picture(export_fit(PUBLISHED, "c"), "c", rows(low, low, 0.0, 3.0), tmp_path)
    np.testing.assert_allclose(found[:, 24], [1.254, 0], atol=1e-3)


@pytest.mark.parametrize("single", [True, False])
def test_a_frame_saves_half_of_the_work_for_every_direction(single):
    functions = framed(describe_formula(PUBLISHED), single=single)
    fields = next(function.fields for function in functions if function.fields)
    vectors = {
        name: tuple(ast.Name(f"{name}_{axis}") for axis in "xyz")
        for name in ("direction", "sun_direction")
    }
    at_once, in_frame = Straight(functions), Straight(functions)
    at_once.call("rgb", vectors | {"turbidity": ast.Name("turbidity")})
    in_frame.call("frame_rgb", vectors | {"frame": {name: ast.Name(name) for name in fields}})
    found = operations(at_once), operations(in_frame)
    assert found == ((264, 97) if single else (230, 80))
    page = Path(__file__).parent.parent / "docs" / "renderers" / "index.md"
    assert f"| {found[0]} | {found[1]} |" in page.read_text()


def operations(straight):
    kinds = ast.BinOp | ast.Call | ast.Compare
    trees = (ast.parse(line.expression) for line in straight.lines)
    return sum(isinstance(node, kinds) for tree in trees for node in ast.walk(tree))


def test_the_heading_tells_what_is_seen_below_the_horizon(tmp_path):
    """Held at the horizon is one factor alone: a view 30 degrees below it is no horizon's."""
    sun, view = np.radians(60.0), np.radians([90.0, 120.0])
    model = skyfit.preetham_sky(3.0)
    got = run_with_picture(export_fit(PUBLISHED, "c"), "c", rows(sun, view, 0.0, 3.0), tmp_path)
    _, _, c, d, e = np.asarray(model.coefficients(sun))[2]
    gamma = view - sun
    indicatrix = 1 + c * np.exp(d * gamma) + e * np.cos(gamma) ** 2
    assert got[1, 2] / got[0, 2] == pytest.approx(indicatrix[1] / indicatrix[0], rel=1e-6)
    assert got[1, 2] < 0.7 * got[0, 2]
    code = export_fit(PUBLISHED, "glsl")
    assert "as bright as\n// the horizon only at the horizon" in code
    assert "sees the brightness of the horizon" not in code
