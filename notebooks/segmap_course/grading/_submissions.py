"""What students handed in: notebooks, read as text, never run here.

A folder holds one notebook a student, `ann.ipynb`, or one folder a student, `ann/34_icp.ipynb`;
the name of the file or folder names the row.
"""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path
from typing import Any, NamedTuple

from .handout import Task, defines

#: A larger file is no notebook of this course, bytes.
MOST_BYTES = 20_000_000
#: The name that a student wrote into the name cell.
NAME = re.compile(r"^\*\*Name:\*\*[ \t]*(\S.*)$", re.MULTILINE)


class Answer(NamedTuple):
    """A cell: the name that the handout gave it, where it is still there, its kind, its text."""

    id: str
    kind: str
    source: str


class Book(NamedTuple):
    """A notebook: its file, when that was written, seconds since 1970, and its cells."""

    file: str
    time: float
    cells: list[Answer]

    def find(self, task: Task) -> str | None:
        """The text of the cell that answers a task; None where there is none.

        Of the cells in which something was written and that define the names that are wanted the
        last one, as in a notebook that runs from top to bottom; but never the answer to another
        task, which may use the same name.
        """
        own = [cell for cell in self.code() if cell.id == f"{task.name}-answer"]
        found = self.written(task) or self.defining(task) or [cell.source for cell in own]
        return found[-1] if found else None

    def code(self) -> list[Answer]:
        """The cells that are no text."""
        return [cell for cell in self.cells if cell.kind == "code"]

    def defining(self, task: Task) -> list[str]:
        """The texts of the cells that define the names of a task."""
        ids = {cell.id for cell in self.code() if cell.id.endswith("-answer")}
        others = ids - {f"{task.name}-answer"}
        texts = [cell.source for cell in self.code() if cell.id not in others]
        return [text for text in texts if all(defines(text, name) for name in task.answers)]

    def written(self, task: Task) -> list[str]:
        """Those in which something was written."""
        return [text for text in self.defining(task) if not is_stub(text, task)]


class Submission(NamedTuple):
    """All that one student handed in, the newest file first; and which could not be read."""

    student: str
    name: str
    books: list[Book]
    problems: list[str]

    def find(self, task: Task) -> tuple[str | None, str]:
        """The text of the cell that answers a task, and which file it is from, if several do.

        The newest file counts in which something was written.
        """
        held = [(book.file, text) for book in self.books if (text := book.find(task)) is not None]
        written = [(file, text) for file, text in held if not is_stub(text, task)]
        if not held:
            return None, ""
        file, text = (written or held)[0]
        book = next(book for book in self.books if book.find(task) == text)
        said = [f"{file} counts, the newest of {len(written)} files that answer it"]
        said = said if len({text for _, text in written}) > 1 else []
        if (count := len(set(book.written(task)))) > 1:
            said += [f"the last of {count} cells that answer it counts"]
        return text, f"{task.name}: {', '.join(said)}" if said else ""

    def beside(self, text: str) -> list[str]:
        """The other cells of code of the notebook that holds this one."""
        held = ([cell.source for cell in book.code()] for book in self.books)
        return [each for each in next((h for h in held if text in h), []) if each != text]

    def written(self, task: str) -> str | None:
        """What was written below a task that a person grades; None where its cell is gone."""
        ids = (f"{task.removesuffix('_by_hand')}-answer", task)
        found = [cell.source for book in self.books for cell in book.cells if cell.id in ids]
        return "\n\n".join(found) if found else None


def is_stub(source: str, task: Task) -> bool:
    """Whether a text is what was handed out, but for comments and spaces."""
    return source == task.stub or code_of(source) == code_of(task.stub)


def code_of(source: str) -> str:
    """A text without what Python does not see; the text itself where it is no Python."""
    try:
        return ast.dump(ast.parse(source))
    except Exception:  # no Python, too deep, or a number that is too long to be written
        return source


def submissions(folder: Path) -> list[Submission]:
    """The submissions in a folder, sorted by student.

    Raises
    ------
    ValueError
        For a folder without any, or with two of one name.
    """
    if not folder.is_dir():
        raise ValueError(f"{folder} is no folder: name the one that holds the submissions")
    found = [submission(path) for path in sorted(folder.iterdir()) if _counts(path)]
    if not found:
        raise ValueError(
            f"{folder} holds no submission: expected a notebook a student (ann.ipynb), "
            "or a folder a student (ann/34_icp.ipynb)"
        )
    students = [each.student for each in found]
    twice = sorted({name for name in students if students.count(name) > 1})
    if twice:
        raise ValueError(f"{folder} holds a file and a folder named {', '.join(twice)}")
    return found


def _counts(path: Path) -> bool:
    """Whether a path is a submission: links may lead anywhere, and do not count."""
    if path.name.startswith(".") or path.is_symlink():
        return False
    return path.is_dir() or path.suffix == ".ipynb"


def submission(path: Path) -> Submission:
    """What one student handed in: a notebook, or a folder of them."""
    found = sorted(path.rglob("*.ipynb")) if path.is_dir() else [path]
    files = [p for p in found if not p.is_symlink() and ".ipynb_checkpoints" not in p.parts]
    problems = [] if files else ["the folder holds no notebook"]
    books, names = [], []
    for file in files:
        try:
            cells = _cells(file)
            answers = [
                Answer(_id(cell), str(cell.get("cell_type")), _source(cell)) for cell in cells
            ]
            books.append(Book(file.name, file.stat().st_mtime, answers))
            names.append(_name(answers))
        except Exception as error:  # a file of a student may hold anything
            problems.append(f"{file.name} cannot be read: {error}"[:300])
    student = path.name if path.is_dir() else path.stem
    books.sort(key=lambda book: -book.time)
    return Submission(student, next(filter(None, names), ""), books, problems)


def _cells(file: Path) -> list[dict[str, Any]]:
    """The cells of a notebook.

    Raises
    ------
    ValueError
        Where it is none.
    """
    if not file.is_file() or file.stat().st_size > MOST_BYTES:
        raise ValueError(f"expected a file of at most {MOST_BYTES // 1_000_000} MB")
    try:
        found = json.loads(file.read_text(encoding="utf-8-sig"))
        cells = found["cells"]
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise ValueError(f"it is no notebook ({type(error).__name__}: {error})") from None
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise ValueError("it is no notebook (its cells are no list)")
    return cells


def _id(cell: dict[str, Any]) -> str:
    meta = cell.get("metadata")
    grader = meta.get("nbgrader") if isinstance(meta, dict) else None
    named = grader.get("grade_id") if isinstance(grader, dict) else None
    return str(named or cell.get("id", ""))


def _source(cell: dict[str, Any]) -> str:
    source = cell.get("source", "")
    text = "".join(map(str, source)) if isinstance(source, list) else str(source)
    return text.removeprefix("\ufeff")


def _name(cells: list[Answer]) -> str:
    texts = [cell.source for cell in cells if cell.kind == "markdown"]
    found = [match.group(1).strip()[:100] for text in texts if (match := NAME.search(text))]
    return found[0] if found else ""
