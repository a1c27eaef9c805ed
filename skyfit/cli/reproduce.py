"""`skyfit reproduce`: the paper's pipeline to a report."""

from pathlib import Path
from typing import Any

import click

import skyfit
from skyfit.colour import PAPER_CHANNELS

from .options import FILE, as_json, workers
from .output import print_json, print_table, progress


@click.command()
@click.option(
    "--out",
    type=FILE,
    default=Path("skyfit-report"),
    show_default=True,
    help="Directory of the report; made if absent.",
)
@workers
@as_json
def reproduce(out: Path, workers: int, as_json: bool) -> int:
    """Run the paper's pipeline end to end and write a report.

    Writes report.html, report.json, the pictures, the simulated skies and the fit.

    \b
    skyfit reproduce --out skyfit-report
    """  # noqa: D301, click reads the backslash
    with progress("recovery check", quiet=as_json) as bar:
        report = skyfit.reproduce(out, bar, workers=workers)
    if as_json:
        print_json(report)
    else:
        _print_report(report, out)
    return 0


def _print_report(report: dict[str, Any], out: Path) -> None:
    from rich.table import Table

    shapes = Table(title="A Practical Analytic Model for Daylight, reproduced")
    shapes.add_column("")
    for channel in PAPER_CHANNELS:
        shapes.add_column(channel, justify="right")
    recovered = [f"{report['recovery_error'][channel]:.0e}" for channel in PAPER_CHANNELS]
    shapes.add_row("published coefficients recovered within", *recovered)
    for pair in ("refit_vs_simulation", "published_vs_simulation", "refit_vs_published"):
        errors = [
            f"{100 * report['shape_error'][channel][pair]:.1f} %" for channel in PAPER_CHANNELS
        ]
        shapes.add_row(f"shape, {pair.replace('_vs_', ' against ')}", *errors)
    sky = Table(title="Measured skies")
    for title in ("model", "RMSE [mW/(m² sr nm)]", "luminance / measured"):
        sky.add_column(title, justify="right" if sky.columns else "left")
    cornell = report["cornell"]
    for name, error in cornell["rmse_mW_m-2_sr-1_nm-1"].items():
        sky.add_row(name, f"{error:.1f}", f"{cornell['luminance_ratio'][name]:.2f}")
    claims = Table(title="Claims")
    claims.add_column("")
    claims.add_column("verdict")
    for claim in report["claims"]:
        claims.add_row(claim["id"].replace("_", " "), claim["verdict"])
    for table in (shapes, sky, claims):
        print_table(table)
    spent = ", ".join(f"{stage} {seconds:.1f} s" for stage, seconds in report["seconds"].items())
    click.echo(spent)
    click.echo(f"report: {out / 'report.html'}")
