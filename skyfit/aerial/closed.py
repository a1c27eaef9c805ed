"""The closed forms of Preetham et al. (1999) for aerial perspective, misprints mended.

They are kept for comparison: `skyfit.aerial.integrals` is far more accurate and about as fast.
Mended are the sign of K (section 4.1) and the prefactor of equation 10, which is H₁ = e^{-α₁h₀}.
"""

from typing import Literal

import jax.numpy as jnp
from jaxtyping import Array, Float

from .layers import Layers, Stretch, lengths, mean_fade


Slopes = Literal["by v", "by x"]

NEARLY_LEVEL = 0.3  # climb in scale heights below which equation 10 is used


def near_level(layers: Layers, ray: Stretch) -> Float[Array, "species *batch channel"]:
    """Equation 10: transmittance as if densities stayed what they are at the eye; [m].

    H₁ (1 - e^{-r s}) / r with r = α₁ cosθ + Σ_j β_j H_j.
    """
    per_metre = _outer(ray.density, layers.extinction)
    parts = []
    for number in range(layers.scale_height.shape[0]):
        rate = (ray.cosine / layers.scale_height[number])[..., None] + per_metre
        power = rate * ray.length[..., None]
        mean = mean_fade(power, jnp.exp(-power))
        parts.append((ray.density[number] * ray.length)[..., None] * mean)
    return jnp.stack(parts)


def by_hermite(
    layers: Layers, ray: Stretch, slopes: Slopes = "by x"
) -> Float[Array, "species *batch channel"]:
    """Equation 11: the other constituents' transmittance f replaced by a cubic in v = u_i; [m].

    With t running from 0 at the far end to 1 at the eye, I_i = c_i ∫ e^{-κ(1-t)} g(t) dt, where c_i
    is the column of constituent i and κ = β_i c_i: the paper's antiderivative with its four powers
    of 1/K in a form that does not cancel.

    Args:
        layers: Layers that the ray crosses.
        ray: Stretch of the ray.
        slopes: Slopes at the cubic's ends. "by v", with respect to the variable it is a cubic in,
            is right but unbounded where constituent i thins out; "by x", as appendix A.4 can be
            read, is wrong but bounded.
    """
    start = ray.density
    end, column = lengths(layers, ray, ray.length)
    parts = []
    for number in range(layers.scale_height.shape[0]):
        others = layers.extinction.at[number].set(0.0)
        far_value = jnp.exp(-_outer(column, others))
        if slopes == "by v":
            per_t_far = column[number] / end[number]
            per_t_near = column[number] / start[number]
        else:
            per_t_far = per_t_near = end[number] - start[number]
        far_slope = far_value * _outer(end, others) * per_t_far[..., None]
        near_slope = _outer(start, others) * per_t_near[..., None]
        depth = _outer(column[number][None], layers.extinction[number][None])
        parts.append(
            column[number][..., None] * _cubic_moment(depth, far_value, far_slope, near_slope)
        )
    return jnp.stack(parts)


def as_published(layers: Layers, ray: Stretch) -> Float[Array, "species *batch channel"]:
    """Equation 10 for nearly level or short rays, the Hermite form for the rest; [m]."""
    climb = jnp.abs(ray.length * ray.cosine)[None] / layers.scale_height.reshape(
        -1, *(1,) * ray.length.ndim
    )
    level = (climb < NEARLY_LEVEL)[..., None]
    return jnp.where(level, near_level(layers, ray), by_hermite(layers, ray))


def _outer(amounts, coefficients):
    """Σ over species of an amount along each ray times a coefficient in each channel."""
    return jnp.tensordot(jnp.moveaxis(amounts, 0, -1), coefficients, axes=1)


def _cubic_moment(depth, far, far_slope, near_slope):
    """∫₀¹ e^{-κ(1-t)} g(t) dt of the Hermite cubic with g(0) = far, g(1) = 1 and two slopes."""
    m0, m1, m2, m3 = _moments(depth)
    return (
        far * (m0 - 3 * m2 + 2 * m3)
        + (3 * m2 - 2 * m3)
        + far_slope * (m1 - 2 * m2 + m3)
        + near_slope * (m3 - m2)
    )


def _moments(depth):
    """∫₀¹ t^k e^{-κ(1-t)} dt for k = 0 to 3."""
    small = depth < 2.0
    kappa = jnp.where(small, depth, 0.0)
    term = jnp.full_like(depth, 0.25)
    third = term
    for n in range(1, 22):
        term = -term * kappa / (n + 4)
        third = third + term
    second = (1 - kappa * third) / 3
    first = (1 - kappa * second) / 2
    series = (1 - kappa * first, first, second, third)
    large = jnp.where(small, 2.0, depth)
    rows = [(1 - jnp.exp(-large)) / large]
    for k in (1, 2, 3):
        rows.append((1 - k * rows[-1]) / large)
    return [jnp.where(small, a, b) for a, b in zip(series, rows, strict=True)]
