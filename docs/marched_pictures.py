"""Pictures by the ray marcher: a day in a contact sheet, and what else the tutorial shows."""

import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from skyfit.marcher import (
    HeightField,
    MarchedAir,
    camera_rays,
    day_frames,
    fisheye_rays,
    march,
    scs_air,
    tone_map,
)
from skyfit.plots import style


def day_sheet(air: MarchedAir | None = None, frames: int = 128, size: int = 48) -> Figure:
    """Every frame of `day_frames` as a thumbnail, sixteen in a row.

    Args:
        air: The tutorial's if not given.
        frames: A multiple of 16.
        size: Of a thumbnail [pixels].
    """
    air = scs_air() if air is None else air
    angles, pictures = zip(*day_frames(air, size, frames), strict=True)
    rows = np.stack([_shown(p) for p in pictures]).reshape(-1, 16, size, size, 3)
    sheet = rows.swapaxes(1, 2).reshape(len(rows) * size, 16 * size, 3)
    with style.house_style():
        figure = style.new_figure(8.2, 8.2 * sheet.shape[0] / sheet.shape[1] + 0.6)
        axes = figure.subplots()
        axes.grid(visible=False)
        axes.imshow(sheet, extent=(0, 16, len(rows), 0), interpolation="antialiased")
        first = np.degrees(angles[::16])
        axes.set_yticks(np.arange(len(rows)) + 0.5, [f"{angle:.0f}°" for angle in first])
        axes.set_xticks([])
        axes.set_ylabel("sun zenith angle of a row's first frame")
        axes.set_title(
            f"{frames} fisheye views from 0° to {np.degrees(angles[-1]):.0f}°, zenith in the middle"
        )
    return figure


def gallery() -> Figure:
    """The tutorial's other pictures: from the air and from space, shafts of light, alien skies."""
    scenes = {
        "10 km up, sun 5° high": _seen(scs_air(), 10e3, 85.0, pitch=0.0),
        "2000 km up": _seen(scs_air(), 2e6, 70.0, pitch=-0.75),
        "shafts behind a ridge, hazy": _shafts(),
        "red air, no haze": _fisheye(scs_air(rayleigh=(33.1e-6, 13.5e-6, 3.8e-6), mie=0.0)),
        "ten times the haze": _fisheye(scs_air(mie=210e-6)),
        "thrice the air, half the planet": _fisheye(
            scs_air(rayleigh=np.array([3.8e-6, 13.5e-6, 33.1e-6]) * 3, planet_radius=3.18e6)
        ),
    }
    with style.house_style():
        figure = style.new_figure(8.2, 5.0)
        for axes, (title, picture) in zip(figure.subplots(2, 3).flat, scenes.items(), strict=True):
            axes.imshow(picture)
            axes.set_title(title)
            axes.set_axis_off()
    return figure


def _shown(light) -> np.ndarray:
    return np.clip(np.asarray(tone_map(light)), 0.0, 1.0)


def _toward(zenith_deg: float, azimuth_deg: float = 0.0) -> np.ndarray:
    zenith, azimuth = np.radians([zenith_deg, azimuth_deg])
    return np.array([np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth),
                     np.cos(zenith)])  # fmt: skip


def _seen(air, altitude, sun_deg, pitch):
    rays = camera_rays(200, 150, np.radians(65.0), pitch=pitch, heading=np.radians(25.0))
    light, _ = march(air, np.array([0.0, 0.0, altitude]), rays, _toward(sun_deg), view_steps=32)
    return _shown(light)


def _fisheye(air):
    rays, shown = fisheye_rays(150)
    light, _ = march(air, np.array([0.0, 0.0, 1.0]), rays, _toward(75.0))
    return _shown(jnp.where(jnp.asarray(shown)[..., None], light, 0.0))


def _shafts():
    """Looking across shafts that a low sun sends through the gaps of a ridge."""
    air = scs_air(mie=100e-6)
    along = np.arange(-100, 101) * 100.0
    ridge = np.zeros((201, 201))
    ridge[:, 140:146] = np.where(along % 2500 < 900, 0.0, 2500.0)[:, None]
    field = HeightField(ridge, 100.0)
    rays = camera_rays(200, 150, np.radians(50.0), pitch=0.25, heading=np.radians(55.0))
    eye = np.array([-1500.0, -4000.0, 50.0])
    distance = np.minimum(_distance_to(field, eye, rays), 25e3)
    light, _ = march(
        air, eye, rays, _toward(80.0), distance,
        view_steps=96, terrain=field, shadow_reach=12e3, shadow_steps=160,
    )  # fmt: skip
    return _shown(light)


def _distance_to(field, eye, rays):
    """Distance along rays to the first sample in the ground; else infinite."""
    s = np.linspace(50.0, 12e3, 480)
    points = eye + s[:, None, None, None] * rays[None]
    ground = np.asarray(field(jnp.asarray(points[..., 0]), jnp.asarray(points[..., 1])))
    below = points[..., 2] < ground
    first = np.argmax(below, axis=0)
    return np.where(below.any(axis=0), s[first], np.inf)
