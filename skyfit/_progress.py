"""How long work says how far it has come: `progress(stage, done, total)`, everywhere."""

from collections.abc import Callable


Progress = Callable[[str, int, int], None]


def silent(stage: str, done: int, total: int) -> None:
    """Say nothing."""
