"""The command line: parse, call, print. `skyfit COMMAND --help` says what each takes."""

import json
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

import skyfit


MISTAKE, BUG, INTERRUPTED = 2, 1, 130


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave with its exit status.

    0 on success; 2 on a user's mistake, with one line that names it; 1 for a bug; 130 when
    interrupted.
    """
    sys.exit(run(arguments))


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit status."""
    try:
        return commands.main(args=arguments, prog_name="skyfit", standalone_mode=False) or 0
    except click.ClickException as error:
        return _complain(error.format_message(), MISTAKE)
    except (KeyboardInterrupt, click.Abort):
        return _complain("interrupted", INTERRUPTED)
    except Exception as error:
        if isinstance(error, OSError) and error.filename is not None:
            return _complain(f"{error.filename}: {error.strerror}", MISTAKE)
        if _is_mistake(error):
            return _complain(str(error), MISTAKE)
        where = traceback.extract_tb(error.__traceback__)[-1]
        what = f"{type(error).__name__}: {error}"
        return _complain(f"bug: {what} ({Path(where.filename).name}:{where.lineno})", BUG)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="skyfit")
def commands() -> None:
    """Simulate clear skies and fit analytic sky models to them."""
    import jax

    jax.config.update("jax_enable_x64", True)


as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON in place of tables.")
workers = click.option(
    "--workers",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Threads that simulate side by side.",
)


@commands.command()
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
    with _progress("skies", quiet=as_json) as bar:

        def progress(finished: int, total: int) -> None:
            done[:] = finished, total
            bar("skies", finished, total)

        try:
            skies = skyfit.run_campaign(plan, progress, out, workers=workers)
        except KeyboardInterrupt:
            if out.suffix != ".zarr" or not out.exists():
                raise
            hint = f"{done[0]} of {done[1]} skies are in {out}; the same command continues"
            return _complain(f"interrupted: {hint}", INTERRUPTED)
    rows = {
        "skies": plan.num_skies,
        "directions": skies.sizes["direction"],
        "wavelengths": skies.sizes["wavelength"],
    }
    _print_record({"out": str(out), **rows}, as_json)
    return 0


@commands.command()
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
    with _progress("fitting", quiet=as_json):
        found = skyfit.fit_sky(skies)
    found.save(out)
    table = skyfit.coefficient_table(found)
    if as_json:
        _print_json({"out": str(out), "coefficients": table})
    else:
        _print_coefficients(table)
    return 0


@commands.command()
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("skyfit-report"),
    show_default=True,
    help="Directory of the report; made if absent.",
)
@workers
@as_json
def reproduce(out: Path, workers: int, as_json: bool) -> int:
    """Run the paper's pipeline end to end and write a report.

    Writes report.html, report.json, the pictures, the simulated skies and the fit.
    """
    with _progress("recovery check", quiet=as_json) as bar:
        report = skyfit.reproduce(out, bar, workers=workers)
    if as_json:
        _print_json(report)
    else:
        _print_report(report, out)
    return 0


def _is_mistake(error: Exception) -> bool:
    """Whether skyfit itself refused something, or the system refused a file."""
    if isinstance(error, OSError):
        return True
    innermost = traceback.extract_tb(error.__traceback__)[-1].filename
    ours = Path(innermost).is_relative_to(Path(__file__).parent)
    return isinstance(error, ValueError) and ours


def _complain(message: str, status: int) -> int:
    click.echo(f"skyfit: {' '.join(message.split())}", err=True)
    return status


@contextmanager
def _progress(first: str, *, quiet: bool) -> Iterator[Callable[[str, int, int], None]]:
    """A bar on standard error, told (stage, done, total)."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description:<24}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, disable=quiet or not console.is_terminal) as bar:
        tasks = {first: bar.add_task(first, total=None)}

        def advance(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                tasks[stage] = bar.add_task(stage, total=total)
            bar.update(tasks[stage], completed=done, total=total)

        yield advance


def _print_json(record: dict[str, Any]) -> None:
    click.echo(json.dumps(record, indent=2))


def _print_record(record: dict[str, Any], as_json: bool) -> None:
    if as_json:
        _print_json(record)
        return
    for name, value in record.items():
        click.echo(f"{name:<12} {value}")


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
    _console().print(rows)


def _print_report(report: dict[str, Any], out: Path) -> None:
    from rich.table import Table

    channels = ("Y", "x", "y")
    shapes = Table(title="A Practical Analytic Model for Daylight, reproduced")
    shapes.add_column("")
    for channel in channels:
        shapes.add_column(channel, justify="right")
    recovered = [f"{report['recovery_error'][channel]:.0e}" for channel in channels]
    shapes.add_row("published coefficients recovered within", *recovered)
    for pair in ("refit_vs_simulation", "published_vs_simulation", "refit_vs_published"):
        errors = [f"{100 * report['shape_error'][channel][pair]:.1f} %" for channel in channels]
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
    console = _console()
    for table in (shapes, sky, claims):
        console.print(table)
    spent = ", ".join(f"{stage} {seconds:.1f} s" for stage, seconds in report["seconds"].items())
    console.print(spent, soft_wrap=True)
    console.print(f"report: {out / 'report.html'}", soft_wrap=True)


def _console():
    from rich.console import Console

    return Console(highlight=False)
