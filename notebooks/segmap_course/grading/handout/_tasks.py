"""What a chapter asks for, and what that is worth: by the program, and by hand.

A function is worth four points. What an open exercise is worth says the text above it: a table
whose rows begin with points, of which those about passing are the program's; or "4 points if the
program says passed"; or, anywhere in a chapter, "by hand: 6 points".
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from ...exercises import Exercise
from ...exercises.open import Prediction
from ._places import Cell, Notebook, Place, imports, places

#: What an answer that the program judges is worth, all or nothing; a log, where nothing is said.
POINTS, LOG_POINTS = 4, 10
BY_HAND = re.compile(r"\bby hand: (\d+) points", re.IGNORECASE)
#: A row of a rubric, and the words by which the program gives its points.
ROW = re.compile(r"^\|\s*(\d+)\s*\|\s*(.*?)\s*\|\s*$", re.MULTILINE)
PASSES = re.compile(r"\bpass(?:es|ed)?\b")
STATED = re.compile(r"(\d+) points\*? if the program")


class Task(NamedTuple):
    """What a handout asks for: its column, its chapter, its names, its points, who grades it."""

    name: str
    chapter: str
    answers: tuple[str, ...]
    points: int
    imports: str = ""
    given: str = ""
    by_hand: bool = False
    rubric: str = ""


def tasks_of(name: str, notebook: Notebook, checks: Mapping[str, Any]) -> list[Task]:
    """The tasks of a chapter, in their order: what is checked, and what is graded by hand."""
    head, cells = imports(notebook), notebook["cells"]
    found = []
    for place in places(cells, checks):
        said, own = rubric(cells, place.written), column(place, name)
        program, hand = worth(checks[place.check], said)
        if not judged_by_hand(checks[place.check]):
            known = Task(own, name, place.answers, program, head, place.given, rubric=said)
            found.append((place.checked, known))
        if hand:
            found.append((place.checked, _hand(f"{own}_by_hand", name, hand, said)))
    for index, cell in enumerate(cells):
        if points := by_hand(cell):
            said = cell["source"]
            found.append((index, _hand(f"by_hand_{name[:2]}_{index}", name, points, said)))
    return [task for _, task in sorted(found, key=lambda pair: pair[0])]


def _hand(name: str, chapter: str, points: int, said: str) -> Task:
    return Task(name, chapter, (), points, by_hand=True, rubric=said)


def column(place: Place, chapter: str) -> str:
    """The name of a task: `compose` for `check_compose`; `own_log_12`, which many chapters ask."""
    own = place.check.removeprefix("check_")
    return f"{own}_{chapter[:2]}" if own == "own_log" else own


def judged_by_hand(exercise: Any) -> bool:
    """Whether an exercise takes more than numbers: a log, or any object of the student's."""
    return not isinstance(exercise, Exercise | Prediction) and not getattr(
        exercise, "numbers", False
    )


def worth(exercise: Any, said: str) -> tuple[int, int]:
    """Points of an exercise that the program gives, and points that a person gives.

    Examples
    --------
    >>> from segmap_course import check_compose, check_own_log, predict_beams_on_wall
    >>> worth(check_compose, ""), worth(check_own_log, "| 2 | it passes |\\n| 3 | a picture |")
    ((4, 0), (0, 5))
    >>> worth(predict_beams_on_wall, "| 2 | the check passes |\\n| 3 | a reason |")
    (2, 3)
    """
    rows = [(int(points), words) for points, words in ROW.findall(said)]
    total = sum(points for points, _ in rows)
    if isinstance(exercise, Exercise):
        return POINTS, 0
    if judged_by_hand(exercise):
        return 0, total or LOG_POINTS
    if rows:
        program = sum(points for points, words in rows if PASSES.search(words))
        return program, total - program
    stated = STATED.search(said) or BY_HAND.search(said)  # half by the program, half by hand
    return int(stated.group(1)) if stated else POINTS, 0


def rubric(cells: list[Cell], index: int) -> str:
    """The text above a cell: what is asked, and what earns how many points."""
    texts = [cell["source"] for cell in cells[:index] if cell["cell_type"] == "markdown"]
    return texts[-1] if texts else ""


def by_hand(cell: Cell) -> int:
    """Points of a task that a person grades; 0 for every other cell."""
    match = BY_HAND.search(cell["source"]) if cell["cell_type"] == "markdown" else None
    return int(match.group(1)) if match else 0
