"""Measure what the simulator is worth: against stored radiances, and over random atmospheres.

    python tests/measure_accuracy.py stored [--quality NAME] [--case NAME ...]
    python tests/measure_accuracy.py random [--quality NAME] [--count N] [--seed N]

`stored` compares all orders and the first with `tests/reference/hard_atmospheres.npz` and
`monte_carlo_skies.csv`. `random` counts the skies that are negative, not finite or refused.
"""

import argparse
import time
import warnings
from collections import defaultdict

import jax


jax.config.update("jax_enable_x64", True)

import numpy as np  # noqa: E402
from hard_atmospheres import hard_atmosphere, random_atmosphere  # noqa: E402
from test_hard_atmospheres import hard_rows, monte_carlo_rows  # noqa: E402

import skyfit  # noqa: E402


WAVELENGTHS = [400.0, 500.0, 600.0, 750.0]  # nm, of random atmospheres
DIRECTIONS = 40  # All skies are padded to this many: one compiled program serves many.


def stored(quality, cases):
    """Print one line a sky: how far the first order and all orders are off, in per cent."""
    skies = defaultdict(list)
    for file, table in (("npz", hard_rows()), ("csv", monte_carlo_rows())):
        for row in table:
            skies[file, row["case"], row["sun_zenith_deg"], row["observer_altitude_m"]].append(row)
    print(
        "file, case, sun, eye: first worst | all: worst beyond 3 se, mean, worst 3 se", flush=True
    )
    for (file, case, sun, altitude), some in skies.items():
        if cases and case not in cases:
            continue
        began = time.time()
        names = ("view_zenith_deg", "relative_azimuth_deg", "order1", "total", "total_se")
        view, azimuth, first, total, error = (np.array([row[n] for row in some]) for n in names)
        padded = np.resize(np.arange(len(some)), DIRECTIONS)
        sky = skyfit.simulate(
            hard_atmosphere(case),
            np.radians(sun),
            np.radians(view[padded]),
            np.radians(azimuth[padded]),
            orders=None,
            quality=quality,
            observer_altitude=np.full(DIRECTIONS, altitude),
        )
        size = len(some)
        dim = 1e-6 * total.max()
        one = 100 * np.abs(np.asarray(sky.by_order[0, :size, 0]) - first) / np.maximum(first, dim)
        off = 100 * (np.asarray(sky.radiance[:size, 0]) - total) / np.maximum(total, dim)
        noise = 300 * error / np.maximum(total, dim)
        print(
            f"{file} {case:26s} {sun:4g} {altitude / 1e3:4g} km: {one.max():6.3f} |"
            f" {np.maximum(np.abs(off) - noise, 0).max():6.2f} {off.mean():+6.2f}"
            f" {noise.max():5.2f}   ({time.time() - began:.0f} s)",
            flush=True,
        )


def random_skies(quality, count, seed):
    """Print each sky that is refused, negative or not finite, and how many were not."""
    bad = refused = 0
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        atmosphere = random_atmosphere(rng, WAVELENGTHS)
        geometry = "flat" if rng.random() < 0.2 else "spherical"
        sun = rng.uniform(0, 89 if geometry == "flat" else 98)
        high = rng.choice([0.0, 10 ** rng.uniform(2, 5.3)]) if geometry == "spherical" else 0.0
        orders = [1, 2, None, None][rng.integers(4)]
        view = rng.uniform(0, 179 if high else 90, 8)
        azimuth = rng.uniform(0, 180, 8)
        what = f"{number}: {geometry}, sun {sun:.1f}, eye {high:.0f} m, orders {orders}"
        try:
            sky = skyfit.simulate(
                atmosphere, np.radians(sun), np.radians(view), np.radians(azimuth),
                orders=orders, geometry=geometry, quality=quality,
                observer_altitude=np.full(8, high),
            )  # fmt: skip
        except ValueError as error:
            refused += 1
            print(f"{what}: REFUSED {error}", flush=True)
            continue
        light = np.concatenate([np.asarray(sky.by_order), np.asarray(sky.radiance)[None]])
        if not np.all(np.isfinite(light)) or light.min() < 0:
            bad += 1
            print(f"{what}: {light.min():.2g} of {light.max():.2g}", flush=True)
        if number % 100 == 99:
            print(f"... {number + 1}", flush=True)
    print(f"{quality}, seed {seed}: {count} skies, {refused} refused, {bad} otherwise bad")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["stored", "random"])
    parser.add_argument("--quality", default="default")
    parser.add_argument("--case", nargs="+", default=[])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    choices = parser.parse_args()
    warnings.simplefilter("ignore", skyfit.AccuracyWarning)
    if choices.what == "stored":
        stored(choices.quality, choices.case)
    else:
        random_skies(choices.quality, choices.count, choices.seed)


if __name__ == "__main__":
    main()
