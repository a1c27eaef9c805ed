"""What the paper's simulation leaves out: averages over the sky, with a sky that is known."""

import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit.report import simplifications as module
from skyfit.report.simplifications import simplifications
from skyfit.transfer.simulate_sky import Sky


CAMPAIGN = skyfit.Campaign(turbidity=[2.0, 5.0], wavelengths=[450.0, 550.0, 650.0])


def known_sky(atmosphere, sun_zenith, view_zenith, azimuth, orders=2, geometry="spherical", **_):
    """Order n ∝ 4⁻ⁿ; the later ones brighter at the zenith, flat 3 % too bright, ground adds."""
    view, _ = np.broadcast_arrays(view_zenith, sun_zenith)
    view = jnp.asarray(view)
    ones = jnp.ones((*view.shape, atmosphere.wavelengths.size))
    shape = jnp.cos(view)[..., None]
    count = 4 if orders is None else orders
    by_order = [0.25**n * (ones if n < 2 else shape * ones) for n in range(count)]
    light = jnp.stack(by_order) * (1.03 if geometry == "flat" else 1.0)
    light = light * (1 + atmosphere.ground_albedo[0])
    tail = 0.25**4 / 0.75 * shape * ones if orders is None else 0 * ones
    return Sky(light, tail)


@pytest.fixture
def found(monkeypatch):
    monkeypatch.setattr(module, "simulate", known_sky)
    return simplifications(CAMPAIGN)


@pytest.mark.slow
def test_the_share_of_later_orders_is_averaged_by_solid_angle(found):
    edge = np.radians(85.0)
    # ∫ cos θ dω over ∫ dω down to 85°: 0.547; the rings are a rule of six nodes, 1.5 % off.
    mean = (1 - np.cos(edge) ** 2) / 2 / (1 - np.cos(edge))
    later = (0.25**2 / 0.75) * mean
    share = later / (1.25 + later)
    np.testing.assert_allclose(found["higher_orders"], np.full((2, 5), share), rtol=0.03)


def test_ground_light_is_what_the_ground_adds(found):
    np.testing.assert_allclose(found["ground_light"], np.full((2, 5), 0.2), rtol=1e-6)


def test_the_flat_error_counts_views_up_to_70_degrees_only(found):
    np.testing.assert_allclose(found["flat"], np.full((2, 5), 0.03), rtol=1e-6)


def test_weights_of_directions_are_shares_of_the_sky():
    weight = module._solid_angles(len(module.SPOKES_DEG))
    assert weight.sum() == pytest.approx(1.0)
    assert weight.size == 1 + len(module.RINGS_DEG) * len(module.SPOKES_DEG)
    # The cap of 10° around the zenith: (1 - cos 10°) / (1 - cos 85°).
    assert weight[0] == pytest.approx(0.016642, rel=1e-4)
