"""Where the chapters ask for answers: which cell holds an answer, and which checks it."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from segmap.files import chapters_folder

Cell = dict[str, Any]
Notebook = dict[str, Any]


class Place(NamedTuple):
    """Where a chapter asks for an answer.

    Parameters
    ----------
    check : str
        The call that checks it, `check_compose` for instance.
    answers : tuple of str
        The names that the student defines, in the order of the call.
    given : str
        What the check is called with: the name, or a tuple of names.
    written, checked : int
        Index of the cell that defines them, and of the cell with the call.
    """

    check: str
    answers: tuple[str, ...]
    given: str
    written: int
    checked: int


def chapters(wanted: str = "") -> dict[str, Path]:
    """Number -> file of the chapters that are named, "34,54" for instance; of all by default.

    Raises
    ------
    ValueError
        For a number that no chapter has.
    FileNotFoundError
        Where no chapters came with the package.
    """
    found = {path.name[:2]: path for path in sorted(chapters_folder().glob("[0-9][0-9]_*.ipynb"))}
    numbers = [word for word in re.split(r"[,\s]+", wanted.strip()) if word]
    unknown = [word for word in numbers if word not in found]
    if unknown:
        raise ValueError(
            f"no chapter has the number {', '.join(unknown)}; there are {', '.join(found)}"
        )
    return {number: found[number] for number in found if not numbers or number in numbers}


def read_chapter(path: Path) -> Notebook:
    """A notebook as a dictionary, the source of each cell as one string."""
    notebook: Notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        cell["source"] = "".join(cell["source"])
    return notebook


def places(cells: list[Cell], checks: Iterable[str]) -> list[Place]:
    """The answers that the cells of a chapter ask for, in their order.

    Parameters
    ----------
    cells : list of dict
    checks : iterable of str
        The calls that check an answer.

    Examples
    --------
    >>> cells = [{"cell_type": "code", "source": "def my_f(x): ..."},
    ...          {"cell_type": "code", "source": "course.check_f(my_f)"}]
    >>> places(cells, ["check_f"])
    [Place(check='check_f', answers=('my_f',), given='my_f', written=0, checked=1)]
    """
    known, found = set(checks), []
    for index, tree in _trees(cells):
        for call in _calls(tree, known):
            given = call.args[0] if len(call.args) == 1 else ast.Tuple(call.args, ast.Load())
            used = [part.id for part in ast.walk(given) if isinstance(part, ast.Name)]
            names = tuple(
                name for name in dict.fromkeys(used) if _cells_of(cells[: index + 1], name)
            )
            check = ast.unparse(call.func).removeprefix("course.")
            place = Place(check, names, ast.unparse(given), _written(cells, names, index), index)
            found.append(place)
    return found


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


def _written(cells: list[Cell], names: tuple[str, ...], checked: int) -> int:
    """The last cell, up to the check, that defines the first of the names."""
    if not names:
        raise ValueError(f"cell {checked} checks what no cell before it defines")
    return _cells_of(cells[: checked + 1], names[0])[-1]


def _cells_of(cells: list[Cell], name: str) -> list[int]:
    """Indices of the cells of code that define a name."""
    code = [index for index, cell in enumerate(cells) if cell["cell_type"] == "code"]
    return [index for index in code if defines(cells[index]["source"], name)]


def defines(source: str, name: str) -> bool:
    """Whether a source defines a function or a variable, without a look at what else it holds.

    Examples
    --------
    >>> defines("def my_f(x): ...", "my_f"), defines("my_guess = 3", "my_guess")
    (True, True)
    >>> defines("print(my_f)", "my_f"), defines("my_f == 3", "my_f")
    (False, False)
    """
    word = re.escape(name)
    assigned = rf"(?:\w+\s*,\s*)*{word}(?:\s*,\s*\w+)*\s*(?::[^=\n]+)?=(?!=)"
    return bool(re.search(rf"^(?:def {word}\s*\(|{assigned})", source, re.M))


def imports(notebook: Notebook) -> str:
    """The imports at the top of all cells of a chapter, a statement a line."""
    nodes = [node for _, tree in _trees(notebook["cells"]) for node in tree.body]
    found = [ast.unparse(n) for n in nodes if isinstance(n, ast.Import | ast.ImportFrom)]
    return "\n".join(dict.fromkeys(found))


def parts(cell: Cell, checks: Mapping[str, Any] | set[str]) -> tuple[str, str]:
    """The answer and the calls that check it, of a cell that may hold both."""
    lines = cell["source"].splitlines()
    calls = [
        (call.lineno - 1, call.end_lineno or call.lineno)
        for call in _calls(ast.parse(cell["source"]), set(checks))
    ]
    checked = {line for first, last in calls for line in range(first, last)}
    kept = "\n".join(line for k, line in enumerate(lines) if k not in checked).strip("\n")
    return kept, "\n".join(lines[k] for k in sorted(checked))
