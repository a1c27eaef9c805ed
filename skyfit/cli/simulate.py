"""`skyfit simulate`: a campaign file to a sky dataset."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import click

import skyfit
from skyfit.dataset.files import check_suffix
from skyfit.error_estimate import CHECKS, ErrorEstimate, estimate_of

from .interrupt import on_interrupt
from .options import FILE, as_json, overwrite, workers
from .output import print_record, progress


@click.command()
@click.argument("campaign", type=FILE)
@click.option(
    "--out",
    type=FILE,
    required=True,
    help="File of the skies, .zarr (resumable) or .nc.",
)
@workers
@click.option(
    "--estimate-error",
    type=click.Choice(CHECKS),
    default="none",
    show_default=True,
    help="Say how far the radiances may be off, from a few skies or from all.",
)
@overwrite
@as_json
def simulate(
    campaign: Path, out: Path, workers: int, estimate_error: str, overwrite: bool, as_json: bool
) -> int:
    """Simulate the skies of the file CAMPAIGN (TOML).

    A .zarr store keeps every finished sky: after an interruption the same command continues it.

    The error is estimated by simulating skies at the next coarser sizes too: half the distance.
    Skies that are in a finished store are not simulated again for it. An estimate above 2 % is
    warned of; the exit status is 0 all the same.

    \b
    skyfit simulate sims/desert_dust.toml --out dust.zarr --estimate-error sample
    """  # noqa: D301, click reads the backslash
    check_suffix(out)
    plan = skyfit.load_campaign(campaign)
    done = [0, plan.num_skies]
    with progress("skies", quiet=as_json) as bar:

        def advance(stage: str, finished: int, total: int) -> None:
            if stage == "skies":
                done[0] = finished
            bar(stage, finished, total)

        def words() -> str | None:
            if out.suffix != ".zarr" or not out.exists():
                return None
            return f"{done[0]} of {done[1]} skies are in {out}; the same command continues"

        with on_interrupt(words):
            skies = skyfit.run_campaign(
                plan,
                advance,
                out,
                workers=workers,
                estimate_error=estimate_error,
                overwrite=overwrite,
            )
    rows = {
        "skies": plan.num_skies,
        "directions": skies.sizes["direction"],
        "wavelengths": skies.sizes["wavelength"],
    }
    estimate = estimate_of(skies)
    if as_json:
        error = {"error_estimate": None if estimate is None else _in_degrees(estimate)}
    else:
        error = {"error": estimate or "not estimated; --estimate-error sample does it"}
    print_record({"out": str(out), **rows, **error}, as_json)
    return 0


def _in_degrees(estimate: ErrorEstimate) -> dict[str, Any]:
    """An estimate for JSON, where names tell the units."""
    at = dict(estimate.worst_at)
    angles = ("sun_zenith", "view_zenith", "relative_azimuth")
    degrees = {f"{name}_deg": math.degrees(at.pop(name)) for name in angles}
    place = degrees | {"wavelength_nm": at.pop("wavelength"), **at}
    return dataclasses.asdict(estimate) | {"worst_at": place}
