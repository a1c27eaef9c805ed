"""One policy below the horizon and at dusk, for every formula that is compared and more.

See `skyfit.models.base`: light is never negative, nothing jumps at sunset or at the horizon, and
every gradient is finite.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from test_models_formula import BASES, sky_of

from skyfit.angles import unit_vector
from skyfit.compare.models import MODELS, Conditions
from skyfit.models import AbstractSkyModel, preetham_sky
from skyfit.models.domes import distribution_from


pytestmark = pytest.mark.any_precision


def formulas():
    """Every model of the table that is a formula, and one of the ladder."""
    at = Conditions(sun_zenith=0.8, turbidity=3.0)
    found = {}
    for entry in MODELS:
        if entry.package or entry.name.startswith("simulated"):
            continue
        sky = entry.sky(at)
        if isinstance(sky, AbstractSkyModel):
            found[entry.name] = sky
    found["published, turbidity 10"] = preetham_sky(10.0)
    found["ladder"] = sky_of(distribution_from({"name": "cie"}), BASES["cosine"])
    return found


FORMULAS = formulas()
EACH = pytest.mark.parametrize("name", FORMULAS)
SUN = 0.7
# Sun, view and azimuth where a formula could break: the sun overhead, at the horizon, set, below
# the earth; the view at the zenith, the horizon, the sun, opposite it, below, straight down.
EDGES = np.array(
    [
        (sun, view, azimuth)
        for sun in (0.0, SUN, np.pi / 2, 1.7, 2.5)
        for view, azimuth in (
            (0.0, 0.0),
            (np.pi / 2, 0.3),
            (sun, 0.0),
            (np.pi - sun, np.pi),
            (1.8, 0.2),
            (np.pi, 0.0),
        )
    ]
)


def test_the_table_has_formulas():
    assert len(FORMULAS) >= 4


@pytest.mark.slow
@EACH
def test_light_is_never_negative_nor_nan_by_day_and_night(name):
    sun = np.radians([0.0, 30.0, 60.0, 85.0, 89.9, 90.1, 93.0, 110.0, 180.0])[:, None, None]
    view = np.radians([0.0, 20.0, 60.0, 85.0, 89.9, 90.1, 120.0, 180.0])[:, None]
    xyY = np.asarray(FORMULAS[name].xyY(sun, view, np.linspace(0, np.pi, 7)))
    assert np.isfinite(xyY).all()
    assert xyY[..., 2].min() >= 0


@pytest.mark.slow
@EACH
def test_nothing_jumps_at_sunset_or_at_the_horizon(name):
    step = 1e-7
    views = np.array([0.0, 0.5, 1.2, 1.6])
    sky = FORMULAS[name]

    def light(sun, view):
        return np.asarray(sky.xyY(sun, view, 0.4))

    # Twilight falls by 53 per radian: 1e-5 over the step. A sky that is black at sunset may fall
    # by what is nothing beside its day.
    nothing = 1e-6 * light(0.5, np.array(0.5))[2]
    before, after = light(np.pi / 2 - step, views), light(np.pi / 2 + step, views)
    np.testing.assert_allclose(after, before, rtol=1e-4, atol=nothing)
    for sun in (0.3, 1.5, 1.6):
        above, below = light(sun, np.pi / 2 - step), light(sun, np.pi / 2 + step)
        np.testing.assert_allclose(below, above, rtol=1e-4, atol=nothing)


@pytest.mark.slow
@pytest.mark.float64
@EACH
def test_light_fades_at_night(name):
    sky = FORMULAS[name]
    depressions = np.radians([90.0, 92.5, 95.0, 100.0])
    zenith = np.asarray(sky.xyY(depressions, 0.0, 0.0))
    assert (np.diff(zenith[:, 2]) < 0).all()
    assert zenith[-1, 2] < 1e-3 * zenith[0, 2]


@pytest.mark.slow
@EACH
def test_every_gradient_is_finite(name):
    sky = FORMULAS[name]

    def colour(angles):
        return sky.xyY(angles[0], angles[1], angles[2]).sum()

    found = jax.jit(jax.vmap(jax.grad(colour)))(jnp.asarray(EDGES))
    assert EDGES[~np.isfinite(found).all(axis=1)].tolist() == []

    def tristimulus(vectors):
        return sky.xyz(vectors[0], vectors[1]).sum()

    suns = unit_vector(jnp.asarray(EDGES[:, 0]), jnp.zeros(len(EDGES)))
    views = unit_vector(jnp.asarray(EDGES[:, 1]), jnp.asarray(EDGES[:, 2]))
    # Exactly at the sun and opposite it, which sines and cosines need not be.
    views = views.at[2::6].set(suns[2::6]).at[3::6].set(-suns[3::6])
    pairs = jnp.stack([views, suns], axis=1)
    found = jax.jit(jax.vmap(jax.grad(tristimulus)))(pairs)
    assert EDGES[~np.isfinite(found).all(axis=(1, 2))].tolist() == []
