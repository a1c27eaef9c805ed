"""report.html: one file that needs nothing else."""

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from ..colour import PAPER_CHANNELS
from ..plots import style


def write_page(
    path: Path,
    record: Mapping[str, Any],
    pictures: Mapping[str, tuple[Path, str]],
    notes: Mapping[str, str | Sequence[str]],
) -> None:
    """Write the report.

    Args:
        path: Name of the HTML file.
        record: Content of report.json.
        pictures: PNG file and caption by name.
        notes: The sentences `summary` (a list), `fit_notes` and `provenance`.
    """

    def picture(name: str) -> Markup:
        file, caption = pictures[name]
        template = Markup('<figure><img alt="{}" src="{}"><figcaption>{}</figcaption></figure>')
        return template.format(name.replace("_", " "), style.data_uri(file), caption)

    source = (resources.files("skyfit.report") / "report.html.j2").read_text(encoding="utf-8")
    page = Environment(autoescape=True, undefined=StrictUndefined).from_string(source)
    html = page.render(
        record=record,
        channels=PAPER_CHANNELS,
        picture=picture,
        number=plain_number,
        percent=lambda share: f"{100 * share:.1f} %",
        **notes,
    )
    path.write_text(html, encoding="utf-8")


def plain_number(value: float) -> str:
    """Five significant digits; powers of ten only for what is very large or small."""
    return f"{value:.5g}".replace("-", "−")
