"""`skyfit export`: a sky formula as source code."""

from pathlib import Path

import click

import skyfit
from skyfit._files import refuse_target, write_text
from skyfit.export.write import FORMATS
from skyfit.fitting import paper_refit

from .options import FILE, as_json, overwrite
from .output import print_record


PUBLISHED, REFIT = "published", "refit"


@click.command()
@click.argument("sky")
@click.option(
    "--format",
    "language",
    type=click.Choice(list(FORMATS)),
    required=True,
    help="Language; python needs NumPy only, json has the numbers.",
)
@click.option("--out", type=FILE, required=True, help="Where the code goes.")
@click.option(
    "--name", default="sky", show_default=True, help="What the functions' names begin with."
)
@overwrite
@as_json
def export(sky: str, language: str, out: Path, name: str, overwrite: bool, as_json: bool) -> int:
    """Write a sky formula as source code for a renderer.

    SKY is a fit file, or the word "published", or "refit": the paper's formula fitted to the
    paper's campaign.
    """
    refuse_target(out, overwrite=overwrite)
    if sky == PUBLISHED:
        formula = skyfit.preetham_sky(2.0)
    else:
        formula = paper_refit() if sky == REFIT else skyfit.load_fit(Path(sky).expanduser())
    code = skyfit.export_fit(formula, language, name=name)
    write_text(out, code)
    print_record({"out": str(out), "format": language, "lines": code.count("\n")}, as_json)
    return 0
