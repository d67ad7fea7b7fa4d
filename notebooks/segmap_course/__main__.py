"""For teachers: `python -m segmap_course handout FOLDER`, `grade FOLDER -o grades.csv`."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

from segmap.files import shown, speak, writable, write_bytes

from .grading import (
    Limits,
    Table,
    class_report,
    duplicates,
    graded,
    gradescope,
    plan_of,
    read_key,
    write_feedback,
)
from .grading.handout import handout, write_solutions

EPILOG = """\
notebooks/INSTRUCTOR.md tells how a course is set up, graded, and what is graded by hand.
Exit codes: 0 done, 1 something failed, 2 the command was not understood.
"""


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code."""
    speak()
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
    handed.add_argument(
        "--seed", type=whole, metavar="N", help="of the hidden cases; default: 128 bits, drawn"
    )
    words = "write tests for otter-grader, too: DIR.otter, for you alone"
    handed.add_argument("--otter", action="store_true", help=words)
    notebooks = (
        "a notebook or a folder a student: ann.ipynb, ann/; with -o results.json one student's"
    )
    _add_options(command(_grade, notebooks, "points and feedback for all submissions"))
    command(_solutions, "a new folder, not for students", "chapters with solutions, for you alone")
    return found


def _add_options(grade: argparse.ArgumentParser) -> None:
    words = "a table; or results.json, which Gradescope reads, for the folder of one student"
    grade.add_argument("-o", "--output", type=Path, required=True, metavar="grades.csv", help=words)
    grade.add_argument(
        "--key", type=Path, metavar="FILE", help="the instructor's file of handout: chapters, seed"
    )
    grade.add_argument("--seed", type=whole, metavar="N", help="without --key: of the hidden cases")
    for name, unit in (("seconds", "of the clock"), ("cpu", "seconds of computing")):
        words = f"of an answer, {unit}; default: %(default)s"
        default = int(getattr(Limits(), name))
        grade.add_argument(f"--{name}", type=whole, default=default, metavar="N", help=words)
    words = "run where nothing guards your files; the table says so"
    grade.add_argument("--unprotected", action="store_true", help=words)
    words = "list what has changed since the table was written; points by hand are kept anyway"
    grade.add_argument("--regrade", action="store_true", help=words)
    words = "of the points, 0 to 1, for an answer that fails on hidden cases only; default: 0"
    grade.add_argument("--partial", type=share, default=0.0, metavar="SHARE", help=words)
    words = "adds a column with the hours that files are late"
    grade.add_argument(
        "--deadline", type=datetime.fromisoformat, metavar="2026-11-23T10:00", help=words
    )
    words = "write a table that it imports, too"
    grade.add_argument("--export", choices=("moodle", "canvas"), help=words)


def _solutions(given: argparse.Namespace) -> None:
    count = write_solutions(given.folder, given.chapters)
    print(f"{count} chapters with solutions in {shown(given.folder)}: for you alone")


def whole(word: str) -> int:
    """A whole number from 0 on."""
    if not word.isdecimal():
        raise argparse.ArgumentTypeError(f"expected a whole number from 0 on, got {word!r}")
    return int(word)


def share(word: str) -> float:
    """A number from 0 to 1."""
    if not re.fullmatch(r"0?\.\d+|[01](\.0*)?", word):
        raise argparse.ArgumentTypeError(f"expected a number from 0 to 1, got {word!r}")
    return float(word)


def _handout(given: argparse.Namespace) -> None:
    key, tasks = handout(given.folder, wanted=given.chapters, seed=given.seed, otter=given.otter)
    count = len(list(given.folder.glob("*.ipynb")))
    points = sum(task.points for task in tasks)
    held = f"{count} chapters, {len(tasks)} tasks, {points} points"
    print(shown(f"{held}: give {given.folder} to students"))
    print(shown(f"for you alone: {key} (the seed of the hidden cases); grade with --key {key}"))
    if given.otter:
        print(shown(f"for you alone: {given.folder}.otter, a folder of tests for each chapter"))


def _grade(given: argparse.Namespace) -> None:
    if given.key and (given.chapters or given.seed is not None):
        raise ValueError("--key holds the chapters and the seed: leave --chapters and --seed out")
    if given.output.suffix not in (".csv", ".json"):
        raise ValueError(f"-o must name a table, grades.csv, or results.json, got {given.output}")
    writable(given.output)
    plan = read_key(given.key) if given.key else plan_of(given.chapters, given.seed)
    run = partial(
        graded,
        given.folder,
        plan._replace(partial=given.partial),
        limits=Limits(seconds=max(given.seconds, 1), cpu=max(given.cpu, 1)),
        unprotected=given.unprotected,
    )
    if given.output.suffix == ".json":
        (row,) = run(alone=True)
        write_bytes(given.output, gradescope(row, plan.tasks).encode())
        print(shown(f"written: {given.output}, {row.points(plan.tasks):g} points"))
        return
    table = Table(given.output, plan.tasks, given.deadline)
    pages = given.output.with_name(f"{given.output.stem}_feedback")
    rows, journal = [], given.output.with_name(f"{given.output.stem}_unfinished.jsonl")
    if journal.exists():
        print(shown(f"going on where grading stopped; to begin anew, remove {journal}"))
    for row in run(journal=journal):
        table.add(row)
        write_feedback(pages, row, plan.tasks)
        rows.append(row)
        right = sum(outcome.right for outcome in row.outcomes.values())
        print(f"{shown(row.submission.student)}: {right} of {len(row.outcomes)} right")
    alike = duplicates(rows, plan.tasks)
    for row in rows:
        if said := alike.get(row.submission.student):
            table.add(row, said)
    report = class_report(rows, plan.tasks)
    path = given.output.with_name(f"{given.output.stem}_class.txt")
    write_bytes(path, "\n".join([*report, ""]).encode("utf-8", "replace"))
    hidden = "with" if plan.seed is not None else "without"
    print(f"{len(rows)} submissions, {len(plan.tasks)} tasks, {hidden} hidden cases")
    if rows[0].jail == "none":
        print("no jail: the code of students could read and change your files")
    for line in report:
        print(f"  {shown(line)}")
    if table.changes:
        print(
            f"{len(table.changes)} cells have changed"
            + ("" if given.regrade else ": see --regrade")
        )
    print("\n".join(f"  {shown(line)}" for line in table.changes if given.regrade))
    if alike:
        print(f"{len(alike)} students with answers that are alike: look at the column `alike`")
    if given.export:
        print(shown(f"for {given.export}: {table.export(given.export)}"))
    print(shown(f"written: {given.output}, {path.name}, feedback for each in {pages}"))
    if any(task.by_hand for task in plan.tasks):
        print(
            "columns that are empty are graded by hand: task, rubric and answer are in the feedback"
        )


if __name__ == "__main__":
    sys.exit(main())
