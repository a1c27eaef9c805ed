"""Errors of shape, and the published coefficients given back."""

import numpy as np
import pytest
from model_skies import DIRECTIONS, SUNS, TURBIDITIES, model_skies

from skyfit.fitting import fit_sky
from skyfit.judging import recovery_error, shape_error
from skyfit.models import preetham_sky


DATA = model_skies()


@pytest.mark.slow
def test_the_published_coefficients_are_recovered_from_a_cold_start():
    for name, error in recovery_error().items():
        assert error <= 1e-9, name


def test_a_dataset_does_not_differ_from_the_model_it_is_made_of():
    for pair in ((DATA, preetham_sky), (preetham_sky, DATA), (DATA, DATA)):
        for error in shape_error(*pair).values():
            assert error < 1e-12


def test_shape_error_is_the_root_mean_square_over_the_zenith():
    data = DATA.copy(deep=True)
    view = DIRECTIONS[0]
    # Half the directions are 20 % too bright; the zenith, which all are measured by, is right.
    off = np.arange(view.size) % 2 == 1
    data["luminance"] = data["luminance"] * np.where(off, 1.2, 1.0)
    inside = view < np.radians(86)
    want = 0.2 * np.sqrt(off[inside].mean())
    got = shape_error(data, DATA)
    np.testing.assert_allclose(got["Y"], want, rtol=1e-12)
    assert got["x"] == 0


def test_a_brighter_zenith_is_a_smaller_relative_sky():
    data = DATA.copy(deep=True)
    data["luminance"][:, :, 0] *= 2
    inside = (DIRECTIONS[0] < np.radians(86)).sum()
    # Every direction but the zenith itself is halved relative to it.
    want = 0.5 * np.sqrt((inside - 1) / inside)
    np.testing.assert_allclose(shape_error(data, DATA)["Y"], want, rtol=1e-12)
    # A luminance unit makes no difference.
    assert shape_error(DATA * 1e3, DATA)["Y"] < 1e-14


@pytest.mark.slow
def test_fits_models_and_data_can_be_compared_in_any_pair():
    fit = fit_sky(DATA)
    for pair in ((fit, DATA), (fit, preetham_sky)):
        for error in shape_error(*pair).values():
            assert error < 1e-8
    # At one turbidity a model stands for itself.
    one = model_skies(turbidities=[3.0])
    assert shape_error(preetham_sky(3.0), one)["Y"] < 1e-12
    assert shape_error(preetham_sky(4.0), one)["Y"] > 0.01


def test_shape_error_counts_the_published_sky_by_hand():
    # Against turbidity 3's own shape, turbidity 2's at one sun, from the formula in NumPy
    def f(table, theta, gamma):
        a, b, c, d, e = table
        return (1 + a * np.exp(b / np.cos(theta))) * (
            1 + c * np.exp(d * gamma) + e * np.cos(gamma) ** 2
        )

    view, azimuth = DIRECTIONS
    inside = view < np.radians(86)
    view, azimuth, sun = view[inside], azimuth[inside], SUNS[1]
    gamma = np.arccos(
        np.clip(np.cos(view) * np.cos(sun) + np.sin(view) * np.sin(sun) * np.cos(azimuth), -1, 1)
    )
    two = [-1.1056, -0.2833, 5.2797, -2.3359, 0.2363]
    three = [-0.9269, -0.6387, 5.2570, -2.2153, 0.1693]
    ratio = (f(two, view, gamma) / f(two, 0, sun)) / (f(three, view, gamma) / f(three, 0, sun))
    data = model_skies(turbidities=[3.0], suns=[sun])
    got = shape_error(preetham_sky(2.0), data)["Y"]
    np.testing.assert_allclose(got, np.sqrt(np.mean((ratio - 1) ** 2)), rtol=1e-10)


def test_a_dataset_without_a_zenith_has_no_shape():
    with pytest.raises(ValueError, match="without a zenith direction"):
        shape_error(DATA.isel(direction=slice(1, None)), preetham_sky)


def test_datasets_of_different_skies_are_not_compared():
    other = model_skies(suns=SUNS + 0.01)
    with pytest.raises(ValueError, match="of the same skies and directions"):
        shape_error(other, DATA)
    assert TURBIDITIES[0] == 2.0
