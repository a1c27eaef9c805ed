"""One measurement of the simulator in a process of its own: `python -m skyfit.benchmark.case`.

A fresh process makes compile time and peak memory those of the case alone, and lets each case
choose its precision.
"""

import json
import sys
import time
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..atmosphere import Atmosphere
from ..campaign import half_dome
from ..preetham_air import preetham_atmosphere
from ..transfer.compiling import compile_quickly
from ..transfer.simulate_sky import coarser_radiance, simulate
from ..transfer.trust import estimated_error


TURBIDITY, GROUND_ALBEDO = 4.0, 0.2
LOWEST_SUN_DEG = 85.0


class Case(NamedTuple):
    """What to measure.

    Attributes:
        orders: Orders of scattering; None for all.
        precision: 32 or 64 bits.
        quality: See `skyfit.simulate`.
        suns: Evenly from 0° to 85° from the zenith.
        rings: Zenith angles of the directions, evenly to the horizon.
        spokes: Azimuths of each ring.
        wavelengths: Evenly from 380 to 780 nm.
        gradient: Measure the gradient of the summed radiance by all numbers of the atmosphere too.
        estimate: Estimate the error by the next coarser sizes too.
        repeats: Runs after the first.
        keep: File for the radiance (.npy); none if empty.
    """

    orders: int | None = 2
    precision: int = 64
    quality: str = "default"
    suns: int = 12
    rings: int = 18
    spokes: int = 19
    wavelengths: int = 41
    gradient: bool = False
    estimate: bool = False
    repeats: int = 3
    keep: str = ""

    @property
    def values(self) -> int:
        """Radiance values of a run."""
        return self.suns * (1 + self.rings * self.spokes) * self.wavelengths

    def directions(self) -> tuple[np.ndarray, np.ndarray]:
        """View zenith and relative azimuth [rad]: the zenith, then the rings."""
        rings = np.linspace(0, np.pi / 2, self.rings + 1)[1:]
        return half_dome(rings, np.linspace(0, np.pi, self.spokes))


def measure(case: Case) -> dict[str, Any]:
    """Compile and run a case in this process, whose precision must be the case's.

    Returns:
        `seconds` (compile, run: the median) and `peak_mib` of the process; with `gradient` also
        those of the gradient; with `estimate` also `estimated_error`, the largest of the radiance,
        and `estimated_error_rms`, relative.
    """
    wavelengths = np.linspace(380.0, 780.0, case.wavelengths)
    atmosphere = preetham_atmosphere(
        TURBIDITY, wavelengths=wavelengths, ground_albedo=GROUND_ALBEDO
    )
    suns = np.radians(np.linspace(0.0, LOWEST_SUN_DEG, case.suns))[:, None]
    view, azimuth = case.directions()

    choices: dict[str, Any] = {"orders": case.orders, "quality": case.quality}

    def radiance(atmosphere: Atmosphere):
        return simulate(atmosphere, suns, view, azimuth, **choices).radiance

    record = _timed(radiance, atmosphere, case.repeats)
    if case.keep:
        np.save(case.keep, np.asarray(radiance(atmosphere), float))
    if case.estimate:
        coarser = coarser_radiance(atmosphere, suns, view, azimuth, **choices)
        skies = zip(np.asarray(radiance(atmosphere)), coarser, strict=True)
        errors = np.stack([estimated_error(sky, rough) for sky, rough in skies])
        record["estimated_error"] = float(errors.max())
        record["estimated_error_rms"] = float(np.sqrt(np.mean(errors**2)))
    if case.gradient:
        gradient = compile_quickly(eqx.filter_grad(lambda air: jnp.sum(radiance(air))))
        slow = _timed(gradient, atmosphere, case.repeats)
        record |= {f"gradient_{name}": value for name, value in slow.items()}
    return record


def _timed(function, atmosphere: Atmosphere, repeats: int) -> dict[str, float]:
    """First call apart; processor time counts all threads, and no other process."""
    start = time.perf_counter()
    jax.block_until_ready(function(atmosphere))
    first = time.perf_counter() - start
    wall, processor = [], []
    for _ in range(repeats):
        start, used = time.perf_counter(), time.process_time()
        jax.block_until_ready(function(atmosphere))
        wall.append(time.perf_counter() - start)
        processor.append(time.process_time() - used)
    run = float(np.median(wall))
    return {
        "compile_s": first - run,
        "run_s": run,
        "processor_s": float(np.median(processor)),
        "peak_mib": _peak_mib(),
    }


def _peak_mib() -> float:
    """Most memory that this process has held [MiB]; NaN where the system does not say."""
    try:
        import resource
    except ImportError:  # Windows
        return float("nan")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)


def main() -> None:
    """Read a case as JSON from standard input; write its record to standard output."""
    case = Case(**json.load(sys.stdin))
    jax.config.update("jax_enable_x64", case.precision == 64)
    json.dump(measure(case), sys.stdout)


if __name__ == "__main__":
    main()
