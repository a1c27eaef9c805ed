"""What the library says, in the words of the command line: options in place of arguments."""

import re

import click


_ARGUMENT = re.compile(r"\b(?:[A-Za-z_][\w.]*\()?([A-Za-z_]\w*)=(?:\.\.\.|True)\)?")
_UNITS = ("", "_deg", "_m", "_nm")


def for_command_line(message: str, command: click.Command | None) -> str:
    """A message that names options of a command as they are typed.

    `animate(seconds=...)` becomes --seconds, `overwrite=True` becomes --overwrite; an argument that
    is no option of the command keeps its bare name.
    """
    parameters = {} if command is None else {one.name: one for one in command.params}

    def typed(found: re.Match) -> str:
        for unit in _UNITS:
            one = parameters.get(found[1] + unit)
            if isinstance(one, click.Option):
                return max(one.opts, key=len)
        return found[1] if "..." in found[0] else found[0]

    return _ARGUMENT.sub(typed, message)
