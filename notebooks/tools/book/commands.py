"""A page a command: its usage, and each option with its help, as the argument parser has them."""

import argparse
import re
from collections.abc import Iterator
from pathlib import Path

from segmap_app.commands import parser

INDEX = """Commands
========

What `segmap` does without a line of Python: each page is what `segmap COMMAND --help-all` says.
"""


def write_commands(folder: Path) -> None:
    """Write the pages, and one that lists them."""
    folder.mkdir(parents=True)
    pages = dict(command_pages())
    for name, text in pages.items():
        (folder / f"{name}.rst").write_text(text, encoding="utf-8")
    listed = "\n".join(f"   {name}" for name in pages)
    text = f"{INDEX}\n.. toctree::\n   :maxdepth: 1\n\n{listed}\n"
    (folder / "index.rst").write_text(text, encoding="utf-8")


def command_pages() -> Iterator[tuple[str, str]]:
    """Name and source of the page of each command."""
    (commands,) = (a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    for name, command in commands.choices.items():
        title = f"segmap {name}"
        head = f"{title}\n{'=' * len(title)}\n\n{_plain(command.description or '')}\n\n"
        lines = [command.usage_line(), "", *(command.epilog or "").split("\n")]
        block = "".join(f"   {line}".rstrip() + "\n" for line in lines)
        usage = f".. code-block:: text\n\n{block}\n"
        groups = "".join(map(_group, command.shown_groups()))
        yield name, f"{head}{usage}.. program:: {title}\n\n{groups}"


def _group(group: argparse._ArgumentGroup) -> str:
    """The arguments of a group, or the thresholds of a method, below its title."""
    title, form = str(group.title), argparse.HelpFormatter("segmap")
    title = title if "_" in title else title.capitalize()
    entries = "".join(
        f".. option:: {form._format_action_invocation(action)}\n\n"
        f"   {_plain(form._expand_help(action))}\n\n"
        for action in group._group_actions
        if action.help != argparse.SUPPRESS
    )
    words = f"{_plain(group.description)}\n\n" if group.description else ""
    return f"{title}\n{'-' * len(title)}\n\n{words}{entries}"


def _plain(text: str) -> str:
    """Words as they stand: none of their signs is a mark."""
    return re.sub(r"([*`|\\_])", r"\\\1", text)
