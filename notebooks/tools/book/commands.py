"""A page a command: what its help says."""

import argparse
from collections.abc import Iterator
from pathlib import Path

from segmap_app.commands import parser

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
    for name, command in commands.choices.items():
        title = f"segmap {name}"
        block = "".join(f"   {line}".rstrip() + "\n" for line in command.format_help().split("\n"))
        yield name, f"{title}\n{'=' * len(title)}\n\n.. code-block:: text\n\n{block}\n"
