"""Around the sun: phase functions and glows are as sharp in pictures as they are in the air."""

import math

import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit.atmosphere import Atmosphere, Constituent
from skyfit.colour import spectrum_to_xyz
from skyfit.phase import HenyeyGreenstein, Rayleigh
from skyfit.profile import Exponential
from skyfit.render import Perspective, SimulatedSource, render, simulated
from skyfit.render.cameras import direction_of
from skyfit.render.falloff import GLOW_ENDS, beside_the_sun, crowding, glow, phase_of_light
from skyfit.transfer.simulate_sky import Sky


WAVELENGTHS = [450.0, 550.0, 650.0]
SUNS = np.radians([3.0, 40.0, 80.0, 88.0])
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def dusty(g=0.95, absorbing=False):
    """Air and grey dust; a gas that only absorbs, if asked for."""
    gas = Constituent(Exponential(8e3), [2.4e-5, 1.06e-5, 5.4e-6], phase=Rayleigh())
    dust = Constituent(Exponential(2e3), 2.5e-4, 5e-6, phase=HenyeyGreenstein(g))
    ozone = Constituent(Exponential(9e3), 0.0, [1e-7, 2e-6, 1e-6], phase=Rayleigh())
    made_of = (gas, ozone, dust) if absorbing else (gas, dust)
    return Atmosphere(WAVELENGTHS, [1.9, 1.9, 1.6], made_of, ground_albedo=0.2)


def around(sun, gamma, turns):
    """Unit vectors at angles to the sun, turned from its vertical; [gamma, turn, 3]."""
    toward, up, side = direction_of(sun, 0.0), direction_of(sun - math.pi / 2, 0.0), [1.0, 0.0, 0.0]
    ring = np.cos(turns)[:, None] * up + np.sin(turns)[:, None] * np.array(side)
    return np.cos(gamma)[:, None, None] * toward + np.sin(gamma)[:, None, None] * ring[None]


def angles_of(unit):
    """Zenith angle and azimuth."""
    east, north, up = np.moveaxis(np.asarray(unit, float), -1, 0)
    return np.arctan2(np.hypot(east, north), up), np.arctan2(east, north)


@pytest.mark.parametrize("g", [0.76, 0.95, 0.99])
def test_a_phase_function_is_itself_between_the_nodes(g):
    gamma = np.concatenate([[0.0], np.geomspace(1e-4, math.pi, 4000)])
    phase = HenyeyGreenstein(g)
    found = phase_of_light(phase, np.ones(3), np.eye(3))(gamma)
    expected = np.asarray(phase.spectral(jnp.cos(gamma)))
    # Required: 0.5 %.
    assert found == pytest.approx(np.broadcast_to(expected, found.shape), rel=1e-4)


def test_a_phase_function_is_the_mean_over_what_each_channel_sees():
    phase = HenyeyGreenstein(jnp.array([0.2, 0.5, 0.8]))
    found = phase_of_light(phase, np.array([1.0, 0.0, 3.0]), np.array([[1.0], [5.0], [1.0]]))
    expected = np.asarray(phase.spectral(jnp.array([0.5])))[0] @ [0.25, 0.0, 0.75]
    assert found(np.array([math.pi / 3])) == pytest.approx(expected, rel=1e-4)


def test_no_light_has_a_phase_function_that_may_divide():
    weights = np.array([[1.0, 0.0], [0.0, 1.0]])
    for spectrum in ([0.0, 0.0], [1.0, 0.0]):
        values = phase_of_light(Rayleigh(), np.array(spectrum), weights)(crowding(50))
        assert (values > 0.05).all()


def test_a_glow_follows_a_peak_and_ends():
    def peak(gamma):
        spread = HenyeyGreenstein(0.95).spectral(jnp.cos(jnp.asarray(gamma)))
        return np.asarray(spread) * [1.0, 2.0, 3.0] + 0.1

    shape = glow(peak(crowding(28, GLOW_ENDS)))
    gamma = np.radians(np.linspace(0, 20, 500))
    ratio = shape(gamma) / peak(gamma)
    assert ratio / ratio[:1] == pytest.approx(np.ones_like(ratio), rel=5e-3)
    assert shape(np.array([GLOW_ENDS, 2.0, math.pi])) == pytest.approx(np.ones((3, 3)))
    assert glow(np.zeros((28, 3))) is None


@pytest.mark.parametrize("sun", [0.0, *SUNS], ids=str)
def test_beside_the_sun_angles_are_as_told_and_the_sky_is_there(sun):
    view, azimuth = beside_the_sun(20, sun)
    cosine = direction_of(view, azimuth) @ direction_of(sun, 0.0)
    assert np.arccos(np.clip(cosine, -1, 1)) == pytest.approx(crowding(20, GLOW_ENDS), abs=2e-8)
    assert view.max() <= math.pi / 2


@pytest.mark.slow
@pytest.mark.parametrize("sun", SUNS[1:3], ids=["high", "low"])
@pytest.mark.parametrize("absorbing", [False, True], ids=["dust", "dust and ozone"])
def test_the_suns_glare_is_the_simulations(sun, absorbing):
    air = dusty(absorbing=absorbing)
    source = SimulatedSource(air, "dust", orders=1, quality="draft")
    camera = Perspective(240, 240, elevation=math.pi / 2 - sun, field_of_view=math.radians(24))
    picture = render(source, camera, sun, 0.0, sun_disc=False)
    unit = camera.rays().direction.astype(float)
    gamma = np.arccos(np.clip(unit @ direction_of(sun, 0.0), -1, 1))
    places = [np.abs(gamma - math.radians(one)).argmin() for one in (0.5, 1.0, 2.0, 5.0, 10.0)]
    view, azimuth = angles_of(unit.reshape(-1, 3)[places])
    sky = skyfit.simulate(air, sun, view, azimuth, orders=1, quality="draft")
    expected = spectrum_to_xyz(sky.radiance, air.wavelengths)[:, 1]
    # Required: 1 %. Measured: 0.02 %.
    found = picture.rgb.reshape(-1, 3)[places] @ LUMINANCE
    assert found == pytest.approx(np.asarray(expected), rel=1e-3)
    # From half a degree to ten it falls to a fifth, and not in steps.
    assert found[4] < 0.2 * found[0]


@pytest.mark.slow
@pytest.mark.parametrize("sun", SUNS[:3], ids=lambda sun: f"{math.degrees(sun):.0f}deg")
def test_glare_of_dust_that_changes_with_the_wavelength_has_the_simulations_colour(sun):
    air = dusty(jnp.array([0.97, 0.95, 0.92]))
    unit = around(sun, np.radians([0.5, 2.0, 10.0, 40.0]), np.radians([0.0, 45.0, 120.0]))
    unit = unit[unit[..., 2] > 0]
    found = SimulatedSource(air, "dust", orders=1, quality="draft").xyz(unit, sun, 0.0)
    sky = skyfit.simulate(air, sun, *angles_of(unit), orders=1, quality="draft")
    expected = np.asarray(spectrum_to_xyz(sky.radiance, WAVELENGTHS))
    assert found == pytest.approx(expected, rel=0.01)


@pytest.mark.slow
@pytest.mark.usefixtures("float32")
def test_one_order_in_single_precision_leaves_no_noise_to_divide():
    air, sun = dusty(), 0.9
    unit = around(sun, np.radians([0.5, 2.0, 20.0, 50.0]), np.radians([0.0, 45.0, 120.0]))
    unit = unit.reshape(-1, 3)
    found = SimulatedSource(air, "dust", orders=1, quality="draft").xyz(unit, sun, 0.0)
    sky = skyfit.simulate(air, sun, *angles_of(unit), orders=1, quality="draft")
    expected = np.asarray(spectrum_to_xyz(sky.radiance, air.wavelengths))
    # Half a degree from the sun, the cosine of single precision is half a percent off its peak.
    assert found == pytest.approx(expected, rel=0.01)


@pytest.mark.slow
def test_what_absorbs_alone_changes_nothing_else():
    """The black pictures of air with ozone: no light was divided by no phase function."""
    sun, unit = 0.9, around(0.9, np.radians([2.0, 20.0, 50.0]), np.radians([0.0, 120.0]))
    air = dusty(absorbing=True)
    found = SimulatedSource(air, "ozone", orders=1, quality="draft").xyz(
        unit.reshape(-1, 3), sun, 0.0
    )
    sky = skyfit.simulate(air, sun, *angles_of(unit.reshape(-1, 3)), orders=1, quality="draft")
    assert found == pytest.approx(np.asarray(spectrum_to_xyz(sky.radiance, WAVELENGTHS)), rel=1e-3)


def peaked(g):
    """A simulator whose later orders are a peak that fades towards the horizon, and an even sky."""

    def simulate(atmosphere, sun_zenith, view, azimuth, orders, **_):
        view, azimuth = np.broadcast_arrays(view, azimuth)
        gamma_cosine = direction_of(view, azimuth) @ direction_of(sun_zenith, 0.0)
        peak = np.asarray(HenyeyGreenstein(g).spectral(jnp.asarray(gamma_cosine)))
        airmass = 1 / (np.cos(view) + 0.02)
        light = (
            peak * np.exp(-0.3 * airmass)[..., None] + (0.1 * airmass / (1 + airmass))[..., None]
        )
        light = light * np.array([1.0, 1.5, 2.0])
        first = 1e-3 * np.ones_like(light)  # of each of two constituents
        if orders == 1:
            return Sky(jnp.asarray(first[None]), jnp.zeros_like(first))
        return Sky(jnp.asarray(np.stack([2 * first, light])), jnp.zeros_like(light))

    return simulate


@pytest.mark.slow
@pytest.mark.parametrize("g", [0.9, 0.95])
@pytest.mark.parametrize("sun", SUNS, ids=lambda sun: f"{math.degrees(sun):.0f}deg")
def test_what_later_orders_leave_of_a_peak_is_kept(monkeypatch, g, sun):
    simulate = peaked(g)
    monkeypatch.setattr(simulated, "simulate", simulate)
    source = SimulatedSource(dusty(), "peaked", orders=None)
    gamma = np.radians([0.0, 0.3, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0])
    unit = around(sun, gamma, np.radians(np.arange(0, 181, 15))).reshape(-1, 3)
    unit = unit[unit[:, 2] > 0]
    sky = simulate(None, sun, *angles_of(unit), None)
    expected = np.asarray(spectrum_to_xyz(sky.radiance, WAVELENGTHS))
    # Required: 2 %. Measured: 1.4 % under the lowest sun, 0.4 % under the others.
    assert source.xyz(unit, sun, 0.0) == pytest.approx(expected, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("zenith_deg", [94.0, 102.0])
def test_deep_twilight_is_the_simulations(zenith_deg):
    """At last the haze is in the planet's shadow whole, and sends no light of the first order."""
    sun, grid = math.radians(zenith_deg), np.arange(400.0, 701.0, 50.0)
    air = skyfit.preetham_atmosphere(3.0, wavelengths=grid)
    source = SimulatedSource(air, "air", orders=2, quality="draft")
    view, azimuth = (
        a.ravel()
        for a in np.meshgrid(np.radians([1.0, 50.0, 80.0, 87.0, 89.0]), [0.0, 0.5, 1.5, 3.0])
    )
    found = source.xyz(direction_of(view, azimuth), sun, 0.0)
    sky = skyfit.simulate(air, sun, view, azimuth, 2, quality="draft")
    expected = np.asarray(spectrum_to_xyz(sky.radiance, grid))
    assert np.isfinite(found).all()
    # What is a hundredth of the brightest is dark; there draft quality is not sure of the sign.
    dark = 1e-2 * float(expected.max())
    assert found == pytest.approx(expected, rel=0.06, abs=dark)
