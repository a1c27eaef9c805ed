"""What commands print: results on standard output, progress and messages on standard error."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import click

from skyfit.transfer.compiling import told_of_compiling


COMPILING = "compiling the simulator, about 20 s, once"
MISTAKE, BUG, INTERRUPTED = 2, 1, 130  # exit statuses
_WHOLE_TABLE = 140  # columns of the widest, `skyfit ladder`'s; rich takes 80 where it cannot ask


def complain(message: str, status: int) -> int:
    """Say in one line on standard error what went wrong; return the exit status."""
    click.echo(f"skyfit: {' '.join(message.split())}", err=True)
    return status


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


def console():
    """Standard output, without highlighting of numbers; into a file or pipe tables go whole."""
    from rich.console import Console

    terminal = Console(highlight=False)
    return terminal if terminal.is_terminal else Console(highlight=False, width=_WHOLE_TABLE)
