"""A page a command: what its help says."""

import io
from collections.abc import Iterator
from pathlib import Path

from rich.console import Console

from segmap_app.commands import APP

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
    for name in APP:
        if not name.startswith("-"):
            title = f"segmap {name}"
            APP.help_print([name], console=Console(file=(page := io.StringIO()), width=90))
            block = "".join(f"   {line}".rstrip() + "\n" for line in page.getvalue().split("\n"))
            yield name, f"{title}\n{'=' * len(title)}\n\n.. code-block:: text\n\n{block}\n"
