"""The command line: parse, call, print. `skyfit COMMAND --help` says what each takes."""

import os
import sys
import traceback
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from skyfit.errors import InputError

from .benchmarks import benchmarks
from .compare import compare
from .export import export
from .fit import fit
from .interrupt import interrupted, leaving_at_once
from .ladder import ladder
from .output import BUG, MISTAKE, complain, print_anywhere
from .programs import keep_programs, no_cache
from .render import render
from .reproduce import reproduce
from .simulate import simulate
from .wording import for_command_line


TRACEBACK = "SKYFIT_TRACEBACK"  # of the environment


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave with its exit status.

    0 on success; 2 on a user's mistake, with one line that names it; 1 for an error inside, with
    one line, and the traceback before it where the environment has SKYFIT_TRACEBACK; 130 when
    interrupted.
    """
    keep_programs()
    with leaving_at_once():
        status = run(arguments)
    sys.exit(status)


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit status."""
    warnings.showwarning = _one_line
    print_anywhere()
    try:
        return commands.main(args=arguments, prog_name="skyfit", standalone_mode=False) or 0
    except click.ClickException as error:
        return complain(error.format_message(), MISTAKE)
    except (KeyboardInterrupt, click.Abort):
        return interrupted()
    except MemoryError as error:
        return complain(f"there is not enough memory for this; {error}", MISTAKE)
    except Exception as error:
        if isinstance(error, OSError) and error.filename is not None:
            return complain(f"{error.filename}: {error.strerror}", MISTAKE)
        if isinstance(error, OSError | InputError):
            return complain(str(error), MISTAKE)
        return _admit(error)


class _Group(click.Group):
    """Commands whose messages name options."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command that was typed."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:  # before click prints an empty line for it
            return interrupted()
        except InputError as error:
            command = self.commands.get(str(ctx.invoked_subcommand))
            raise InputError(for_command_line(str(error), command)) from error


@click.group(
    cls=_Group,
    context_settings={"help_option_names": ["-h", "--help"]},
    invoke_without_command=True,
)
@click.version_option(package_name="skyfit")
@click.pass_context
def commands(context: click.Context) -> None:
    """Simulate clear skies and fit analytic sky models to them.

    \b
    skyfit reproduce                                   the paper's pipeline, and a report
    skyfit render --sun-zenith-deg 60 --out sky.png    a picture of the published sky
    skyfit COMMAND --help                              what a command takes, with an example
    """  # noqa: D301, click reads the backslash
    import jax

    jax.config.update("jax_enable_x64", True)
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


for command in (simulate, fit, ladder, export, compare, reproduce, render, benchmarks):
    if command is not benchmarks:  # which measures how long compiling takes
        command.params.append(no_cache)
    commands.add_command(command)


def _one_line(message, category, filename, lineno, file=None, line=None) -> None:
    """A warning of skyfit's as one line on standard error; those of libraries are for programs."""
    if category is UserWarning or category.__module__.partition(".")[0] == "skyfit":
        context = click.get_current_context(silent=True)
        text = for_command_line(str(message), context and context.command)
        click.echo(f"skyfit: warning: {' '.join(text.split())}", err=True)


def _admit(error: Exception) -> int:
    """Say that skyfit is at fault, in one line, and how to see where."""
    if os.environ.get(TRACEBACK):
        traceback.print_exception(error)
    last = traceback.extract_tb(error.__traceback__)[-1]
    what = f"{type(error).__name__}: {error} ({Path(last.filename).name}:{last.lineno})"
    return complain(f"internal error: {what}; set {TRACEBACK}=1 for the traceback", BUG)
