"""What the paper's simulation leaves out, measured: later orders, the ground, a curved planet."""

from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from ..atmosphere import Atmosphere
from ..campaign import Campaign, half_dome
from ..colour import luminance
from ..transfer.simulate_sky import PAPER_FLAT_BELOW, simulate


SUNS_DEG = (0.0, 30.0, 60.0, 75.0, 85.0)
RINGS_DEG = (20.0, 40.0, 55.0, 69.0, 85.0)
SPOKES_DEG = (0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0)
GROUND_ALBEDO = 0.2  # of grass and dry earth, roughly
# Shares of a few per cent are asked for: the coarse simulator knows them within 2 % of themselves.
QUALITY = "draft"


def simplifications(plan: Campaign) -> dict[str, Any]:
    """How much light each simplification of the paper costs, over turbidity and sun.

    Args:
        plan: Campaign whose turbidities and atmosphere are taken.

    Returns:
        `turbidity`, `sun_zenith_deg`, `ground_albedo`, and tables [turbidity][sun]:
        `higher_orders`, the share of the third and later orders in the luminance, averaged over
        the sky above 85° by solid angle; `ground_light`, what a ground of `ground_albedo` adds to
        the luminance of two orders, likewise; `flat`, the largest relative error of luminance over
        a flat planet up to a view zenith of 70°, two orders.
    """
    view, azimuth = half_dome(np.radians(RINGS_DEG), np.radians(SPOKES_DEG))
    weight = _solid_angles(len(SPOKES_DEG))
    suns = np.radians(SUNS_DEG)[:, None]
    near = view < PAPER_FLAT_BELOW

    def seen(atmosphere: Atmosphere, **choices):
        sky = simulate(atmosphere, suns, view, azimuth, quality=QUALITY, **choices)
        lam = atmosphere.wavelengths
        return np.asarray(luminance(sky.by_order, lam)), np.asarray(luminance(sky.tail, lam))

    tables: dict[str, list[list[float]]] = {"higher_orders": [], "ground_light": [], "flat": []}
    for turbidity in plan.turbidity:
        black = plan.build_atmosphere(turbidity=turbidity)
        black = _with_ground(black, 0.0)
        orders, tail = seen(black, orders=None)
        lit, _ = seen(_with_ground(black, GROUND_ALBEDO), orders=None)
        flat, _ = seen(black, orders=2, geometry="flat")
        two, every = orders[:2].sum(0), orders.sum(0) + tail
        tables["higher_orders"].append((1 - (two @ weight) / (every @ weight)).tolist())
        gain = lit[:2].sum(0) @ weight / (two @ weight) - 1
        tables["ground_light"].append(gain.tolist())
        error = np.abs(flat.sum(0) / two - 1)
        tables["flat"].append(error[:, near].max(axis=1).tolist())
    return {
        "turbidity": list(plan.turbidity),
        "sun_zenith_deg": list(SUNS_DEG),
        "ground_albedo": GROUND_ALBEDO,
        **tables,
    }


def _with_ground(atmosphere: Atmosphere, albedo: float) -> Atmosphere:
    grey = jnp.full_like(atmosphere.ground_albedo, albedo)
    return eqx.tree_at(lambda a: a.ground_albedo, atmosphere, grey)


def _solid_angles(spokes: int) -> np.ndarray:
    """Of the zenith and each direction of the rings, up to 85°; they sum to 1."""
    edges = np.radians([0.0, 10.0, 30.0, 47.5, 62.0, 77.0, 85.0])
    rings = -np.diff(np.cos(edges)) / (1 - np.cos(edges[-1]))
    ends = np.ones(spokes)
    ends[[0, -1]] = 0.5  # half a turn, mirrored: its first and last azimuth count once
    share = ends / ends.sum()
    return np.concatenate([rings[:1], np.outer(rings[1:], share).ravel()])
