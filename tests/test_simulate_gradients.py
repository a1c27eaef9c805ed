"""Gradients of a sky by everything continuous in it, and by where one looks."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit import Atmosphere, Constituent, phase, profile


def total(parameters, sun, view, azimuth, altitude=0.0):
    """Light of a small atmosphere as a function of everything continuous in it."""
    air = Constituent(
        profile.Exponential(parameters["scale_height"]),
        parameters["scattering"] * jnp.asarray([2e-5, 1e-5]),
        phase=phase.Rayleigh(),
    )
    particles = Constituent(
        profile.Tabulated([0.0, 1e3, 4e3, 2e4], parameters["density"]),
        1e-4,
        parameters["absorption"],
        phase=phase.HenyeyGreenstein(parameters["g"]),
    )
    atm = Atmosphere([450.0, 600.0], 1.0, (air, particles), parameters["albedo"])
    sky = skyfit.simulate(atm, sun, view, azimuth, quality="draft", observer_altitude=altitude)
    return sky.radiance.sum()


PARAMETERS = {
    "scale_height": jnp.asarray(8e3),
    "scattering": jnp.asarray(1.0),
    "density": jnp.asarray([1.0, 0.4, 0.1, 0.0]),
    "absorption": jnp.asarray(2e-5),
    "g": jnp.asarray(0.7),
    "albedo": jnp.asarray(0.3),
}
GRADIENT = eqx.filter_jit(jax.value_and_grad(total, argnums=(0, 1, 2, 3, 4)))
VALUE = eqx.filter_jit(total)  # runs in a fraction of the time, which some thirty differences pay


@pytest.mark.slow
def test_gradients_are_those_of_central_differences():
    at = (PARAMETERS, *(jnp.asarray(x) for x in (0.9, 1.1, 0.7, 500.0)))
    light, slopes = GRADIENT(*at)
    np.testing.assert_allclose(VALUE(*at), light, rtol=1e-12)
    leaves, shape = jax.tree.flatten(at)
    steps = iter(jax.tree.leaves(slopes))
    for number, leaf in enumerate(leaves):
        slope = next(steps)
        for index in np.ndindex(leaf.shape):
            # A density of 0 may not step below 0.
            if float(leaf[index]) == 0:
                continue
            step = 1e-4 * float(jnp.abs(leaf[index]))

            def value(sign, number=number, index=index, step=step):
                moved = [a.at[index].add(sign * step) if k == number else a
                         for k, a in enumerate(leaves)]  # fmt: skip
                return float(VALUE(*jax.tree.unflatten(shape, moved)))

            difference = (value(1) - value(-1)) / (2 * step)
            # Steps of 1e-4 leave 1e-8 of curvature and 1e-12 / 1e-4 of rounding.
            np.testing.assert_allclose(slope[index], difference, rtol=1e-5)


# sun, view, azimuth [deg]: zenith, horizon, sun in view, opposite it, sun at the horizon, night
EDGES = [(50, 0, 0), (50, 90, 30), (50, 50, 0), (50, 50, 180), (0, 0, 0), (90, 90, 0), (90, 0, 0)]
EDGES += [(96, 30, 0), (120, 45, 90), (180, 10, 0)]


@pytest.mark.slow
@pytest.mark.parametrize("degrees", EDGES, ids=str)
def test_gradients_are_finite_where_they_could_break(degrees):
    at = (PARAMETERS, *(jnp.radians(float(x)) for x in degrees), jnp.asarray(0.0))
    value, slopes = GRADIENT(*at)
    assert np.isfinite(value)
    assert all(np.all(np.isfinite(s)) for s in jax.tree.leaves(slopes))
