"""Options that several commands share, and names of files on the command line."""

import math
from pathlib import Path
from typing import Any

import click


class FileName(click.ParamType):
    """A name of a file or folder; a leading ~ is the home folder, as a shell has it."""

    name = "path"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The name as a path."""
        text = str(value)
        if not text or "\0" in text:
            self.fail(f"expected the name of a file; got {text!r}", param, ctx)
        try:
            return Path(text).expanduser()
        except RuntimeError:  # there is no such user
            self.fail(f"{text}: there is no such home folder", param, ctx)


class Number(click.FloatRange):
    """A finite number, within bounds if there are any."""

    name = "number"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number."""
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not math.isfinite(number):
            self.fail(f"expected a number; got {value}", param, ctx)
        return super().convert(value, param, ctx)

    def _describe_range(self) -> str:
        # Without bounds click would say "x<=None".
        return "" if self.min is None and self.max is None else super()._describe_range()


class _Setting(click.ParamType):
    """NAME=VALUE, as a pair."""

    name = "NAME=VALUE"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None):
        """The name and the number."""
        key, equals, text = str(value).rpartition("=")
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not key or not equals or not math.isfinite(number):
            self.fail(f"expected NAME=VALUE with a number; got {value!r}", param, ctx)
        return key, number


FILE = FileName()
settings = click.option(
    "--set",
    "settings",
    type=_Setting(),
    multiple=True,
    metavar="NAME=VALUE",
    callback=lambda _, __, pairs: dict(pairs),
    help="A parameter that a fit was made for; may be repeated.",
)
as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON in place of tables.")
overwrite = click.option(
    "--overwrite", is_flag=True, help="Replace what is under the name of --out."
)
workers = click.option(
    "--workers",
    type=click.IntRange(1, 256),
    default=1,
    show_default=True,
    help="Threads that simulate side by side.",
)
