"""What grading found: a table with a row a student, and a page a student, in which nothing runs."""

from __future__ import annotations

import html
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from segmap.files import shown, table_text, write_bytes

from ._run import Outcome
from ._submissions import Submission
from .handout import Task

#: A cell of a table that begins so would be a formula in a spreadsheet.
FORMULA = ("=", "+", "-", "@", "\t", "\r")
#: So many reasons a task stand in the report on a class.
MOST_REASONS = 3
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


class Row(NamedTuple):
    """A submission, and what became of each of its answers."""

    submission: Submission
    outcomes: Mapping[str, Outcome]

    def points(self, tasks: Sequence[Task]) -> int:
        """The points that the program gives."""
        return sum(task.points for task in tasks if self.gained(task))

    def cell(self, task: Task) -> str:
        """The points of a task, empty by hand; where the program gives none, what it says."""
        if task.by_hand:
            return ""
        return (
            str(task.points * self.gained(task)) if task.points else self.outcomes[task.name].kind
        )

    def gained(self, task: Task) -> bool:
        """Whether the answer to a task is right."""
        return task.name in self.outcomes and self.outcomes[task.name].right


def write_table(path: Path, rows: Sequence[Row], tasks: Sequence[Task]) -> None:
    """A row a student, a column a task; what a person grades is left empty.

    Raises
    ------
    OSError, ValueError
        For a path that cannot be written.
    """
    head = ["student", "name", "points", "of", *(task.name for task in tasks), "reasons"]
    most = sum(task.points for task in tasks if not task.by_hand)
    table = [[*map(safe, head)]]
    for row in rows:
        cells = [row.cell(task) for task in tasks]
        known = [row.submission.student, row.submission.name]
        found = [*known, str(row.points(tasks)), str(most), *cells, reasons(row)]
        table.append([*map(safe, found)])
    write_bytes(path, table_text(table).encode("utf-8", "replace"))


def reasons(row: Row) -> str:
    """In one line why answers have no points, and which files could not be read."""
    lost = [f"{name}: {o.kind}" for name, o in row.outcomes.items() if not o.right]
    return " ".join("; ".join([*lost, *row.submission.problems]).split())


def class_report(rows: Sequence[Row], tasks: Sequence[Task]) -> list[str]:
    """For each task how many are right, and the commonest reasons of the others."""
    lines = []
    for task in tasks:
        if not task.by_hand:
            found = [row.outcomes[task.name] for row in rows]
            lines.append(f"{task.name}: {sum(o.right for o in found)} of {len(found)} right")
            lost = Counter(_shared(o) for o in found if not o.right)
            lines += [f"  {count} x {shown(why)}" for why, count in lost.most_common(MOST_REASONS)]
    return lines


def _shared(found: Outcome) -> str:
    """A reason without what differs from student to student."""
    said = found.reason.partition(" expected ")[0] if found.kind == "wrong" else ""
    return " ".join(f"{found.kind}: {said}".rstrip(": ").split())[:150]


def safe(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula.

    Examples
    --------
    >>> safe("=1+1"), safe("ann")
    ("'=1+1", 'ann')
    """
    return f"'{cell}" if cell.startswith(FORMULA) else cell


def write_feedback(folder: Path, rows: Sequence[Row], tasks: Sequence[Task]) -> None:
    """A page a student, named as the submission; everything of the student's is shown as text."""
    folder.mkdir(exist_ok=True)
    for row in rows:
        path = folder / f"{row.submission.student}.html"
        write_bytes(path, page(row, tasks).encode("utf-8", "replace"))


def page(row: Row, tasks: Sequence[Task]) -> str:
    """The feedback for one student, as HTML."""
    handed = row.submission
    title = f"{handed.student}, {handed.name}" if handed.name else handed.student
    most = sum(task.points for task in tasks if not task.by_hand)
    hand = sum(task.points for task in tasks if task.by_hand)
    summary = [f"{row.points(tasks)} of {most} points."]
    summary += [f"Up to {hand} more are given by hand."] if hand else []
    summary += handed.problems
    sections = "\n".join(_section(row, task) for task in tasks)
    shown = html.escape(" ".join(summary))
    return PAGE.format(title=html.escape(title), summary=shown, sections=sections)


def _section(row: Row, task: Task) -> str:
    """What became of an answer; of what a person grades the rubric, and what the student wrote."""
    if task.by_hand:
        written = row.submission.written(task.name)
        head = f"{task.name}: graded by hand, up to {task.points} points"
        said = "<p>Nothing was handed in.</p>" if written is None else _code(written)
        return f"<section><h2>{html.escape(head)}</h2>{_code(task.rubric)}{said}</section>"
    found = row.outcomes[task.name]
    answer = row.submission.find(task.name, task.answers) or ""
    head = f"{task.name}: {task.points * found.right} of {task.points} points"
    passed = found.reason == "passed"
    said = "Right." if passed else f"{found.kind.capitalize()}: {found.reason}"
    return (
        f'<section class="{"right" if found.right else "wrong"}"><h2>{html.escape(head)}</h2>'
        f"<p>{html.escape(said)}</p>{_code(answer)}</section>"
    )


def _code(text: str) -> str:
    """Text of a student or a chapter, in which no mark of HTML means anything."""
    return f"<pre>{html.escape(text[:20_000])}</pre>" if text else ""
