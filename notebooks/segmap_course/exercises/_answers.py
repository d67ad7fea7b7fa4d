"""What a function answers to cases, as plain values that go from one process to another as JSON.

An answer is a dictionary with one of these keys:

- `values`, with `shape`: the numbers, flattened;
- `nothing`: the stub, None or `...`;
- `error`, with `message`: the name of the exception that was raised, and what it says;
- `type`: the name of the type of something that is no array of numbers;
- `library`: the function of the library that ran in place of the student's own code.
"""

from __future__ import annotations

import copy
import math
import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from segmap.angles import axial_difference
from segmap.arrays import Array

from ._notice import Watch

#: What one case asks: words -> the arguments.
Cases = Mapping[str, tuple[Any, ...]]
#: A plain answer, as described above.
Answer = dict[str, Any]
#: An answer with more numbers is no answer to an exercise: no file of a gigabyte from a student.
MOST_NUMBERS = 100_000
#: As many characters of the message of an exception are kept.
MOST_WORDS = 300


def answered(
    function: Callable[..., Any], cases: Cases, watch: Watch | None = None
) -> list[Answer]:
    """What a function answers to each case, given copies of its arguments. Raises nothing.

    `watch` holds the functions of the library that must not run meanwhile.
    """
    return [_answer(function, arguments, watch or Watch()) for arguments in cases.values()]


def _answer(function: Callable[..., Any], arguments: tuple[Any, ...], watch: Watch) -> Answer:
    given = copy.deepcopy(arguments)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            with watch:
                found = plain(function(*given))
        except (Exception, SystemExit) as error:
            found = {"error": type(error).__name__, "message": words(error)}
    return {"library": watch.seen} if watch.seen else found


def plain(found: Any) -> Answer:
    """What a function returned, as a plain answer."""
    if found is None or found is ...:
        return {"nothing": True}
    try:
        array = np.asarray(found, float)
    except Exception:  # an answer may be any object at all
        return {"type": type(found).__name__}
    if array.size > MOST_NUMBERS:
        return {"type": f"array of {array.size} numbers"}
    return {"shape": list(array.shape), "values": array.ravel().tolist()}


def words(error: BaseException) -> str:
    """What an exception says, where that is text."""
    try:
        return str(error)[:MOST_WORDS]
    except Exception:  # its own text may fail too
        return "an error without a text"


def numbers(answer: Answer) -> Array | None:
    """The numbers of a plain answer, as an array of its shape; None where it holds none."""
    try:
        values, shape = answer["values"], tuple(map(int, answer["shape"]))
        if len(values) > MOST_NUMBERS or math.prod(shape) != len(values):
            return None
        return np.array([float(value) for value in values]).reshape(shape)
    except Exception:  # it may come from a file that somebody wrote
        return None


def agree(found: Answer, expected: Answer, same: Callable[[Any, Any], bool]) -> bool:
    """Whether two plain answers are the same: numbers by `same`, exceptions by their names."""
    if "error" in found or "error" in expected:
        return found.get("error") == expected.get("error")
    a, b = numbers(found), numbers(expected)
    return a is not None and b is not None and bool(same(a, b))


def text(answer: Answer) -> str:
    """An answer to six digits; of a long array the shape and how it starts."""
    if "error" in answer:
        return f"{answer['error']}: {answer.get('message', '')}"
    array = numbers(answer)
    if array is None:
        return f"something of type {answer.get('type', type(None).__name__)}"
    return _shown(array)


def _shown(array: Array) -> str:
    if array.ndim == 0:
        return f"{float(array):.6g}"
    if array.size > 6:
        return f"an array {array.shape} that starts {_shown(array.ravel()[:3])}"
    return f"[{', '.join(_shown(part) for part in array)}]"


# ------------------------------------------------------------------ when two answers are the same
def close(found: Any, expected: Any) -> bool:
    """Whether two answers have the same shape and values, to nine digits or 1e-9."""
    a, b = _pair(found, expected)
    return a.shape == b.shape and np.allclose(a, b, rtol=1e-9, atol=1e-9, equal_nan=True)


def same_line(found: Any, expected: Any) -> bool:
    """Whether two angles, in radians, are those of one undirected line."""
    a, b = _pair(found, expected)
    return a.shape == () and bool(np.isfinite(a) and abs(axial_difference(a, b)) < 5e-9)


def same_segment(found: Any, expected: Any) -> bool:
    """Whether two answers are one segment `(2, 2)`, whichever end point comes first."""
    a, b = _pair(found, expected)
    return a.shape == (2, 2) and (close(a, b) or close(a[::-1], b))


def same_cells(found: Any, expected: Any) -> bool:
    """Whether both hold the same cells `(n, 2)`, in any order."""
    a, b = _pair(found, expected)
    return a.shape == b.shape and a.ndim == 2 and sorted(a.tolist()) == sorted(b.tolist())


def same_poses(found: Any, expected: Any) -> bool:
    """Whether x and y of `(n, 3)` answers agree, and the angles as those of undirected lines."""
    a, b = _pair(found, expected)
    if a.shape != b.shape or not np.isfinite(a).all():
        return False
    return close(a[..., :2], b[..., :2]) and bool(
        (np.abs(axial_difference(a[..., 2], b[..., 2])) < 1e-9).all()
    )


def _pair(found: Any, expected: Any) -> tuple[Array, Array]:
    return np.asarray(found, float), np.asarray(expected, float)
