"""`skyfit simulate`: a campaign file to a sky dataset."""

from pathlib import Path

import click

import skyfit

from .options import as_json, workers
from .output import INTERRUPTED, complain, print_record, progress


@click.command()
@click.argument("campaign", type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    required=True,
    help="Where the skies go: a name ending in .zarr (resumable) or .nc.",
)
@workers
@as_json
def simulate(campaign: Path, out: Path, workers: int, as_json: bool) -> int:
    """Simulate the skies of the file CAMPAIGN (TOML).

    A .zarr store keeps every finished sky: after an interruption the same command continues it.
    """
    plan = skyfit.load_campaign(campaign)
    done = [0, plan.num_skies]
    with progress("skies", quiet=as_json) as bar:

        def advance(finished: int, total: int) -> None:
            done[:] = finished, total
            bar("skies", finished, total)

        try:
            skies = skyfit.run_campaign(plan, advance, out, workers=workers)
        except KeyboardInterrupt:
            if out.suffix != ".zarr" or not out.exists():
                raise
            hint = f"{done[0]} of {done[1]} skies are in {out}; the same command continues"
            return complain(f"interrupted: {hint}", INTERRUPTED)
    rows = {
        "skies": plan.num_skies,
        "directions": skies.sizes["direction"],
        "wavelengths": skies.sizes["wavelength"],
    }
    print_record({"out": str(out), **rows}, as_json)
    return 0
