"""The directory of a report: made if absent, renewed if it is one of ours, else refused."""

import json
from os import PathLike
from pathlib import Path

from ..errors import InputError


SCHEMA = "skyfit/report/1"


def claim_directory(path: str | PathLike[str]) -> Path:
    """Make or take over the directory of a report.

    It holds `report.json` from the start, by which a later call knows that it may write here.

    Raises:
        InputError: Something is there that is no report.
    """
    directory = Path(path)
    if directory.exists() and not directory.is_dir():
        raise InputError(f"{directory}: exists and is not a directory")
    marker = directory / "report.json"
    if directory.exists() and any(directory.iterdir()) and not _is_report(marker):
        raise InputError(f"{directory}: holds something else than a report; give another name")
    (directory / "figures").mkdir(parents=True, exist_ok=True)
    marker.write_text(json.dumps({"schema": SCHEMA, "complete": False}))
    return directory


def _is_report(marker: Path) -> bool:
    try:
        content = json.loads(marker.read_text())
    except (OSError, ValueError):
        return False
    return isinstance(content, dict) and content.get("schema") == SCHEMA
