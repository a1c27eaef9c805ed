"""Light on planes and domes made of samples, against plain sums and published values."""

import inspect

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit.campaign import paper_directions
from skyfit.colour import luminance, xyY_to_xyz
from skyfit.dataset.measurements import cornell_skies
from skyfit.models import cie_general_sky, cie_overcast_sky, preetham_sky
from skyfit.surfaces import Dome, plane_light, sampled_dome, sky_dome, sun_light


WALL = np.pi / 2
PLANES = [(0.0, 0.0), (0.6, 0.5), (WALL, 0.0), (WALL, 2.5), (1.2, np.pi), (2.5, 0.3)]


def plain_sum(sky, sun, tilt, azimuth, nodes=400):
    """Illuminance of a plane by the sky [lx]: midpoints all over the dome."""
    zenith = ((np.arange(nodes) + 0.5) * np.pi / 2 / nodes)[:, None]
    around = (np.arange(2 * nodes) + 0.5) * np.pi / nodes
    luminance = np.asarray(sky.xyY(sun, zenith, around)[..., 2])
    cosine = np.cos(zenith) * np.cos(tilt)
    cosine = cosine + np.sin(zenith) * np.sin(tilt) * np.cos(around - azimuth)
    cell = np.sin(zenith) * np.pi / 2 / nodes * np.pi / nodes
    return (np.maximum(cosine, 0) * luminance * cell).sum()


def uniform_dome(channels=1):
    return Dome(jnp.ones((16, 32, channels)), jnp.asarray(0.5))


@pytest.mark.slow
@pytest.mark.parametrize("tilt", [0.0, 0.7, WALL, 2.5])
def test_a_uniform_sky_lights_a_plane_by_what_it_sees(tilt):
    # π (1 + cos tilt) / 2, and the rest by a ground that sends π albedo / π of it back.
    light = plane_light(sky_dome(cie_general_sky(5, diffuse_illuminance=np.pi), 0.5), tilt, 1.0)
    # Steps of the grid at the edge of what the plane sees.
    np.testing.assert_allclose(light.sky[1], np.pi * (1 + np.cos(tilt)) / 2, rtol=1e-3)
    ground = plane_light(uniform_dome(), tilt, 1.0, ground_albedo=0.3).ground
    np.testing.assert_allclose(ground[0], 0.3 * np.pi * (1 - np.cos(tilt)) / 2, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("make", [lambda: preetham_sky(3.0), lambda: cie_general_sky(15)])
@pytest.mark.parametrize("sun", [0.3, 1.4])
def test_planes_get_the_light_of_a_plain_sum_over_the_dome(make, sun):
    tilt, azimuth = np.array(PLANES).T
    got = plane_light(sky_dome(make(), sun), tilt, azimuth).sky[:, 1]
    want = [plain_sum(make(), sun, *plane) for plane in PLANES]
    # 2e-4 against a converged sum (`sky_dome`); 400 midpoints have as much again.
    np.testing.assert_allclose(got[:5], want[:5], rtol=4e-4)
    np.testing.assert_allclose(got[5], want[5], rtol=2e-3)  # sees a sliver of sky


def test_the_sun_lights_planes_by_the_cosine_of_its_angle():
    sun = 0.8
    disc = sun_light(2.0, sun)
    planes = plane_light(
        sky_dome(cie_overcast_sky(), sun), [0.0, sun, WALL], [0.0, 0.0, np.pi], sun=disc
    )
    np.testing.assert_allclose(planes.direct[:, 1], disc[1] * np.array([np.cos(sun), 1.0, 0.0]))
    without = plane_light(sky_dome(cie_overcast_sky(), sun), [0.0, sun, WALL], [0.0, 0.0, np.pi])
    np.testing.assert_array_equal(without.direct, 0)
    np.testing.assert_array_equal(without.sky, planes.sky)
    np.testing.assert_allclose(planes.total, planes.direct + planes.diffuse)


def test_the_ground_before_a_plane_is_lit_by_sun_and_sky():
    sun, disc = 0.8, sun_light(2.0, 0.8)
    dome = sky_dome(preetham_sky(2.0), sun)
    below = plane_light(dome, np.pi, 0.0, sun=disc, ground_albedo=0.25)
    flat = plane_light(dome, 0.0, 0.0, sun=disc)
    np.testing.assert_allclose(below.total, 0.25 * flat.total, rtol=1e-9)


@pytest.mark.parametrize("elevation", [20.0, 40.0, 60.0])
def test_the_sun_is_as_bright_as_lighting_engineers_have_it(elevation):
    # IES (1984): 127.5 klx e^{-0.21 / sin h} normal to the sun in a clear sky, as of turbidity 2.
    height = np.radians(elevation)
    want = 127.5e3 * np.exp(-0.21 / np.sin(height))
    np.testing.assert_allclose(sun_light(2.0, np.pi / 2 - height)[1], want, rtol=0.05)


@pytest.mark.parametrize("elevation", [20.0, 40.0, 60.0])
def test_a_clear_sky_gives_the_ground_what_lighting_engineers_have(elevation):
    # IES (1984): 800 + 15 500 √sin h lx of a clear sky, 300 + 21 000 sin h of an overcast one.
    height = np.radians(elevation)
    clear = plane_light(sky_dome(cie_general_sky(12), np.pi / 2 - height)).sky[1]
    np.testing.assert_allclose(clear, 800 + 15500 * np.sqrt(np.sin(height)), rtol=3e-4)
    overcast = plane_light(sky_dome(cie_overcast_sky(), np.pi / 2 - height)).sky[1]
    np.testing.assert_allclose(overcast, 300 + 21000 * np.sin(height), rtol=3e-3)
    # The published sky is 1.5 to 2.5 times as bright, which is known of its zenith.
    published = plane_light(sky_dome(preetham_sky(2.0), np.pi / 2 - height)).sky[1]
    assert 1.5 < published / clear < 2.5


@pytest.mark.slow
def test_a_spectral_dome_adds_up_to_its_luminance():
    lam = np.arange(380.0, 781.0, 20.0)
    spectral = plane_light(sky_dome(preetham_sky(3.0), 0.9, wavelengths=lam), 0.5, 1.0)
    luminous = plane_light(sky_dome(preetham_sky(3.0), 0.9), 0.5, 1.0)
    np.testing.assert_allclose(luminance(spectral.sky, lam), luminous.sky[1], rtol=5e-3)
    assert sun_light(3.0, 0.9, lam).shape == lam.shape


@pytest.mark.slow
@pytest.mark.parametrize("sun", [0.3, 0.9, 1.4])
def test_a_dome_of_the_campaigns_directions_has_the_skys_light(sun):
    view, azimuth = paper_directions()
    sky = preetham_sky(3.0)
    samples = xyY_to_xyz(sky.xyY(sun, view, azimuth))
    tilt, facing = np.array(PLANES[:4]).T
    got = plane_light(sampled_dome(sun, view, azimuth, samples), tilt, facing).sky
    want = plane_light(sky_dome(sky, sun), tilt, facing).sky
    np.testing.assert_allclose(got, want, rtol=0.004)


def test_samples_come_back_where_they_were_taken_and_planes_in_between():
    view, azimuth = paper_directions()
    # Linear in the plane of the triangles: it must come back exactly.
    values = 2.0 + view * np.cos(azimuth)
    dome = sampled_dome(0.5, view, azimuth, values[:, None])
    directions = np.asarray(dome.directions)
    zenith = np.arccos(directions[..., 2])
    want = 2.0 + zenith * np.cos(np.arctan2(directions[..., 1], directions[..., 0]))
    # At the horizon the triangles' edges are chords of 10°: 0.4 % within the circle.
    np.testing.assert_allclose(dome.light[..., 0], want, atol=0.01)
    inside = zenith < 1.5
    np.testing.assert_allclose(dome.light[..., 0][inside], want[inside], atol=1e-9)


def test_patches_without_a_value_are_bridged_by_their_neighbours():
    view, azimuth = paper_directions()
    values = 2.0 + view * np.cos(azimuth)
    values[7::9] = np.nan
    dome = sampled_dome(0.5, view, azimuth, values[:, None])
    x, y, z = np.moveaxis(np.asarray(dome.directions), -1, 0)
    zenith = np.arccos(z)
    want = 2.0 + zenith * x / np.hypot(x, y)
    inside = zenith < 1.3
    np.testing.assert_allclose(dome.light[..., 0][inside], want[inside], atol=1e-9)
    with pytest.raises(skyfit.InputError, match="expected 4 directions or more"):
        sampled_dome(0.5, view[:5], azimuth[:5], [[1.0]] * 3 + [[np.nan]] * 2)


@pytest.mark.slow
def test_a_measured_sky_lights_the_ground_as_its_nearest_samples_do():
    skies = cornell_skies().isel(time=3)
    keep = skies["reliable"].values
    view, azimuth = (skies[n].values[keep] for n in ("view_zenith", "relative_azimuth"))
    values = skies["luminance"].values[keep]
    dome = sampled_dome(float(skies["sun_zenith"]), view, azimuth, values[:, None])

    # The azimuths are folded to one side of the sun: each sample stands for two directions.
    sine, side = np.sin(view), np.sin(azimuth)
    left, right = (
        np.stack([sine * np.cos(azimuth), sign * sine * side, np.cos(view)], -1) for sign in (1, -1)
    )
    grid = np.asarray(dome.directions)
    nearest = np.argmax(np.maximum(grid @ left.T, grid @ right.T), axis=-1)
    want = (values[nearest] * grid[..., 2] * np.asarray(dome.solid_angle)[:, None]).sum()
    got = float(plane_light(dome).sky[0])
    # Steps between 81 samples against slopes between them.
    np.testing.assert_allclose(got, want, rtol=0.01)
    assert 5e3 < got < 3e4  # clear skies give 5 to 30 klx


@pytest.mark.slow
def test_derivatives_by_turbidity_sun_and_tilt_are_those_of_differences():
    def light(at):
        turbidity, sun, tilt = at
        dome = sky_dome(preetham_sky(turbidity), sun, zeniths=16, azimuths=32)
        disc = sun_light(turbidity, sun)
        return plane_light(dome, tilt, 0.4, sun=disc, ground_albedo=0.2).total[1]

    at, step = jnp.asarray([3.0, 0.8, 0.0]), 1e-5
    value, slopes = jax.jit(light), jax.jit(jax.grad(light))
    gradient = slopes(at)
    for k in range(3):
        nudge = step * jnp.zeros(3).at[k].set(1.0)
        slope = (value(at + nudge) - value(at - nudge)) / (2 * step)
        np.testing.assert_allclose(gradient[k], slope, rtol=1e-5)
    for edge in ([3.0, 0.0, 0.0], [3.0, np.pi / 2, WALL], [3.0, 1.7, np.pi]):
        assert np.isfinite(slopes(jnp.asarray(edge))).all()


@pytest.mark.slow
def test_light_is_linear_in_the_samples():
    view, azimuth = paper_directions()

    def ground(samples):
        return plane_light(sampled_dome(0.5, view, azimuth, samples)).sky[0]

    gradient = jax.grad(ground)(jnp.ones((view.size, 1)))
    np.testing.assert_allclose(gradient.sum(), np.pi, rtol=1e-3)
    assert (gradient >= 0).all()


@pytest.mark.slow
def test_float32_is_within_a_ten_thousandth(float32):
    dome = sky_dome(preetham_sky(3.0), 0.9)
    assert dome.light.dtype == jnp.float32
    got = plane_light(dome, 0.6, 0.5).sky[1]
    np.testing.assert_allclose(got, plain_sum(preetham_sky(3.0), 0.9, 0.6, 0.5), rtol=5e-4)


@pytest.mark.parametrize(
    ("function", "arguments", "options", "message"),
    [
        (sky_dome, (preetham_sky(3.0), [0.1, 0.2]), {}, r"sun_zenith=...\): expected one value"),
        (sky_dome, (preetham_sky(3.0), 0.1), {"zeniths": 1}, "expected 2 and 4 or more; got 1"),
        (sky_dome, (preetham_sky([2.0, 3.0]), 0.1), {"azimuths": 2}, "expected 2 and 4 or more"),
        (sampled_dome, (0.1, [0.1], [0.2, 0.3], [[1.0]]), {}, "expected one direction in"),
        (sampled_dome, (0.1, [0.1] * 3, [0.2] * 3, [[1.0]] * 3), {}, "4 directions or more"),
        (sampled_dome, (0.1, [2.0] * 5, [0.2] * 5, [[1.0]] * 5), {}, "must lie in 0 to π/2"),
    ],
)
def test_mistakes_are_named(function, arguments, options, message):
    with pytest.raises(ValueError, match=message):
        inspect.unwrap(function)(*arguments, **options)
