"""Land under a sky, seen through the air before it."""

from typing import Protocol, runtime_checkable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._progress import Progress
from .._typing import Scalar
from ..aerial import AerialPerspective
from ..angles import as_azimuth, as_zenith
from ..colour import srgb_matrix
from ..constants import SUN_SOLID_ANGLE
from ..errors import InputError
from .cameras import Perspective, direction_of
from .elevation import Elevation
from .horizon_scan import Scan, meet, scan
from .land_light import harmonics9, sky_view, slope_irradiance, sun_share
from .light_check import refuse_black_day
from .picture import Picture, ground_xyz, horizontal_irradiance
from .shafts import Shadow, cast_shadow, lost_light
from .sources import AbstractSource
from .sun_disc import disc_cover


_GOLDEN = 0.618034  # multiples of it, less their whole part, are evenly spread


@runtime_checkable
class Air(Protocol):
    """What `skyfit.aerial` makes, with channels "rgb"."""

    def split(
        self, distance, view_zenith, relative_azimuth, observer_altitude
    ) -> tuple[Array, Array]:
        """Transmittance, and light scattered in [cd m⁻²]."""
        ...


class _Lit(eqx.Module):
    """Land with its light, in linear sRGB."""

    elevation: Elevation
    table: Float[Array, "row column 4"]  # slopes east and north, sun's share, sky's share
    sky: Float[Array, "9 3"]
    sun: Float[Array, " 3"]
    toward_sun: Float[Array, " 3"]
    albedo: Scalar


def check_samples(samples: int) -> int:
    """Samples along one side of a pixel.

    Raises:
        InputError: The number of samples is no square, or beyond a thousand.
    """
    side = round(max(samples, 0) ** 0.5)
    if not 1 <= samples <= 1024 or side**2 != samples:
        raise InputError(
            f"render_terrain(samples=...): expected 1, 4, 9, 16, ..., 1024; got {samples}"
        )
    return side


def render_terrain(
    source: AbstractSource,
    elevation: Elevation,
    camera: Perspective,
    eye: tuple[float, float],
    sun_zenith: float,
    sun_azimuth: float,
    air: Air | None,
    *,
    ground_albedo: float = 0.2,
    samples: int = 16,
    sun_disc: bool = True,
    shafts: bool = False,
    progress: Progress | None = None,
) -> Picture:
    """Make a picture of a landscape.

    Land of one albedo, Lambertian, lit by the sun where no hill stands before it and by sky and
    land around according to its slope.

    Args:
        source: The sky.
        elevation: The land.
        camera: Camera, whose `altitude` counts from the land below it.
        eye: Place of the eye, east and north of the south-western corner [m].
        sun_zenith: Zenith angle of the sun [rad].
        sun_azimuth: Compass azimuth [rad].
        air: Aerial perspective between eye and land, of channels "rgb"; None for clear vacuum.
        ground_albedo: Albedo of the land, Lambertian.
        samples: Number of samples in each pixel, a square.
        sun_disc: Sunlight, and the disc itself where it is in view.
        shafts: Whether land shades the air as well. Such air scatters skylight only; the sky behind
            it is dimmed by the share of the air's light that is lost. `air` is then a
            `skyfit.aerial.AerialPerspective`.
        progress: Called as `progress("samples", done, total)`.

    Returns:
        The picture, in absolute luminance.

    Raises:
        InputError: An albedo or a number of samples that cannot be; shafts without such an air;
            light that is not finite, or negative by more than rounding; a black sky by day.
    """
    side = check_samples(samples)
    if not 0 <= ground_albedo <= 1:
        raise InputError(
            f"render_terrain(ground_albedo=...): expected 0 to 1; got {ground_albedo:.6g}"
        )
    if shafts and not isinstance(air, AerialPerspective):
        got = type(air).__name__
        raise InputError(f"render_terrain(shafts=...): expected an AerialPerspective; got {got}")
    shadow = None
    as_zenith(sun_zenith, "render_terrain(sun_zenith=...)")
    as_azimuth(sun_azimuth, "render_terrain(sun_azimuth=...)")
    if shafts and sun_disc and sun_zenith < np.pi / 2:
        shadow = cast_shadow(elevation, sun_zenith, sun_azimuth)
    if isinstance(air, eqx.Module):
        air = jax.tree.map(lambda a: a.astype(jnp.float32), air)
    sun = source.sun_xyz(sun_zenith) if sun_disc else None
    lit = _light(source, elevation, sun_zenith, sun_azimuth, sun, ground_albedo)
    east, north = (jnp.float32(place) for place in eye)
    height = elevation.at(east, north) + jnp.float32(camera.altitude)
    rows, columns = camera.shape
    planes = _planes(camera, side)
    seen = scan(elevation, east, north, height, jnp.asarray(planes))
    total = np.zeros((rows * columns, 3), np.float32)
    open_sky = np.zeros(rows * columns, np.float32)
    column, row = np.meshgrid(np.arange(columns), np.arange(rows))
    offsets = (np.arange(side) + 0.5) / side
    for number, (down, right) in enumerate((d, r) for d in offsets for r in offsets):
        direction = camera.look(column + right, row + down).direction
        direction = direction.reshape(-1, 3).astype(np.float32)
        place = _plane_of(direction, planes)
        light, sky = _shade(
            lit, seen, air, shadow, (east, north, height), jnp.asarray(direction),
            jnp.asarray(place), jnp.float32(sun_azimuth), jnp.float32((0.5 + number * _GOLDEN) % 1),
        )  # fmt: skip
        light, sky = np.array(light), np.asarray(sky)
        if sky.any():
            xyz = source.xyz(direction[sky], sun_zenith, sun_azimuth)
            with np.errstate(invalid="ignore"):  # infinite light is refused below
                light[sky] *= (np.asarray(xyz) @ srgb_matrix().T).astype(np.float32)
        total += light
        open_sky += sky
        if progress is not None:
            progress("samples", number + 1, samples)
    rgb = (total / samples).reshape(rows, columns, 3)
    solid_angle = np.array(camera.rays().solid_angle)
    if sun is not None and sun[1] > 0:
        y, x, share = disc_cover(camera, direction_of(sun_zenith, sun_azimuth))
        clear = open_sky.reshape(rows, columns)[y, x] / samples
        rgb[y, x] += ((share * clear)[:, None] * (srgb_matrix() @ sun)).astype(np.float32)
        solid_angle[y, x] = 0.0
    angle = f"sun zenith {np.degrees(sun_zenith):.4g} deg"
    text = f"{source.name}; land of albedo {ground_albedo:g}; {angle}"
    picture = Picture(rgb, np.ones((rows, columns), bool), solid_angle, camera, text)
    sky = open_sky.reshape(rows, columns) == samples
    refuse_black_day(source, sun_zenith, rgb, sky & (solid_angle > 0))
    return picture


def _light(source, elevation, sun_zenith, sun_azimuth, sun, albedo) -> _Lit:
    """Everything about the light that does not depend on the eye."""
    around = ground_xyz(source, sun_zenith, sun_azimuth, albedo, sun)
    by_slope = slope_irradiance(source, sun_zenith, sun_azimuth, around)
    # Scaled so that level land has exactly the sky's irradiance.
    level = by_slope.T @ np.asarray(harmonics9(jnp.asarray([0.0, 0.0, 1.0])))
    wanted = horizontal_irradiance(source, sun_zenith, sun_azimuth)
    by_slope = by_slope * (wanted / np.where(level == 0, 1.0, level))
    direct = np.zeros(3) if sun is None else sun * SUN_SOLID_ANGLE
    shares = jnp.stack([sun_share(elevation, sun_zenith, sun_azimuth), sky_view(elevation)], -1)
    table = jnp.concatenate([elevation.slopes(), shares], axis=-1)
    to_rgb = srgb_matrix().T
    return _Lit(
        elevation, table, jnp.asarray(by_slope @ to_rgb, jnp.float32),
        jnp.asarray(direct @ to_rgb, jnp.float32),
        jnp.asarray(direction_of(sun_zenith, sun_azimuth), jnp.float32), jnp.float32(albedo),
    )  # fmt: skip


def _planes(camera: Perspective, side: int) -> np.ndarray:
    """Azimuths of vertical planes, one for each column of samples in the picture's widest row."""
    rows, columns = camera.shape
    edge = np.concatenate(
        [camera.look(np.array([0.0, columns]), np.array([y, y])).direction for y in (0.0, rows)]
    )
    turn = np.arctan2(edge[:, 0], edge[:, 1]) - camera.azimuth
    widest = float(np.abs((turn + np.pi) % (2 * np.pi) - np.pi).max())
    straight_up = abs(camera.elevation) + camera.field_of_view / 2 > np.pi / 2
    widest = np.pi if straight_up else widest
    count = int(np.ceil(2 * widest / (camera.field_of_view / (columns * side))))
    count = min(count, 16384)
    return (camera.azimuth + np.linspace(-widest, widest, count)).astype(np.float32)


def _plane_of(direction: np.ndarray, planes: np.ndarray) -> np.ndarray:
    """Place of each ray among the planes."""
    middle = 0.5 * (planes[0] + planes[-1])
    turn = np.arctan2(direction[:, 0], direction[:, 1]) - middle
    turn = (turn + np.pi) % (2 * np.pi) - np.pi
    step = planes[1] - planes[0]
    return ((turn + middle - planes[0]) / step).astype(np.float32)


@eqx.filter_jit
def _shade(lit: _Lit, seen: Scan, air, shadow: Shadow | None, eye, direction, plane, sun_azimuth,
           offset):  # fmt: skip
    """Light along rays that meet land; of the sky's, the share that is left; which see the sky."""
    east, north, height = eye

    def some(rays):
        direction, plane = rays
        run = jnp.sqrt(jnp.maximum(direction[:, 0] ** 2 + direction[:, 1] ** 2, 1e-12))
        ground = meet(seen, plane, direction[:, 2] / run)
        sky = ~jnp.isfinite(ground)
        ground = jnp.where(sky, 1.0, ground)
        x = east + ground * direction[:, 0] / run
        y = north + ground * direction[:, 1] / run
        light = _land(lit, x, y)
        left = jnp.ones_like(light)
        if air is not None:
            azimuth = jnp.arctan2(direction[:, 0], direction[:, 1]) - sun_azimuth
            zenith = jnp.arctan2(run, direction[:, 2])
            distance = jnp.where(sky, jnp.inf, ground / run)
            through, glow = air.split(distance, zenith, azimuth, jnp.full_like(run, height))
            light = light * through + glow
            if shadow is not None:
                meets = jnp.where(sky, jnp.inf, ground)
                lost = lost_light(air, shadow, eye, direction, meets, sun_azimuth, offset)
                light, left = light - lost, 1 - lost / jnp.maximum(glow, 1e-9)
        return jnp.where(sky[:, None], left, light), sky

    return _chunks(some, (direction, plane))


def _chunks(function, rays, size=32768):
    """A function of many rays, some at a time, so that what it needs stays in the cache."""
    count = rays[0].shape[0]
    blocks = -(-count // size)
    padded = [jnp.pad(a, ((0, blocks * size - count), *((0, 0),) * (a.ndim - 1))) for a in rays]
    split = [a.reshape(blocks, size, *a.shape[1:]) for a in padded]
    light, sky = jax.lax.map(function, tuple(split))
    return light.reshape(-1, 3)[:count], sky.reshape(-1)[:count]


def _land(lit: _Lit, east, north):
    """Linear sRGB [cd m⁻²] of the land at places."""
    values = lit.elevation.read(lit.table, east, north)
    sign_east, sign_north = lit.elevation.signs(east, north)
    slope_east = values[:, 0] * sign_east.astype(jnp.float32)
    slope_north = values[:, 1] * sign_north.astype(jnp.float32)
    length = jnp.sqrt(1 + slope_east**2 + slope_north**2)
    normal = jnp.stack([-slope_east, -slope_north, jnp.ones_like(length)], -1) / length[:, None]
    facing = jnp.maximum(normal @ lit.toward_sun, 0.0) * jnp.clip(values[:, 2], 0.0, 1.0)
    skylight = jnp.maximum(harmonics9(normal) @ lit.sky, 0.0) * values[:, 3][:, None]
    falling = facing[:, None] * lit.sun[None] + skylight
    return lit.albedo / jnp.pi * falling
