"""Student copies of the chapters: no outputs, no solutions, a name cell, points, test cells.

The cells carry the metadata of nbgrader (schema 3): a solution cell for each answer, and a locked
test cell with its points. Hidden cases never stand in a copy: they come from a seed, which is
written beside the folder, for the instructor alone.
"""

from __future__ import annotations

import json
import re
import secrets
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from segmap.files import writable, write_bytes

from ... import EXERCISES
from ._given import listed
from ._otter import otter_tests
from ._tasks import Cell, Notebook, Task, chapters, column, parts, places, read_chapter, tasks_of

#: First word of the instructor's file, with the version of its layout.
KIND = "segmap handout 1"
#: Links to files: an image or a page, with its words and what follows a file's name.
LINK = re.compile(r"(!?)\[([^\]\n]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")


def handout(
    folder: Path, *, wanted: str = "", seed: int | None = None, otter: bool = False
) -> tuple[Path, list[Task]]:
    """Write student copies of chapters into a new folder, and the instructor's file beside it.

    The folder must not exist, or be empty, and `wanted` are numbers of chapters, "34,54"; all by
    default. The seed is that of the hidden cases, by default 128 bits that nobody can guess. What
    is returned is the instructor's file, which must stay out of the folder that students
    get, and the tasks. `otter` writes tests for otter-grader beside the folder, too.

    Raises
    ------
    ValueError
        For a chapter that does not exist, a seed below 0, or a folder that holds something.
    """
    seed = secrets.randbits(128) if seed is None else seed
    if seed < 0:
        raise ValueError(f"the seed must be a whole number from 0 on, got {seed}")
    chosen, key = chapters(wanted), folder.with_name(f"{folder.name}.instructor.json")
    tests = folder.with_name(f"{folder.name}.otter")
    for new in (folder, *([tests] if otter else [])):
        refuse_old(new)
    if key.exists():
        raise ValueError(f"{key} is there already, with the seed of a handout: move it away first")
    if folder.parent.is_dir():
        writable(key)
    notebooks = {path.name: read_chapter(path) for path in chosen.values()}
    tasks = [task for name, book in notebooks.items() for task in tasks_of(name, book)]
    copies = {n: student_copy(n, book, notebooks) for n, book in notebooks.items()}
    write_folder(folder, {n: text(copy) for n, copy in copies.items()})
    if otter:
        write_folder(tests, otter_tests(tasks, seed))
    held = {"format": KIND, "seed": seed, "tasks": [task._asdict() for task in tasks]}
    write_bytes(key, (json.dumps(held, indent=1) + "\n").encode())
    key.chmod(0o600)
    return key, tasks


def refuse_old(folder: Path) -> None:
    """Refuse to write over something, which may be a student's work.

    Raises
    ------
    ValueError
        Where the folder is a file, or holds something.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file: name a new folder")
    if folder.is_dir() and any(folder.iterdir()):
        held = ", ".join(sorted(path.name for path in folder.iterdir())[:3])
        raise ValueError(f"{folder} holds {held} already: name a new folder, or empty this one")


def write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write a folder whole, or not at all."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    part = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir()
    try:
        for name, data in files.items():
            (part / name).parent.mkdir(exist_ok=True)
            write_bytes(part / name, data)
        part.replace(folder)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def text(notebook: Notebook) -> bytes:
    """A notebook as it stands in its file."""
    return (json.dumps(notebook, indent=1, ensure_ascii=False) + "\n").encode()


# ------------------------------------------------------------------------------ a student's copy
def student_copy(name: str, notebook: Notebook, handed: Iterable[str]) -> Notebook:
    """A chapter as students get it; `handed` are the files that its links may lead to."""
    tasks = {task.name: task for task in tasks_of(name, notebook)}
    asked = {place.checked: place for place in places(notebook["cells"])}
    written = {place.written: column(place, name) for place in asked.values()}
    cells: list[Cell] = []
    for index, cell in enumerate(notebook["cells"]):
        if index in asked:
            own = column(asked[index], name)
            cells += checked_cells(cell, own, tasks, index in written)
        elif index in written:
            cells += answer_cells(cell["source"], written[index], tasks)
        elif cell["cell_type"] == "markdown":
            cells.append(markdown(cell["id"], with_links(cell["source"], set(handed))))
            cells += hand_cells(tasks.get(f"by_hand_{name[:2]}_{index}"))
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
        "An answer is graded by itself: its cell runs after the imports of the chapter, and "
        "without the other cells. Save this notebook under its own name, and hand it in. "
        "Chapters that are named without a link are not part of this handout; "
        "`segmap notebooks FOLDER` copies all of them.",
    )


def checked_cells(cell: Cell, name: str, tasks: Mapping[str, Task], both: bool) -> list[Cell]:
    """The cell with the check; before it the answer, where both stood in one cell."""
    answer, check = parts(cell)
    found = answer_cells(answer, name, tasks) if both else []
    found.append(code(f"{name}-check", check))
    points = tasks[name].points if name in tasks else 0
    if points:
        test = code(f"{name}-test", f"{points} * bool({check.strip()})  # points: do not change")
        test["metadata"] = nbgrader(f"{name}-test", points, grade=True, locked=True)
        found.append(test)
    return [*found, *hand_cells(tasks.get(f"{name}_by_hand"))]


def answer_cells(source: str, name: str, tasks: Mapping[str, Task]) -> list[Cell]:
    """What an answer is worth, and the cell for it."""
    known = [tasks[own] for own in (name, f"{name}_by_hand") if own in tasks]
    said = [
        f"**{task.points} points** {'by hand' if task.by_hand else 'by the program'}"
        for task in known
        if task.points
    ]
    exercise = EXERCISES.get(name)
    said += [f"of segmap it may call {listed(exercise)}"] if exercise else []
    cell = code(f"{name}-answer", source)
    cell["metadata"] = nbgrader(f"{name}-answer", solution=True)
    return [markdown(f"{name}-points", f"`{name}`: {'; '.join(said)}"), cell]


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
    found = {"grade": grade, "grade_id": name, "locked": locked, "schema_version": 3}
    worth = {} if points is None else {"points": points}
    return {"nbgrader": {**found, **worth, "solution": solution, "task": False}}


def markdown(name: str, source: str) -> Cell:
    """A cell of text."""
    return {"cell_type": "markdown", "id": name, "metadata": {}, "source": source}


def code(name: str, source: str, metadata: dict[str, Any] | None = None) -> Cell:
    """A cell of code that was not run."""
    kept = {"metadata": metadata or {}, "source": source}
    return {"cell_type": "code", "execution_count": None, "id": name, **kept, "outputs": []}


def with_links(source: str, handed: set[str]) -> str:
    """A text whose links lead to files of the handout only: of others the words stay.

    Examples
    --------
    >>> with_links("see [34](34_icp.ipynb#steps), [54](54_fusion.ipynb)", {"54_fusion.ipynb"})
    'see 34, [54](54_fusion.ipynb)'
    """

    def kept(match: re.Match[str]) -> str:
        target = match.group(3)
        inside = target in handed or "://" in target
        return match.group() if inside else match.group(2)

    return LINK.sub(kept, source)
