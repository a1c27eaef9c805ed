"""report.html: one file that needs nothing else."""

from collections.abc import Mapping
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
    notes: Mapping[str, Any],
) -> None:
    """Write the report.

    Args:
        path: Name of the HTML file.
        record: Content of report.json.
        pictures: PNG file and caption by name.
        notes: Sentences: `summary` (a list), `findings` (by picture), `fit_notes`, `provenance`.
    """

    def picture(name: str) -> Markup:
        file, caption = pictures[name]
        finding = notes["findings"][name]
        template = Markup(
            '<figure><img alt="{}" src="{}"><figcaption><b>{}</b> {}</figcaption></figure>'
        )
        return template.format(name.replace("_", " "), style.data_uri(file), finding, caption)

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
