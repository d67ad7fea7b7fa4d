"""From a folder of submissions to a table of points, and a page of feedback for each student."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

from segmap.files import shown, write_bytes

from ._jail import Limits
from ._report import Row, class_report, write_feedback, write_table
from ._run import Outcome, Pool, judged, outcome
from ._submissions import Submission, submissions
from .handout import CHECKS, KIND, Task, chapters, read_chapter, tasks_of

#: Answers that run at the same time.
WORKERS = 2


class Plan(NamedTuple):
    """What is graded: the tasks, and the seed of the hidden cases where there is one."""

    tasks: list[Task]
    seed: int | None = None


def read_key(path: Path) -> Plan:
    """The plan of a handout, from the instructor's file.

    Raises
    ------
    ValueError
        For a file that `handout` did not write.
    """
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        tasks = [Task(**task) for task in held["tasks"]]
        kind, seed = held["format"], held["seed"]
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} is no instructor's file of a handout ({error})") from None
    if kind != KIND:
        raise ValueError(f"{path} is written as {kind!r}, this version reads {KIND!r}")
    return Plan([task._replace(answers=tuple(task.answers)) for task in tasks], seed)


def plan_of(wanted: str, seed: int | None) -> Plan:
    """The plan of chapters by their numbers; of all of them by default."""
    found = [
        task
        for path in chapters(wanted).values()
        for task in tasks_of(path.name, read_chapter(path))
    ]
    return Plan(found, seed)


def grade(
    folder: Path,
    output: Path,
    plan: Plan,
    *,
    limits: Limits = Limits(),
    unprotected: bool = False,
    tell: Callable[[str], None] = print,
) -> list[Row]:
    """Grade all submissions of a folder; write the table, and feedback and a report beside it.

    The output is the table, `grades.csv`; feedback goes to `grades_feedback`, what the class found
    hard to `grades_class.txt`. The limits are those of each answer. `unprotected` runs where this
    system keeps no files from a student's code, and `tell` is told which locks hold, and each
    student who is done.

    Raises
    ------
    ValueError
        Without submissions, tasks or, unless `unprotected`, a lock on files.
    """
    handed = submissions(folder)
    if not plan.tasks:
        raise ValueError("the chapters that are graded ask for no answer")
    with Pool(plan.tasks, limits, WORKERS) as pool:
        tell(f"students' code runs under these locks: {pool.locks}")
        if not (pool.locks.files or unprotected):
            raise ValueError(
                "this system would let a student's code change your files. Grade as root in a "
                "container or on Linux 5.13 or later; or, if you have read all of it: --unprotected"
            )
        rows = _rows(handed, plan, pool, tell)
    write_feedback(output.with_name(f"{output.stem}_feedback"), rows, plan.tasks)
    report = "\n".join([*class_report(rows, plan.tasks), ""])
    write_bytes(output.with_name(f"{output.stem}_class.txt"), report.encode("utf-8", "replace"))
    write_table(output, rows, plan.tasks)
    return rows


def _rows(
    handed: Sequence[Submission], plan: Plan, pool: Pool, tell: Callable[[str], None]
) -> list[Row]:
    """Grade each submission; as many answers at a time as there are workers."""
    exercises = {name.removeprefix("check_"): exercise for name, exercise in CHECKS.items()}
    cases = {t.name: cases_of(exercises[t.name], plan.seed) for t in plan.tasks if not t.by_hand}

    def graded(submission: Submission) -> Row:
        found = {}
        for task in plan.tasks:
            if not task.by_hand:
                exercise = exercises[task.name]
                found[task.name] = _one(submission, task, exercise, cases[task.name], pool)
        row = Row(submission, found)
        right = sum(o.right for o in found.values())
        tell(shown(f"{submission.student}: {right} of {len(found)} right"))
        return row

    with ThreadPoolExecutor(WORKERS) as workers:
        return list(workers.map(graded, handed))


def cases_of(exercise: Any, seed: int | None) -> dict[str, Any]:
    """The cases that students see, and the hidden ones of a seed."""
    hidden = {} if seed is None else exercise.fresh(seed)
    seen = getattr(exercise, "cases", {})  # an open exercise has none
    return {**seen, **{f"{words} (hidden case)": v for words, v in hidden.items()}}


def _one(handed: Submission, task: Task, exercise: Any, cases: Any, pool: Pool) -> Outcome:
    """What becomes of one answer."""
    cell = handed.find(task.name, task.answers)
    if cell is None and handed.problems:
        return Outcome("unreadable", "; ".join(handed.problems))
    if cell is None:
        return Outcome("missing", f"no cell defines {' and '.join(task.answers)}")
    found = outcome(exercise, cases, pool.run(task, cell, cases), pool.limits)
    return found if isinstance(found, Outcome) else judged(pool.judge(task, found), pool.limits)
