"""Choices of weights and what they do to coefficients."""

import numpy as np
import pytest
from model_skies import model_skies

from skyfit.fitting import fit_sky
from skyfit.judging import compare_weights
from skyfit.models.preetham import published_coefficients


@pytest.mark.slow
def test_perfect_skies_have_the_same_coefficients_by_any_weights():
    published = published_coefficients()
    for weighting in compare_weights(model_skies()).values():
        for k, channel in enumerate(("x", "y", "Y")):
            np.testing.assert_allclose(weighting.coefficients[channel], published[k], atol=1e-6)


def test_each_choice_is_best_by_its_own_measure_and_only_there():
    skies = model_skies()
    # Brighter towards the horizon than the formula can be, as hazy skies are.
    skies["luminance"] = skies["luminance"] * (1 + 0.3 * np.sin(skies["view_zenith"]) ** 6)
    found = compare_weights(skies)
    for name in found:
        best = found[name].rms["Y"][name]
        assert all(best < other.rms["Y"][name] for key, other in found.items() if key != name)
    default = fit_sky(skies)
    np.testing.assert_allclose(
        found["relative"].coefficients["Y"], default.coefficients["Y"], rtol=1e-6
    )
    assert found["relative"].rms["Y"]["relative"] == pytest.approx(default.diagnostics["Y"].rms)
    assert found["absolute"].to_dict()["rms"] == found["absolute"].rms
