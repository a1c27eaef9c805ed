"""Fits to skies whose formula is known, and to skies that follow none."""

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from model_skies import DIRECTIONS, SUNS, model_skies, noisy

from skyfit.fitting import fit_each_sky, fit_sky, load_fit
from skyfit.fitting.batch import fit_groups
from skyfit.fitting.choices import PUBLISHED, FitSettings
from skyfit.fitting.fit import fit_formula
from skyfit.fitting.lanes import solve
from skyfit.fitting.problem import objective
from skyfit.fitting.skies import read_skies
from skyfit.models import preetham_sky
from skyfit.models.formula import CHANNELS
from skyfit.models.preetham import (
    ZENITH_ANGLE,
    ZENITH_LUMINANCE,
    published_coefficients,
    published_zenith_chromaticity,
)
from skyfit.models.scale import TangentZenith


COEFFICIENTS = dict(zip(CHANNELS, published_coefficients(), strict=True))


@pytest.fixture(scope="module")
def exact():
    return model_skies()


@pytest.fixture(scope="module")
def fit(exact):
    return fit_sky(exact)


@pytest.fixture(scope="module")
def bent(exact):
    """Skies that no Perez formula follows: a ripple of 5 % on the published ones."""
    view, azimuth = DIRECTIONS
    ripple = 1 + 0.05 * np.sin(3 * view) * np.cos(2 * azimuth) * np.sin(view)
    return exact * xr.DataArray(ripple, dims="direction")


@pytest.mark.slow
def test_published_skies_give_the_published_coefficients_back(fit):
    for name in CHANNELS:
        np.testing.assert_allclose(fit.coefficients[name], COEFFICIENTS[name], atol=1e-9)
        assert fit.diagnostics[name].converged
        assert fit.diagnostics[name].rms < 1e-10


def test_published_zenith_values_give_the_published_numbers_back(fit):
    x, y = published_zenith_chromaticity()
    # Twelve terms of a polynomial on 3 turbidities and 4 suns: a condition number of some 1e4
    np.testing.assert_allclose(fit.zenith["x"]["matrix"], x, atol=1e-9)
    np.testing.assert_allclose(fit.zenith["y"]["matrix"], y, atol=1e-9)
    np.testing.assert_allclose(fit.zenith["Y"]["linear"], ZENITH_LUMINANCE, rtol=1e-6)
    np.testing.assert_allclose(fit.zenith["Y"]["angle"], ZENITH_ANGLE, rtol=1e-6)


def test_the_fitted_model_is_the_model_it_was_fitted_to(fit):
    angles = (0.6, np.linspace(0, 1.7, 9), 0.8)
    want = preetham_sky(4.4).xyY(*angles)
    np.testing.assert_allclose(fit.sky(turbidity=4.4).xyY(*angles), want, rtol=1e-6)


@pytest.mark.slow
def test_without_a_zenith_direction_the_zenith_is_fitted_too(exact):
    fit = fit_sky(exact.isel(direction=slice(1, None)))
    for name in CHANNELS:
        np.testing.assert_allclose(fit.coefficients[name], COEFFICIENTS[name], atol=1e-8)
    np.testing.assert_allclose(fit.zenith["Y"]["linear"], ZENITH_LUMINANCE, rtol=1e-5)


def test_three_starts_lead_to_the_same_optimum(bent):
    gentle, steep = (-0.1, -0.5, 1.0, -0.3, 0.1), (-0.4, -0.1, 0.1, -2.0, 0.0)
    starts = [
        None,
        {"x": gentle, "y": gentle, "Y": (-0.8, -1.0, 4.0, -1.5, 0.1)},
        {"x": steep, "y": steep, "Y": (-1.2, -0.2, 20.0, -4.0, 0.9)},
    ]
    fits = [fit_sky(bent, starts=start) for start in starts]
    for name in CHANNELS:
        for other in fits[1:]:
            # The loss is flat to 1e-13 within 1e-6 of its minimum.
            np.testing.assert_allclose(
                other.coefficients[name], fits[0].coefficients[name], rtol=1e-4, atol=1e-5
            )


def test_standard_errors_are_those_of_the_noise(exact, fit):
    scatter = []
    for seed in range(8):
        noise = fit_sky(noisy(exact, 0.01, seed))
        pull = [
            (noise.coefficients[name] - COEFFICIENTS[name]) / noise.standard_errors[name]
            for name in CHANNELS
        ]
        scatter.append(pull)
        # 3 skies × 4 suns × 41 directions: 1 % within its own error of 1 / √(2·984)
        np.testing.assert_allclose(noise.diagnostics["Y"].rms, 0.01, rtol=0.1)
    # 240 pulls, correlated within a channel: a true 1 scatters by some 15 %.
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(scatter))), 1, atol=0.35)


def test_ten_numbers_together_fit_better_than_a_line_through_separate_fits(exact):
    data = noisy(exact, 0.05)
    fit = fit_sky(data)
    for name in CHANNELS:
        stage, together = fit.two_stage[name], fit.diagnostics[name].rms
        separate = np.sqrt(np.mean(stage.rms_by_value**2))
        # Fifteen numbers, ten fitted together, ten by a line; the prior moves the third digit.
        assert separate <= 1.001 * together <= 1.002 * stage.rms
        assert stage.coefficients.shape == (3, 5)


def test_a_flat_channel_is_said_to_be_unidentified(exact):
    data = exact.copy(deep=True)
    rng = np.random.default_rng(3)
    data["x"][:] = 0.3 + 1e-3 * rng.standard_normal(data["x"].shape)
    data["x"][:, :, 0] = 0.3
    found = fit_sky(data).diagnostics["x"].unidentified
    assert any(words.startswith("C, D and E") for words in found)
    assert all("turbidity" in words for words in found)


@pytest.mark.slow
def test_nothing_swept_needs_no_parameter(exact):
    fit = fit_sky(exact.isel(turbidity=1, drop=True))
    assert fit.parameter_name is None
    want = preetham_sky(3.5)
    np.testing.assert_allclose(fit.sky().xyY(0.6, 0.8, 0.3), want.xyY(0.6, 0.8, 0.3), rtol=1e-6)
    assert set(fit.sky().valid_range) == {"sun_zenith"}
    np.testing.assert_array_equal(fit.coefficients["Y"][:, 0], 0)
    with pytest.raises(ValueError, match=r"SkyFit.sky: expected the parameters \[\]; got"):
        fit.sky(turbidity=3.0)


def test_another_swept_parameter_keeps_its_name(exact):
    fit = fit_sky(exact.rename(turbidity="optical_depth"))
    assert fit.parameter_range == (2.0, 6.0)
    sky = fit.sky(optical_depth=3.0)
    assert sky.valid_range["optical_depth"] == (2.0, 6.0)
    with pytest.warns(UserWarning, match=r"SkyFit.sky\(optical_depth=...\) is valid from 2 to 6"):
        fit.sky(optical_depth=7.0)


@pytest.mark.slow
def test_one_sky_alone_can_be_fitted(exact):
    fit = fit_sky(exact.isel(turbidity=0, sun_zenith=[1], drop=True))
    want = preetham_sky(2.0).xyY(SUNS[1], DIRECTIONS[0], DIRECTIONS[1])
    near = DIRECTIONS[0] < np.radians(86)
    np.testing.assert_allclose(fit.sky().xyY(SUNS[1], *DIRECTIONS)[near], want[near], rtol=1e-6)


def test_weights_and_residuals_change_the_fit_and_are_recorded(bent):
    fits = {
        choice: fit_sky(bent, weights=choice[0], residuals=choice[1])
        for choice in (("equal", "relative"), ("solid angle", "relative"), ("equal", "absolute"))
    }
    (plain, *others) = fits.values()
    for (weights, residuals), fit in fits.items():
        assert fit.settings["weights"] == weights
        assert fit.settings["residuals"] == residuals
    for other in others:
        assert np.abs(other.coefficients["Y"] - plain.coefficients["Y"]).max() > 1e-3


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ({"weights": "cosine"}, r"fit_sky\(weights=...\): expected one of"),
        ({"residuals": "squared"}, r"fit_sky\(residuals=...\): expected one of"),
        ({"max_view_zenith": 85.0}, r"fit_sky\(max_view_zenith=...\) must lie in .* rad; got 85"),
        ({"prior": -1.0}, r"fit_sky\(prior=...\) must be 0 or more"),
    ],
)  # fmt: skip
def test_an_unknown_choice_is_refused_by_name(choice, message):
    with pytest.raises(ValueError, match=message):
        FitSettings(**choice)


def test_an_unknown_zenith_is_refused(exact):
    with pytest.raises(ValueError, match=r"fit_sky\(zenith=...\): expected one of"):
        fit_sky(exact, zenith="sqrt")


def test_a_start_that_cannot_be_one_is_refused(exact):
    with pytest.raises(ValueError, match=r"fit_sky\(starts=...\): expected channels of .*'Z'"):
        fit_sky(exact, starts={"Z": (0.0,) * 5})
    with pytest.raises(ValueError, match=r"\(starts=...\): Y expected 5 coefficients; got 2"):
        fit_sky(exact, starts={"Y": (0.0, 1.0)})
    with pytest.raises(ValueError, match=r"fit_sky\(starts=...\): Y starts out of bounds; got"):
        fit_sky(exact, starts={"Y": (-1.0, 0.3, 10.0, -3.0, 0.45)})


def test_fitting_new_data_compiles_nothing_new(exact):
    fit_sky(exact)
    compiled = []
    listener = lambda name, _, **more: compiled.append((name, more))  # noqa: E731
    jax.monitoring.register_event_duration_secs_listener(listener)
    try:
        fit_sky(noisy(exact, 0.02, seed=5))
    finally:
        jax.monitoring.unregister_event_duration_listener(listener)
    backend = [more for name, more in compiled if "backend_compile" in name]
    assert not backend


@jax.jit
def newton_step(problem, free):
    """Towards the last digit of the optimum."""

    def one(u, p):
        loss = lambda u: 0.5 * jnp.sum(objective(u, p) ** 2)  # noqa: E731
        return u - jnp.linalg.solve(jax.hessian(loss)(u), jax.grad(loss)(u))

    return jax.vmap(one)(free, problem)


def polished(problem, free):
    for _ in range(4):
        free = newton_step(problem, free)
    return free


@pytest.mark.slow
def test_coefficients_differentiate_with_respect_to_the_data(bent):
    skies = read_skies(noisy(bent, 0.02))
    fit = fit_groups(skies, PUBLISHED, FitSettings())
    free = polished(fit.problem, jnp.asarray(fit.solution.free))
    rng = np.random.default_rng(0)
    change = jnp.asarray(rng.standard_normal(fit.problem.target.shape)) * fit.problem.target

    def moved(size):
        return eqx.tree_at(lambda p: p.target, fit.problem, fit.problem.target + size * change)

    def fitted(size):
        return solve(moved(size), free, rtol=1e-13, max_steps=128).free

    implicit = jax.jvp(fitted, (0.0,), (1.0,))[1]
    step = 1e-5
    slope = (polished(moved(step), free) - polished(moved(-step), free)) / (2 * step)
    # The implicit derivative is taken where the solver stopped, 1e-6 from the optimum.
    scale = np.abs(slope).max(axis=1, keepdims=True)
    np.testing.assert_allclose(implicit / scale, slope / scale, atol=1e-4)


@pytest.mark.slow
def test_every_sky_by_itself_is_fitted_as_well_as_from_random_starts(bent):
    data = noisy(bent, 0.01)
    each = fit_each_sky(data)
    assert each.coefficients.shape == (3, 3, 4, 5)
    problem = fit_groups(
        read_skies(data), PUBLISHED, FitSettings(prior=0.0), "sky", again=False
    ).problem
    rng, lanes = np.random.default_rng(0), problem.target.shape[0]
    bright = (np.repeat(np.arange(3), lanes // 3) == 2)[:, None]
    best = np.full(lanes, np.inf)
    for _ in range(24):
        n = rng.standard_normal((lanes, 5))
        start = np.where(
            bright,
            [0.7, -1.5, -1.6, -2.0, 0.0] + n * [0.8, 1.0, 0.8, 1.5, 0.2],
            [0.05, -1.5, -0.1, 0.0, 0.02] + n * [0.1, 1.0, 0.2, 1.2, 0.2],
        )
        loss = np.asarray(solve(problem, jnp.asarray(start), rtol=1e-8, max_steps=64).loss)
        best = np.fmin(best, loss)
    count = np.count_nonzero(np.asarray(problem.weight), axis=(1, 2))
    random = np.sqrt(2 * best / count).reshape(each.rms.shape)
    # A loss within 0.1 % of the best known
    assert np.all(each.rms <= np.sqrt(1.001) * random)


def test_nan_of_a_simulation_is_refused_and_never_fitted(exact):
    data = exact.copy(deep=True).assign_attrs(campaign="{}")
    data["luminance"][1, 2, 3] = np.nan
    for fit in (fit_sky, fit_each_sky):
        with pytest.raises(ValueError, match=r"luminance has 1 non-finite values of 552"):
            fit(data)


def dusk_zenith(turbidity, sun_zenith):
    zenith = TangentZenith(jnp.array([4045.3, -4971.0, -615.5, 2419.2]), jnp.array(ZENITH_ANGLE))
    return np.asarray(zenith(jnp.asarray(turbidity), jnp.asarray(sun_zenith)))


def dusk():
    """The published skies with a zenith whose tangent is 0 at a turbidity of 6 and a sun of 85.2°.

    There 19300.8 tan χ = 1273.8, χ = 0.06590, and π - 2 θₛ = 0.06590 / (4/9 - 6/120) = 0.1671.
    """
    data = model_skies(suns=np.radians([5.0, 30.0, 55.0, 75.0, 80.0, 85.0]))
    at = data["turbidity"].values[:, None], data["sun_zenith"].values[None, :]
    factor = dusk_zenith(*at) / data["luminance"].values[..., 0]
    return data.assign(luminance=data["luminance"] * factor[..., None])


@pytest.mark.slow
def test_a_zenith_that_turns_black_before_sunset_is_warned_of():
    with pytest.warns(UserWarning, match=r"black at turbidity 6 with the sun 85\.5 degrees"):
        fit_sky(dusk())


@pytest.mark.slow
def test_a_logarithm_keeps_the_zenith_bright_until_sunset_and_falls_in_twilight(tmp_path):
    fit = fit_sky(dusk(), zenith="logarithm")
    fit.save(tmp_path / "fit.json")
    sky = load_fit(tmp_path / "fit.json").sky(turbidity=6.0)
    suns = np.radians([75.0, 85.0, 87.5, 90.0, 96.0])
    zenith = np.asarray(sky.xyY(suns, 0.0, 0.0))[:, 2]
    # Where there are skies, they; then the fall of their last degree; below, a decade for 2.5°.
    np.testing.assert_allclose(zenith[:2], dusk_zenith(np.full(2, 6.0), suns[:2]), rtol=1e-3)
    assert zenith[1] > zenith[2] > 0
    assert zenith[2] / zenith[1] == pytest.approx(zenith[3] / zenith[2], rel=1e-6)
    assert zenith[4] / zenith[3] == pytest.approx(10 ** (-6 / 2.5), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("weights", ["equal", "solid angle"])
def test_patches_without_a_value_are_left_out(exact, weights):
    # Every fifth patch, the zenith of one sky among them, and one without an angle.
    gone = (np.arange(exact["luminance"].size) % 5 == 0).reshape(exact["luminance"].shape)
    data = exact.copy(deep=True)
    data["luminance"].values[gone] = np.nan
    data["x"].values[1, 1, 1] = np.nan
    data["relative_azimuth"].values[7] = np.nan
    fit = fit_sky(data, weights=weights)
    np.testing.assert_allclose(fit.coefficients["Y"], published_coefficients()[2], rtol=1e-5)
    assert fit.diagnostics["Y"].worst < 1e-6


def test_a_scanner_of_luminance_alone_is_fitted_and_white(exact):
    white = fit_sky(exact.drop_vars(["x", "y"]))
    np.testing.assert_allclose(white.coefficients["Y"], published_coefficients()[2], rtol=1e-5)
    colour = white.sky(turbidity=3.0).xyY(0.5, 0.9, 1.0)
    np.testing.assert_allclose(colour[:2], [0.3127, 0.3290], rtol=1e-4)


@pytest.mark.slow
@pytest.mark.usefixtures("float32")
def test_fits_work_in_a_float32_program(exact):
    skies = read_skies(exact)
    assert fit_groups(skies, PUBLISHED, FitSettings()).problem.target.dtype == np.float32
    line = fit_formula(skies).coefficients["Y"]
    # 1e-7 of rounding in the data, times the condition number of some 100
    np.testing.assert_allclose(line, COEFFICIENTS["Y"], atol=1e-3)


def test_a_fit_is_immutable(fit):
    with pytest.raises(dataclasses.FrozenInstanceError):
        fit.parameter_name = "albedo"
