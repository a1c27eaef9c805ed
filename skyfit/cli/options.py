"""Options that several commands share."""

import math

import click


class _Setting(click.ParamType):
    """NAME=VALUE, as a pair."""

    name = "NAME=VALUE"

    def convert(self, value, param, ctx):
        key, equals, text = value.rpartition("=")
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not key or not equals or math.isnan(number):
            self.fail(f"expected NAME=VALUE with a number; got {value!r}", param, ctx)
        return key, number


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
workers = click.option(
    "--workers",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Threads that simulate side by side.",
)
