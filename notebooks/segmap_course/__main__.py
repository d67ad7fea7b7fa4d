"""For who teaches: `python -m segmap_course handout FOLDER`, `grade FOLDER -o grades.csv`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from segmap.files import shown

from .grading import Limits, class_report, grade, plan_of, read_key
from .grading.handout import handout, write_solutions

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
        print(shown(f"{given.command}: {error}"), file=sys.stderr)
        return 1


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    found = argparse.ArgumentParser(
        prog="python -m segmap_course", description=__doc__, epilog=EPILOG, allow_abbrev=False
    )
    commands = found.add_subparsers(required=True, metavar="COMMAND", dest="command")

    def command(run: Callable[[argparse.Namespace], None], folder: str, text: str) -> Any:
        added = commands.add_parser(run.__name__.strip("_"), help=text)
        added.add_argument("folder", metavar="DIR", type=Path, help=folder)
        added.add_argument("--chapters", default="", metavar="34,54", help="default: all")
        added.set_defaults(run=run)
        return added

    handed = command(_handout, "a new folder for the students", "student copies of the chapters")
    handed.add_argument("--seed", type=whole, metavar="N", help="of the hidden cases; keep it")
    notebooks = "a notebook or a folder a student: ann.ipynb, ann/"
    _add_options(command(_grade, notebooks, "points and feedback for all submissions"))
    command(_solutions, "a new folder, not for students", "chapters with solutions, for you alone")
    return found


def _add_options(grade: argparse.ArgumentParser) -> None:
    grade.add_argument("-o", "--output", type=Path, required=True, metavar="grades.csv")
    grade.add_argument(
        "--key", type=Path, metavar="FILE", help="the instructor's file of handout: chapters, seed"
    )
    grade.add_argument("--seed", type=whole, metavar="N", help="without --key: of the hidden cases")
    for name, unit in (("seconds", "of the clock"), ("cpu", "seconds of computing")):
        words = f"of an answer, {unit}; default: %(default)s"
        default = int(getattr(Limits(), name))
        grade.add_argument(f"--{name}", type=whole, default=default, metavar="N", help=words)
    words = "run where nothing guards your files"
    grade.add_argument("--unprotected", action="store_true", help=words)


def _solutions(given: argparse.Namespace) -> None:
    count = write_solutions(given.folder, given.chapters)
    print(f"{count} chapters with solutions in {shown(given.folder)}: for you alone")


def whole(word: str) -> int:
    """A whole number from 0 on."""
    if not word.isdecimal():
        raise argparse.ArgumentTypeError(f"expected a whole number from 0 on, got {word!r}")
    return int(word)


def _handout(given: argparse.Namespace) -> None:
    key, tasks = handout(given.folder, wanted=given.chapters, seed=given.seed)
    count = len(list(given.folder.glob("*.ipynb")))
    points = sum(task.points for task in tasks)
    held = f"{count} chapters, {len(tasks)} tasks, {points} points"
    print(shown(f"{held}: give {given.folder} to students"))
    hidden = "no seed: no hidden cases" if given.seed is None else "the seed of the hidden cases"
    print(shown(f"for you alone: {key} ({hidden}); grade with --key {key}"))


def _grade(given: argparse.Namespace) -> None:
    if given.key and (given.chapters or given.seed is not None):
        raise ValueError("--key holds the chapters and the seed: leave --chapters and --seed out")
    if given.output.suffix != ".csv":
        raise ValueError(f"-o must name a table, grades.csv for instance, got {given.output}")
    if not given.output.parent.is_dir():
        raise ValueError(f"cannot write {given.output}: there is no folder {given.output.parent}")
    plan = read_key(given.key) if given.key else plan_of(given.chapters, given.seed)
    limits = Limits(seconds=max(given.seconds, 1), cpu=max(given.cpu, 1))
    rows = grade(given.folder, given.output, plan, limits=limits, unprotected=given.unprotected)
    hidden = "with" if plan.seed is not None else "without"
    pages = given.output.with_name(f"{given.output.stem}_feedback")
    print(f"{len(rows)} submissions, {len(plan.tasks)} tasks, {hidden} hidden cases")
    for line in class_report(rows, plan.tasks):
        print(f"  {line}")
    report = f"{given.output.stem}_class.txt"
    print(shown(f"written: {given.output}, {report}, feedback for each in {pages}"))
    if any(task.by_hand for task in plan.tasks):
        print(
            "columns that are empty are graded by hand: task, rubric and answer are in the feedback"
        )


if __name__ == "__main__":
    sys.exit(main())
