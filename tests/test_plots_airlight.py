"""Pictures of aerial perspective."""

import numpy as np
import pytest

from skyfit.plots import airlight


@pytest.mark.slow
def test_the_errors_drawn_are_those_of_the_methods():
    errors = list(airlight.path_errors(np.array([60.0, 90.0]), np.array([1e4])).values())
    assert errors[0].max() < 1e-9
    # Equation 10 after 10 km under 60°: by hand, haze has thinned to e^(-10 / 2.4) of the ground's.
    np.testing.assert_allclose(errors[1][0], 0.15, atol=0.01)
    assert errors[1][1] < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("chart", [airlight.path_error_chart, airlight.sunset_chart])
def test_charts_name_their_units(chart):
    figure = chart()
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes]
    assert any("[km]" in label for label in labels)
