"""Shafts of light: the land's shadow in the air before an eye, and what light is lost by it."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import Scalar
from ..aerial import AerialPerspective
from ..aerial.layers import lengths, mean_fade, stretch
from ..constants import EARTH_RADIUS
from .elevation import Elevation
from .horizon_scan import FARTHEST, curvature_drop
from .land_light import shadow_distances, sun_edges


STEPS = 32  # along a ray; the samples of a pixel look at different places between them
_IMAGES = ((1, 1), (-1, 1), (1, -1), (-1, -1))  # of the land, mirrored east to west, north to south
_NO_SHADOW = -1e5  # m


class Shadow(eqx.Module):
    """How high the land's shadow reaches.

    Attributes:
        elevation: The land.
        top: Altitudes at the nodes, for the land and its three mirror images, below which
            nothing of the sun's disc is seen, and above which all of it is [m].
        highest: No shadow above this altitude [m].
    """

    elevation: Elevation
    top: Float[Array, "row column 8"]
    highest: Scalar

    def light(
        self, east: Float[Array, " ray"], north: Float[Array, " ray"], altitude: Float[Array, "ray"]
    ) -> Float[Array, " ray"]:
        """Part of the disc that is seen from points in the air, their places as of `Elevation`."""
        tops = self.elevation.read(self.top, east, north)
        sign_east, sign_north = self.elevation.signs(east, north)
        left, right = (jnp.where((sign_east < 0)[:, None], tops[:, k + 2 : k + 4],
                                 tops[:, k : k + 2]) for k in (0, 4))  # fmt: skip
        none, whole = jnp.where((sign_north < 0)[:, None], right, left).T
        return jnp.clip((altitude - none) / jnp.maximum(whole - none, 1e-3), 0.0, 1.0)


def cast_shadow(elevation: Elevation, sun_zenith: float, sun_azimuth: float) -> Shadow:
    """The land's shadow.

    Args:
        elevation: The land.
        sun_zenith: Zenith angle of the sun, above the horizon [rad].
        sun_azimuth: Compass azimuth [rad].
    """
    edges = jnp.asarray(sun_edges(sun_zenith), jnp.float32)
    distances = jnp.asarray(shadow_distances(elevation))
    images = [
        _tops(elevation, jnp.float32(e * np.sin(sun_azimuth)), jnp.float32(n * np.cos(sun_azimuth)),
              edges, distances)
        for e, n in _IMAGES
    ]  # fmt: skip
    top = jnp.concatenate(images, axis=-1)
    return Shadow(elevation, top, jnp.max(top))


@eqx.filter_jit
def _tops(elevation, sine, cosine, edges, distances) -> Float[Array, "row column 2"]:
    rows, columns = elevation.height.shape
    north = (jnp.arange(rows, dtype=jnp.float32) * elevation.north)[:, None]
    east = (jnp.arange(columns, dtype=jnp.float32) * elevation.east)[None, :]
    north, east = jnp.broadcast_arrays(north, east)

    def step(tops, distance):
        land = elevation.at(east + distance * sine, north + distance * cosine)
        crest = (land - curvature_drop(distance))[..., None] - distance * edges[None, None]
        return jnp.maximum(tops, crest), None

    start = jnp.full((rows, columns, 2), _NO_SHADOW, jnp.float32)
    return jax.lax.scan(step, start, distances)[0]


def lost_light(
    air: AerialPerspective,
    shadow: Shadow,
    eye: tuple[Scalar, Scalar, Scalar],
    direction: Float[Array, "ray 3"],
    ground: Float[Array, " ray"],
    sun_azimuth: Scalar,
    offset: Scalar,
    steps: int = STEPS,
) -> Float[Array, "ray 3"]:
    """Light that the air would send to the eye if no land stood before the sun [cd m⁻²].

    Σ (1 - v) S_i ∫ u_i e^{-τ} dx over steps along the ray, v being the part of the disc seen from
    a place in each step, and the integral over it exact but for the mixing of the constituents.

    Args:
        air: Aerial perspective with channels "rgb"; as wide as `direction`.
        shadow: Shadow that `cast_shadow` found.
        eye: East and north [m], and height above sea level [m].
        direction: Directions of the rays: unit vectors east, north, up.
        ground: Distance along the ground to what they meet; infinite for the sky [m].
        sun_azimuth: Compass azimuth of the sun [rad].
        offset: Place in each step at which the shadow is looked at, 0 to 1.
        steps: Number of steps, shorter near the eye.
    """
    layers = air.layers
    east, north, height = eye
    up = direction[:, 2]
    run = jnp.sqrt(jnp.maximum(1 - up**2, 1e-12))
    reach = jnp.minimum(jnp.minimum(ground, FARTHEST), _leaves(shadow.highest - height, up / run))
    ray = stretch(layers, reach / run, up, height)
    species, channels = layers.extinction.shape

    def add(carry, number):
        lost, column, depth = carry
        look, end = (ray.length * ((number + at) / steps) ** 2 for at in (offset, 1.0))
        far = look * run
        altitude = height + look * up + curvature_drop(far)
        seen = shadow.light(east + look * direction[:, 0], north + look * direction[:, 1], altitude)
        _, beyond = lengths(layers, ray, end)
        deep = jnp.tensordot(beyond, layers.extinction, axes=(0, 0))
        thick = deep - depth
        through = jnp.exp(-depth) * mean_fade(thick, jnp.exp(-thick))
        share = (1 - seen)[:, None, None] * (beyond - column).T[:, :, None] * through[:, None, :]
        return (lost + share, beyond, deep), None

    count = direction.shape[0]
    shapes = (count, species, channels), (species, count), (count, channels)
    start = tuple(jnp.zeros(shape, direction.dtype) for shape in shapes)
    (lost, _, _), _ = jax.lax.scan(add, start, jnp.arange(steps, dtype=jnp.float32))
    azimuth = jnp.arctan2(direction[:, 0], direction[:, 1]) - sun_azimuth
    glow = air.source.sunlight(jnp.arctan2(run, up), azimuth)
    return jnp.sum(glow * lost, axis=1)


def _leaves(room, rise):
    """Distance along the ground at which a ray has climbed by a height for good [m]; 0 if above."""
    # d² / 2R + d rise = room, the larger root.
    bend = 1 / (2 * EARTH_RADIUS)
    under = rise**2 + 4 * bend * room
    root = jnp.sqrt(jnp.maximum(under, 0.0))
    climbing = 2 * room / jnp.where(rise > 0, rise + root, 1.0)
    distance = jnp.where(rise > 0, climbing, (root - rise) / (2 * bend))
    return jnp.where(under > 0, jnp.maximum(distance, 0.0), 0.0)
