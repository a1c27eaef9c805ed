"""`skyfit benchmarks`: time, memory and accuracy of the simulator on this machine."""

from typing import Any

import click

import skyfit
from skyfit.transfer.quality import QUALITIES

from .options import as_json
from .output import print_json, print_table, progress


_COLUMNS = {
    "orders": ("orders", "{}"),
    "precision": ("bits", "{}"),
    "s_per_sky": ("s / sky", "{:.3f}"),
    "ns_per_value": ("ns / value", "{:.0f}"),
    "processor_s_per_sky": ("processor s / sky", "{:.3f}"),
    "compile_s": ("compile s", "{:.1f}"),
    "peak_mib": ("peak MiB", "{:.0f}"),
    "error_to_75_deg": ("error ≤ 75°", "{:.1e}"),
    "error_at_85_deg": ("error at 85°", "{:.1e}"),
    "estimated_error": ("estimated", "{:.1e}"),
}
_QUALITIES = {
    "quality": ("quality", "{}"),
    **{name: _COLUMNS[name] for name in ("s_per_sky", "processor_s_per_sky", "compile_s")},
    "peak_mib": ("peak MiB", "{:.0f}"),
    "estimated_error": ("estimated error", "{:.1e}"),
    "estimated_error_rms": ("RMS", "{:.1e}"),
}
_GRADIENT = {
    "orders": ("orders", "{}"),
    "ratio": ("gradient / forward", "{:.2f}"),
    "forward_run_s": ("forward s", "{:.3f}"),
    "gradient_run_s": ("gradient s", "{:.3f}"),
    "gradient_compile_s": ("compile s", "{:.1f}"),
    "gradient_peak_mib": ("peak MiB", "{:.0f}"),
}
_SCALING = {
    "axis": ("what grows", "{}"),
    "size": ("size", "{}"),
    "run_s": ("s", "{:.3f}"),
    "processor_s": ("processor s", "{:.3f}"),
    "compile_s": ("compile s", "{:.1f}"),
}


@click.command()
@click.option(
    "--orders",
    type=click.Choice(["1", "2", "4", "all"]),
    multiple=True,
    default=("1", "2", "4", "all"),
    show_default=True,
    help="Orders of scattering; give it several times for several rows.",
)
@click.option(
    "--precision",
    type=click.Choice(["32", "64"]),
    multiple=True,
    default=("32", "64"),
    show_default=True,
    help="Bits of the numbers.",
)
@click.option(
    "--quality",
    type=click.Choice(list(QUALITIES)),
    default="default",
    show_default=True,
    help="Size of the simulator's tables and quadratures.",
)
@click.option(
    "--accuracy/--no-accuracy",
    default=True,
    help="Compare with quality high, and estimate the error by the next coarser sizes; both take "
    "longer.",
)
@click.option(
    "--qualities", is_flag=True, help="Measure time and estimated error of every quality."
)
@click.option("--gradient", is_flag=True, help="Measure the gradient's time and memory too.")
@click.option(
    "--scaling", is_flag=True, help="Measure time against wavelengths, directions, suns, orders."
)
@as_json
def benchmarks(
    orders: tuple[str, ...],
    precision: tuple[str, ...],
    quality: str,
    accuracy: bool,
    qualities: bool,
    gradient: bool,
    scaling: bool,
    as_json: bool,
) -> int:
    """Measure the simulator on this machine.

    Each case has a process of its own. It takes more than ten minutes on two cores with everything,
    five with --no-accuracy. Nothing else should be running.

    \b
    skyfit benchmarks --orders 2 --precision 64 --no-accuracy
    """  # noqa: D301, click reads the backslash
    with progress("benchmarks", quiet=as_json) as bar:
        record = skyfit.run_benchmarks(
            [None if number == "all" else int(number) for number in orders],
            [int(bits) for bits in precision],
            quality,
            accuracy=accuracy,
            qualities=qualities,
            gradient=gradient,
            scaling=scaling,
            progress=bar,
        )
    if as_json:
        print_json(record)
        return 0
    click.echo("; ".join(f"{name} {value}" for name, value in record["machine"].items()))
    titles = {
        "skies": (f"12 suns × 343 directions × 41 wavelengths, quality {quality}", _COLUMNS),
        "qualities": ("Every quality, two orders, 64 bits", _QUALITIES),
        "gradient": ("Gradient by every number of the atmosphere", _GRADIENT),
        "scaling": ("Growth", _SCALING),
    }
    for name, (title, columns) in titles.items():
        if name in record:
            print_table(_table(title, columns, record[name]))
    return 0


def _table(title: str, columns: dict[str, tuple[str, str]], rows: list[dict[str, Any]]):
    from rich.table import Table

    table = Table(title=title)
    shown = {name: column for name, column in columns.items() if name in rows[0]}
    for heading, _ in shown.values():
        table.add_column(heading, justify="right")
    for row in rows:
        table.add_row(*(form.format(row[name]) for name, (_, form) in shown.items()))
    return table
