"""Draw the fisheye thumbnails of `sims/README.md`: every campaign under a high and a low sun.

Run `python sims/make_thumbnails.py` for all campaigns, or name some: `... sims/mars.toml`. The sky
is simulated, not the fit's; zenith in the middle, sun to the right, exposed each by its own mean.
"""

import sys
from pathlib import Path

import jax
import matplotlib.image
import numpy as np


SIMS = Path(__file__).parent
SUNS_DEG = (35.0, 80.0)
RADIUS = 36  # pixels
WAVELENGTHS = np.arange(380.0, 781.0, 25.0)


def main(files: list[Path]) -> None:
    """Draw the campaigns one by one."""
    jax.config.update("jax_enable_x64", True)
    (SIMS / "thumbnails").mkdir(exist_ok=True)
    for file in files:
        picture = np.concatenate([fisheye(file, np.radians(sun)) for sun in SUNS_DEG], axis=1)
        matplotlib.image.imsave(SIMS / "thumbnails" / f"{file.stem}.png", picture)


def fisheye(file: Path, sun: float) -> np.ndarray:
    """One sky, [row, column, RGB] in sRGB; equal zenith angles at equal distances."""
    import skyfit
    from skyfit.colour import spectrum_to_xyz, xyz_to_rgb

    campaign = skyfit.load_campaign(file)
    swept = {name: values[len(values) // 2] for name, values in campaign.swept.items()}
    atmosphere = skyfit.load_atmosphere(file, WAVELENGTHS, **swept)
    x, y = np.meshgrid(*[(np.arange(2 * RADIUS) + 0.5) / RADIUS - 1] * 2)
    view, azimuth = np.hypot(x, y) * np.pi / 2, np.arctan2(y, x)
    half = (view <= np.pi / 2) & (y > 0)  # the other half is its mirror image
    sky = skyfit.simulate(
        atmosphere,
        np.array([[sun]]),
        view[half],
        azimuth[half],
        orders=campaign.orders,
        geometry=campaign.geometry,
        quality="draft",
        observer_altitude=campaign.observer_altitude_at(**swept),
    )
    rgb = np.asarray(xyz_to_rgb(spectrum_to_xyz(sky.radiance[0], WAVELENGTHS)))
    picture = np.zeros((*view.shape, 3))
    picture[half] = rgb
    picture = np.maximum(picture, picture[::-1])
    exposed = 1 - np.exp(-1.2 * np.maximum(picture, 0) / rgb.mean())
    curve = np.where(exposed <= 0.0031308, 12.92 * exposed, 1.055 * exposed ** (1 / 2.4) - 0.055)
    return np.where((view <= np.pi / 2)[..., None], np.clip(curve, 0, 1), 1.0)


if __name__ == "__main__":
    main([Path(name) for name in sys.argv[1:]] or sorted(SIMS.glob("*.toml")))
