"""What the README shows: programs and commands run in its order, files and tests exist."""

import re
import shlex
from pathlib import Path

import pytest

from skyfit import cli


ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
# The first takes a minute and is run at a smaller size by test_report.py, the second takes ten.
LONG = ("reproduce", "ladder")


@pytest.mark.slow
def test_the_programs_run_one_after_the_other(capsys):
    code = "\n".join(re.findall(r"```python\n(.*?)```", README, re.DOTALL))
    # The same calls at a fraction of the size: what is shown must run, not take a minute.
    fewer = "skyfit.Campaign(turbidity=[2, 4, 6], sun_zenith=[0.2, 0.7, 1.2], quality='draft')"
    code, replaced = re.subn(r"skyfit\.Campaign\([^)]*\)", fewer, code)
    assert replaced == 1
    exec(compile(code, "README.md", "exec"), {})
    *sky, light = capsys.readouterr().out.splitlines()
    assert "".join(sky).count("[") > 4
    direct, diffuse = map(float, light.split())  # lx, on a wall
    assert 1e4 < diffuse < direct < 1e5


@pytest.mark.slow
def test_the_commands_run_one_after_the_other(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sims").symlink_to(ROOT / "sims")
    text = "".join(re.findall(r"```sh\n(.*?)```", README, re.DOTALL))
    lines = [shlex.split(line, comments=True) for line in text.splitlines()]
    commands = [line[1:] for line in lines if line[:1] == ["skyfit"] and line[1] not in LONG]
    assert len(commands) >= 7
    for command in commands:
        assert cli.run(command) == 0, command
        assert capsys.readouterr().out
        if "--out" in command:
            assert (tmp_path / command[command.index("--out") + 1]).exists()


def test_every_misprint_cites_a_test_that_exists():
    cited = set(re.findall(r"`(test_\w+)`", (ROOT / "docs" / "misprints.md").read_text()))
    text = "".join(path.read_text() for path in Path(__file__).parent.glob("test_*.py"))
    assert len(cited) >= 20
    assert cited <= set(re.findall(r"def (test_\w+)\(", text))


def test_every_file_that_is_shown_is_there():
    shown = re.findall(r"\]\(((?!https?:|#)[^)]+)\)|(sims/\w+\.\w+)", README)
    assert len(shown) >= 8
    assert all((ROOT / (link or file)).exists() for link, file in shown)
