"""What commands print: results on standard output, progress and messages on standard error."""

import codecs
import io
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import click

from skyfit.transfer.compiling import told_of_compiling


COMPILING = "compiling the simulator, about 20 s, once"
MISTAKE, BUG, INTERRUPTED = 2, 1, 130  # exit statuses
_WIDEST = 1000  # columns of a table


def complain(message: str, status: int) -> int:
    """Say in one line on standard error what went wrong; return the exit status."""
    click.echo(f"skyfit: {' '.join(message.split())}", err=True)
    return status


# Letters of what commands print, where a terminal has ASCII or a code page alone.
_PLAIN = {
    "°": "deg", "²": "2", "³": "3", "θ": "theta", "γ": "gamma", "χ": "chi", "Σ": "sum", "√": "sqrt",
    "×": "x", "±": "+-", "≤": "<=", "≥": ">=", "†": "+", "→": "->", "–": "-", "⁻": "^-", "¹": "1",
}  # fmt: skip


def print_anywhere() -> None:
    """Let no letter that a terminal does not have stop a result from being printed."""
    codecs.register_error("skyfit", _plainly)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="skyfit")


def _plainly(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    return "".join(_PLAIN.get(letter, "?") for letter in letters), error.end


@contextmanager
def progress(first: str, *, quiet: bool) -> Iterator[Callable[[str, int, int], None]]:
    """A bar on standard error, told (stage, done, total); a second one while XLA compiles."""
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
            if COMPILING in tasks:
                bar.remove_task(tasks.pop(COMPILING))
            if stage not in tasks:
                tasks[stage] = bar.add_task(stage, total=total)
            bar.update(tasks[stage], completed=done, total=total)

        def tell() -> None:
            if COMPILING not in tasks:
                tasks[COMPILING] = bar.add_task(COMPILING, total=None)

        with told_of_compiling(tell):
            yield advance


def print_json(record: dict[str, Any]) -> None:
    """Print for machines."""
    click.echo(json.dumps(record, indent=2))


def print_record(record: dict[str, Any], as_json: bool) -> None:
    """Print a line for each entry, or JSON."""
    if as_json:
        print_json(record)
        return
    for name, value in record.items():
        click.echo(f"{name:<12} {value}")


def print_table(table: Any) -> None:
    """Print a table whole, however narrow the terminal: a number cut short is none."""
    from rich.console import Console
    from rich.measure import Measurement

    terminal = Console(highlight=False, markup=False, emoji=False)
    wide = terminal.options.update(max_width=_WIDEST)
    terminal.width = max(1, Measurement.get(terminal, wide, table).maximum)
    with terminal.capture() as printed:
        terminal.print(table)
    for line in printed.get().splitlines():
        click.echo(line.rstrip())
