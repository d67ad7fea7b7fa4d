"""The files that a command writes: their names are checked before any work is done."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path

#: Stands for the name of the log.
NAME = "{name}"


def add_output(command: argparse.ArgumentParser, suffixes: Sequence[str], what: str) -> None:
    """The option -o, as often as one likes, for names that end in one of the suffixes."""
    command.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        type=partial(_checked, suffixes),
        help=f"write {what}; the name ends in {', '.join(suffixes)}; may be given more than once; "
        f"{NAME} in it stands for the name of the log, for several logs: 'maps/{NAME}.svg'",
    )


def _checked(suffixes: Sequence[str], text: str) -> str:
    if not text.lower().endswith(tuple(suffixes)) or text.startswith(tuple(suffixes)):
        raise argparse.ArgumentTypeError(f"{text!r} must end in one of {', '.join(suffixes)}")
    return text


class Targets:
    """The names given with -o, with the name of each log in its place."""

    def __init__(self, patterns: Sequence[str]) -> None:
        self._patterns = patterns
        self._taken: dict[Path, str] = {}

    def alike(self) -> str:
        """The first name that is the same for all logs; empty where there is none."""
        return next((pattern for pattern in self._patterns if NAME not in pattern), "")

    def paths(self, name: str, source: str) -> list[Path]:
        """The files for a log of this name, none of them written before, nor the log itself."""
        found = [Path(pattern.replace(NAME, name)) for pattern in self._patterns]
        for path in found:
            place = path.resolve()
            if not place.parent.is_dir():
                raise FileNotFoundError(f"cannot write {path}: make the folder {path.parent} first")
            if place.is_dir():
                raise ValueError(f"cannot write {path}: it is a folder")
            if place == Path(source).resolve():
                raise ValueError(f"cannot write {path}: it is the log itself")
            if other := self._taken.get(place):
                raise ValueError(f"{path} was written for {other}: this log would replace it")
            self._taken[place] = source
        return found
