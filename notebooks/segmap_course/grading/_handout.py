"""The course folder of nbgrader: what students get, and what they do not.

A source notebook is a chapter without outputs: a cell for the name, the points, each answer with
its solution between the marks of nbgrader, and behind the check a locked cell that gives the
points, with hidden cases of the seed. Of it nbgrader makes the release; when it grades, it puts the
locked cells back.
"""

from __future__ import annotations

import json
import os
import re
import secrets
import subprocess
import sys
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from segmap.files import write_bytes

from ._cases import JUDGED, own_case, with_own_case
from ._otter import otter_tests
from ._solutions import solution
from ._tasks import (
    Cell,
    Notebook,
    Task,
    chapters,
    column,
    number_of,
    parts,
    places,
    read_chapter,
    tasks_of,
)

#: Links to files: an image or a page, with its words and what follows a file's name.
LINK = re.compile(r"(!?)\[([^\]\n]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")
#: The stub of a chapter stays where a solution stood, and runs.
CONFIG = """\
c = get_config()
c.ClearSolutions.code_stub = {"python": "# your code in the stub above"}
"""


def handout(
    folder: Path, *, wanted: str = "", seed: int | None = None, otter: bool = False
) -> list[Task]:
    """Write an assignment of nbgrader, named as the folder, into the course folder around it.

    `wanted` are numbers of chapters, "07,17"; all by default. The seed is that of the hidden cases,
    by default 128 bits that nobody can guess. `course/lab1` writes `course/source/lab1`, whose
    notebooks have solutions and hidden cases, and lets nbgrader make `course/release/lab1`, which
    students get. `otter` writes `course/otter/lab1`, tests for otter-grader, too.

    Raises
    ------
    ValueError
        Without nbgrader, for a chapter that does not exist, an assignment that is there already, or
        one that nbgrader refuses.
    """
    if find_spec("nbgrader") is None:
        raise ValueError("nbgrader makes what students get: pip install nbgrader")
    course, name = folder.parent, folder.name
    seed = secrets.randbits(128) if seed is None else seed
    notebooks = {path.name: read_chapter(path) for path in chapters(wanted).values()}
    tasks = [task for chapter, book in notebooks.items() for task in tasks_of(chapter, book)]
    files: dict[str, str] = {}
    for chapter, book in notebooks.items():
        source = source_notebook(chapter, book, seed, notebooks)
        files[f"source/{name}/{chapter}"] = json.dumps(source, indent=1, ensure_ascii=False) + "\n"
    if otter:
        tests = otter_tests(tasks, seed)
        files |= {f"otter/{name}/{file}": test for file, test in tests.items()}
    for room in ("source", "release", "otter"):
        if (old := course / room / name).exists():
            raise ValueError(f"{old} is there already: choose another name, or remove it")
    if not (course / "nbgrader_config.py").exists():
        files["nbgrader_config.py"] = CONFIG
    for file, text in files.items():
        (course / file).parent.mkdir(parents=True, exist_ok=True)
        write_bytes(course / file, text.encode())
    beside = Path(sys.executable).parent  # nbgrader calls alembic by its name
    run = subprocess.run(
        [sys.executable, "-m", "nbgrader", "generate_assignment", name],
        env=os.environ | {"PATH": f"{beside}{os.pathsep}{os.environ.get('PATH', '')}"},
        cwd=course,
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode:
        raise ValueError(f"nbgrader made no release of {name}:\n{run.stderr}")
    return tasks


# ------------------------------------------------------------------------- a source notebook
def source_notebook(
    chapter: str, notebook: Notebook, seed: int, handed: Iterable[str] = ()
) -> Notebook:
    """A chapter as nbgrader wants it; `handed` are the files that its links may lead to."""
    tasks = {task.name: task for task in tasks_of(chapter, notebook)}
    asked = {place.checked: place for place in places(notebook["cells"])}
    written = {place.written: column(place, chapter) for place in asked.values()}
    cells: list[Cell] = []
    for index, cell in enumerate(with_own_case(notebook["cells"], seed)):
        if index in asked:
            name = column(asked[index], chapter)
            answer, check = parts(cell)
            cells += answer_cells(answer, name, tasks, seed) if index in written else []
            check = check.replace("(", ".noted(", 1) if name in JUDGED else check
            cells += [code(f"{name}-check", check), *test_cells(tasks.get(name), seed)]
            cells += hand_cells(tasks.get(f"{name}_by_hand"))
        elif index in written:
            cells += answer_cells(cell["source"], written[index], tasks, seed)
        elif cell["cell_type"] == "markdown":
            cells.append(markdown(cell["id"], with_links(cell["source"], set(handed))))
            cells += hand_cells(tasks.get(f"by_hand_{number_of(chapter)}_{index}"))
        else:
            cells.append(code(cell["id"], cell["source"], cell["metadata"]))
    cells.insert(1, name_cell(list(tasks.values())))
    return {**notebook, "cells": cells}


def name_cell(tasks: list[Task]) -> Cell:
    """Where a student writes a name, and how many points there are."""
    points = "".join(
        f"- `{task.name}`: {task.points} points{', graded by hand' if task.by_hand else ''}\n"
        for task in tasks
    )
    return markdown(
        "name",
        "**Name:** \n\n**Student number:** \n\n"
        f"Points in this chapter:\n\n{points or '- none'}\n"
        "Save this notebook under its own name, and hand it in. It is graded by running it from "
        "top to bottom, at most 30 s a cell. Chapters that are named without a link are not part "
        "of this handout; `segmap notebooks FOLDER` copies all of them.",
    )


def answer_cells(source: str, name: str, tasks: Mapping[str, Task], seed: int) -> list[Cell]:
    """What an answer is worth, that there is none yet, and the cell for it with its solution."""
    worth = [
        f"**{task.points} points** {'by hand' if task.by_hand else 'by the program'}"
        for own in (name, f"{name}_by_hand")
        if (task := tasks.get(own)) and task.points
    ]
    solved = solution(name, ", ".join(tasks[name].answers)) if name in tasks else "# your own log"
    if name in JUDGED:
        solved = f"{tasks[name].given} = {own_case(name, seed).solution}"
    text = f"{source}\n\n\n### BEGIN SOLUTION\n{solved}\n### END SOLUTION"
    answer = code(f"{name}-answer", text, nbgrader(f"{name}-answer", solution=True))
    points = markdown(f"{name}-points", f"`{name}`: {'; '.join(worth)}")
    names = tasks[name].answers if name in tasks else ()
    none = [f"{answer_name} = ...  # until the next cell has run" for answer_name in names]
    return [points, *([code(f"{name}-none", "\n".join(none))] if none else []), answer]


def test_cells(task: Task | None, seed: int) -> list[Cell]:
    """The locked cell whose value is the points; those of hidden cases take its place."""
    if task is None or not task.points:
        return []
    shown = task.calls(seed)
    lines = [f"{task.points} * bool({shown[0]})  # points: do not change"]
    if len(shown) > 1:
        hidden = f"{task.points} * bool({' and '.join(shown)})"
        lines += ["### BEGIN HIDDEN TESTS", hidden, "### END HIDDEN TESTS"]
    name = f"{task.name}-test"
    return [code(name, "\n".join(lines), nbgrader(name, task.points, grade=True, locked=True))]


def hand_cells(task: Task | None) -> list[Cell]:
    """A cell to write in, for what a person grades."""
    if task is None:
        return []
    cell = markdown(task.name, f"*Write here ({task.points} points, graded by hand).*")
    return [cell | {"metadata": nbgrader(task.name, task.points, grade=True, solution=True)}]


def nbgrader(
    name: str,
    points: int | None = None,
    *,
    grade: bool = False,
    locked: bool = False,
    solution: bool = False,
) -> dict[str, Any]:
    """Metadata of a cell in nbgrader's schema 3."""
    grading = {"grade": grade, "grade_id": name, "locked": locked, "schema_version": 3}
    worth = {} if points is None else {"points": points}
    return {"nbgrader": {**grading, **worth, "solution": solution, "task": False}}


def markdown(name: str, source: str) -> Cell:
    """A cell of text."""
    return {"cell_type": "markdown", "id": name, "metadata": {}, "source": source}


def code(name: str, source: str, metadata: dict[str, Any] | None = None) -> Cell:
    """A cell of code that was not run."""
    body = {"metadata": metadata or {}, "source": source}
    return {"cell_type": "code", "execution_count": None, "id": name, **body, "outputs": []}


def with_links(source: str, handed: set[str]) -> str:
    """A text whose links lead to files of the handout only: of others the words stay.

    Examples
    --------
    >>> with_links("see [07](07_icp.ipynb#steps), [17](17_fusion.ipynb)", {"17_fusion.ipynb"})
    'see 07, [17](17_fusion.ipynb)'
    """

    def kept(match: re.Match[str]) -> str:
        target = match.group(3)
        inside = target in handed or "://" in target
        return match.group() if inside else match.group(2)

    return LINK.sub(kept, source)
