"""Render a sky: the public verb, and the picture it makes."""

import warnings
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from ..angles import as_azimuth, as_zenith
from ..colour import srgb_matrix
from ..constants import SUN_SOLID_ANGLE
from ..errors import InputError
from .cameras import AbstractCamera, Panorama, direction_of
from .files import check_target, write_exr, write_hdr, write_png
from .light_check import refuse_black_day, refuse_impossible_light
from .sources import AbstractSource
from .sun_disc import disc_cover
from .tone import automatic_exposure, display, into_gamut


@dataclass(frozen=True)
class Picture:
    """A sky in linear sRGB, not clipped, (1, 1, 1) being white of 1 cd m⁻².

    Attributes:
        rgb: Linear sRGB [row, column, 3], float32; 0 where nothing is shown.
        inside: Mask of the pixels that show something.
        weight: Solid angle of each pixel without the sun's disc, for exposure [sr].
        camera: Camera that projected it.
        description: Line that says what is seen.

    Raises:
        InputError: Light is not finite, or a luminance is negative by more than rounding.
    """

    rgb: Float[np.ndarray, "row column 3"]
    inside: Bool[np.ndarray, "row column"]
    weight: Float[np.ndarray, "row column"]
    camera: AbstractCamera
    description: str

    def __post_init__(self):
        """Refuse light that cannot be."""
        refuse_impossible_light(self.rgb, self.weight, self.description)

    def exposure(self) -> float:
        """Exposure value that suits it; the sun's disc does not count."""
        return automatic_exposure(self.rgb, self.weight)

    def pixels(
        self, ev: float | None = None, tone: str = "aces", gamut: str = "desaturate"
    ) -> np.ndarray:
        """8-bit sRGB [row, column, 3]; arguments as `save`."""
        return to_pixels(self.rgb, self.exposure() if ev is None else ev, tone, gamut)

    def save(
        self,
        path: str | PathLike[str],
        *,
        ev: float | None = None,
        tone: str = "aces",
        gamut: str = "desaturate",
        precision: str = "half",
        overwrite: bool = False,
    ) -> dict[str, Any]:
        """Write it to a file, its kind told by the name's ending.

        `.exr` and `.hdr` keep luminances: exposure and tone curve do not touch them.

        Args:
            path: Ends in .exr, .hdr or .png.
            ev: Exposure value; None for an automatic one.
            tone: Curve of a PNG; see `tone.display`.
            gamut: What becomes of colours that sRGB does not have; see `tone.into_gamut`.
            precision: Precision of an EXR's numbers.
            overwrite: Replace a file that is there.

        Returns:
            What was done: the file, how many pixels were outside the gamut, and for a PNG the
            exposure and how many were overexposed, else what a value of 1 stands for [cd m⁻²].

        Raises:
            InputError: Another ending, or a file is there.
        """
        kind = check_target(path, overwrite)
        rgb, outside = into_gamut(self.rgb, gamut)
        record: dict[str, Any] = {"out": str(path), "outside_srgb": outside, "gamut": gamut}
        if kind == ".exr":
            panorama = isinstance(self.camera, Panorama)
            white = write_exr(path, rgb, self.description, precision, panorama)
            return record | {"cd_m2_of_1": white, "precision": precision}
        if kind == ".hdr":
            return record | {"cd_m2_of_1": write_hdr(path, rgb, self.description)}
        if kind != ".png":
            raise InputError(f"{path}: expected .exr, .hdr or .png for one picture")
        ev = self.exposure() if ev is None else ev
        shown = display(rgb, ev, tone)
        notes = {"Description": self.description, "Exposure": f"EV {ev:.2f}, tone curve {tone}"}
        write_png(path, shown.pixels, notes)
        return record | {"ev": round(ev, 3), "tone": tone, "overexposed": shown.overexposed}


def to_pixels(
    rgb: Float[np.ndarray, "row column 3"], ev: float, tone: str, gamut: str
) -> np.ndarray:
    """8-bit sRGB of linear sRGB; arguments as `Picture.save`."""
    return display(into_gamut(rgb, gamut)[0], ev, tone).pixels


def render(
    source: AbstractSource,
    camera: AbstractCamera,
    sun_zenith: float,
    sun_azimuth: float = np.pi,
    *,
    sun_disc: bool = True,
    ground_albedo: float | None = None,
) -> Picture:
    """Make a picture of a sky.

    Args:
        source: The sky: a `ModelSource`, `SimulatedSource` or `RecordedSource`, what `load_source`
            makes of a file, or a class of your own.
        camera: `Fisheye`, `Panorama` or `Perspective`.
        sun_zenith: Zenith angle of the sun [rad].
        sun_azimuth: Compass azimuth of the sun, north 0, east π/2 [rad].
        sun_disc: Whether to show the disc, 0.53° across. Pixels it fills in part have its light in
            part.
        ground_albedo: Albedo of a Lambertian ground below the horizon, lit by this sky and sun;
            only where the source has no ground of its own. None: the source's `ground_albedo`.

    Returns:
        The picture, in absolute luminance.

    Raises:
        InputError: An angle out of its range; a sun whose dimming is unknown; light that is not
            finite, or negative by more than rounding; a black sky under a risen sun.

    Warns:
        UserWarning: A formula continues beyond the suns it was fitted to.
    """
    if not 0 <= sun_zenith <= np.pi:
        raise InputError(f"render(sun_zenith=...): expected 0 to pi rad; got {sun_zenith:.6g}")
    if not np.isfinite(sun_azimuth):
        raise InputError(f"render(sun_azimuth=...): expected a number; got {sun_azimuth}")
    as_azimuth(sun_azimuth, "render(sun_azimuth=...)")
    albedo = source.ground_albedo if ground_albedo is None else ground_albedo
    if not 0 <= albedo <= 1:
        raise InputError(f"render(ground_albedo=...): expected 0 to 1; got {albedo:.6g}")
    _warn_of_sun(source, sun_zenith)
    rays = camera.rays()
    direction = rays.direction.reshape(-1, 3)
    light = np.array(source.xyz(direction, sun_zenith, sun_azimuth), np.float32)
    sun = source.sun_xyz(sun_zenith) if sun_disc else None
    below = direction[:, 2] < 0
    if not source.has_ground and below.any():
        light[below] = ground_xyz(source, sun_zenith, sun_azimuth, albedo, sun)
    light = light.reshape(*camera.shape, 3)
    weight = np.where(rays.inside, rays.solid_angle, 0.0)
    if sun is not None and sun[1] > 0:
        toward = direction_of(sun_zenith, sun_azimuth)
        row, column, share = disc_cover(camera, toward, source.horizon())
        light[row, column] += share[:, None] * sun
        weight[row, column] = 0.0
    with np.errstate(invalid="ignore"):  # infinite light is refused below
        rgb = light @ srgb_matrix().T.astype(np.float32)
    rgb = np.where(rays.inside[..., None], rgb, np.float32(0))
    places = (
        f"sun zenith {np.degrees(sun_zenith):.4g} deg, azimuth {np.degrees(sun_azimuth):.4g} deg"
    )
    text = f"{source.name}; {places}; linear sRGB"
    picture = Picture(rgb, rays.inside, weight, camera, text)
    refuse_black_day(source, sun_zenith, rgb, (weight > 0) & (rays.direction[..., 2] > 0))
    return picture


def _warn_of_sun(source: AbstractSource, sun_zenith: float) -> None:
    low, high = source.sun_range()
    if not low - 1e-4 <= sun_zenith <= high + 1e-4:
        suns = f"{np.degrees(low):.3g} to {np.degrees(high):.3g} degrees"
        warnings.warn(
            f"render: {source.name} was fitted to suns {suns} from the zenith; beyond, its formula "
            "goes on, and nothing says how well",
            stacklevel=3,
        )


def ground_xyz(
    source: AbstractSource,
    sun_zenith: float,
    sun_azimuth: float,
    albedo: float,
    sun: np.ndarray | None,
) -> Float[np.ndarray, " 3"]:
    """CIE XYZ [cd m⁻²] of a Lambertian ground under a sky, and a sun where there is one."""
    light = horizontal_irradiance(source, sun_zenith, sun_azimuth)
    if sun is not None:
        light = light + sun * SUN_SOLID_ANGLE * max(np.cos(sun_zenith), 0.0)
    return albedo / np.pi * light


def horizontal_irradiance(
    source: AbstractSource, sun_zenith: float, sun_azimuth: float
) -> Float[np.ndarray, " 3"]:
    """What a sky without its sun sends onto the ground: XYZ, whose Y is the illuminance [lx]."""
    as_zenith(sun_zenith, "horizontal_irradiance(sun_zenith=...)")
    as_azimuth(sun_azimuth, "horizontal_irradiance(sun_azimuth=...)")
    # Gauss nodes in cos²θ, whose differential is the cosine-weighted solid angle.
    x, w = np.polynomial.legendre.leggauss(32)
    zenith = np.arccos(np.sqrt((x + 1) / 2))
    azimuth = (np.arange(72) + 0.5) * (2 * np.pi / 72) + sun_azimuth
    rings, spokes = np.meshgrid(zenith, azimuth, indexing="ij")
    sine = np.sin(rings)
    vectors = [sine * np.sin(spokes), sine * np.cos(spokes), np.cos(rings)]
    direction = np.stack(vectors, axis=-1).reshape(-1, 3).astype(np.float32)
    light = np.asarray(source.xyz(direction, sun_zenith, sun_azimuth), float)
    return (w / 2 * np.pi) @ light.reshape(*rings.shape, 3).mean(axis=1)
