"""I_i = ∫ u_i e^{-τ} dx along a ray: how much of each constituent's glow reaches the eye.

Preetham et al. (1999), equation 8: the light scattered in is Σ_i S_i⁰ I_i.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..transfer.quadrature import gauss
from .layers import Layers, Stretch, lengths


NODES = 16
_NEAR = 8.0  # the variable turns from linear to logarithmic at so many of the shortest lengths


def by_quadrature(
    layers: Layers, ray: Stretch, nodes: int = NODES
) -> Float[Array, "species *batch channel"]:
    """The integrals by Gauss's rule in y = log(1 + x/l); [m].

    Densities and transmittances fall over anything between a few hundred metres and a few hundred
    kilometres. In log x each of these falls takes about the same width, so that 16 nodes serve all
    rays: within 3e-4 of the light scattered in, from any height up to 12 km, in any direction.

    Args:
        layers: Layers that the ray crosses.
        ray: Stretch of the ray.
        nodes: Number of the rule's nodes.
    """
    first_density = ray.density
    strongest = jnp.max(layers.extinction, axis=1)
    fastest = jnp.abs(ray.cosine) / jnp.min(layers.scale_height)
    fastest = fastest + jnp.tensordot(strongest, first_density, axes=1)
    near = _NEAR / jnp.maximum(fastest, 1e-9)
    width = jnp.log1p(ray.length / near)
    places, weights = gauss(nodes)
    dtype = ray.length.dtype

    species, channels = layers.extinction.shape
    x_rank = ray.length.ndim

    def add(total, node):
        x, weight = node
        beyond = near * jnp.exp(x * width)
        density, column = lengths(layers, ray, beyond - near)
        # Channels before rays, so that long axes are last and loops over them vectorise.
        spread = layers.extinction.reshape(species, channels, *(1,) * x_rank)
        depth = sum(spread[i] * column[i][None] for i in range(species))
        seen = jnp.exp(-depth) * (weight * width * beyond)[None]
        return total + density[:, None] * seen[None], None

    start = jnp.zeros((species, channels, *ray.length.shape), dtype)
    steps = jnp.asarray(places, dtype), jnp.asarray(weights, dtype)
    total, _ = jax.lax.scan(add, start, steps)
    return jnp.moveaxis(total, 1, -1)
