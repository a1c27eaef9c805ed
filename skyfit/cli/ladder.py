"""`skyfit ladder`: every formula fitted to skies, judged on skies left out."""

import dataclasses
from pathlib import Path
from typing import Any

import click

import skyfit
from skyfit.fitting.dependence import KINDS
from skyfit.models.domes import DISTRIBUTIONS

from .options import FILE, as_json
from .output import print_json, print_table, progress


@click.command()
@click.argument("sky", type=FILE)
@click.option(
    "--held-out",
    type=FILE,
    help="Skies to judge by; without them SKY is cross-validated.",
)
@click.option(
    "--distribution",
    "distributions",
    type=click.Choice(list(DISTRIBUTIONS)),
    multiple=True,
    help="Formula of the dome; may be repeated, all by default.",
)
@click.option(
    "--dependence",
    "dependences",
    type=click.Choice(KINDS),
    multiple=True,
    help="Dependence of its coefficients; may be repeated, all by default.",
)
@click.option(
    "--channels",
    type=click.Choice(["Yxy", "XYZ", "RGB", "spectrum"]),
    multiple=True,
    help="Channels that are fitted; may be repeated, Yxy and XYZ by default.",
)
@as_json
def ladder(
    sky: Path,
    held_out: Path | None,
    distributions: tuple[str, ...],
    dependences: tuple[str, ...],
    channels: tuple[str, ...],
    as_json: bool,
) -> int:
    """Fit every formula to the skies in SKY and compare them.

    How far off each is is judged on skies left out. A formula is a distribution over the dome, a
    dependence of its coefficients on the swept parameter and the sun, and channels. All of them
    together take about ten minutes for the paper's skies.

    \b
    skyfit ladder sky.zarr --distribution perez --distribution series --channels Yxy
    """  # noqa: D301, click reads the backslash
    skies = skyfit.load_dataset(sky)
    others = None if held_out is None else skyfit.load_dataset(held_out)
    chosen: dict[str, Any] = {
        "distributions": distributions,
        "dependences": dependences,
        "channels": channels,
    }
    chosen = {name: choice for name, choice in chosen.items() if choice}
    with progress("fitting", quiet=as_json) as bar:

        def advance(_: str, done: int, total: int) -> None:
            bar("fitting", done, total)

        rungs = skyfit.ladder(skies, held_out=others, progress=advance, **chosen)
    claim = skyfit.colour_claim(rungs)
    if as_json:
        print_json({"rungs": [dataclasses.asdict(rung) for rung in rungs], "claim": claim})
    else:
        _print(rungs, claim)
    return 0


def _print(rungs: list[Any], claim: str | None) -> None:
    from rich.table import Table

    rows = Table(title="Errors on skies left out; beyond a light's column, its worst")
    for name in ("distribution", "dependence", "channels"):
        rows.add_column(name)
    for name in ("numbers", "Y", "worst", "x, y", "worst", "each channel", "light ≥ 0", "s"):
        rows.add_column(name, justify="right")
    for rung in rungs:
        away = rung.held_out
        own = [name for name in away if name not in ("x", "y", "Y")]
        own = own if 0 < len(own) <= 3 else []
        rows.add_row(
            rung.distribution,
            rung.dependence,
            rung.channels,
            str(rung.coefficients),
            f"{100 * away['Y'].rms:.1f} %",
            f"{100 * away['Y'].worst:.0f} %",
            f"{rung.chromaticity_rms:.4f}",
            f"{max(away['x'].worst, away['y'].worst):.3f}",
            "  ".join(f"{name} {100 * away[name].rms:.1f} %" for name in own),
            "" if rung.positivity is None else ("yes" if rung.positivity.holds else "no"),
            f"{rung.seconds:.1f}",
        )
    print_table(rows)
    if claim:
        click.echo(claim)
