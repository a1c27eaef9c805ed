"""The benchmarks: cases over orders, precision and size, each in a process of its own."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .._progress import Progress
from ..provenance import processor, versions
from ..transfer.quality import QUALITIES
from .case import Case


ORDERS: tuple[int | None, ...] = (1, 2, 4, None)
PRECISIONS = (32, 64)
# Over two decades each; the other sizes stay small, so that the one that grows is what counts.
SCALING = {
    "wavelengths": (4, 40, 400),
    "rings": (2, 20, 200),
    "suns": (1, 10, 100),
    "orders": (2, 6, 20),
}
HIGH_ZENITH, LOW_ZENITH = 75.0, 85.0  # degree


def run_benchmarks(
    orders: Sequence[int | None] = ORDERS,
    precisions: Sequence[int] = PRECISIONS,
    quality: str = "default",
    *,
    accuracy: bool = True,
    qualities: bool = False,
    gradient: bool = False,
    scaling: bool = False,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Measure the simulator on 12 suns × 343 directions × 41 wavelengths over grey ground.

    Args:
        orders: Orders of scattering, one row each; None for all.
        precisions: 32 and 64 bits, one row each.
        quality: See `skyfit.simulate`.
        accuracy: Compare with quality "high" in 64 bits: as many more runs as there are orders;
            and estimate the error as `simulate(..., estimate_error=True)` does.
        qualities: Measure every quality with two orders in 64 bits, with its estimated error.
        gradient: Measure the gradient by all numbers of the atmosphere, for one sun, two orders.
        scaling: Measure the time against the number of wavelengths, rings of directions, suns and
            orders.
        progress: Called as `progress("benchmarks", done, total)`.

    Returns:
        `machine`; `skies`, a row for each precision and order; `qualities`, `gradient` and
        `scaling`, rows, where asked for. Times are medians in seconds, memory is the process' peak
        in MiB, errors are the worst relative differences from quality "high" up to 75° and at 85°
        from the zenith, the sun overhead and at 85°. `estimated_error` is the largest of all
        directions down to the horizon, suns and wavelengths, half the distance from the next
        coarser sizes; `estimated_error_rms` the root mean square.
    """
    rows = [Case(n, bits, quality, estimate=accuracy) for bits in precisions for n in orders]
    each = [Case(2, 64, name, estimate=True) for name in QUALITIES] if qualities else []
    # The first and the last of the suns: quality "high" takes its time.
    exact = [Case(n, 64, "high", suns=2, repeats=0) for n in orders] if accuracy else []
    slow = [Case(2, 64, quality, suns=1, gradient=True)] if gradient else []
    grown = [(axis, size) for axis, sizes in SCALING.items() for size in sizes] if scaling else []
    total, done = sum(map(len, (rows, exact, each, slow, grown))), 0

    def measured(case: Case) -> dict[str, Any]:
        nonlocal done
        if progress is not None:
            progress("benchmarks", done, total)
        record = _in_fresh_process(case)
        done += 1
        return record

    result: dict[str, Any] = {"machine": machine(), "skies": []}
    with tempfile.TemporaryDirectory() as scratch:
        files = {case.orders: str(Path(scratch) / f"high_{case.orders}.npy") for case in exact}
        for case in exact:
            measured(case._replace(keep=files[case.orders]))
        mine = str(Path(scratch) / "mine.npy")
        for case in rows:
            record = measured(case._replace(keep=mine))
            row = _row(case, record)
            if accuracy:
                row |= _errors(case, np.load(mine)[[0, -1]], np.load(files[case.orders]))
            result["skies"].append(row)
    if each:
        result["qualities"] = [_row(case, measured(case)) for case in each]
    if slow:
        result["gradient"] = [_gradient_row(case, measured(case)) for case in slow]
    if grown:
        result["scaling"] = [_scaled(axis, size, quality, measured) for axis, size in grown]
    if progress is not None:
        progress("benchmarks", total, total)
    return result


def machine() -> dict[str, Any]:
    """What the figures belong to."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "load_before": load,
        **{name: number for name, number in versions().items() if name in ("skyfit", "jax")},
    }


def _in_fresh_process(case: Case) -> dict[str, Any]:
    environment = os.environ | {"JAX_ENABLE_COMPILATION_CACHE": "false"}
    finished = subprocess.run(
        [sys.executable, "-m", "skyfit.benchmark.case"],
        input=json.dumps(case._asdict()),
        env=environment,
        capture_output=True,
        text=True,
    )
    if finished.returncode:
        raise RuntimeError(f"{case} failed: {finished.stderr.strip().splitlines()[-1]}")
    return json.loads(finished.stdout)


def _row(case: Case, record: dict[str, Any]) -> dict[str, Any]:
    return {
        "orders": "all" if case.orders is None else case.orders,
        "precision": case.precision,
        "quality": case.quality,
        "s_per_sky": record["run_s"] / case.suns,
        "ns_per_value": 1e9 * record["run_s"] / case.values,
        "processor_s_per_sky": record["processor_s"] / case.suns,
        "compile_s": record["compile_s"],
        "peak_mib": record["peak_mib"],
        **{name: value for name, value in record.items() if name.startswith("estimated_error")},
    }


def _errors(case: Case, found: np.ndarray, exact: np.ndarray) -> dict[str, float]:
    view = np.degrees(case.directions()[0])
    error = np.abs(found / exact - 1).max(axis=(0, 2))
    high, low = view <= HIGH_ZENITH + 1e-9, np.isclose(view, LOW_ZENITH)
    return {"error_to_75_deg": float(error[high].max()), "error_at_85_deg": float(error[low].max())}


def _gradient_row(case: Case, record: dict[str, Any]) -> dict[str, Any]:
    times = {
        f"{way}_{clock}": record[f"{prefix}{clock}"]
        for way, prefix in (("forward", ""), ("gradient", "gradient_"))
        for clock in ("run_s", "processor_s", "compile_s", "peak_mib")
    }
    ratio = times["gradient_processor_s"] / times["forward_processor_s"]
    return {"orders": case.orders, "quality": case.quality, "ratio": ratio, **times}


def _scaled(
    axis: str, size: int, quality: str, measured: Callable[[Case], dict[str, Any]]
) -> dict[str, Any]:
    small = Case(2, 64, quality, suns=2, rings=6, spokes=7, wavelengths=8)
    record = measured(small._replace(**{axis: size}))
    return {"axis": axis, "size": size, "processor_s": record["processor_s"], **record}
