"""Tables of phase functions: log-linear between their angles, constant outside, over the sphere."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._typing import as_parameter


def _panels(angle: Float[Array, " angle"]) -> Float[Array, " edge"]:
    """Edges 0, the table's angles, π; a panel of no width where they coincide."""
    return jnp.concatenate([jnp.zeros_like(angle[:1]), angle, jnp.full_like(angle[:1], np.pi)])


def panel_nodes(
    angle: Float[Array, " angle"], nodes_per_panel: int
) -> tuple[Float[Array, " node"], Float[Array, " node"]]:
    """Gauss–Legendre nodes and weights in angle over [0, π] [rad], panel by panel."""
    edges = _panels(angle)
    x, w = np.polynomial.legendre.leggauss(nodes_per_panel)
    half = 0.5 * jnp.diff(edges)[:, None]
    middle = 0.5 * (edges[1:] + edges[:-1])[:, None]
    x, w = as_parameter(x)[None, :], as_parameter(w)[None, :]
    return (middle + half * x).ravel(), (half * w).ravel()


@jax.jit
def normalised(
    angle: Float[Array, " angle"], value: Float[Array, "angle #wavelength"]
) -> Float[Array, "angle #wavelength"]:
    """Logarithm of values [any unit, above 0] divided by their integral over the sphere."""
    log_p = jnp.log(value)
    return log_p - jnp.log(_sphere_integral(angle, log_p))[None, :]


def _sphere_integral(angle, log_p):
    """2π ∫ p sinΘ dΘ of the log-linear interpolation, exactly; [wavelength]."""
    edges = _panels(angle)
    log_edge = jnp.concatenate([log_p[:1], log_p, log_p[-1:]])
    width = jnp.diff(edges)[:, None]
    slope = jnp.diff(log_edge, axis=0) / jnp.where(width > 0, width, 1.0)

    def antiderivative(log_value, theta):
        # d/dΘ of e^{bΘ} (b sinΘ - cosΘ) / (1 + b²) is e^{bΘ} sinΘ.
        return jnp.exp(log_value) * (slope * jnp.sin(theta) - jnp.cos(theta)) / (1 + slope**2)

    low, high = edges[:-1, None], edges[1:, None]
    parts = antiderivative(log_edge[1:], high) - antiderivative(log_edge[:-1], low)
    return 2 * np.pi * jnp.sum(parts, axis=0)
