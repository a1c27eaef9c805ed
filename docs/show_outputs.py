"""Write below each program of a page what it prints: python docs/show_outputs.py PAGE ..."""

import contextlib
import io
import re
import sys
from collections.abc import Iterator
from pathlib import Path


PROGRAM = re.compile(r"```python\n(.*?)```\n(?:\n```text\n(.*?)```\n)?", re.DOTALL)


def outputs(page: Path) -> Iterator[tuple[str, str, str]]:
    """Run a page's programs in their order; yield each, what it prints, and what is shown of it."""
    names = {"__name__": page.stem}
    for code, shown in PROGRAM.findall(page.read_text(encoding="utf-8")):
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile(code, str(page), "exec"), names)
        yield code, printed.getvalue(), shown


def main() -> None:
    """Rewrite the pages that are named."""
    for page in map(Path, sys.argv[1:]):
        found = iter(list(outputs(page)))

        def written(match: re.Match[str], found=found) -> str:
            code, printed, _ = next(found)
            shown = f"\n```text\n{printed}```\n" if printed else ""
            return f"```python\n{code}```\n{shown}"

        page.write_text(PROGRAM.sub(written, page.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
