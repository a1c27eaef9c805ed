"""Skies through bands: the mean of skies that each have one class of lines, and nothing else."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit import Atmosphere, Bands, Constituent, phase, profile
from skyfit.aerial.source import sunlight_at_ground
from skyfit.campaign.description.bands import mixed_gas_bands, water_vapour_bands
from skyfit.render.simulated import SimulatedSource, only
from skyfit.render.sun_disc import disc_radiance
from skyfit.transfer.line_classes import line_classes, side_by_side


pytestmark = pytest.mark.any_precision


LAM = np.array([550.0, 690.0, 720.0])
BANDED = [1, 2]
ALBEDO, SUN = np.array([0.1, 0.3, 0.5]), np.array([1.9, 1.5, 1.4])
VIEW = np.radians([0.0, 40.0, 85.0])[:, None]
AZIMUTH = np.radians([0.0, 120.0])
WEIGHTS = np.asarray(water_vapour_bands(LAM, 0.02, 1.0).weights)


def plain_constituents(at=(0, 1, 2)):
    """Air, and haze whose phase function has a spectrum; at some of the wavelengths."""
    at = list(at)
    air = Constituent(
        profile.Exponential(8e3),
        np.array([1.2e-5, 4.8e-6, 4.0e-6])[at],
        phase=phase.Rayleigh(np.array([0.03, 0.02, 0.01])[at]),
    )
    haze = Constituent(
        profile.Exponential(1200.0),
        np.array([8e-5, 7e-5, 6e-5])[at],
        np.array([1e-5, 2e-5, 3e-5])[at],
        phase=phase.HenyeyGreenstein(np.array([0.75, 0.7, 0.65])[at]),
    )
    return air, haze


def atmosphere(*more, lam=LAM, **changes):
    takes = {"solar_irradiance": SUN, "ground_albedo": ALBEDO} | changes
    return Atmosphere(lam, constituents=(*plain_constituents(), *more), **takes)


def vapour(water=0.02):
    return skyfit.water_vapour(LAM, water)


def by_hand(numbers, at):
    """The same with plain absorbers: wavelength `at[n]` as class `numbers[n]` of lines sees it."""
    numbers, at = np.asarray(numbers), np.asarray(at)
    absorbers = []
    for bands, density in (
        (water_vapour_bands(LAM, 0.02, float(profile.Exponential(2e3).column(6e4))),
         profile.Exponential(2e3)),
        (mixed_gas_bands(LAM, float(profile.StandardAtmosphere().column(6e4))),
         profile.StandardAtmosphere()),
    ):  # fmt: skip
        lines = np.asarray(bands.absorption)[numbers, at]
        absorbers.append(Constituent(density, 0.0, lines, phase=phase.Isotropic()))
    apart = LAM[at] + 1e-6 * np.arange(at.size)  # wavelengths increase, and mean nothing here
    order = np.argsort(apart)
    assert (order == np.arange(at.size)).all()
    return Atmosphere(apart, SUN[at], (*plain_constituents(at), *absorbers), ALBEDO[at])


@pytest.mark.slow
@pytest.mark.parametrize(("orders", "geometry"), [(1, "flat"), (2, "spherical"), (3, "flat")])
def test_a_sky_is_the_weighted_mean_over_classes_of_lines(orders, geometry):
    choice = {"orders": orders, "geometry": geometry, "quality": "draft"}
    got = skyfit.simulate(atmosphere(vapour(), skyfit.oxygen(LAM)), 1.1, VIEW, AZIMUTH, **choice)
    first = skyfit.simulate(by_hand([0, 0, 0], [0, 1, 2]), 1.1, VIEW, AZIMUTH, **choice)
    numbers, at = np.tile(np.arange(1, 6), 2), np.repeat(BANDED, 5)
    rest = skyfit.simulate(by_hand(numbers, at), 1.1, VIEW, AZIMUTH, **choice)
    want = np.array(first.by_order)
    for place in BANDED:
        rest_here = np.asarray(rest.by_order)[..., at == place]
        want[..., place] = WEIGHTS[0] * want[..., place] + rest_here @ WEIGHTS[1:]
    np.testing.assert_allclose(got.by_order, want, rtol=1e-6)
    np.testing.assert_allclose(got.radiance, want.sum(axis=0), rtol=1e-6)


@pytest.mark.slow
def test_all_orders_are_near_to_each_class_simulated_by_itself():
    """Alone a class has nodes where it needs them: 0.2 % is what the others' needs change."""
    choice = {"orders": None, "geometry": "flat", "quality": "draft"}
    banded = atmosphere(vapour(), skyfit.oxygen(LAM))
    got = skyfit.simulate(banded, 1.1, VIEW, AZIMUTH, **choice)
    alone = [
        skyfit.simulate(by_hand([k] * 3, [0, 1, 2]), 1.1, VIEW, AZIMUTH, **choice) for k in range(6)
    ]
    for name, rtol in (("radiance", 2e-3), ("by_order", 2e-3), ("tail", 2e-2)):
        want = sum(w * getattr(sky, name) for w, sky in zip(WEIGHTS, alone, strict=True))
        np.testing.assert_allclose(getattr(got, name), want, rtol=rtol)


@pytest.mark.slow
def test_wavelengths_without_bands_stay_as_they_are():
    choice = {"orders": 1, "quality": "draft"}
    without = skyfit.simulate(atmosphere(), 1.4, VIEW, AZIMUTH, **choice).radiance
    got = skyfit.simulate(atmosphere(vapour()), 1.4, VIEW, AZIMUTH, **choice).radiance
    np.testing.assert_allclose(got[..., 0], without[..., 0], rtol=5e-4)
    dry = skyfit.simulate(atmosphere(vapour(0.0)), 1.4, VIEW, AZIMUTH, **choice).radiance
    np.testing.assert_allclose(dry, without, rtol=1e-6)


@pytest.mark.slow
def test_more_water_is_less_light_and_as_much_less_as_published():
    """2 cm take 14 % of light that comes straight down at 724 nm, 48 % at air mass 10."""
    lam = np.array([718.0, 724.0])
    air = skyfit.preetham_atmosphere(2.0, wavelengths=lam)

    def light(water, sun):
        part = () if water is None else (skyfit.water_vapour(lam, water),)
        wet = Atmosphere(lam, air.solar_irradiance, (*air.constituents, *part))
        sky = skyfit.simulate(wet, sun, VIEW, AZIMUTH, orders=1, quality="draft")
        return np.asarray(sky.radiance)

    suns = np.radians([[[20.0]], [[60.0]], [[84.0]]])
    dry = light(None, suns)
    lost = [1 - light(water, suns) / dry for water in (0.005, 0.01, 0.02, 0.04)]
    assert (lost[0] > 0).all()
    assert (np.diff(lost, axis=0) > 0).all()
    assert 0.1 < lost[2].min() < 0.15
    assert 0.4 < lost[2].max() < 0.5


def sunlight_on_the_ground(air, sun, _):
    plain, classes = side_by_side(air)
    return classes.mean(sunlight_at_ground(plain, sun))


SUN_ZENITHS = np.radians([0.0, 60.0, 75.0, 85.0, 89.0])


@pytest.mark.slow
@pytest.mark.parametrize("sun", SUN_ZENITHS)
@pytest.mark.parametrize("through", [disc_radiance, sunlight_on_the_ground])
def test_direct_sunlight_is_dimmed_as_bird_and_riordan_say(sun, through):
    lam = np.array([593.0, 690.0, 718.0, 724.4, 762.5])
    water, mixed = np.array([0.075, 0.016, 1.8, 2.5, 1e-5]), np.array([0, 0.15, 0, 0, 4.0])
    at = jnp.asarray(sun), jnp.asarray(0.0)

    def passed(one):
        return np.asarray(through(Atmosphere(lam, 1.0, (one,)), *at) / through(nothing, *at))

    nothing = Atmosphere(
        lam, 1.0, (Constituent(profile.Exponential(2e3), 0.0, phase=phase.Isotropic()),)
    )
    for one, formula, k in (
        (skyfit.water_vapour(lam, 0.02), lambda x: 0.2385 * x / (1 + 20.07 * x) ** 0.45, 2 * water),
        (skyfit.oxygen(lam), lambda x: 1.41 * x / (1 + 118.93 * x) ** 0.45, mixed),
    ):
        # The air mass of the profile, by an absorber of vertical optical depth 0.01.
        thin = 0.01 / one.density.column(6e4)
        mass = -np.log(passed(Constituent(one.density, 0.0, thin, phase=phase.Isotropic()))) / 0.01
        np.testing.assert_allclose(passed(one), np.exp(-formula(k * mass)), atol=1.1e-3)


def test_the_optical_depth_is_that_of_the_mean_transmittance():
    dry, wet = atmosphere().optical_depth(), atmosphere(vapour()).optical_depth()
    np.testing.assert_array_equal(wet[:2], dry)
    x = 2.0 * np.array([0.0, 0.016, 1.8 + 0.7 * 2 / 6.4])  # linear between the table's rows
    np.testing.assert_allclose(wet[2], 0.2385 * x / (1 + 20.07 * x) ** 0.45, atol=1.1e-3)


@pytest.mark.slow
def test_derivatives_by_the_amount_of_water_are_those_of_differences():
    def light(water):
        air = atmosphere(vapour(water))
        sky = skyfit.simulate(air, 1.1, VIEW, AZIMUTH, orders=1, geometry="flat", quality="draft")
        return sky.radiance.sum(axis=(0, 1))

    # The derivative and the light itself are one program.
    forwards = jax.jit(lambda water: jax.jvp(light, (water,), (1.0,)))
    _, slope = forwards(0.02)
    assert slope[0] == pytest.approx(0.0, abs=1e-4)
    difference = (forwards(0.0202)[0] - forwards(0.0198)[0]) / 4e-4
    np.testing.assert_allclose(slope[1:], difference[1:], rtol=1e-3)
    backwards = jax.jit(jax.jacrev(light))(0.02)
    np.testing.assert_allclose(backwards[1:], slope[1:], rtol=1e-6)


@pytest.mark.slow
def test_an_atmosphere_with_bands_goes_through_jit_vmap_and_grad():
    def light(air):
        return skyfit.simulate(air, 1.1, VIEW, AZIMUTH, orders=1, quality="draft").radiance

    one, other = atmosphere(vapour(0.01)), atmosphere(vapour(0.03))
    want = jnp.stack([light(one), light(other)])
    both = jax.tree.map(lambda a, b: jnp.stack([a, b]), one, other)
    np.testing.assert_allclose(jax.vmap(light)(both), want, rtol=1e-9)

    def total(air):
        sky = light(air)
        return sky.sum(), sky

    slopes, got = eqx.filter_jit(eqx.filter_grad(total, has_aux=True))(one)
    np.testing.assert_allclose(got, want[0], rtol=1e-9)
    assert slopes.constituents[2].bands.strength.shape == (6, 2)
    # Of the last class the air is black: what it has is rounding.
    assert (np.asarray(slopes.constituents[2].bands.strength)[:5] < 0).all()


@pytest.mark.slow
def test_bands_made_inside_a_program_are_those_made_outside():
    kappa = np.array([[0.0, 1e-5], [0.0, 1e-4]])

    def light(kappa):
        gas = Constituent(
            profile.Exponential(2e3), 0.0, phase=phase.Isotropic(), bands=Bands([0.7, 0.3], kappa)
        )
        air = Constituent(profile.Exponential(8e3), 1e-5, phase=phase.Rayleigh())
        sky = Atmosphere([500.0, 700.0], 1.0, (air, gas))
        return skyfit.simulate(sky, 0.5, 0.3, 0.2, orders=1, quality="draft").radiance

    np.testing.assert_allclose(jax.jit(light)(kappa), light(kappa), rtol=1e-5)


@pytest.mark.slow
def test_one_class_of_lines_is_absorption():
    kappa = np.array([1e-6, 2e-5, 4e-5])
    takes = {"density": profile.Exponential(2e3), "scattering": 0.0, "phase": phase.Isotropic()}
    lines = Constituent(**takes, bands=Bands([1.0], kappa[None]))
    plain = Constituent(**takes, absorption=kappa)
    got, want = (
        skyfit.simulate(atmosphere(one), 1.1, VIEW, AZIMUTH, orders=1, quality="draft").radiance
        for one in (lines, plain)
    )
    np.testing.assert_allclose(got, want, rtol=1e-12)


@pytest.mark.slow
def test_single_precision_is_enough(float32):
    air = atmosphere(vapour(), skyfit.oxygen(LAM))
    got = skyfit.simulate(air, 1.1, VIEW, AZIMUTH, orders=1, quality="draft").radiance
    assert got.dtype == jnp.float32
    with jax.enable_x64(True):
        air = atmosphere(vapour(), skyfit.oxygen(LAM))
        want = skyfit.simulate(air, 1.1, VIEW, AZIMUTH, orders=1, quality="draft").radiance
    np.testing.assert_allclose(got, want, rtol=2e-4)


@pytest.mark.slow
def test_the_error_of_a_sky_with_bands_is_estimated():
    sky = skyfit.simulate(
        atmosphere(vapour()), 0.5, VIEW, AZIMUTH, orders=1, quality="draft", estimate_error=True
    )
    assert sky.error_estimate is not None
    assert sky.error_estimate.shape == sky.radiance.shape
    assert float(sky.error_estimate.max()) < 0.02


@pytest.mark.slow
def test_aerial_perspective_dims_by_the_mean_of_the_classes():
    air = atmosphere(vapour())
    light = np.full((576, 3), 0.01)
    seen = {}
    for name, one in (("wet", air), ("dry", atmosphere())):
        model = skyfit.aerial_perspective(one, lambda z, a: light, 0.9)
        seen[name] = np.asarray(model.transmittance([2e3, 2e4], np.pi / 2))
    column = np.array([[2e3], [2e4]]) / (2e3 * (1 - np.exp(-30)))
    x = 2.0 * column * np.array([0.0, 0.016, 1.8 + 0.7 * 2 / 6.4])
    want = np.exp(-0.2385 * x / (1 + 20.07 * x) ** 0.45)
    np.testing.assert_allclose(seen["wet"] / seen["dry"], want, atol=1.1e-3)
    constant = skyfit.ward_larson_aerial(air, lambda z, a: np.full((1, 3), 0.01), 0.9)
    at_a_kilometre = skyfit.aerial_perspective(air, lambda z, a: light, 0.9)
    np.testing.assert_allclose(
        constant.transmittance(1e3), at_a_kilometre.transmittance(1e3, np.pi / 2), rtol=1e-3
    )


@pytest.mark.slow
def test_air_lit_and_seen_through_bands_is_the_mean_of_its_classes():
    air = atmosphere(vapour())
    plain, classes = side_by_side(air)
    ray = (np.array([3e3, 3e4]), 1.5, 0.7)
    got = skyfit.aerial_perspective(air, None, 0.9).inscatter(*ray)
    # Channel after channel as wavelengths of a plain atmosphere, whose sky is simulated with it.
    each = np.asarray(skyfit.aerial_perspective(plain, None, 0.9).inscatter(*ray))
    want = each[:, :3].copy()
    for number, place in enumerate(BANDED):
        share = np.append(WEIGHTS[0], WEIGHTS[1:])
        column = each[:, [place, *range(3 + number, each.shape[1], 2)]]
        want[:, place] = column @ share
    np.testing.assert_allclose(got, want, rtol=1e-9)
    assert classes.place == tuple(BANDED)


@pytest.mark.slow
def test_linear_srgb_sees_through_bands_nearly_what_the_spectrum_does():
    lam = np.arange(400.0, 741.0, 20.0)
    base = skyfit.preetham_atmosphere(2.0, wavelengths=lam)
    gases = skyfit.water_vapour(lam, 0.02), skyfit.oxygen(lam)
    air = Atmosphere(lam, base.solar_irradiance, (*base.constituents, *gases))
    weights = np.asarray(skyfit.aerial.perspective.rgb_weights(air.wavelengths))

    def flat(z, a):
        return np.full((576, lam.size), 0.02)

    ray = (np.array([1e3, 1e4]), np.pi / 2, 0.7)
    spectral = skyfit.aerial_perspective(air, flat, 1.0)
    rgb = skyfit.aerial_perspective(air, flat, 1.0, channels="rgb")
    sun = np.asarray(air.solar_irradiance)
    want = (np.asarray(spectral.transmittance(*ray[:2])) * sun) @ weights / (sun @ weights)
    np.testing.assert_allclose(rgb.transmittance(*ray[:2]), want, rtol=0.015)
    np.testing.assert_allclose(rgb.inscatter(*ray), spectral.inscatter(*ray) @ weights, rtol=0.015)


@pytest.mark.slow
def test_pictures_show_skies_with_bands():
    lam = np.array([450.0, 550.0, 650.0, 720.0])
    base = skyfit.preetham_atmosphere(3.0, wavelengths=lam)
    wet = Atmosphere(
        lam, base.solar_irradiance, (*base.constituents, skyfit.water_vapour(lam, 0.04))
    )
    assert only(wet, 0).constituents[2].bands is not None
    source = SimulatedSource(wet, "wet", orders=1, quality="draft", grid=(12, 9))
    view, azimuth = np.radians(50.0), np.radians(120.0)
    direction = np.array([[np.sin(view) * np.sin(azimuth), np.sin(view) * np.cos(azimuth),
                           np.cos(view)]])  # fmt: skip
    sky = skyfit.simulate(wet, 0.9, view, azimuth, orders=1, quality="draft")
    want = skyfit.render.simulated.xyz_weights(lam).T @ np.asarray(sky.radiance)
    np.testing.assert_allclose(source.xyz(direction, 0.9, 0.0)[0], want, rtol=5e-3)


def test_what_bands_cannot_be_is_named():
    with pytest.raises(ValueError, match=r"^Bands: expected weights \[line_class\].*\(2,\) and"):
        Bands([0.5, 0.5], [[1e-5]])
    with pytest.raises(ValueError, match=r"^Bands\(weights=\.\.\.\) must add up to 1; got 0\.5"):
        Bands([0.5, 0.4], [[1e-5], [1e-5]])
    with pytest.raises(ValueError, match=r"^Bands\(weights=\.\.\.\) must be above 0.*got 0$"):
        Bands([1.0, 0.0], [[1e-5], [1e-5]])
    with pytest.raises(ValueError, match=r"^Bands\(absorption=\.\.\.\) must be 0 or more.*-1$"):
        Bands([0.5, 0.5], [[1e-5], [-1.0]])
    for water in (-0.01, 2.0):  # 2 cm, by one who forgot that lengths are in metres
        with pytest.raises(ValueError, match=r"in \[0, 0\.2\] m; 2 cm are 0\.02; got -?\d"):
            vapour(water)
    with pytest.raises(ValueError, match="known up to 800 nm; got 850"):
        skyfit.oxygen([700.0, 850.0])


def test_an_atmosphere_refuses_bands_that_do_not_fit():
    takes = {"density": profile.Exponential(2e3), "scattering": 0.0, "phase": phase.Isotropic()}
    wide = Constituent(**takes, bands=Bands([0.5, 0.5], [[1e-5] * 2] * 2))
    with pytest.raises(ValueError, match=r"constituents\[2\]\.bands has 2 wavelengths, expected 3"):
        atmosphere(wide)
    other = Constituent(**takes, bands=Bands([0.5, 0.5], [[1e-5] * 3] * 2))
    with pytest.raises(ValueError, match=r"constituents\[3\]\.bands has other weights than those"):
        atmosphere(vapour(), other)


@pytest.mark.slow
def test_bands_have_no_one_coefficient():
    with pytest.raises(ValueError, match="absorbs in bands, which have no one coefficient"):
        _ = atmosphere(vapour()).extinction
    assert line_classes(atmosphere(vapour(), skyfit.oxygen(LAM))).place == (1, 2)
    assert line_classes(atmosphere()).place == ()
