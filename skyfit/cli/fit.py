"""`skyfit fit`: a sky dataset to a fit file."""

from pathlib import Path
from typing import Any

import click

import skyfit

from .options import as_json
from .output import console, print_json, progress


@click.command()
@click.argument("sky", type=click.Path(path_type=Path))
@click.option(
    "--out", type=click.Path(path_type=Path), required=True, help="Where the fit goes (JSON)."
)
@as_json
def fit(sky: Path, out: Path, as_json: bool) -> int:
    """Fit the sky model's coefficients to the skies in SKY and print them.

    The published coefficients stand beside them.
    """
    if out.exists():
        raise click.UsageError(f"--out: {out} exists already; give another name")
    skies = skyfit.load_dataset(sky)
    with progress("fitting", quiet=as_json):
        found = skyfit.fit_sky(skies)
    found.save(out)
    table = skyfit.coefficient_table(found)
    if as_json:
        print_json({"out": str(out), "coefficients": table})
    else:
        _print_coefficients(table)
    return 0


def _print_coefficients(table: dict[str, Any]) -> None:
    from rich.table import Table

    rows = Table(title="F = (1 + A e^(B/cos θ)) (1 + C e^(D γ) + E cos² γ)")
    rows.add_column("")
    rows.add_column("")
    for part in ("slope", "intercept"):
        rows.add_column(part, justify="right", no_wrap=True)
        rows.add_column("published", justify="right", no_wrap=True)
    for channel, letters in table.items():
        for letter, parts in letters.items():
            cells = []
            for part in ("slope", "intercept"):
                row = parts[part]
                cells.append(f"{row['refit']:.4g} ± {row['standard_error']:.1g}")
                cells.append("" if row["published"] is None else f"{row['published']:.5g}")
            rows.add_row(channel, letter, *cells)
        rows.add_section()
    console().print(rows)
