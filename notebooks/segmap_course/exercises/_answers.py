"""What a function answers to cases, and when two answers are the same.

An answer is a plain value, as it comes back from another process too (see `_sandbox_protocol`); or
`Raised`, the exception in its place; or `Other`, for something that is no plain value. The answer
of the stub is None.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from segmap.angles import axial_difference
from segmap.arrays import Array

from .._sandbox_protocol import Other, Raised, decode, encode, reply

#: What one case asks: words -> the arguments.
Cases = Mapping[str, tuple[Any, ...]]


def answered(function: Callable[..., Any], cases: Cases) -> list[Any]:
    """What a function answers to each case, given copies of its arguments. Raises nothing."""
    return [decode(reply(function, plain(arguments))) for arguments in cases.values()]


def plain(value: Any) -> Any:
    """A value as it comes back from another process."""
    return decode(encode(value))


def numbers(answer: Any) -> Array | None:
    """The numbers of an answer, as an array of its shape; None where it holds none."""
    if isinstance(answer, Raised | Other):
        return None
    try:
        array = np.asarray(answer)
    except ValueError:  # lists of several lengths
        return None
    return array.astype(float) if array.dtype.kind in "biuf" else None


def agree(found: Any, expected: Any, same: Callable[[Any, Any], bool]) -> bool:
    """Whether two answers are the same: numbers by `same`, exceptions by their names.

    What holds no numbers agrees with nothing, not with its like either.
    """
    if isinstance(found, Raised) and isinstance(expected, Raised):
        return found.name == expected.name
    a, b = numbers(found), numbers(expected)
    return a is not None and b is not None and bool(same(a, b))


def text(answer: Any) -> str:
    """An answer to six digits; of a long array the shape and how it starts."""
    if isinstance(answer, Raised):
        return f"{answer.name}: {answer.words}"
    array = numbers(answer)
    return f"something of type {type_name(answer)}" if array is None else _shown(array)


def in_full(answer: Any) -> str:
    """An answer with all of its numbers, as many as a page holds; an argument that has none too."""
    if numbers(answer) is not None:
        return np.array2string(np.asarray(answer), precision=6, suppress_small=True, threshold=200)
    return text(answer) if isinstance(answer, Raised | Other) else repr(answer)[:500]


def type_name(answer: Any) -> str:
    """The name of the type of what was answered."""
    return answer.name if isinstance(answer, Other) else type(answer).__name__


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


def near(found: Any, expected: Any) -> bool:
    """The same to 1e-5 of the largest value: for what may be found by minimising, too."""
    a, b = _pair(found, expected)
    return a.shape == b.shape and np.allclose(a, b, rtol=0, atol=1e-5 * np.abs(b).max() + 1e-9)


def same_line(found: Any, expected: Any) -> bool:
    """Whether two angles, radians, are those of one undirected line; minimising is near enough."""
    a, b = _pair(found, expected)
    return a.shape == () and bool(np.isfinite(a) and abs(axial_difference(a, b)) < 1e-5)


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
