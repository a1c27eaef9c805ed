"""Fit the aerosol of Cornell's skies, simulate it, refit formulas, compare all with the skies.

Run `python sims/fit_cornell.py`. It writes the fitted numbers into `cornell_2013.toml`, the best
formula fitted to that file's simulation as `cornell_2013.fit.json`, and every error as
`cornell_2013.json`. Half of the skies are fitted, the others only compared with.

Errors are root mean squares over 80 directions and the wavelengths 360, 371.75 … 712.5 nm, then
over times, in mW m⁻² sr⁻¹ nm⁻¹, as in published comparisons on these skies.
"""

import dataclasses
import json
import re
from pathlib import Path

import jax
import numpy as np


SIMS = Path(__file__).parent
FITTED, HELD_OUT = [0, 2, 4, 6], [1, 3, 5, 7]  # times of day, of eight
WAVELENGTHS = 360 + 11.75 * np.arange(31)
FEWER = WAVELENGTHS[1::5]
TURBIDITY = 2.53  # of that day, as published comparisons take it


def main() -> None:
    """Fit, simulate, refit, compare, write."""
    jax.config.update("jax_enable_x64", True)
    import skyfit

    skies = skyfit.cornell_skies()
    skies = skies.isel(direction=skies["reliable"].values)
    some = skies.isel(time=FITTED)
    file = SIMS / "cornell_2013.toml"
    found = skyfit.fit_aerosol(some, skyfit.load_campaign(file), "haze", wavelengths=FEWER)
    print(found)
    write_numbers(file, found.values)

    simulated = skyfit.run_campaign(skyfit.load_campaign(file))
    best = {"distribution": "series", "dependence": "polynomial", "channels": WAVELENGTHS}
    fits = {
        "paper's form, fitted to the simulation": skyfit.fit_sky(simulated, residuals="absolute"),
        "best of the ladder, fitted to the simulation": skyfit.fit_sky(
            simulated, residuals="absolute", **best
        ),
        "paper's form, fitted to the skies": skyfit.fit_sky(some, residuals="absolute"),
        "best of the ladder, fitted to the skies": skyfit.fit_sky(
            some, residuals="absolute", **best
        ),
    }
    (SIMS / "cornell_2013.fit.json").unlink(missing_ok=True)
    fits["best of the ladder, fitted to the simulation"].save(SIMS / "cornell_2013.fit.json")
    guesses = {"published, T = 2.53": of_model(skyfit.preetham_sky(TURBIDITY), skies)}
    guesses |= {name: of_model(fit.sky(), skies) for name, fit in fits.items()}
    guesses["simulator"] = of_simulator(file, skies)
    measured = skies["radiance"].interp(wavelength=WAVELENGTHS).values
    table = {name: errors(guess, measured) for name, guess in guesses.items()}
    for name, row in table.items():
        print(f"{name:46}", *(f"{row[key]:7.2f}" for key in ("day", "fitted", "held_out")))
    record = {"fit": dataclasses.asdict(found), "rmse_mW_m-2_sr-1_nm-1": table}
    (SIMS / "cornell_2013.json").write_text(json.dumps(record, indent=1) + "\n")


def write_numbers(file: Path, values: dict[str, float]) -> None:
    """Put fitted numbers in place of the file's own; the ground's factor multiplies the file's."""
    text = file.read_text()
    for name, value in values.items():
        key = "scale" if name == "ground_scale" else name
        before = re.findall(rf"(?m)^{key} = (\S+)", text)
        assert len(before) == 1, key
        number = value * float(before[0]) if name == "ground_scale" else value
        text = re.sub(rf"(?m)^{key} = \S+", f"{key} = {float(f'{number:.5g}')}", text)
    file.write_text(text)


def of_model(model, skies) -> np.ndarray:
    """Radiance of a formula, [time, direction, wavelength]."""
    sun, view = skies["sun_zenith"].values[:, None], skies["view_zenith"].values[None]
    return np.asarray(model.radiance(sun, view, skies["relative_azimuth"].values, WAVELENGTHS))


def of_simulator(file: Path, skies) -> np.ndarray:
    """Radiance of the simulator, every direction itself."""
    import skyfit

    sun, view = skies["sun_zenith"].values[:, None], skies["view_zenith"].values[None]
    atmosphere = skyfit.load_atmosphere(file, WAVELENGTHS)
    azimuth = skies["relative_azimuth"].values
    return np.asarray(skyfit.simulate(atmosphere, sun, view, azimuth, orders=None).radiance)


def errors(guess: np.ndarray, measured: np.ndarray) -> dict[str, object]:
    """Root mean square errors of the whole day, and of the times fitted and held out."""
    by_time = 1e3 * np.sqrt(np.mean((guess - measured) ** 2, axis=(1, 2)))

    def over(times):
        return float(np.sqrt(np.mean(by_time[times] ** 2)))

    return {
        "day": over(slice(None)),
        "fitted": over(FITTED),
        "held_out": over(HELD_OUT),
        "times": by_time.tolist(),
    }


if __name__ == "__main__":
    main()
