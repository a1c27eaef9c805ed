"""What the documentation shows: its programs run, its commands, files and tests exist."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from show_outputs import outputs

import skyfit
from skyfit.cli import commands


pytestmark = pytest.mark.any_precision


DOCS = Path(__file__).parent.parent / "docs"
# Other files of the repository that are shown as pages have tests of their own.
PAGES = sorted(page for page in DOCS.rglob("*.md") if page.resolve().is_relative_to(DOCS.resolve()))


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(), re.DOTALL)


def test_pages_are_found():
    assert {page.name for page in PAGES} >= {"index.md", "tutorial.md", "refit.md"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", [page for page in PAGES if blocks(page, "python")], ids=lambda page: page.stem
)
def test_the_programs_of_a_page_run_and_print_what_is_shown(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    number = r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?"
    for _, printed, shown in outputs(page):
        words, wanted = (re.sub(rf"\s*{number}\s*", " N ", text) for text in (printed, shown))
        assert words == wanted
        found, want = (np.array(re.findall(number, text), float) for text in (printed, shown))
        # Other machines round otherwise; what is below a millionth is rounding itself.
        np.testing.assert_allclose(found, want, rtol=0.02, atol=1e-6)


def test_campaign_files_of_the_pages_are_campaigns(tmp_path):
    files = [text for page in PAGES for text in blocks(page, "toml")]
    assert files
    for text in files:
        (tmp_path / "shown.toml").write_text(text)
        assert skyfit.load_campaign(tmp_path / "shown.toml").places


def test_commands_of_the_pages_exist_with_their_options():
    text = "".join(block for page in PAGES for block in blocks(page, "sh"))
    shown = text.replace("\\\n", " ").splitlines()
    lines = [shlex.split(line, comments=True) for line in shown if line.startswith("skyfit ")]
    assert len(lines) >= 8
    for _, name, *words in lines:
        given = commands.commands[name].params
        known = {option for one in given for option in (*one.opts, *one.secondary_opts)}
        assert {word for word in words if word.startswith("--")} <= known, name


def test_every_test_that_a_page_cites_exists():
    cited = {name for page in PAGES for name in re.findall(r"`(test_\w+)`", page.read_text())}
    text = "".join(path.read_text() for path in Path(__file__).parent.glob("test_*.py"))
    assert len(cited) >= 25
    assert cited <= set(re.findall(r"def (test_\w+)\(", text))


def test_every_public_name_is_in_the_reference():
    text = "".join(page.read_text() for page in (DOCS / "reference").glob("*.md"))
    shown = set(re.findall(r"^::: skyfit\.(\w+)$", text, re.MULTILINE))
    public = {name for name in dir(skyfit) if not name.startswith("_") and name in skyfit._HOME}
    assert public - shown == set()
    modules = set(re.findall(r"^::: skyfit\.(\w+)(?:\.\w+)?$", text, re.MULTILINE))
    assert set(skyfit._MODULES) <= modules


@pytest.mark.slow
def test_the_places_that_contributors_are_sent_to_exist():
    root = DOCS.parent
    text = (root / "CONTRIBUTING.md").read_text()
    rows = text[text.index("## Where to change what") :].split("\n| ")[2:]
    assert len(rows) == 14
    code = "".join(
        path.read_text() for path in (*root.glob("skyfit/**/*.py"), *root.glob("tests/*.py"))
    )
    for row in rows:
        places = re.findall(r"`([^`]+)`", row)
        missing = [place for place in places if "/" in place and not (root / place).exists()]
        missing += [
            place for place in places if "/" not in place and not re.search(rf"\b{place}\b", code)
        ]
        assert missing == [], row
