"""Solutions from the library's own source: each as a cell that runs, with all that it calls.

An open exercise gets the number that is true, or an input that fools the method.

All of it is copied but what the task gives, which is imported. So a solution is right when it is
handed in.
"""

from __future__ import annotations

import ast
from pathlib import Path

from ... import EXERCISES, OPEN_EXERCISES
from ...exercises import Exercise
from ...exercises.open import Prediction
from ._given import package
from ._handout import refuse_old, student_copy, text, write_folder
from ._inputs import INPUTS
from ._source import Gatherer
from ._tasks import Notebook, chapters, read_chapter, tasks_of

#: nbgrader leaves out what stands between these lines when it makes the students' version.
BEGIN, END = "### BEGIN SOLUTION", "### END SOLUTION"


def solution(exercise: Exercise, name: str) -> str:
    """A cell that defines `name`, which the student is asked for, by the library's source."""
    gatherer = Gatherer(package(exercise)[1])
    source = gatherer.source(exercise.draw.__module__)  # where it is defined itself
    made = source.nodes[f"check_{exercise.name}"]
    assert isinstance(made, ast.Assign) and isinstance(made.value, ast.Call)
    last = f"{name} = {gatherer.needs(source, made.value.args[1])}"
    head = "\n".join(dict.fromkeys(gatherer.imports))
    return "\n\n\n".join(part for part in [head, *gatherer.parts, last] if part)


def open_answer(name: str, names: str) -> str:
    """A cell with an answer to an open exercise: the true number, or what fools a method."""
    exercise = OPEN_EXERCISES[name]
    if isinstance(exercise, Prediction):
        return f"{names} = {exercise.measure():.6g}  # {exercise.unit}"
    return f"import numpy as np\n\n{names} = {INPUTS[name]}"


def write_solutions(folder: Path, wanted: str = "") -> int:
    """Write chapters with solutions into a new folder, each in one of its own; their number.

    So nbgrader wants them: `source/34_icp/34_icp.ipynb`.

    Raises
    ------
    ValueError
        For a chapter that does not exist, or a folder that holds something.
    """
    refuse_old(folder)
    notebooks = {path.name: read_chapter(path) for path in chapters(wanted).values()}
    copies = {n: solved_copy(n, book) for n, book in notebooks.items()}
    write_folder(folder, {f"{n[:-6]}/{n}": text(copy) for n, copy in copies.items()})
    return len(copies)


def solved_copy(name: str, notebook: Notebook) -> Notebook:
    """A student's copy with each solution below its stub, between the marks of nbgrader."""
    copy = student_copy(name, notebook, {name})
    answers = {f"{task.name}-answer": task for task in tasks_of(name, notebook)}
    for cell in copy["cells"]:
        if task := answers.get(cell["id"]):
            exercise = EXERCISES.get(task.name)
            names = ", ".join(task.answers)
            code = solution(exercise, names) if exercise else open_answer(task.name, names)
            cell["source"] = f"{cell['source']}\n\n\n{BEGIN}\n{code}\n{END}"
    return copy
