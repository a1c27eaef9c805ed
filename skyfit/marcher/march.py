"""March along rays: light scattered once into the eye, and the transmittance before an object."""

import math
from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..phase import CornetteShanks, Rayleigh
from .air import MarchedAir
from .ball import crossings, height, up_cosine
from .table import OpticalDepthTable
from .terrain import HeightField, in_shadow


VIEW_STEPS, LIGHT_STEPS = 16, 8
Terrain = HeightField | Callable[[Array, Array], Array]


def march(
    air: MarchedAir,
    eye: ArrayLike,
    direction: ArrayLike,
    sun_direction: ArrayLike,
    distance: ArrayLike = math.inf,
    *,
    view_steps: int = VIEW_STEPS,
    light_steps: int = LIGHT_STEPS,
    table: OpticalDepthTable | None = None,
    terrain: Terrain | None = None,
    shadow_reach: float = 40e3,
    shadow_steps: int = 48,
) -> tuple[Float[Array, "*batch 3"], Float[Array, "*batch 3"]]:
    """Light scattered once into each ray, and how much of what lies behind is seen through it.

    An object of colour c at the distance is seen as `c * transmittance + light`. Rays end at the
    ground, and where they leave the air. Each step adds its middle's light, dimmed by the air up to
    the step's far end: the tutorial's rule, which converges as steps get shorter.

    Args:
        air: Air that `scs_air` makes.
        eye: Place of the eye, z up, from an origin on the ground; in the air or in space too [m].
        direction: Direction of each ray, a unit vector.
        sun_direction: Direction to the sun, a unit vector, or one for each ray.
        distance: Distance to what each ray meets; infinite for sky or ground [m].
        view_steps: Number of steps along each ray.
        light_steps: Number of steps from each of them towards the sun; one in the ground shades.
        table: Optical lengths to use in place of the steps towards the sun.
        terrain: A `HeightField`, or any function from x and y to the altitude of the ground, whose
            shadows make shafts of light. It does not hide anything itself: give `distance`.
        shadow_reach: Distance over which such shadows may fall [m].
        shadow_steps: Number of places at which the way to the sun is looked at.

    Returns:
        Light, in the unit of `air.sun` times sr⁻¹. Transmittance.
    """
    eyes, rays = as_float(eye), as_float(direction)
    far, sun = as_float(distance), as_float(sun_direction)
    batch = jnp.broadcast_shapes(eyes.shape[:-1], rays.shape[:-1], sun.shape[:-1], far.shape)
    dtype = jnp.result_type(eyes, rays)
    eyes = jnp.broadcast_to(eyes, (*batch, 3)).astype(dtype).reshape(-1, 3)
    rays = jnp.broadcast_to(rays, (*batch, 3)).astype(dtype).reshape(-1, 3)
    far = jnp.broadcast_to(far, batch).astype(dtype).reshape(-1)
    air = jax.tree.map(lambda a: a.astype(dtype), air)
    steps = view_steps, light_steps, shadow_steps
    suns = jnp.broadcast_to(sun, (*batch, 3)).astype(dtype).reshape(-1, 3)
    light, seen = _march(air, (eyes, rays, far, suns), table, terrain, shadow_reach, steps)
    return light.reshape(*batch, 3), seen.reshape(*batch, 3)


@eqx.filter_jit
def _march(air, rays, table, terrain, reach, steps):
    def one(ray):
        eye, direction, far, sun = ray
        return _along(air, eye, direction, far, sun, table, terrain, reach, steps)

    # A few thousand rays at a time stay in the cache.
    return jax.lax.map(one, rays, batch_size=min(4096, rays[0].shape[0]))


def _along(air: MarchedAir, eye, ray, far, sun, table, terrain, reach, steps):
    """One ray."""
    view_steps, light_steps, shadow_steps = steps
    start, end = _inside(air, eye, ray, far)
    step = (end - start) / view_steps
    middle = start + step * (jnp.arange(view_steps, dtype=step.dtype) + 0.5)
    points = eye[None] + middle[:, None] * ray[None]
    altitude = height(air.planet_radius, points)
    amounts = step * jnp.exp(-jnp.maximum(altitude, 0.0)[:, None] / air.scale_heights[None])
    passed = jnp.cumsum(amounts, axis=0)
    if table is None:
        ahead, lit = jax.vmap(lambda p: _towards_sun(air, p, sun, light_steps))(points)
    else:
        ahead, lit = table(altitude, up_cosine(air.planet_radius, points, sun))
    if terrain is not None:
        hidden = in_shadow(terrain, altitude, points, sun, reach, shadow_steps)
        lit = lit & ~hidden
    arriving = jnp.exp(-(passed + ahead) @ air.extinction)
    arriving = jnp.where(lit[:, None], arriving, 0.0)
    mu = jnp.clip(jnp.sum(ray * sun), -1.0, 1.0)
    # pyright takes the constructor from the fields; it is the class's own.
    haze = CornetteShanks(0.0)  # pyright: ignore[reportCallIssue]
    haze = jax.tree.map(lambda _: air.g[None], haze)
    phases = jnp.concatenate([Rayleigh().spectral(mu), haze.spectral(mu)])
    scattered = jnp.stack([air.rayleigh, air.mie]) * phases[:, None]
    light = air.sun * jnp.sum(scattered * (amounts.T @ arriving), axis=0)
    return light, jnp.exp(-passed[-1] @ air.extinction)


def _inside(air: MarchedAir, eye, ray, far):
    """Where a ray enters the air and where it leaves it, meets the ground or the object."""
    enters, leaves = crossings(air.planet_radius, air.top_altitude, eye, ray)
    meets = jnp.isfinite(leaves) & (leaves > 0)
    start = jnp.maximum(jnp.where(meets, enters, 0.0), 0.0)
    end = jnp.where(meets, leaves, 0.0)
    near_ground, _ = crossings(air.planet_radius, jnp.zeros_like(air.top_altitude), eye, ray)
    ground = jnp.where(near_ground > 0, near_ground, jnp.inf)
    end = jnp.minimum(jnp.minimum(end, ground), jnp.maximum(far, 0.0))
    return start, jnp.maximum(end, start)


def _towards_sun(air: MarchedAir, point, sun, steps):
    """Columns of air and haze from a point to space, and whether the ground is out of the way."""
    _, end = crossings(air.planet_radius, air.top_altitude, point, sun)
    step = jnp.where(jnp.isfinite(end), jnp.maximum(end, 0.0), 0.0) / steps
    s = step * (jnp.arange(steps, dtype=step.dtype) + 0.5)
    altitude = height(air.planet_radius, point[None] + s[:, None] * sun[None])
    above = jnp.maximum(altitude, 0.0)[:, None]
    column = step * jnp.sum(jnp.exp(-above / air.scale_heights[None]), axis=0)
    return column, jnp.all(altitude >= 0)
