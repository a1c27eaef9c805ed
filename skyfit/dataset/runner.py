"""Carrying out a campaign: one compiled program, called for a few suns at a time."""

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from os import PathLike
from typing import Any, NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import xarray as xr

from .._progress import Progress, silent
from .._typing import as_float
from ..atmosphere import Atmosphere
from ..campaign import Campaign
from ..error_estimate import (
    CHECKS,
    ERRORS,
    covers,
    estimate_of,
    recorded,
    sampled_skies,
    sum_up,
    warn_where_large,
)
from ..errors import InputError
from ..transfer.simulate_sky import coarser_radiance, simulate
from ..transfer.trust import estimated_error, refuse_impossible
from .files import check_suffix, save_dataset
from .record import sky_dataset, sky_variables, with_errors
from .store import SkyStore, empty_skies, opened


class _Job(NamedTuple):
    """Some suns of one atmosphere."""

    at: int
    suns: list[int]


class _Place(NamedTuple):
    """An atmosphere, and where in it the observer stands [m]."""

    atmosphere: Atmosphere
    altitude: float


def _place(campaign: Campaign, at: int) -> _Place:
    values = campaign.places[at]
    return _Place(campaign.build_atmosphere(**values), campaign.observer_altitude_at(**values))


_DIRECTIONS_PER_CALL = 20_000  # of all suns together, for the memory that a call takes
Variables = dict[str, np.ndarray]


class _Run(NamedTuple):
    """A campaign under way."""

    campaign: Campaign
    suns_per_call: int
    workers: int
    progress: Progress


def run_campaign(
    campaign: Campaign,
    progress: Progress | None = None,
    store: str | PathLike[str] | None = None,
    *,
    workers: int = 1,
    suns_per_call: int | None = None,
    estimate_error: str = "none",
    overwrite: bool = False,
) -> xr.Dataset:
    """Simulate every sky of a campaign.

    Args:
        campaign: Campaign to simulate.
        progress: Called as `progress("skies", done, total)`, and after that, where errors are
            estimated, as `progress("error estimate", done, total)`; both count skies.
        store: A name ending in .zarr or .nc to save the skies under. A .zarr store keeps every
            finished sky: the same call continues it after an interruption.
        workers: Threads that run the compiled program side by side.
        suns_per_call: Suns that one call of the program simulates: how much an interruption
            loses, and how much memory a call takes. All of a turbidity's by default, but at
            most 12, and fewer where there are thousands of directions.
            Campaigns with as many share the compiled program.
        estimate_error: "sample" to simulate a few skies at the next coarser sizes too and put on
            record how far the radiances may be off; "all" to do so with every sky, and record it
            for each radiance. Finished skies of `store` are taken as they are. "none" leaves what
            is on record.
        overwrite: Replace a sky dataset that is under `store`; nothing else is ever replaced.

    Returns:
        Dimensions (turbidity and what else is swept, or sample; sun_zenith, direction,
        wavelength); see `skyfit.dataset`, and `skyfit.error_estimate.estimate_of` for the estimate.

    Raises:
        InputError: `store` holds something else, or a store of another campaign, or another run
            is writing to it; an argument is impossible; a radiance is negative or not finite.

    Warns:
        AccuracyWarning: The estimate on record exceeds 2 %; what `simulate` warns of.
    """
    if store is not None:
        check_suffix(store)
    if suns_per_call is None:
        fit = max(1, _DIRECTIONS_PER_CALL // len(campaign.view_zenith))
        suns_per_call = min(12, fit, len(campaign.sun_zenith))
    if workers < 1 or suns_per_call < 1:
        raise InputError(
            "run_campaign: expected workers and suns_per_call of 1 or more; "
            f"got {workers} and {suns_per_call}"
        )
    if estimate_error not in CHECKS:
        expected = ", ".join(repr(name) for name in CHECKS)
        raise InputError(
            f"run_campaign(estimate_error=...): expected one of {expected}; got {estimate_error!r}"
        )
    shapes = _shapes(campaign, _place(campaign, 0))
    template = empty_skies(campaign, shapes, jnp.result_type(float))
    run = _Run(campaign, suns_per_call, workers, progress or silent)
    with opened(store, template, overwrite=overwrite) as (kept, dataset):
        fresh = dataset is None
        if dataset is None:
            dataset = _simulated(run, template, kept)
        refuse_impossible(
            dataset["radiance"].values, "run_campaign" if store is None else str(store)
        )
        if store is not None and kept is None and fresh:
            # before what follows, which may be interrupted
            save_dataset(dataset, store, overwrite=overwrite)
        if not covers(estimate_of(dataset), estimate_error):
            dataset = _estimated(run, dataset, estimate_error, kept)
            if store is not None and kept is None:
                save_dataset(dataset, store, overwrite=True)
        if (estimate := estimate_of(dataset)) is not None:
            warn_where_large(estimate, campaign.quality)
        return dataset


def _simulated(run: _Run, template: xr.Dataset, kept: SkyStore | None) -> xr.Dataset:
    """All skies, simulated or as they are in a store, with the store's estimate of the error."""
    variables = {str(name): array.values for name, array in template.data_vars.items()}
    done = np.zeros(run.campaign.sky_shape, bool)
    if kept is not None:
        done = kept.done()
        variables = {name: kept.read(name) for name in variables}
    run.progress("skies", int(done.sum()), done.size)
    for piece in _pieces(run, ~done, run.suns_per_call, _skies):
        for sky, one in piece:
            for name, array in one.items():
                variables[name][sky] = array
            if kept is not None:
                kept.write(sky, one)
            done[sky] = True
        run.progress("skies", int(done.sum()), done.size)
    dataset = sky_dataset(run.campaign, variables)
    if kept is not None and ERRORS in kept.attributes:
        dataset = dataset.assign_attrs({ERRORS: kept.attributes[ERRORS]})
        if covers(estimate_of(dataset), "all"):
            dataset = with_errors(dataset, kept.read(ERRORS))
    return dataset


def _estimated(run: _Run, dataset: xr.Dataset, skies: str, kept: SkyStore | None) -> xr.Dataset:
    """A dataset with an estimate of its error from a sample of its skies, or from all."""
    campaign, radiance = run.campaign, dataset["radiance"].values
    chosen = sampled_skies(campaign) if skies == "sample" else np.ones(campaign.sky_shape, bool)
    errors = np.full(radiance.shape, np.nan)
    left, size = chosen, int(chosen.sum(axis=-1).max())
    if skies == "all":
        size = run.suns_per_call
        if kept is not None:
            errors = kept.add(ERRORS, with_errors(dataset, errors)[ERRORS])
            left = np.isnan(errors[..., 0, 0])
    total = int(chosen.sum())
    run.progress("error estimate", total - int(left.sum()), total)
    for piece in _pieces(run, left, size, _coarser_skies):
        for sky, one in piece:
            errors[sky] = estimated_error(radiance[sky], one["radiance"])
            if kept is not None and skies == "all":
                kept.put(ERRORS, sky, errors[sky])
        done = int((chosen & np.isfinite(errors[..., 0, 0])).sum())
        run.progress("error estimate", done, total)
    record = recorded(sum_up(campaign, skies, errors))
    if kept is not None:
        kept.put_attributes(record)
    dataset = dataset.assign_attrs(record)
    return with_errors(dataset, errors) if skies == "all" else dataset


def _pieces(
    run: _Run,
    left: np.ndarray,
    suns_per_call: int,
    work: Callable[[Campaign, _Place, list[int], int], Variables],
) -> Iterator[list[tuple[tuple[int, ...], Variables]]]:
    """Work on the skies that are left, and yield them with their variables as they are ready."""

    def done(job: _Job) -> list[tuple[tuple[int, ...], Variables]]:
        found = work(run.campaign, _place(run.campaign, job.at), job.suns, suns_per_call)
        return [
            (
                (*(int(k) for k in np.unravel_index(job.at, left.shape[:-1])), sun),
                {name: array[n] for name, array in found.items()},
            )
            for n, sun in enumerate(job.suns)
        ]

    jobs = _jobs(left.reshape(-1, left.shape[-1]), suns_per_call)
    # The first job alone compiles the program; two threads would each compile it.
    yield from map(done, jobs[: 1 if run.workers > 1 else None])
    if run.workers == 1:
        return
    pool = ThreadPoolExecutor(run.workers)
    try:
        running = {pool.submit(done, job) for job in jobs[1:]}
        while running:
            ready, running = wait(running, return_when=FIRST_COMPLETED)
            for future in ready:
                yield future.result()
    finally:
        pool.shutdown(cancel_futures=True)


def _jobs(left: np.ndarray, suns_per_call: int) -> list[_Job]:
    """What is left to do, in pieces."""
    jobs = []
    for at, row in enumerate(left):
        suns = np.flatnonzero(row).tolist()
        starts = range(0, len(suns), suns_per_call)
        jobs += [_Job(at, suns[start : start + suns_per_call]) for start in starts]
    return jobs


def _skies(campaign: Campaign, place: _Place, suns: list[int], size: int) -> Variables:
    """Variables of some suns' skies, [sun, ...]; the program always sees `size` suns."""
    sky = simulate(**_arguments(campaign, place, _suns(campaign, suns, size)))
    count = len(suns)
    by_order = None
    if campaign.keep_orders:
        by_order = np.moveaxis(np.asarray(sky.by_order), 0, 1)[:count]
    wavelengths = np.array(campaign.wavelengths)
    radiance = np.asarray(sky.radiance)[:count]
    refuse_impossible(radiance, "run_campaign")
    return sky_variables(radiance, wavelengths, by_order)


def _coarser_skies(campaign: Campaign, place: _Place, suns: list[int], size: int) -> Variables:
    """Radiance of the same at the next coarser sizes."""
    arguments = _arguments(campaign, place, _suns(campaign, suns, size))
    return {"radiance": coarser_radiance(**arguments)[: len(suns)]}


def _suns(campaign: Campaign, suns: list[int], size: int) -> np.ndarray:
    """Zenith angles of some suns, the last as often as it takes to make `size` of them [rad]."""
    return np.array(campaign.sun_zenith)[suns + suns[-1:] * (size - len(suns))]


def _arguments(campaign: Campaign, place: _Place, suns: np.ndarray) -> dict[str, Any]:
    """Arguments of the simulator for all directions under some suns."""
    return {
        "atmosphere": place.atmosphere,
        "sun_zenith": as_float(suns)[:, None],
        "view_zenith": as_float(campaign.view_zenith)[None, :],
        "relative_azimuth": as_float(campaign.relative_azimuth)[None, :],
        "orders": campaign.orders,
        "geometry": campaign.geometry,
        "quality": campaign.quality,
        "observer_altitude": place.altitude,
    }


def _shapes(campaign: Campaign, place: _Place) -> dict[str, tuple[int, ...]]:
    """Shape of each variable of one sky."""
    directions, wavelengths = len(campaign.view_zenith), len(campaign.wavelengths)
    shapes: dict[str, tuple[int, ...]] = {"radiance": (directions, wavelengths)}
    if wavelengths > 1:
        shapes |= {name: (directions,) for name in ("luminance", "x", "y")}
    if campaign.keep_orders:
        count = campaign.orders
        if count is None:
            one = _arguments(campaign, place, np.zeros(1))
            air = one.pop("atmosphere")
            sky = eqx.filter_eval_shape(lambda air: simulate(air, **one), air)
            count = sky.by_order.shape[0]
        shapes["radiance_by_order"] = (count, directions, wavelengths)
    return shapes
