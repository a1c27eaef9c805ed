"""The sun's disc in a picture: which share of each pixel it fills, and how bright it is."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import Scalar
from ..atmosphere import Atmosphere
from ..constants import SUN_SOLID_ANGLE
from ..transfer.geometry import Ray, Spherical, SunDirection
from ..transfer.line_classes import side_by_side
from ..transfer.medium import make_medium
from ..transfer.paths import column_along, legs
from .cameras import AbstractCamera


_POINTS = 20_000


def disc_cover(
    camera: AbstractCamera, sun: Float[np.ndarray, " 3"], horizon: float = 0.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which share of each pixel the sun's disc fills.

    Points spread evenly over the disc are dropped into the picture, so that pixels of any size
    receive its light to the last ray: shares times solid angles add up to the disc's.

    Args:
        camera: The picture.
        sun: Unit vector towards the middle of the disc.
        horizon: Height above the horizontal plane below which the disc is hidden, the sine of the
            horizon's elevation.

    Returns:
        Rows, columns and shares of the pixels that the disc touches. A share is the disc's solid
        angle in the pixel over the pixel's.
    """
    points = _disc_points(sun)
    points = points[points[:, 2] >= horizon]
    column, row = camera.place(points)
    rows, columns = camera.shape
    seen = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    place = np.stack([row[seen].astype(int), column[seen].astype(int)], axis=1)
    pixels, counts = np.unique(place, axis=0, return_counts=True)
    y, x = pixels.T
    solid_angle = camera.rays().solid_angle[y, x]
    return y, x, counts * (SUN_SOLID_ANGLE / _POINTS) / solid_angle


def _disc_points(sun: np.ndarray) -> np.ndarray:
    """Unit vectors on a sunflower's spiral: each stands for the same solid angle."""
    number = np.arange(_POINTS) + 0.5
    cosine = 1 - number / _POINTS * (SUN_SOLID_ANGLE / (2 * np.pi))
    sine, turn = np.sqrt(1 - cosine**2), number * np.pi * (3 - math.sqrt(5))
    side = np.cross(sun, [0.0, 1.0, 0.0] if abs(sun[1]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(sun, side)
    around = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * other
    return cosine[:, None] * sun + sine[:, None] * around


@eqx.filter_jit
def disc_radiance(
    atmosphere: Atmosphere, sun_zenith: Scalar, altitude: Scalar
) -> Float[Array, " wavelength"]:
    """Mean radiance of the sun's disc seen through a spherical atmosphere [W m⁻² sr⁻¹ nm⁻¹].

    Solar irradiance over the disc's solid angle, times the transmittance towards its middle; 0
    where the planet hides that.

    Args:
        atmosphere: Air that the light crosses.
        sun_zenith: Zenith angle of the sun [rad].
        altitude: Altitude of the eye [m].
    """
    planet = Spherical(atmosphere.planet_radius, atmosphere.top_altitude)
    plain, classes = side_by_side(atmosphere)
    medium = make_medium(plain, planet)
    ray = Ray(altitude, jnp.cos(sun_zenith), jnp.sin(sun_zenith))
    start, _, meets = planet.enter(ray, SunDirection.from_angles(sun_zenith, 1 + 0 * sun_zenith))
    none = jnp.zeros_like(altitude)
    falling, rising, strikes = legs(planet, start.altitude, start.mu, none + jnp.inf)
    column = column_along(medium, falling, none, falling.length)
    column = column + column_along(medium, rising, none, rising.length)
    seen = jnp.where(meets, classes.mean(jnp.exp(-column @ plain.extinction)), 1.0)
    dark = meets & strikes
    return jnp.where(dark, 0.0, seen) * atmosphere.solar_irradiance / SUN_SOLID_ANGLE


def hidden_sine(atmosphere: Atmosphere, altitude: float) -> float:
    """Sine of the elevation of a planet's horizon from an altitude [m]; 0 or negative."""
    radius = float(atmosphere.planet_radius)
    return -math.sqrt(max(0.0, 1 - (radius / (radius + altitude)) ** 2))


def float_of(value: float) -> Scalar:
    """A number as JAX's default float."""
    return jax.numpy.asarray(value, jnp.result_type(float))
