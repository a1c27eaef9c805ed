"""`skyfit compare`: the same sky through every model, as a table."""

import math
from pathlib import Path
from typing import Any

import click

import skyfit
from skyfit.fitting import paper_refit
from skyfit.render.source_files import REFIT

from .options import FILE, Number, as_json, settings
from .output import print_json, print_table, progress
from .place import hint_at_radians


@click.command()
@click.option(
    "--sun-zenith-deg",
    type=Number(0, 180),
    required=True,
    callback=hint_at_radians,
    help="Zenith angle of the sun, in degrees.",
)
@click.option(
    "--turbidity", type=Number(min=1), required=True, help="Turbidity of the air, 1 or more."
)
@click.option(
    "--fit",
    "fits",
    type=FILE,
    multiple=True,
    help="A fit file to compare as well, or the word refit; may be repeated.",
)
@settings
@as_json
def compare(
    sun_zenith_deg: float,
    turbidity: float,
    fits: tuple[Path, ...],
    settings: dict[str, float],
    as_json: bool,
) -> int:
    """Print the same sky through every model side by side.

    \b
    skyfit compare --sun-zenith-deg 50 --turbidity 3 --fit fit.json
    """  # noqa: D301, click reads the backslash
    known = {
        path.name: paper_refit() if str(path) == REFIT else skyfit.load_fit(path) for path in fits
    }
    sun = math.radians(sun_zenith_deg)
    with progress("simulating", quiet=as_json):
        rows = skyfit.compare_skies(sun, turbidity, fits=known, parameters=settings)
    if as_json:
        print_json({"sun_zenith_deg": sun_zenith_deg, "turbidity": turbidity, "skies": rows})
    else:
        _print_rows(rows, f"Sun {sun_zenith_deg:g}° from the zenith, turbidity {turbidity:g}")
    return 0


def _print_rows(rows: list[dict[str, Any]], title: str) -> None:
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    table.add_column("", no_wrap=True)
    heads = ("zenith", "45° sun", "aside", "opposite", "85° aside", "sun/opp.", "diffuse",
             "zenith x y", "85° x y")  # fmt: skip
    for head in heads:
        table.add_column(head, justify="right", no_wrap=True)
    for row in rows:
        # A number without a unit is not a thousandth of anything.
        unit = 1.0 if row["white"] else 1000.0
        luminances = [_short(value / unit) for value in row["luminance"].values()]
        ratio = row["sun_side_ratio"]
        table.add_row(
            f"{row['model']}{' †' if row['white'] else ''}{' *' if row['outside'] else ''}",
            *luminances,
            "" if ratio is None else f"{ratio:.2f}",
            _short(row["diffuse_illuminance"] / unit),
            *(f"{x:.3f} {y:.3f}" for x, y in row["chromaticity"].values()),
        )
    print_table(table)
    click.echo("Luminances in kcd/m²; diffuse: light of the sky alone on the ground, in klx.")
    for row in rows:
        if row["white"]:
            click.echo(f"† In units of {row['white']}.")
        if row["outside"]:
            click.echo(f"* {row['model']}: {'; '.join(row['outside'])}; held at the end.")


def _short(value: float) -> str:
    return f"{value:#.3g}".rstrip(".")
