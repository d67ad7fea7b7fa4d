"""For who teaches: `python -m segmap.course handout FOLDER`, `grade FOLDER -o grades.csv`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ._grade_checks import checks
from ._handout import handout

EPILOG = """\
notebooks/INSTRUCTOR.md tells how a course is set up, graded, and what is graded by hand.
Exit codes: 0 done, 1 something failed, 2 the command was not understood.
"""


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code."""
    given = parser().parse_args(arguments)
    try:
        return int(given.run(given) or 0)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130
    except (ValueError, OSError) as error:
        print(f"{given.command}: {error}", file=sys.stderr)
        return 1


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    found = argparse.ArgumentParser(
        prog="python -m segmap.course", description=__doc__, epilog=EPILOG, allow_abbrev=False
    )
    commands = found.add_subparsers(required=True, metavar="COMMAND", dest="command")
    _add_handout(commands.add_parser("handout", help="student copies of the chapters"))
    return found


def _add_handout(command: argparse.ArgumentParser) -> None:
    command.add_argument("folder", metavar="DIR", type=Path, help="a new folder for the students")
    command.add_argument("--chapters", default="", metavar="34,54", help="default: all")
    command.add_argument("--seed", type=whole, metavar="N", help="of the hidden cases; keep it")
    command.set_defaults(run=_handout)


def whole(word: str) -> int:
    """A whole number from 0 on."""
    if not word.isdecimal():
        raise argparse.ArgumentTypeError(f"expected a whole number from 0 on, got {word!r}")
    return int(word)


def _handout(given: argparse.Namespace) -> None:
    key, tasks = handout(given.folder, checks(), wanted=given.chapters, seed=given.seed)
    count = len(list(given.folder.glob("*.ipynb")))
    points = sum(task.points for task in tasks)
    print(f"{count} chapters, {len(tasks)} tasks, {points} points: give {given.folder} to students")
    hidden = (
        "the seed of the hidden cases" if given.seed is not None else "no seed: no hidden cases"
    )
    print(f"for you alone: {key} ({hidden}); grade with --key {key}")


if __name__ == "__main__":
    sys.exit(main())
