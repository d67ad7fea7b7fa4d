"""For teachers: `python -m segmap_course handout COURSE/LAB` writes what nbgrader grades."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from segmap.files import escape, speak

from .grading import handout

EPILOG = """\
notebooks/INSTRUCTOR.md tells how a course is set up, graded, and what is graded by hand.
Exit codes: 0 done, 1 something failed, 2 the command was not understood.
"""


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code."""
    speak()
    request = parser().parse_args(arguments)
    lab: Path = request.folder
    try:
        tasks = handout(lab, wanted=request.chapters, seed=request.seed, otter=request.otter)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130
    except (ValueError, OSError) as error:
        print(escape(f"{request.command}: {error}"), file=sys.stderr)
        return 1
    points = sum(task.points for task in tasks)
    chapters = len({task.chapter for task in tasks})
    print(f"{len(tasks)} tasks in {chapters} chapters, {points} points")
    print(escape(f"for students: {lab.parent / 'release' / lab.name}"))
    print(escape(f"for you alone, solutions and hidden cases: {lab.parent / 'source' / lab.name}"))
    print(escape(f"to grade, in {lab.parent}: nbgrader autograde {lab.name}, then nbgrader export"))
    return 0


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    program = argparse.ArgumentParser(
        prog="python -m segmap_course", description=__doc__, epilog=EPILOG, allow_abbrev=False
    )
    commands = program.add_subparsers(required=True, metavar="COMMAND", dest="command")
    words = "chapters as an assignment of nbgrader, with solutions and hidden cases"
    handed = commands.add_parser("handout", help=words)
    words = "a name for the assignment, in a course folder of nbgrader: robotics/lab1"
    handed.add_argument("folder", metavar="COURSE/LAB", type=Path, help=words)
    handed.add_argument("--chapters", default="", metavar="07,17", help="default: all")
    handed.add_argument(
        "--seed", type=whole, metavar="N", help="of the hidden cases; default: 128 bits, drawn"
    )
    words = "write tests for otter-grader, too: COURSE/otter/LAB, for you alone"
    handed.add_argument("--otter", action="store_true", help=words)
    return program


def whole(word: str) -> int:
    """A whole number from 0 on."""
    if not word.isdecimal():
        raise argparse.ArgumentTypeError(f"expected a whole number from 0 on, got {word!r}")
    return int(word)


if __name__ == "__main__":
    sys.exit(main())
