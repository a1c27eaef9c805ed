"""The published sky against the paper's numbers and against another program."""

import warnings

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.models import preetham_sky
from skyfit.models.preetham import published_coefficients, published_zenith_chromaticity


pytestmark = pytest.mark.any_precision


# Spectral radiance [W m^-2 sr^-1 nm^-1] at T = 2.53 and 559.75 nm of the Preetham model in E.
# Bruneton's clear-sky-models (BSD licence), a program of its own: sun zenith, view zenith and
# relative azimuth in degrees.
PEER = [
    (0.0, 2.5, 0.0, 0.286444),
    (20.0, 42.5, 30.0, 0.149478),
    (40.0, 2.5, 180.0, 0.0813948),
    (40.0, 87.5, 60.0, 0.150393),
    (60.0, 57.5, 0.0, 0.362797),
    (60.0, 32.5, 120.0, 0.0520066),
    (80.0, 72.5, 15.0, 0.255928),
    (80.0, 87.5, 180.0, 0.0987056),
]


@pytest.mark.parametrize(("sun", "view", "azimuth", "want"), PEER)
def test_radiance_agrees_with_another_program(sun, view, azimuth, want):
    angles = np.radians([sun, view, azimuth])
    got = preetham_sky(2.53).radiance(*angles, [450.0, 559.75])[1]
    # Its colour-matching functions stop elsewhere: 2e-4 in luminance.
    np.testing.assert_allclose(got, want, rtol=5e-4)


@pytest.mark.float64
def test_coefficients_at_turbidity_two_are_those_of_the_paper():
    # Appendix A.2 by hand: slope times 2 plus intercept
    want = {
        "x": [-0.2978, -0.1322, 0.2117, -1.0271, 0.0386],
        "y": [-0.2942, -0.1808, 0.1944, -1.7419, 0.0311],
        "Y": [-1.1056, -0.2833, 5.2797, -2.3359, 0.2363],
    }
    np.testing.assert_allclose(preetham_sky(2.0).coefficients(0.5), list(want.values()), atol=1e-12)


def test_tables_come_in_the_order_of_x_y_and_luminance():
    coefficients = published_coefficients()
    np.testing.assert_array_equal(coefficients[:, 0, 0], [-0.0193, -0.0167, 0.1787])
    np.testing.assert_array_equal(coefficients[:, 4, 1], [0.0452, 0.0529, 0.3703])
    x, y = published_zenith_chromaticity()
    np.testing.assert_array_equal(x[0], [0.00166, -0.00375, 0.00209, 0.0])
    np.testing.assert_array_equal(y[2], [0.15346, -0.26756, 0.06670, 0.26688])


@pytest.mark.float64
def test_zenith_luminance_is_the_printed_formula():
    # T = 3, θₛ = 60°: χ = (4/9 - 3/120) π/3 = 0.439241, tan χ = 0.469854
    kilo = (4.0453 * 3 - 4.9710) * np.tan((4 / 9 - 3 / 120) * np.pi / 3) - 0.2155 * 3 + 2.4192
    np.testing.assert_allclose(kilo, 5.1392, atol=1e-4)
    got = preetham_sky(3.0).xyY(np.pi / 3, 0.0, 0.0)[2]
    np.testing.assert_allclose(got, 1000 * kilo, rtol=1e-12)


@pytest.mark.float64
def test_zenith_chromaticity_is_the_printed_matrix():
    # T = 2, θₛ = 1: rows summed, x = 4(0.0) + 2(0.00666) + 0.22434, from the five-decimal matrix
    x = 4 * (0.00166 - 0.00375 + 0.00209) + 2 * (-0.02903 + 0.06377 - 0.03202 + 0.00394)
    x += 0.11693 - 0.21196 + 0.06052 + 0.25886
    got = preetham_sky(2.0).xyY(1.0, 0.0, 0.0)
    np.testing.assert_allclose(got[0], x, rtol=1e-12)
    np.testing.assert_allclose(got[0], 0.23767, atol=1e-5)


def test_luminance_has_a_pole_below_the_valid_range():
    # 1 + A e^B at the zenith changes sign near T = 1.64: why the model is held at 1.9.
    def overhead(turbidity):
        (a, b), _ = (published_coefficients()[2, k] @ [turbidity, 1.0] for k in (0, 1)), None
        return 1 + a * np.exp(b)

    assert overhead(1.63) < 0 < overhead(1.66)
    np.testing.assert_array_equal(preetham_sky(1.9).valid_range["turbidity"], (1.9, 10.0))


def test_zenith_luminance_would_turn_negative_for_low_suns():
    # The elevations at which the published zenith luminance vanishes: -4.2° at T = 6, -0.59° at
    # T = 10, +2.6° at T = 20.
    sky = preetham_sky(3.0).scale.luminance
    for turbidity, elevation in ((6.0, -4.2), (10.0, -0.59), (20.0, 2.6)):
        zenith = [np.radians(90 - elevation - d) for d in (0.05, -0.05)]
        above, below = (float(sky(jnp.asarray(turbidity), jnp.asarray(z))) for z in zenith)
        assert below < 0 < above


@pytest.mark.parametrize(("turbidity", "held"), [(1.0, 1.9), (1.64, 1.9), (20.0, 10.0)])
def test_turbidity_out_of_range_is_held_and_said_so(turbidity, held):
    with pytest.warns(UserWarning, match="preetham_sky.turbidity=.* is valid from 1.9 to 10"):
        got = preetham_sky(turbidity).xyY(0.5, 1.0, 0.3)
    np.testing.assert_array_equal(got, preetham_sky(held).xyY(0.5, 1.0, 0.3))


def test_turbidity_in_range_gives_no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        preetham_sky(1.9)
        preetham_sky(np.float32(10.0))


@pytest.mark.parametrize("bad", [0.9, -1.0, np.nan])
def test_impossible_turbidity_is_refused(bad):
    with pytest.raises(ValueError, match=r"preetham_sky\(turbidity=...\) must be 1 or more; got"):
        preetham_sky(bad)


def test_impossible_turbidity_is_refused_under_jit():
    with pytest.raises(RuntimeError, match="must be 1 or more"):
        jax.jit(lambda t: preetham_sky(t).xyY(0.5, 0.3, 0.1))(0.5).block_until_ready()


@pytest.mark.float64
def test_methods_go_into_jit_as_they_are_one_model_apart_from_another():
    for turbidity in (3.0, 5.0):
        model = preetham_sky(turbidity)
        # Compiled arithmetic is fused: the last digits may differ.
        want = model.xyY(0.5, 0.3, 0.1)
        np.testing.assert_allclose(jax.jit(model.xyY)(0.5, 0.3, 0.1), want, rtol=1e-12)
