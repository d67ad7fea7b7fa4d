"""What a function answers to cases, and when two answers are the same.

An answer is an array of numbers; or `Raised`, the exception in its place; or `Other`, for something
that holds no numbers. The answer of the stub is None.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np

from segmap.angles import axial_difference
from segmap.arrays import Array

#: What one case asks: words -> the arguments.
Cases = Mapping[str, tuple[Any, ...]]


@dataclass(frozen=True)
class Raised:
    """In place of an answer: the exception that was raised, by its name, and its message."""

    name: str
    words: str


@dataclass(frozen=True)
class Other:
    """In place of an answer that holds no numbers: the name of its type."""

    name: str


def answered(function: Callable[..., Any], cases: Cases) -> list[Any]:
    """What a function answers to each case, given copies of its arguments. Raises nothing."""
    return [_answer(function, deepcopy(arguments)) for arguments in cases.values()]


def _answer(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            return plain(function(*arguments))
        except (Exception, SystemExit) as error:
            return Raised(type(error).__name__, str(error)[:300])


def plain(answer: Any) -> Any:
    """The numbers of an answer as an array of its own, or what stands in their place.

    Examples
    --------
    >>> plain([1, 2.5]), plain(...), plain([[1], [2, 3]])
    (array([1. , 2.5]), None, Other(name='list'))
    """
    if answer is None or answer is ...:
        return None
    try:
        array = None if isinstance(answer, str | bytes) else np.array(answer)
        if array is not None and array.dtype.kind not in "biuf":
            array = np.array(answer, float)
    except Exception:  # an answer may be any object at all
        array = None
    return Other(type(answer).__name__) if array is None else array


def numbers(answer: Any) -> Array | None:
    """The numbers of an answer, as an array of its shape; None where it holds none."""
    array = plain(answer)
    return array.astype(float) if isinstance(array, np.ndarray) else None


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


# ---------------------------------- mistakes that any exercise may meet, and where answers differ
#: What to tell -> how the right numbers were changed.
COMMON: dict[str, Callable[[Array], Array]] = {
    "the numbers are right, but angles in degrees: radians are wanted": np.degrees,
    "a number was turned from degrees to radians that was none in degrees": np.radians,
    "the size is right, the sign is the other way round": np.negative,
    "the parts are right, in the other order": lambda right: (
        right[..., ::-1] if right.ndim else right
    ),
    "each is one too many: count from 0, as Python does": lambda right: right + 1,
    "each is one too few": lambda right: right - 1,
    "this is twice the answer": lambda right: 2 * right,
    "this is half of the answer": lambda right: right / 2,
    "this is a thousand times the answer: mind the unit, metres or millimetres": (
        lambda right: 1000 * right
    ),
    "a thousandth of the answer: mind the unit, metres or millimetres": lambda right: right / 1000,
    "this is a hundred times the answer: no per cent, no centimetres": lambda right: 100 * right,
    "this is the rest, 1 minus the answer": lambda right: 1 - right,
    "this is the square of the answer": np.square,
    "this is the root of the answer": lambda right: np.sqrt(np.abs(right)),
    "the last one is missing": lambda right: right[:-1] if right.ndim else right,
    "the first one is missing": lambda right: right[1:] if right.ndim else right,
}
SWAPPED = "the first two arguments are exchanged"


def common_mistake(
    found: Sequence[Any],
    cases: Cases,
    solution: Callable[..., Any],
    same: Callable[[Any, Any], bool],
) -> str:
    """What to tell of answers that are the right ones, changed alike in all cases; "" for none.

    Examples
    --------
    >>> cases = {"one": (0.5,), "another": (2.0,)}
    >>> common_mistake([1.0, 4.0], cases, lambda x: x, close)
    'this is twice the answer'
    """
    right = answered(solution, cases)
    values = [numbers(answer) for answer in right]
    if any(value is None for value in values) or any(isinstance(each, Raised) for each in found):
        return ""
    for hint, change in COMMON.items():
        changed = [np.asarray(change(value)) for value in values if value is not None]
        if _alike(found, changed, same) and not _alike(right, changed, same):
            return hint
    if all(len(inputs) > 1 for inputs in cases.values()):
        other = answered(lambda a, b, *rest: solution(b, a, *rest), cases)
        if _alike(found, other, same) and not _alike(right, other, same):
            return SWAPPED
    return ""


def _alike(one: Sequence[Any], other: Sequence[Any], same: Callable[[Any, Any], bool]) -> bool:
    try:
        return all(agree(a, b, same) for a, b in zip(one, other, strict=True))
    except (IndexError, ValueError):  # an answer of another shape, of which `same` takes parts
        return False


def first_difference(got: Any, right: Any, given: Sequence[Any]) -> str:
    """Of two long arrays of one shape the first place that differs, and what was given there.

    Examples
    --------
    >>> first_difference([0] * 8, [0] * 5 + [1] * 3, (np.arange(8.0),))
    '; they differ first at [5]: 1 is expected, got 0, for 5'
    """
    a, b = numbers(got), numbers(right)
    if a is None or b is None or a.shape != b.shape or a.size <= 6:
        return ""
    apart = np.argwhere(~np.isclose(a, b, rtol=1e-9, atol=1e-9, equal_nan=True))
    if not len(apart):
        return ""
    place = tuple(apart[0].tolist())
    arrays = [
        array
        for array in map(numbers, given)
        if array is not None and array.ndim and len(array) == len(b)
    ]
    inputs = f", for {', '.join(text(array[place[0]]) for array in arrays)}" if arrays else ""
    difference = f"{text(b[place])} is expected, got {text(a[place])}"
    where = ", ".join(map(str, place))
    return f"; they differ first at [{where}]: {difference}{inputs}"


Three = tuple[float, float, float]


@dataclass(frozen=True)
class Surface:
    """The value of a pose: so much for each metre or radian from a point, or away from it.

    A ridge runs through the point: off it the value falls by so much on both sides.
    """

    slope: Three
    point: Three = (0.0, 0.0, 0.0)
    away: tuple[bool, bool, bool] = (False, False, False)
    ridge: Three = (0.0, 0.0, 0.0)

    def __call__(self, pose: Any) -> float:
        """The score of a pose, an array or a tuple of three numbers."""
        off = np.subtract(pose, self.point)
        fallen = abs(float(off @ np.array(self.ridge)))
        return float(np.where(self.away, np.abs(off), off) @ np.array(self.slope)) - fallen
