"""A page a command: its usage, and each option with its help, as the argument parser has them."""

import argparse
import re
from collections.abc import Iterator
from pathlib import Path

from segmap._commands import parser

INDEX = """Commands
========

What `segmap` does without a line of Python: each page is what `segmap COMMAND --help` says.
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
    helps = {action.dest: _plain(action.help or "") for action in commands._choices_actions}
    for name, command in commands.choices.items():
        title = f"segmap {name}"
        head = f"{title}\n{'=' * len(title)}\n\n{helps[name][:1].upper()}{helps[name][1:]}.\n\n"
        form = argparse.HelpFormatter(title)
        form.add_usage(None, [a for a in command._actions if not a.option_strings], [], "")
        usage = f".. code-block:: text\n\n   {form.format_help().strip()} [OPTIONS]\n\n"
        groups = (group for group in command._action_groups if group._group_actions)
        yield name, f"{head}{usage}.. program:: {title}\n\n" + "".join(map(_group, groups))


def _group(group: argparse._ArgumentGroup) -> str:
    """The arguments of a group, below its title."""
    title, form = str(group.title).capitalize(), argparse.HelpFormatter("segmap")
    entries = "".join(
        f".. option:: {form._format_action_invocation(action)}\n\n"
        f"   {_plain(form._expand_help(action))}\n\n"
        for action in group._group_actions
    )
    return f"{title}\n{'-' * len(title)}\n\n{entries}"


def _plain(text: str) -> str:
    """Words as they stand: none of their signs is a mark."""
    return re.sub(r"([*`|\\_])", r"\\\1", text)
