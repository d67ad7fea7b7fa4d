"""What a chapter asks for: which cells hold and check an answer, and what that is worth.

A function is worth four points. What an open exercise is worth says the text above it: a table
whose rows begin with points, of which those about passing are the program's; or "4 points if the
program says passed"; or, anywhere in a chapter, "by hand: 6 points".
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from symtable import symtable
from typing import Any, NamedTuple

from segmap.files import chapters_folder

from .. import EXERCISES, OPEN_EXERCISES
from ..exercises import Exercise
from ..exercises.open import OwnLog
from ._cases import JUDGED, own_case

Cell = dict[str, Any]
Notebook = dict[str, Any]
#: The calls by which chapters check an answer -> the exercises behind them.
CHECKS: dict[str, Any] = {f"check_{n}": e for n, e in EXERCISES.items()} | OPEN_EXERCISES
#: What an answer that the program judges is worth, all or nothing; a log, where nothing is said.
POINTS, LOG_POINTS = 4, 10
BY_HAND = re.compile(r"\bby hand: (\d+) points", re.IGNORECASE)
#: A row of a rubric, and the words by which the program gives its points.
ROW = re.compile(r"^\|\s*(\d+)\s*\|\s*(.*?)\s*\|\s*$", re.MULTILINE)
PASSES = re.compile(r"\bpass(?:es|ed)?\b")
STATED = re.compile(r"(\d+) points\*? if the program")


class Place(NamedTuple):
    """Where a chapter asks for an answer."""

    #: The call that checks it, `check_compose` for instance.
    check: str
    #: The names that the student defines, in the order of the call.
    answers: tuple[str, ...]
    #: What the check is called with: the name, or a tuple of names.
    given: str
    #: Index of the last cell, up to the call, that defines the first of them, and of the call's.
    written: int
    checked: int


def chapters(wanted: str = "") -> dict[str, Path]:
    """Number -> file of the chapters that are named, "07,17" for instance; of all by default.

    Raises
    ------
    ValueError
        For a number that no chapter has.
    FileNotFoundError
        Where no chapters came with the package.
    """
    files = sorted(chapters_folder().glob("[0-9]*_*.ipynb"))
    paths = {number_of(path.name): path for path in files}
    numbers = [word for word in re.split(r"[,\s]+", wanted) if word]
    unknown = [word for word in numbers if word not in paths]
    if unknown:
        raise ValueError(
            f"no chapter has the number {', '.join(unknown)}; there are {', '.join(paths)}"
        )
    return {number: paths[number] for number in paths if not numbers or number in numbers}


def number_of(file: str) -> str:
    """Number of a chapter by its file: "07" of `07_icp.ipynb`."""
    return file.partition("_")[0]


def read_chapter(path: Path) -> Notebook:
    """A notebook as a dictionary, the source of each cell as one string."""
    notebook: Notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        cell["source"] = "".join(cell["source"])
    return notebook


def places(cells: list[Cell], checks: Iterable[str] = CHECKS) -> list[Place]:
    """The answers that the cells of a chapter ask for, in their order.

    Examples
    --------
    >>> cells = [{"cell_type": "code", "source": "def my_f(x): ..."},
    ...          {"cell_type": "code", "source": "course.check_f(my_f)"}]
    >>> places(cells, ["check_f"])
    [Place(check='check_f', answers=('my_f',), given='my_f', written=0, checked=1)]
    """
    check_names, rows = set(checks), []
    for index, tree in _trees(cells):
        for call in _calls(tree, check_names):
            answer = call.args[0] if len(call.args) == 1 else ast.Tuple(call.args, ast.Load())
            used = [part.id for part in ast.walk(answer) if isinstance(part, ast.Name)]
            names = tuple(
                name for name in dict.fromkeys(used) if _cells_of(cells[: index + 1], name)
            )
            if not names:
                raise ValueError(f"cell {index} checks what no cell before it defines")
            check = ast.unparse(call.func).removeprefix("course.")
            written = _cells_of(cells[: index + 1], names[0])[-1]
            rows.append(Place(check, names, ast.unparse(answer), written, index))
    return rows


def _trees(cells: list[Cell]) -> Iterator[tuple[int, ast.Module]]:
    for index, cell in enumerate(cells):
        if cell["cell_type"] == "code":
            yield index, ast.parse(cell["source"])


def _calls(tree: ast.Module, checks: set[str]) -> Iterator[ast.Call]:
    """Calls of a check that stand by themselves."""
    for node in tree.body:
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            call = node.value
            if ast.unparse(call.func).removeprefix("course.") in checks and call.args:
                yield call


def _cells_of(cells: list[Cell], name: str) -> list[int]:
    """Indices of the cells of code that define a name."""
    code = [index for index, cell in enumerate(cells) if cell["cell_type"] == "code"]
    return [index for index in code if defines(cells[index]["source"], name)]


def defines(source: str, name: str) -> bool:
    """Whether a source defines a function or a variable at its top.

    Examples
    --------
    >>> defines("def my_f(x): ...", "my_f"), defines("a, my_f = my_g = 3, 4", "my_f")
    (True, True)
    >>> defines("print(my_f)", "my_f"), defines("my_f == 3", "my_f")
    (False, False)
    """
    return name in symtable(source, "cell", "exec").get_identifiers() and (
        symtable(source, "cell", "exec").lookup(name).is_assigned()
    )


def parts(cell: Cell) -> tuple[str, str]:
    """The answer and the calls that check it, of a cell that may hold both."""
    lines = cell["source"].splitlines()
    calls = [
        (call.lineno - 1, call.end_lineno or call.lineno)
        for call in _calls(ast.parse(cell["source"]), set(CHECKS))
    ]
    checked = {line for first, last in calls for line in range(first, last)}
    unchecked = "\n".join(line for k, line in enumerate(lines) if k not in checked).strip("\n")
    return unchecked, "\n".join(lines[k] for k in sorted(checked))


# ------------------------------------------------------------------------- what that is worth
class Task(NamedTuple):
    """What a handout asks for: its name, its chapter, its points, the names of the answer.

    A task without an answer is graded by hand. `given` is what the check is called with.
    """

    name: str
    chapter: str
    points: int
    answers: tuple[str, ...] = ()
    given: str = ""

    @property
    def by_hand(self) -> bool:
        """Whether a person gives the points."""
        return not self.answers

    def calls(self, seed: int) -> list[str]:
        """The check that students see, and that on the hidden cases of a seed, if it has some."""
        if self.name in JUDGED:
            seals = own_case(self.name, seed).seals
            check = f"course.{self.name}"
            return [f"{check}.noted({self.given})", f'{check}({self.given}, "{seals}")']
        if self.name not in EXERCISES:
            return [f"course.{self.name}({self.given})"]
        check = f"course.check_{self.name}"
        return [f"{check}({self.given})", f"{check}({self.given}, {check}.hidden({seed}))"]


def tasks_of(name: str, notebook: Notebook) -> list[Task]:
    """The tasks of a chapter, in their order: what is checked, and what is graded by hand."""
    cells, tasks = notebook["cells"], []
    for place in places(cells):
        exercise, own = CHECKS[place.check], column(place, name)
        program, hand = worth(exercise, text_above(cells, place.written))
        if not isinstance(exercise, OwnLog):
            tasks.append((place.checked, Task(own, name, program, place.answers, place.given)))
        if hand:
            tasks.append((place.checked, Task(f"{own}_by_hand", name, hand)))
    for index, cell in enumerate(cells):
        if points := by_hand(cell):
            tasks.append((index, Task(f"by_hand_{number_of(name)}_{index}", name, points)))
    return [task for _, task in sorted(tasks, key=lambda pair: pair[0])]


def column(place: Place, chapter: str) -> str:
    """The name of a task: `compose` for `check_compose`; `own_log_52`, which many chapters ask."""
    own = place.check.removeprefix("check_")
    return f"{own}_{number_of(chapter)}" if own == "own_log" else own


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
    if isinstance(exercise, OwnLog):
        return 0, total or LOG_POINTS
    if rows:
        program = sum(points for points, words in rows if PASSES.search(words))
        return program, total - program
    stated = STATED.search(said) or BY_HAND.search(said)  # half by the program, half by hand
    return int(stated.group(1)) if stated else POINTS, 0


def text_above(cells: list[Cell], index: int) -> str:
    """The text above a cell: what is asked, and what earns how many points."""
    texts = [cell["source"] for cell in cells[:index] if cell["cell_type"] == "markdown"]
    return texts[-1] if texts else ""


def by_hand(cell: Cell) -> int:
    """Points of a task that a person grades; 0 for every other cell."""
    match = BY_HAND.search(cell["source"]) if cell["cell_type"] == "markdown" else None
    return int(match.group(1)) if match else 0
