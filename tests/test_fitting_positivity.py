"""Light stays positive and colours possible, or it is said where they do not."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from skyfit._typing import as_float
from skyfit.angles import view_sun_angle
from skyfit.colour import matching_functions
from skyfit.fitting import Positivity, positivity
from skyfit.fitting.positivity import locus_margin
from skyfit.models import preetham_sky
from skyfit.models.axes import Line
from skyfit.models.basis import Basis


def test_margins_are_distances_from_the_edge_of_all_colours():
    # By hand: at equal-energy white the nearest part of the edge is the line of purples, from
    # (0.1741, 0.0050) at 380 nm to (0.7347, 0.2653) at 700 nm (CIE 15, table of chromaticities):
    # |0.5606 (1/3 - 0.0050) - 0.2603 (1/3 - 0.1741)| / 0.6181 = 0.2308.
    assert locus_margin(np.array([1 / 3, 1 / 3])) == pytest.approx(0.2308, abs=3e-3)
    wavelengths, cmf = matching_functions()
    green = cmf[wavelengths == 520][0]
    on_edge = green[:2] / green.sum()
    assert abs(locus_margin(on_edge)) < 1e-4
    outward = on_edge - np.array([1 / 3, 1 / 3])
    assert locus_margin(on_edge + 0.1 * outward) < -0.01
    assert locus_margin(np.array([0.05, 0.05])) < 0


def raw(turbidity):
    """The published formulas where nobody holds the turbidity within bounds."""
    held = preetham_sky(3.0)
    anywhere = (1.0, 20.0)
    return dataclasses.replace(
        held,
        swept={"turbidity": as_float(turbidity)},
        ranges=(("turbidity", anywhere),),
        basis=Basis((Line("turbidity", anywhere),)),
    )


def test_the_published_model_is_negative_below_its_pole_and_black_in_thick_haze():
    # 1 + A e^B of the published luminance vanishes near T = 1.64.
    found = positivity(raw, parameter_range=(1.5, 1.6))
    assert found.least_luminance < -1
    assert not found.holds
    # The published zenith luminance falls below 0 under a low sun, where models make the sky black.
    found = positivity(raw, parameter_range=(10.0, 14.0))
    assert found.least_luminance == 0
    assert found.least_luminance_at["sun_zenith"] > np.radians(80)
    assert not found.holds


def test_the_published_model_is_sound_where_it_is_held():
    found = positivity(preetham_sky, parameter_range=(1.9, 10.0))
    assert found.holds
    assert found.least_luminance == pytest.approx(0.1, abs=0.03)
    at = found.locus_margin_at
    xyY = preetham_sky(at["turbidity"]).xyY(
        at["sun_zenith"], at["view_zenith"], at["relative_azimuth"]
    )
    assert locus_margin(np.asarray(xyY)[:2]) == pytest.approx(found.locus_margin, abs=1e-12)
    assert found.locus_margin == pytest.approx(0.035, abs=0.01)


@pytest.mark.slow
def test_a_sky_that_goes_wrong_at_one_place_is_found_there():
    class Sky:
        swept = {}  # noqa: RUF012

        def sky(self):
            return self

        @property
        def valid_range(self):
            return {"sun_zenith": (0.0, 1.4)}

        def xyY(self, sun, view, azimuth):
            angles = jnp.broadcast_arrays(*map(jnp.asarray, (view, sun, azimuth)))
            gamma = view_sun_angle(*angles)
            luminance = 1.0 - 1.5 * jnp.exp(-((gamma - 2.9) ** 2))
            return jnp.stack([0.3 + 0 * gamma, 0.3 - 0.2 * jnp.cos(angles[0]), luminance], axis=-1)

    found = positivity(Sky())
    gamma = view_sun_angle(
        *(
            jnp.asarray(found.least_luminance_at[name])
            for name in ("view_zenith", "sun_zenith", "relative_azimuth")
        )
    )
    assert found.least_luminance < 0
    assert float(gamma) == pytest.approx(2.9, abs=0.1)
    assert found.locus_margin_at["view_zenith"] == 0
    assert "negative luminance" in found.sentence()


def test_margins_are_told_in_words():
    found = Positivity(0.02, {"sun_zenith": np.pi / 3}, -0.1, {"turbidity": 3.0})
    assert not found.holds
    assert found.sentence() == (
        "darkest point 0.02 of the sky's mean (sun 60°); impossible colour -0.1 (turbidity 3)"
    )
