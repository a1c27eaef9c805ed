"""Options that several commands share."""

import click


as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON in place of tables.")
workers = click.option(
    "--workers",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Threads that simulate side by side.",
)
