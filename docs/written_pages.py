"""Writes the index of names and the help of the commands into pages while they are built."""

import importlib

import click

import skyfit
from skyfit.cli import commands


def on_page_markdown(markdown: str, **_) -> str:
    """Put a table or the commands' help where a page asks for it; MkDocs calls it for each."""
    for mark, write in (("<!-- names -->", names), ("<!-- commands -->", helps)):
        if mark in markdown:
            markdown = markdown.replace(mark, write())
    return markdown


def names() -> str:
    """A row for each public name: the first line of its docstring, and its file."""
    lines = ["| name | what it is | file |", "|---|---|---|"]
    for name in sorted(skyfit._HOME, key=str.lower):
        thing = getattr(skyfit, name)
        module = importlib.import_module(thing.__module__)
        path = module.__name__.replace(".", "/")
        path += "/__init__.py" if hasattr(module, "__path__") else ".py"
        summary = thing.__doc__.split("\n")[0].replace("|", "\\|")
        lines.append(f"| [`{name}`][skyfit.{name}] | {summary} | `{path}` |")
    return "\n".join(lines)


def helps() -> str:
    """What `--help` prints, of every command."""
    top = click.Context(commands, info_name="skyfit", max_content_width=98)
    sections = []
    for name, command in commands.commands.items():
        context = click.Context(command, top, info_name=name, max_content_width=98)
        sections.append(f"## skyfit {name}\n\n```text\n{command.get_help(context)}\n```\n")
    return "\n".join(sections)
