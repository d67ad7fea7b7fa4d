"""`segmap notebooks DIR`: the chapters, for who installed the package with pip."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import Any

from .._files import existing, write_bytes
from ._words import counted

PACKAGE = Path(__file__).parents[1]
#: In an installed wheel the chapters lie inside the package, in a clone beside it.
PLACES = (PACKAGE / "notebooks", PACKAGE.parent / "notebooks")
#: The chapter that is opened first.
FIRST = "00_start_here.ipynb"
#: Links that lead out of the folder of the chapters lead nowhere in a copy: their words stay.
OUTSIDE = re.compile(rb"\[([^\]\n]+)\]\(\.\./[^)\n]*\)")


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser("notebooks", help="copy the chapters into a folder of yours")
    command.add_argument("folder", metavar="DIR", type=Path, help="it is made if it is not there")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> None:
    """Copy what is not there; what differs is a student's work, and stays."""
    chapters = {path.name: OUTSIDE.sub(rb"\1", path.read_bytes()) for path in originals()}
    given.folder.mkdir(parents=True, exist_ok=True)
    old = {name: given.folder / name for name in chapters if existing(given.folder / name)}
    yours = [name for name, path in old.items() if path.read_bytes() != chapters[name]]
    new = [name for name in chapters if name not in old]
    for name in new:
        write_bytes(given.folder / name, chapters[name])
    print(f"{counted(len(new), 'chapter')} copied to {given.folder}")
    if same := len(old) - len(yours):
        print(f"{counted(same, 'chapter')} there already")
    if yours:
        print(f"left as they are, since yours differ: {', '.join(yours)}")
        print("rename one of these, and run this again, to get the chapter as it was")
    print(f"open them with: jupyter lab {given.folder / FIRST}  (needs: pip install 'segmap[lab]')")


def originals() -> list[Path]:
    """The chapters that come with segmap."""
    for place in PLACES:
        if (place / FIRST).is_file():
            return sorted(place.glob("*.ipynb"))
    raise FileNotFoundError("the chapters are missing: install segmap again")
