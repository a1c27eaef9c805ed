"""Air and haze whose density falls exponentially with height, as seen along straight rays.

The ground is flat here, as in Preetham et al. (1999), section 4: good for eyes and objects in the
lowest kilometres and some hundred kilometres apart.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import Scalar, as_parameter
from ..atmosphere import Atmosphere
from ..profile import Exponential


# Haze and molecules fall by e over these heights: 0.8333 and 0.1136 per km, appendix A.4.
PAPER_SCALE_HEIGHTS = (1e3 / 0.1136, 1e3 / 0.8333)  # m: molecules, haze
LOWEST = -500.0  # m; the lowest dry land lies 430 m below the sea. Rays end here.
_SEEN_THROUGH = 20.0  # optical depth past which nothing is looked for
_THINNED_OUT = 30.0  # scale heights past which there is nothing
_MATCHED_TO = 10e3  # m


class Layers(eqx.Module):
    """Constituents with exponential densities.

    Attributes:
        scale_height: Scale height of each layer [m].
        extinction: Coefficient at altitude 0 [m⁻¹]; a channel is a wavelength or a primary, or a
            wavelength as one class of lines sees it.
    """

    scale_height: Float[Array, " species"]
    extinction: Float[Array, "species channel"]


class Stretch(eqx.Module):
    """The part of a ray that matters: from an eye at some height up to its end.

    Attributes:
        length: Length from the eye to the object, or to where nothing more is seen [m].
        cosine: Cosine of the ray's zenith angle.
        density: Relative density of each constituent at the eye.
    """

    length: Float[Array, "*batch"]
    cosine: Float[Array, "*batch"]
    density: Float[Array, "species *batch"]


def exponential_layers(atmosphere: Atmosphere) -> Layers:
    """Layers as an atmosphere has them near the ground.

    An exponential profile is taken as it is. Any other is replaced by the exponential of the same
    density at the ground and the same column up to 10 km; one that is empty at the ground, such as
    an ozone layer, has no part in aerial perspective.

    Args:
        atmosphere: Atmosphere without bands; see `skyfit.transfer.line_classes.side_by_side`.
    """
    pairs = [_as_exponential(one.density) for one in atmosphere.constituents]
    ground = jnp.stack([density for density, _ in pairs])
    height = jnp.stack([scale for _, scale in pairs])
    return Layers(height, ground[:, None] * atmosphere.extinction)


def _as_exponential(profile) -> tuple[Scalar, Scalar]:
    """Density at the ground, and scale height [m]."""
    if isinstance(profile, Exponential):
        return jnp.ones_like(profile.scale_height), profile.scale_height
    ground = profile(as_parameter(0.0))
    filled = ground > 0
    column = profile.column(_MATCHED_TO) / jnp.where(filled, ground, 1.0)
    share = jnp.clip(column / _MATCHED_TO, 0.01, 0.95)

    def newton(height, _):
        # H (1 - e^{-1/H}) = share, lengths in units of the matched height.
        fade = jnp.exp(-1 / height)
        wrong = height * (1 - fade) - share
        return height - wrong / (1 - fade - fade / height), None

    height, _ = jax.lax.scan(newton, share, length=12)
    return ground, jnp.where(filled, height, 1.0) * _MATCHED_TO


def stretch(
    layers: Layers,
    distance: Float[Array, "*#batch"],
    cosine: Float[Array, "*#batch"],
    height: Float[Array, "*#batch"],
) -> Stretch:
    """Cut a ray where all beyond is out of sight, thinned out, or below the lowest land.

    Args:
        layers: Layers that the ray crosses.
        distance: Distance to the object, 0 or more, or infinite [m].
        cosine: Cosine of the zenith angle of the ray from the eye.
        height: Altitude of the eye [m].
    """
    distance, cosine, height = jnp.broadcast_arrays(distance, cosine, height)
    height = jnp.maximum(height, LOWEST)
    scale = layers.scale_height.reshape(-1, *(1,) * cosine.ndim)
    density = jnp.exp(-height[None] / scale)
    faintest = jnp.min(layers.extinction, axis=1).reshape(scale.shape)
    per_metre = jnp.maximum(faintest * density, 1e-12)
    # Where one constituent alone has grown opaque: τ = β u₀ H (1 - e^{-x cosθ/H}) / cosθ.
    share = _SEEN_THROUGH * cosine[None] / (per_metre * scale)
    never, level = share > 1 - 1e-6, jnp.abs(share) < 1e-3
    ratio = -jnp.log1p(-jnp.where(never, 0.0, share)) / jnp.where(level, 1.0, share)
    opaque = _SEEN_THROUGH / per_metre * jnp.where(level, 1 + share / 2, ratio)
    opaque = jnp.where(never, jnp.inf, opaque)
    thin = _THINNED_OUT * jnp.max(layers.scale_height) / jnp.maximum(cosine, 1e-9)
    end = jax.lax.stop_gradient(jnp.minimum(jnp.min(opaque, axis=0), thin))
    falls = cosine < 0
    ground = (height - LOWEST) / jnp.where(falls, jnp.maximum(-cosine, 1e-9), 1.0)
    ground = jnp.where(falls, ground, jnp.inf)
    length = jnp.minimum(jnp.minimum(jnp.maximum(distance, 0.0), end), ground)
    return Stretch(length, cosine, density)


def lengths(
    layers: Layers, ray: Stretch, distance: Float[Array, "*batch"]
) -> tuple[Float[Array, "species *batch"], Float[Array, "species *batch"]]:
    """Densities at a distance along a ray, and columns up to there.

    Returns:
        Relative density u. Column of it, u₀ x (1 - e^{-z}) / z with z = x cosθ / H [m].
    """
    scale = layers.scale_height.reshape(-1, *(1,) * distance.ndim)
    climb = (distance * ray.cosine)[None] / scale
    fade = jnp.exp(-climb)
    return ray.density * fade, ray.density * distance[None] * mean_fade(climb, fade)


# Taylor coefficients of (1 - e^{-z}) / z
_SERIES = tuple(float((-1) ** n / np.prod(np.arange(1.0, n + 2))) for n in range(9))


def mean_fade(climb: Float[Array, "*batch"], fade: Float[Array, "*batch"]) -> Float[Array, "*b"]:
    """(1 - e^{-z}) / z from z and e^{-z}, smooth through 0."""
    small = jnp.abs(climb) < 0.1
    series = jnp.full_like(climb, _SERIES[-1])
    for coefficient in reversed(_SERIES[:-1]):
        series = series * jnp.where(small, climb, 0.0) + coefficient
    return jnp.where(small, series, (1 - fade) / jnp.where(small, 1.0, climb))


def transmittance(layers: Layers, ray: Stretch) -> Float[Array, "*batch channel"]:
    """Share of the light that comes through from the far end of a stretch."""
    _, column = lengths(layers, ray, ray.length)
    return jnp.exp(-jnp.tensordot(jnp.moveaxis(column, 0, -1), layers.extinction, axes=1))
