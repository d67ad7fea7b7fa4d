"""The six functions with which chapter 30 maps: a student's from `my_mapper.py`, where right."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...literal.alignment.plain_mapper import Functions
from .._exercise import MY_MAPPER, Exercise
from ..alignment import check_least_translation, check_move_onto_walls
from ..lines import check_segments_all_round
from ..poses import check_compose, check_edge_error
from ..quadtree import check_cell_of

#: Chapter that asks for the function -> its check.
CHECKS: dict[str, Exercise] = {
    "02": check_compose,
    "03": check_segments_all_round,
    "07": check_move_onto_walls,
    "09": check_least_translation,
    "11": check_edge_error,
    "24": check_cell_of,
}


def check_my_mapper(folder: str | Path = ".") -> Functions:
    """The six functions of `my_mapper.py` in a folder, and a line printed on each.

    Where one is missing or fails its check, the library's takes its place, and the line says so.

    Examples
    --------
    >>> mine = check_my_mapper("no folder")
    compose            (chapter 02): the library's, since there is no my_mapper.py
    segments_all_round (chapter 03): the library's, since there is no my_mapper.py
    move_onto_walls    (chapter 07): the library's, since there is no my_mapper.py
    least_translation  (chapter 09): the library's, since there is no my_mapper.py
    edge_error         (chapter 11): the library's, since there is no my_mapper.py
    cell_of            (chapter 24): the library's, since there is no my_mapper.py
    """
    own, problem = _names_of(Path(folder) / MY_MAPPER)
    functions: dict[str, Callable[..., Any]] = {}
    for chapter, check in CHECKS.items():
        function, why = own.get(check.name), problem
        if function is not None:
            verdict = check(function, check.cases)  # on given cases: nothing is kept again
            why = "" if verdict else f"yours does not pass: {verdict.hint}"
        report = f"the library's, since {why}" if why else "yours"
        print(f"{check.name:18} (chapter {chapter}): {report}")
        functions[check.name] = _in_arrays(check.solution if function is None or why else function)
    return Functions(**functions)


def _in_arrays(function: Callable[..., Any]) -> Callable[..., Any]:
    """The same, with an array where the answer is a list of numbers."""

    def answer(*given: Any) -> Any:
        numbers = function(*given)
        return np.array(numbers, float) if isinstance(numbers, list | tuple) else numbers

    return answer


def _names_of(path: Path) -> tuple[dict[str, Any], str]:
    """What the file defines, and why a function that it lacks is missing."""
    if not path.is_file():
        return {}, f"there is no {MY_MAPPER}"
    names: dict[str, Any] = {}
    try:
        exec(compile(path.read_text("utf-8"), str(path), "exec"), names)  # a student's own file
    except Exception as error:
        return {}, f"{MY_MAPPER} does not run: {type(error).__name__}: {error}"
    return names, f"{MY_MAPPER} does not have it"
