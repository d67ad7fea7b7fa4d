"""What grading found: a table with a row a student, and a page a student, in which nothing runs."""

from __future__ import annotations

import ast
import csv
import hashlib
import html
import io
import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import datetime
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

from segmap.files import shown, table_text, write_bytes

from ._submissions import Submission, code_of, is_stub
from .handout import Task

#: A cell of a table that begins so would be a formula in a spreadsheet.
FORMULA = ("=", "+", "-", "@", "\t", "\r")
#: What became of an answer that was not given, and of one that nobody could judge.
UNANSWERED, UNJUDGED = ("empty", "missing"), ("unreadable", "not graded")
#: Answers are nearly equal where they share so much of their runs of five marks, and have so many.
ALIKE, LEAST_MARKS = 0.9, 40
#: Points that a person gives or takes beside those of the tasks.
EXTRA = "extra_by_hand"
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width"><title>{title}</title>
<style>
body {{ font: 16px/1.5 sans-serif; max-width: 48em; margin: 2em auto; padding: 0 1em }}
section {{ border-left: 4px solid #bbb; padding: 0 1em; margin: 1.5em 0 }}
.right {{ border-color: #009e73 }} .wrong {{ border-color: #d55e00 }}
pre {{ background: #f5f5f5; padding: .7em; overflow-x: auto; white-space: pre-wrap }}
</style></head><body>
<h1>{title}</h1>
<p>{summary}</p>
{sections}
</body></html>
"""


class Outcome(NamedTuple):
    """What became of an answer: its kind in one word, the reason, and its share of the points.

    `cases` are those that students see and that have another answer, in full.
    """

    kind: str
    reason: str
    share: float = 0.0
    cases: str = ""

    @property
    def right(self) -> bool:
        """Whether it earns all."""
        return self.kind == "right"


class Row(NamedTuple):
    """A submission, what became of each of its answers, and the jail that these ran in."""

    submission: Submission
    outcomes: Mapping[str, Outcome]
    jail: str = ""

    def points(self, tasks: Sequence[Task]) -> float:
        """The points that the program gives."""
        return sum(self.gained(task) for task in tasks)

    def gained(self, task: Task) -> float:
        """The points that the program gives for a task."""
        return 0 if task.by_hand else task.points * self.outcomes[task.name].share

    def cell(self, task: Task) -> str:
        """The points of a task; where the program gives none, what it says."""
        return f"{self.gained(task):g}" if task.points else self.outcomes[task.name].kind


# ----------------------------------------------------------------------------- the table
class Table:
    """The table in its file, written anew with each student.

    What a person wrote is kept: the columns that end in `_by_hand`, those that are not ours, and
    the rows of students who did not hand in this time. `changes` are the cells that are not what
    they were.

    Raises
    ------
    ValueError
        For a file that is no such table.
    """

    def __init__(self, path: Path, tasks: Sequence[Task], deadline: datetime | None = None) -> None:
        self.path, self.tasks, self.deadline = path, tasks, deadline
        self.rows: dict[str, dict[str, str]] = {}
        self.changes: list[str] = []
        self.head = ["student", "name", "points", "of", *(task.name for task in tasks), EXTRA]
        self.head += ["total", "reasons", *(["late"] if deadline else []), "alike", "jail", "notes"]
        if path.exists():
            text = path.read_text(encoding="utf-8-sig", errors="replace")
            found = list(csv.DictReader(io.StringIO(text, newline="")))
            if not found or "student" not in found[0]:
                raise ValueError(f"{path} is there already, and is no table of grades")
            self.rows = {row["student"]: {k: v or "" for k, v in row.items() if k} for row in found}
            self.head += [name for name in found[0] if name and name not in self.head]
        self.of = f"{sum(task.points for task in tasks if not task.by_hand):g}"
        self.ours = ["points", *(task.name for task in tasks if not task.by_hand)]

    def add(self, row: Row, alike: str = "") -> None:
        """Put in the row of a student, and write."""
        student = safe(row.submission.student)
        old = self.rows.get(student, {})
        notes = [row.submission.find(task)[1] for task in self.tasks if not task.by_hand]
        found = {
            **{"student": student, "name": safe(row.submission.name), "of": self.of},
            **{task.name: row.cell(task) for task in self.tasks if not task.by_hand},
            **{"points": f"{row.points(self.tasks):g}", "reasons": safe(reasons(row))},
            **{"alike": alike, "jail": row.jail, "notes": safe("; ".join(filter(None, notes)))},
        }
        if self.deadline:
            found["late"] = late(row.submission, self.deadline)
        if not alike:
            self.changes += [
                f"{student} {name}: {old[name]} -> {found[name]}"
                for name in self.ours
                if name in old and old[name] != found[name]
            ]
        new = {name: "" for name in self.head} | old | found
        hand = [number(new[name]) for name in self.head if name.endswith("_by_hand")]
        self.rows[student] = new | {"total": f"{row.points(self.tasks) + sum(hand):g}"}
        self.write()

    def write(self) -> None:
        """Write all rows, sorted by student."""
        rows = [self.rows[student] for student in sorted(self.rows)]
        table = [self.head, *([row.get(name, "") for name in self.head] for row in rows)]
        write_bytes(self.path, table_text(table).encode("utf-8", "replace"))

    def export(self, kind: str) -> Path:
        """Write the totals as Moodle or Canvas import them; the file.

        Both name a student in the file that is handed in: `Ann_123_assignsubmission_file` is
        participant 123 of Moodle, `ann_123_456_x` is user 123 of Canvas.
        """
        path = self.path.with_name(f"{self.path.stem}_{kind}.csv")
        rows = [[row["student"], row["name"], row.get("total", "")] for row in self.rows.values()]
        if kind == "moodle":
            table = [["Identifier", "Full name", "Grade"]]
            for student, name, total in rows:
                found = re.search(r"_(\d+)_assignsubmission_", student)
                table.append([f"Participant {found[1]}" if found else student, name, total])
        else:
            title, blank = self.path.stem, [""] * 3
            table = [["Student", "ID", "SIS User ID", "SIS Login ID", "Section", title]]
            table.append(["    Points Possible", "", *blank, self.of])
            for student, name, total in rows:
                found = re.search(r"_(?:late_)?(\d+)_\d+", student)
                known = [name or student, found[1] if found else "", "", student, ""]
                table.append([*known, total])
        write_bytes(path, table_text(table).encode("utf-8", "replace"))
        return path


def number(cell: str) -> float:
    """The points in a cell that a person filled; 0 for anything else."""
    try:
        return float(cell.removeprefix("'").replace(",", "."))
    except ValueError:
        return 0.0


def gradescope(row: Row, tasks: Sequence[Task]) -> str:
    """What Gradescope reads as `results.json`: a test for each task that the program grades."""
    tests = [
        {
            **{"name": task.name, "score": row.gained(task), "max_score": task.points},
            **{"status": "passed" if row.outcomes[task.name].right else "failed"},
            **{"output": f"{_told(row, task)}\n\n{row.outcomes[task.name].cases}".strip()},
            **{"visibility": "visible"},
        }
        for task in tasks
        if not task.by_hand
    ]
    return json.dumps({"output": "; ".join(row.submission.problems), "tests": tests}, indent=1)


def late(handed: Submission, deadline: datetime) -> str:
    """By how many hours the newest file was written after the deadline; empty for in time."""
    hours = (max((b.time for b in handed.books), default=0) - deadline.timestamp()) / 3600
    return f"{hours:.1f} h" if hours > 0 else ""


def reasons(row: Row) -> str:
    """In one line why answers have no points, and which files could not be read."""
    lost = [f"{name}: {o.kind}" for name, o in row.outcomes.items() if not o.right]
    return " ".join("; ".join([*lost, *row.submission.problems]).split())


def safe(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula.

    Examples
    --------
    >>> safe("=1+1"), safe("ann")
    ("'=1+1", 'ann')
    """
    return f"'{cell}" if cell.startswith(FORMULA) else cell


# ----------------------------------------------------------------------------- the class
def class_report(rows: Sequence[Row], tasks: Sequence[Task]) -> list[str]:
    """For each task how many are right, unanswered and wrong; and why, the commonest first."""
    lines = []
    for task in tasks:
        if not task.by_hand:
            found = [row.outcomes[task.name] for row in rows]
            counts = Counter(map(_side, found))
            said = [f"{counts.pop('right', 0)} of {len(found)} right"]
            said += [f"{counts[side]} {side}" for side in sorted(counts)]
            lines.append(f"{task.name}: {', '.join(said)}")
            lost = Counter(_shared(o) for o in found if not o.right)
            lines += [f"  {count} x {shown(why)}" for why, count in lost.most_common()]
    return lines


def _side(found: Outcome) -> str:
    """On which side of the count an answer stands."""
    sides = {"right": "right"} | dict.fromkeys(UNANSWERED, "unanswered")
    return (sides | dict.fromkeys(UNJUDGED, "not judged")).get(found.kind, "wrong")


def _shared(found: Outcome) -> str:
    """A reason without what this student's function answered."""
    said = re.split(r", got |, but it raised ", found.reason)[0]
    return " ".join(f"{found.kind}: {said}".rstrip(": ").split())


def duplicates(rows: Sequence[Row], tasks: Sequence[Task]) -> dict[str, str]:
    """Student -> whose answers to which tasks are equal or nearly so: for a person to look at."""
    found: dict[str, list[str]] = {}
    for task in tasks:
        texts = {row.submission.student: row.submission.find(task)[0] for row in rows}
        written = {s: text for s, text in texts.items() if text and not is_stub(text, task)}
        runs = {student: _runs(text) for student, text in written.items()}
        for a, b in () if task.by_hand else combinations(runs, 2):
            shared = len(runs[a] & runs[b])
            near = shared >= ALIKE * len(runs[a] | runs[b]) and shared >= LEAST_MARKS
            if near or code_of(written[a]) == code_of(written[b]):
                found.setdefault(a, []).append(f"{task.name}: {b}")
                found.setdefault(b, []).append(f"{task.name}: {a}")
    return {student: "; ".join(said)[:1000] for student, said in found.items()}


def _runs(source: str) -> set[tuple[str, ...]]:
    """Runs of five marks of a program, in which the names of variables mean nothing."""
    try:
        marks = [
            getattr(node, "attr", None) or repr(getattr(node, "value", type(node).__name__))
            if isinstance(node, ast.Attribute | ast.Constant)
            else type(node).__name__
            for node in ast.walk(ast.parse(source))
            if not isinstance(node, ast.expr_context)
        ]
    except Exception:  # no Python, too deep, or a number that is too long to be written
        return set()
    return {tuple(marks[k : k + 5]) for k in range(len(marks) - 4)}


# ----------------------------------------------------------------------------- feedback
def write_feedback(folder: Path, row: Row, tasks: Sequence[Task]) -> None:
    """The page of a student, named as the submission; what is the student's is shown as text."""
    folder.mkdir(exist_ok=True)
    name = row.submission.student
    if len(name.encode("utf-8", "replace")) > 200:  # longer than a name of a file may be
        name = f"{name[:40]}_{hashlib.sha256(name.encode('utf-8', 'replace')).hexdigest()[:16]}"
    write_bytes(folder / f"{name}.html", page(row, tasks).encode("utf-8", "replace"))


def page(row: Row, tasks: Sequence[Task]) -> str:
    """The feedback for one student, as HTML."""
    handed = row.submission
    title = f"{handed.student}, {handed.name}" if handed.name else handed.student
    most = sum(task.points for task in tasks if not task.by_hand)
    hand = sum(task.points for task in tasks if task.by_hand)
    summary = [f"{row.points(tasks):g} of {most} points."]
    summary += [f"Up to {hand} more are given by hand."] if hand else []
    summary += handed.problems
    sections = "\n".join(_section(row, task) for task in tasks)
    said = html.escape(" ".join(summary))
    return PAGE.format(title=html.escape(title), summary=said, sections=sections)


def _section(row: Row, task: Task) -> str:
    """What became of an answer; of what a person grades the rubric, and what the student wrote."""
    if task.by_hand:
        written = row.submission.written(task.name)
        head = f"{task.name}: graded by hand, up to {task.points} points"
        said = "<p>Nothing was handed in.</p>" if written is None else _code(written)
        return f"<section><h2>{html.escape(head)}</h2>{_code(task.rubric)}{said}</section>"
    found = row.outcomes[task.name]
    answer, _ = row.submission.find(task)
    head = f"{task.name}: {row.gained(task):g} of {task.points} points"
    return (
        f'<section class="{_side(found).replace(" ", "-")}"><h2>{html.escape(head)}</h2>'
        f"<p>{html.escape(_told(row, task))}</p>{_code(found.cases)}{_code(answer or '')}</section>"
    )


def _told(row: Row, task: Task) -> str:
    """What a student is told of an answer."""
    found, (_, note) = row.outcomes[task.name], row.submission.find(task)
    said = f"{found.kind.capitalize()}: {found.reason[:1000]}" if found.reason else "Right."
    return said + (f" ({note})" if note else "")


def _code(text: str) -> str:
    """Text of a student or a chapter, in which no mark of HTML means anything."""
    return f"<pre>{html.escape(text[:20_000])}</pre>" if text else ""
