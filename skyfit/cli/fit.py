"""`skyfit fit`: a sky dataset to a fit file."""

import dataclasses
from pathlib import Path
from typing import Any

import click

import skyfit
from skyfit._files import refuse_target
from skyfit.colour import PAPER_CHANNELS
from skyfit.fitting.choices import ZENITHS
from skyfit.fitting.dependence import NAMED
from skyfit.fitting.document import refuse_no_fit
from skyfit.models.domes import DISTRIBUTIONS
from skyfit.report.coefficients import has_published_form

from .options import FILE, as_json, overwrite
from .output import print_json, print_table, progress


@click.command()
@click.argument("sky", type=FILE)
@click.option("--out", type=FILE, required=True, help="File of the fit (JSON).")
@click.option(
    "--distribution",
    type=click.Choice(list(DISTRIBUTIONS)),
    default="perez",
    show_default=True,
    help="Formula of the dome.",
)
@click.option(
    "--dependence",
    type=click.Choice(list(NAMED)),
    default="linear",
    show_default=True,
    help="Dependence of its coefficients: linear in the parameters, polynomial in them and sun; "
    "linear between nodes; or of terms of low total degree, for several parameters and twilight.",
)
@click.option(
    "--zenith",
    type=click.Choice(ZENITHS),
    default="paper",
    show_default=True,
    help="Zenith of the default formula: the paper's, black before sunset in hazy air, or e to the "
    "power of a polynomial, which is not.",
)
@click.option(
    "--channels",
    type=click.Choice(["Yxy", "XYZ", "RGB", "spectrum"]),
    default="Yxy",
    show_default=True,
    help="Channels that are fitted; spectrum is every wavelength.",
)
@click.option(
    "--weights",
    type=click.Choice(["equal", "solid angle"]),
    default="equal",
    show_default=True,
    help="Weights of the directions.",
)
@click.option(
    "--residuals",
    type=click.Choice(["relative", "absolute"]),
    default="relative",
    show_default=True,
    help="Residuals that are made small.",
)
@click.option(
    "--compare-weights",
    is_flag=True,
    help="Print the published form's coefficients by every choice of weights too.",
)
@overwrite
@as_json
def fit(
    sky: Path,
    out: Path,
    distribution: str,
    dependence: str,
    zenith: str,
    channels: str,
    weights: Any,
    residuals: Any,
    compare_weights: bool,
    overwrite: bool,
    as_json: bool,
) -> int:
    """Fit a formula to the skies in SKY and print it.

    For the published form, the published coefficients stand beside them.

    \b
    skyfit fit sky.zarr --out fit.json
    skyfit fit sky.zarr --out best.json --distribution series --dependence polynomial
    """  # noqa: D301, click reads the backslash
    refuse_target(out, overwrite=overwrite)
    refuse_no_fit(out)  # which is not replaced: better known before the work
    skies = skyfit.load_dataset(sky)
    with progress("fitting", quiet=as_json):
        found = skyfit.fit_sky(
            skies,
            distribution=distribution,
            dependence=dependence,
            zenith=zenith,
            channels=channels,
            weights=weights,
            residuals=residuals,
        )
        compared = skyfit.compare_weights(skies) if compare_weights else {}
    found.save(out)
    record: dict[str, Any] = {"out": str(out)}
    record["fit"] = {name: one.rms for name, one in found.diagnostics.items()}
    record["numbers"] = found.num_numbers
    if has_published_form(found):
        record["coefficients"] = skyfit.coefficient_table(found)
    record["diagnostics"] = {name: dataclasses.asdict(d) for name, d in found.diagnostics.items()}
    record["settings"] = {"weights": weights, "residuals": residuals}
    if found.positivity is not None:
        record["positivity"] = dataclasses.asdict(found.positivity)
    if compared:
        record["weights"] = {name: one.to_dict() for name, one in compared.items()}
    if as_json:
        print_json(record)
    else:
        _print(found, record)
    return 0


def _print(found: Any, record: dict[str, Any]) -> None:
    if "coefficients" in record:
        _print_coefficients(record["coefficients"])
    else:
        click.echo(found.distribution.formula)
        click.echo(f"{record['numbers']} numbers a channel")
    _print_diagnostics(record)
    if found.positivity is not None:
        click.echo(found.positivity.sentence())
    if "weights" in record:
        _print_weights(record["weights"])


def _print_diagnostics(record: dict[str, Any]) -> None:
    """How good each channel's fit is, and what the skies leave open."""
    chosen = record["settings"]
    click.echo(f"Weights {chosen['weights']}, residuals {chosen['residuals']}:")
    for name, one in record["diagnostics"].items():
        line = (
            f"{name:<8} RMS {one['rms']:.2%}, worst {one['worst']:.0%}, condition number "
            f"{one['condition']:.3g}" + ("" if one["converged"] else ", not converged")
        )
        click.echo(line)
        for combination in one["unidentified"]:
            click.echo(f"{'':<8} not determined by the skies: {combination}")


def _print_weights(compared: dict[str, Any]) -> None:
    from rich import box
    from rich.table import Table

    # Without upright rules, so that common numbers fit into 80 columns.
    rows = Table(title="Coefficients by weights, as slope, intercept", box=box.SIMPLE, padding=0)
    rows.add_column("", no_wrap=True)
    for name in compared:
        rows.add_column(f"  {name}", justify="right", no_wrap=True)
    for channel in PAPER_CHANNELS:
        for k, letter in enumerate("ABCDE"):
            pairs = [one["coefficients"][channel][k] for one in compared.values()]
            rows.add_row(
                f"{channel} {letter}", *(f"  {slope:.3g}, {cut:.3g}" for slope, cut in pairs)
            )
        for measure in compared:
            values = [one["rms"][channel][measure] for one in compared.values()]
            rows.add_row(f"{channel} RMS {measure}", *(f"  {value:.2%}" for value in values))
        rows.add_section()
    print_table(rows)


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
    print_table(rows)
