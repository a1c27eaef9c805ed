"""Carrying out a campaign: one compiled program, called for a few suns at a time."""

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import xarray as xr

from ._typing import as_float
from .atmosphere import Atmosphere
from .campaign import Campaign
from .dataset import check_suffix, load_dataset, save_dataset, sky_dataset, sky_variables
from .store import SkyStore, empty_skies, refuse_another
from .transfer.simulate_sky import simulate


class _Job(NamedTuple):
    """Some suns of one atmosphere."""

    at: int
    suns: list[int]


class _Place(NamedTuple):
    """An atmosphere, and where in it the observer stands [m]."""

    atmosphere: Atmosphere
    altitude: float


def run_campaign(
    campaign: Campaign,
    progress: Callable[[int, int], None] | None = None,
    store: str | PathLike[str] | None = None,
    *,
    workers: int = 1,
    suns_per_call: int | None = None,
) -> xr.Dataset:
    """Simulate every sky of a campaign.

    Args:
        campaign: What to simulate.
        progress: Called as `progress(done, total)` with numbers of skies.
        store: A name ending in .zarr or .nc to save the skies under. A .zarr store keeps every
            finished sky: the same call continues it after an interruption.
        workers: Threads that run the compiled program side by side.
        suns_per_call: Suns that one call of the program simulates: how much an interruption
            loses, and how much memory a call takes. All of a turbidity's, at most 12, by default.
            Campaigns with as many share the compiled program.

    Returns:
        Dimensions (turbidity or what else is swept, sun_zenith, direction, wavelength); see
        `skyfit.dataset`.

    Raises:
        ValueError: `store` holds something else, or a store of another campaign.
    """
    if suns_per_call is None:
        suns_per_call = min(12, len(campaign.sun_zenith))
    if workers < 1 or suns_per_call < 1:
        raise ValueError(
            "run_campaign: expected workers and suns_per_call of 1 or more; "
            f"got {workers} and {suns_per_call}"
        )
    template = empty_skies(campaign, _shapes(campaign), jnp.result_type(float))
    variables = {str(name): array.values for name, array in template.data_vars.items()}
    kept, done = None, np.zeros(campaign.sky_shape, bool)
    if store is not None and check_suffix(store) == ".zarr":
        kept = SkyStore(store, template)
        done = kept.done()
        variables = {name: kept.read(name) for name in variables}
    elif store is not None and Path(store).exists():
        refuse_another(store, template)
        return load_dataset(store)

    def report() -> None:
        if progress is not None:
            progress(int(done.sum()), done.size)

    report()
    jobs = _jobs(np.atleast_2d(done), suns_per_call)
    for job, skies in _simulated(campaign, jobs, suns_per_call, workers):
        for number, sun in enumerate(job.suns):
            one = {name: array[number] for name, array in skies.items()}
            sky = (job.at, sun)[-done.ndim :]
            for name, array in one.items():
                variables[name][sky] = array
            if kept is not None:
                kept.write(sky, one)
            done[sky] = True
        report()
    dataset = sky_dataset(campaign, variables)
    if store is not None and kept is None:
        save_dataset(dataset, store)
    return dataset


def _jobs(done: np.ndarray, suns_per_call: int) -> list[_Job]:
    """What is left to do."""
    jobs = []
    for at, row in enumerate(done):
        left = np.flatnonzero(~row).tolist()
        starts = range(0, len(left), suns_per_call)
        jobs += [_Job(at, left[start : start + suns_per_call]) for start in starts]
    return jobs


def _simulated(
    campaign: Campaign, jobs: list[_Job], suns_per_call: int, workers: int
) -> Iterator[tuple[_Job, dict[str, np.ndarray]]]:
    """Every job with the variables of its skies, as they are ready."""
    places = [
        _Place(campaign.build_atmosphere(value), campaign.observer_altitude_at(value))
        for value in campaign.swept[1]
    ]

    def work(job: _Job) -> tuple[_Job, dict[str, np.ndarray]]:
        return job, _skies(campaign, places[job.at], job.suns, suns_per_call)

    # The first job alone compiles the program; two threads would each compile it.
    yield from map(work, jobs[: 1 if workers > 1 else None])
    if workers == 1:
        return
    pool = ThreadPoolExecutor(workers)
    try:
        running = {pool.submit(work, job) for job in jobs[1:]}
        while running:
            ready, running = wait(running, return_when=FIRST_COMPLETED)
            for future in ready:
                yield future.result()
    finally:
        pool.shutdown(cancel_futures=True)


def _skies(campaign: Campaign, place: _Place, suns: list[int], size: int) -> dict[str, np.ndarray]:
    """Variables of some suns' skies, [sun, ...]; the program always sees `size` suns."""
    padded = suns + suns[-1:] * (size - len(suns))
    sky = _call(campaign, place, np.array(campaign.sun_zenith)[padded])
    count = len(suns)
    by_order = None
    if campaign.keep_orders:
        by_order = np.moveaxis(np.asarray(sky.by_order), 0, 1)[:count]
    wavelengths = np.array(campaign.wavelengths)
    return sky_variables(np.asarray(sky.radiance)[:count], wavelengths, by_order)


def _call(campaign: Campaign, place: _Place, suns: np.ndarray):
    return simulate(
        place.atmosphere,
        as_float(suns)[:, None],
        as_float(campaign.view_zenith)[None, :],
        as_float(campaign.relative_azimuth)[None, :],
        orders=campaign.orders,
        geometry=campaign.geometry,
        quality=campaign.quality,
        observer_altitude=place.altitude,
    )


def _shapes(campaign: Campaign) -> dict[str, tuple[int, ...]]:
    """Shape of each variable of one sky."""
    directions, wavelengths = len(campaign.view_zenith), len(campaign.wavelengths)
    shapes: dict[str, tuple[int, ...]] = {"radiance": (directions, wavelengths)}
    if wavelengths > 1:
        shapes |= {name: (directions,) for name in ("luminance", "x", "y")}
    if campaign.keep_orders:
        count = campaign.orders
        if count is None:
            value = campaign.swept[1][0]
            place = _Place(campaign.build_atmosphere(value), campaign.observer_altitude_at(value))
            sky = eqx.filter_eval_shape(_call, campaign, place, np.zeros(1))
            count = sky.by_order.shape[0]
        shapes["radiance_by_order"] = (count, directions, wavelengths)
    return shapes
