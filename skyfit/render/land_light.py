"""Light on land: shadows of the sun, and the sky's light on slopes."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .cameras import direction_of
from .elevation import Elevation
from .horizon_scan import curvature_drop
from .sources import AbstractSource


_SHADOW_STEPS = 400
_SHADOW_REACH = 40e3  # m
_SUN_WIDTH = 0.00465  # tangent of the disc's radius
_AROUND = 12  # azimuths of the horizon of a place


def shadow_distances(elevation: Elevation) -> np.ndarray:
    """Distances at which land may stand before the light of a place [m]."""
    step = min(float(elevation.east), float(elevation.north))
    return np.geomspace(0.7 * step, _SHADOW_REACH, _SHADOW_STEPS, dtype=np.float32)


def horizon_rise(elevation: Elevation, azimuth: float) -> Float[Array, "row column"]:
    """Rise over run of the horizon that every node sees in one direction of the compass."""
    distances = jnp.asarray(shadow_distances(elevation))
    return _horizon_rise(elevation, jnp.float32(azimuth), distances)


@eqx.filter_jit
def _horizon_rise(elevation, azimuth, distances):
    rows, columns = elevation.height.shape
    north = (jnp.arange(rows, dtype=jnp.float32) * elevation.north)[:, None]
    east = (jnp.arange(columns, dtype=jnp.float32) * elevation.east)[None, :]
    north, east = jnp.broadcast_arrays(north, east)

    def step(steepest, distance):
        land = elevation.at(east + distance * jnp.sin(azimuth), north + distance * jnp.cos(azimuth))
        rise = (land - curvature_drop(distance) - elevation.height) / distance
        return jnp.maximum(steepest, rise), None

    start = jnp.full(elevation.height.shape, -1e3, jnp.float32)
    steepest, _ = jax.lax.scan(step, start, distances)
    return steepest


def sun_share(
    elevation: Elevation, sun_zenith: float, sun_azimuth: float
) -> Float[Array, "row column"]:
    """How far the sun's lower edge stands above each node's horizon, in widths of the disc.

    Clipped to [0, 1] it is the part of the disc that is seen; kept as it is, it can be read between
    nodes first.
    """
    if sun_zenith >= np.pi / 2:
        return jnp.full(elevation.height.shape, -1e3, jnp.float32)
    upper, lower = sun_edges(sun_zenith)
    gap = jnp.float32(upper) - horizon_rise(elevation, sun_azimuth)
    return gap / jnp.float32(upper - lower)


def sun_edges(sun_zenith: float) -> tuple[float, float]:
    """Rise over run of the upper and the lower edge of the sun's disc."""
    rise = 1 / np.tan(max(sun_zenith, 1e-3))
    width = _SUN_WIDTH * (1 + rise**2)
    return rise + width, rise - width


def sky_view(elevation: Elevation) -> Float[Array, "row column"]:
    """Share of a level plane's skylight that is left to each node by the hills around it.

    Mean of cos²(horizon elevation) over azimuths, for a sky of even brightness.
    """
    total = jnp.zeros(elevation.height.shape, jnp.float32)
    for number in range(_AROUND):
        rise = jnp.maximum(horizon_rise(elevation, 2 * np.pi * number / _AROUND), 0.0)
        total = total + 1 / (1 + rise**2)
    return total / _AROUND


def slope_irradiance(
    source: AbstractSource,
    sun_zenith: float,
    sun_azimuth: float,
    ground: Float[np.ndarray, " 3"],
) -> Float[np.ndarray, "9 3"]:
    """What sky and ground send onto a surface of any orientation: nine numbers per channel, XYZ.

    The irradiance [lx for Y] is their product with `harmonics9` of the surface's normal: spherical
    harmonics to the second degree hold it within some percents.

    Source: Ramamoorthi & Hanrahan (2001), "An efficient representation for irradiance environment
    maps".

    Args:
        source: The sky.
        sun_zenith: Zenith angle of the sun [rad].
        sun_azimuth: Compass azimuth of the sun [rad].
        ground: XYZ of the land seen below the horizon.
    """
    x, w = np.polynomial.legendre.leggauss(32)
    zenith = np.arccos(x)
    azimuth = (np.arange(64) + 0.5) * (2 * np.pi / 64)
    vectors = direction_of(zenith[:, None], azimuth[None, :]).reshape(-1, 3)
    light = np.asarray(source.xyz(vectors.astype(np.float32), sun_zenith, sun_azimuth), float)
    light = np.where(vectors[:, 2:] > 0, light, ground)
    area = np.repeat(w, 64) * 2 * np.pi / 64
    basis = np.asarray(harmonics9(jnp.asarray(vectors)))
    moments = (basis * area[:, None]).T @ light
    fold = np.pi * np.array([1.0, *[2 / 3] * 3, *[1 / 4] * 5])  # cosine lobe, by degree
    return fold[:, None] * moments


def harmonics9(normal: Float[Array, "*b 3"]) -> Float[Array, "*b 9"]:
    """Real spherical harmonics of degrees 0 to 2."""
    x, y, z = normal[..., 0], normal[..., 1], normal[..., 2]
    one = jnp.ones_like(x)
    first, second = np.sqrt(3 / (4 * np.pi)), np.sqrt(15 / (4 * np.pi))
    return jnp.stack(
        [
            one * float(np.sqrt(1 / (4 * np.pi))),
            float(first) * y, float(first) * z, float(first) * x,
            float(second) * x * y, float(second) * y * z,
            float(np.sqrt(5 / (16 * np.pi))) * (3 * z**2 - 1),
            float(second) * x * z, float(second / 2) * (x**2 - y**2),
        ],
        axis=-1,
    )  # fmt: skip
