"""Refraction: the twin against the refraction of stars, the simulator against the twin."""

from functools import cache
from pathlib import Path

import bent_twin
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from plain_air import Air

import skyfit
from skyfit import phase, profile
from skyfit.atmosphere import Atmosphere, Constituent, Refraction
from skyfit.transfer.refraction import straightened
from skyfit.transfer.trust import AccuracyWarning


STORED = Path(__file__).parent / "reference" / "bent_radiances.csv"
SHARP = 2.770e-4  # of dry air at 590 nm, 15 °C and 1013.25 hPa; Peck & Reeder (1972)
WAVELENGTHS = np.array([450.0, 550.0, 650.0])
SCALE = 8e3


def hazy(refractivity=None, refracts=None):
    """Smooth air with haze over a grey ground, under a sun of 1."""
    air = Constituent(
        profile.Exponential(SCALE), 1.16e-5 * (550 / WAVELENGTHS) ** 4, phase=phase.Rayleigh()
    )
    haze = Constituent(
        profile.Exponential(1.2e3),
        5e-5 * 550 / WAVELENGTHS,
        1e-6,
        phase=phase.HenyeyGreenstein(0.7),
    )
    bends = None
    if refractivity is not None:
        bends = Refraction(refractivity, refracts or profile.Exponential(SCALE))
    return Atmosphere(WAVELENGTHS, 1.0, (air, haze), 0.2, top_altitude=80e3, refraction=bends)


def twin_of(atm, refractivity, density=lambda h: np.exp(-h / SCALE)):
    return bent_twin.Bending(Air(atm), refractivity, density)


def of_stars():
    standard = profile.StandardAtmosphere()
    grid = np.arange(-20.0, 60.1e3, 5.0)
    logarithm = np.log(np.asarray(standard(grid)))
    return twin_of(
        eqx.tree_at(lambda a: a.top_altitude, hazy(), jnp.array(60e3)),
        SHARP,
        lambda h: np.exp(np.interp(h, grid, logarithm)),
    )


def pulkovo(altitude):
    """Refraction of a star [rad], Pulkovo tables: 15 °C, 1013.25 mbar, 590 nm, dry, sea level.

    A fit within 0.3 arcseconds by J.-M. Baillard, of the apparent altitude [rad].
    """
    h = np.degrees(altitude)
    inner = h + 4.2206 / (h + 15.1115 / (h + 5.9431))
    return np.radians(1 / 62.8093 / np.tan(np.radians(inner)))


@pytest.mark.parametrize("altitude_deg", [0.0, 1.5, 5.0, 10.0, 27.0, 60.0])
def test_twin_bends_starlight_as_the_pulkovo_tables_have_it(altitude_deg):
    zenith = np.pi / 2 - np.radians(altitude_deg)
    bent = bent_twin.shoot(of_stars(), 0.0, zenith)[0] - zenith
    # Another standard atmosphere than the tables', and a radius 11 km smaller.
    np.testing.assert_allclose(bent, pulkovo(np.radians(altitude_deg)), rtol=4e-3)


def test_rays_to_the_horizon_touch_the_ground():
    bending = twin_of(hazy(), 2.8e-4)
    altitude = np.array([10.0, 2e3, 20e3, 70e3])
    lowest = bent_twin.shoot(bending, altitude, bent_twin.grazing(bending, altitude))[2]
    assert np.all(np.abs(lowest) < 0.5)


@pytest.mark.slow
@pytest.mark.parametrize("altitude", [0.0, 5e3, 40e3])
def test_sun_appears_where_the_twin_finds_it_and_as_bright(altitude):
    atm = hazy(2.8e-4)
    _, planet, over = straightened(atm, 64)
    true = np.radians([0.5, 30.0, 70.0, 88.0, 90.0, 90.4])
    seen, _, spread = bent_twin.find_sun(twin_of(atm, 2.8e-4), np.full(true.shape, altitude), true)
    sun = skyfit.transfer.geometry.SunDirection.from_angles(jnp.asarray(true), jnp.ones(6))
    got, bright = planet.appear(sun, over.straighten(jnp.full(6, altitude)))
    index = float(over.index(jnp.array(altitude)))
    np.testing.assert_allclose(got.zenith(), seen, rtol=0, atol=3e-6)
    np.testing.assert_allclose(bright * index**2, spread, rtol=1e-3)


def stored():
    rows = np.genfromtxt(STORED, delimiter=",", names=True)
    return [tuple(row) for row in rows]


@pytest.mark.slow
@pytest.mark.parametrize("sun_deg", [60.0, 85.0, 89.0, 92.0, 96.0])
def test_first_order_is_the_twins(sun_deg):
    rows = np.array([row for row in stored() if row[0] == sun_deg])
    sky = skyfit.simulate(
        hazy(2.8e-4), np.radians(sun_deg), np.radians(rows[:, 1]), np.radians(rows[:, 2]), orders=1
    )
    bright = rows[:, 3:] > 0
    assert bright.sum() > 12
    # Within 2.2e-4; n² at the eye alone is 5.6e-4.
    np.testing.assert_allclose(np.asarray(sky.radiance)[bright], rows[:, 3:][bright], rtol=4e-4)
    np.testing.assert_array_equal(np.asarray(sky.radiance)[~bright], 0.0)


@pytest.mark.slow
def test_stored_radiance_is_the_twins():
    row = next(r for r in stored() if r[:3] == (96.0, 0.0, 0.0))
    got = bent_twin.first(twin_of(hazy(), 2.8e-4), np.radians(96.0), 0.0, [0.0])[0]
    np.testing.assert_allclose(got, row[3:], rtol=1e-6)


@pytest.mark.slow
def test_refraction_of_nothing_is_no_refraction():
    look = np.radians(93.0), np.radians([0.0, 85.0]), 0.3
    straight = skyfit.simulate(hazy(), *look, orders=1)
    idle = skyfit.simulate(hazy(0.0), *look, orders=1)
    np.testing.assert_array_equal(idle.radiance, straight.radiance)
    # Through the bending program; the horizon is 0.1 mm/km lower there in the shadow's edge too.
    weak = skyfit.simulate(hazy(1e-12), *look, orders=1)
    np.testing.assert_allclose(weak.radiance, straight.radiance, rtol=1e-5)


@pytest.mark.slow
def test_flat_air_does_not_bend():
    look = np.radians(40.0), np.radians([0.0, 85.0]), 0.3
    options = {"orders": 1, "geometry": "flat"}
    straight = skyfit.simulate(hazy(), *look, **options)
    with pytest.warns(AccuracyWarning, match="refraction is left out"):
        bent = skyfit.simulate(hazy(2.8e-4), *look, **options)
    np.testing.assert_array_equal(bent.radiance, straight.radiance)


@pytest.mark.slow
@pytest.mark.parametrize(("altitude", "orders"), [(0.0, None), (100e3, 1)])
def test_all_orders_by_day_hardly_feel_refraction(altitude, orders):
    view = np.radians([150.0, 180.0] if altitude else [0.0, 60.0])
    sky = [
        skyfit.simulate(a, np.radians(40.0), view, 0.3, orders=orders, quality="draft",
                        observer_altitude=altitude)
        for a in (hazy(2.8e-4), hazy())
    ]  # fmt: skip
    np.testing.assert_allclose(sky[0].radiance, sky[1].radiance, rtol=3e-3)
    assert np.all(sky[0].radiance != sky[1].radiance)


@pytest.mark.slow
def test_second_order_after_sunset_is_brighter_for_refraction():
    look = np.radians(93.0), np.radians([0.0, 60.0]), 0.3
    bent, straight = (
        skyfit.simulate(a, *look, quality="draft").by_order[1] for a in (hazy(2.8e-4), hazy())
    )
    assert np.all(bent > straight)
    np.testing.assert_allclose(bent, straight, rtol=0.2)


@cache
def light_and_slope(sun_deg):
    """Of radiance by refractivity, in one program: its derivative by rule beside itself."""

    def light(n):
        sun, view = np.radians(sun_deg), np.radians([0.0, 80.0])
        return skyfit.simulate(hazy(n), sun, view, 0.3, orders=1, quality="draft").radiance

    return light, jax.jit(lambda n: jax.jvp(light, (n,), (jnp.ones_like(n),)))


# Draft quality is not smooth in where shells and shadow lie: at 94° differences by other steps are
# off by as much.
@pytest.mark.slow
@pytest.mark.parametrize(("sun_deg", "rtol"), [(40.0, 1e-4), (89.0, 1e-4), (94.0, 1e-3)])
def test_derivative_by_refractivity_is_the_central_difference(sun_deg, rtol):
    _, both = light_and_slope(sun_deg)
    step = 1e-8
    radiance, slopes = both(jnp.array(2.8e-4))
    low, high = (float(jnp.sum(jnp.log(both(jnp.array(2.8e-4 + d))[0]))) for d in (-step, step))
    np.testing.assert_allclose(jnp.sum(slopes / radiance), (high - low) / (2 * step), rtol=rtol)


@pytest.mark.slow
def test_gradient_by_refractivity_is_the_derivative():
    light, both = light_and_slope(89.0)
    at = jnp.array(2.8e-4)
    gradient = jax.grad(lambda n: jnp.sum(light(n)))(at)
    np.testing.assert_allclose(gradient, jnp.sum(both(at)[1]), rtol=1e-9)


def test_air_that_leads_light_round_the_planet_is_refused():
    with pytest.raises(ValueError, match="would lead light round the planet"):
        hazy(2e-3)
    with pytest.raises(ValueError, match=r"refractivity=\.\.\.\) must be 0"):
        Refraction(-1e-4, profile.Exponential(SCALE))


@pytest.mark.slow
def test_campaign_file_bends_light_by_the_profile_of_its_air(tmp_path):
    path = tmp_path / "bent.toml"
    text = (
        'schema = "skyfit/campaign/1"\n[planet]\nrefractivity = 2.8e-4\n'
        '[[constituents]]\nname = "air"\nkind = "KIND"\n'
        'profile = {kind = "exponential", scale_height_m = 8000}\n'
    )
    path.write_text(text.replace("KIND", "air"))
    atm = skyfit.load_atmosphere(path)
    assert atm.refraction is not None
    assert float(atm.refraction.refractivity) == 2.8e-4
    assert isinstance(atm.refraction.density, profile.Exponential)
    path.write_text(text.replace("KIND", "ozone").replace("profile", "dobson_units = 1\nprofile"))
    with pytest.raises(ValueError, match=r"planet.refractivity: expected a constituent of kind"):
        skyfit.load_atmosphere(path)
