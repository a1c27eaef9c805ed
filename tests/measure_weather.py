"""Seven weather years through files, sun and sky, against pvlib: `python tests/measure_weather.py`.

Rows that came back; the largest angle between skyfit's sun and NREL's; the largest error of Perez's
clearness and brightness for suns above 5°; and, of every hour by day, that of the light on the
ground which the dome has, beside the diffuse irradiance times its efficacy.
"""

import tempfile
from pathlib import Path

import jax
import numpy as np
from weather_years import YEARS, irradiance, write_epw

import skyfit
from skyfit.surfaces.dome import dome_grid


def ground_light(table, piece=500):
    """Illuminance of the ground by Perez's dome for every row [lx]."""
    zenith, azimuth, solid_angle = dome_grid(48, 64)
    found = []
    for start in range(0, len(table), piece):
        rows = table.iloc[start : start + piece]
        sun, direct, diffuse, top = (
            rows[name].to_numpy()[:, None, None]
            for name in ("sun_zenith", "direct_normal", "diffuse_horizontal", "extraterrestrial")
        )
        sky = skyfit.perez_all_weather_sky(direct, diffuse, extraterrestrial=top)
        light = np.asarray(sky.xyY(sun, zenith[:, None], azimuth[None])[..., 2])
        found.append(np.einsum("rza,z->r", light, np.cos(zenith) * solid_angle))
    return np.concatenate(found)


def main():
    """Print a row for each year."""
    jax.config.update("jax_enable_x64", True)
    print(f"{'year':<12}{'rows':>12}{'dark':>7}{'NaN':>6}{'sun °':>8}{'ε':>9}{'Δ':>9}{'light':>9}")
    for name, year in YEARS.items():
        rows = irradiance(year, range(365))
        with tempfile.TemporaryDirectory() as folder:
            write_epw(Path(folder) / "year.epw", year, rows)
            table = skyfit.weather_table(skyfit.read_weather(Path(folder) / "year.epw"))
        light = ground_light(table)
        day = ((rows["dhi"] > 0) & (rows["zenith"] < np.pi / 2)).to_numpy()
        high = day & (rows["zenith"] < np.radians(85)).to_numpy()
        bend = 1.041 * rows["zenith"] ** 3
        pairs = {
            "clearness": (1 + rows["dni"] / rows["dhi"] / (1 + bend)).clip(1, 12),
            "brightness": (rows["mass"] * rows["dhi"] / rows["top"]).clip(0.01, 0.6),
        }
        worst = [abs(table[key] / want - 1)[high].max() for key, want in pairs.items()]
        lit = abs(light / table["diffuse_illuminance"] - 1)[day].max()
        apart = np.degrees(abs(table["sun_zenith"] - rows["zenith"])).max()
        back = f"{len(table)}/{len(rows)}"
        counts = f"{(light == 0).sum():>7}{np.isnan(light).sum():>6}"
        print(f"{name:<12}{back:>12}{counts}{apart:>8.4f}", *(f"{x:>8.1e}" for x in (*worst, lit)))


if __name__ == "__main__":
    main()
