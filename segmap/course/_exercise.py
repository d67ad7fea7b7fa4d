"""Exercises: a student's function is compared with the library's; each known mistake has a hint."""

from __future__ import annotations

import copy
import html
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..angles import axial_difference
from ..arrays import Array
from ..plotting import ERROR, TRUTH


@dataclass(frozen=True)
class Check:
    """What a check found: true or false, with a hint.

    Examples
    --------
    >>> Check("compose", False, "turn before you move"), bool(Check("compose", True))
    (not yet: turn before you move, True)
    """

    exercise: str
    passed: bool
    hint: str = ""

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        return "passed" if self.passed else f"not yet: {self.hint}"

    def _repr_html_(self) -> str:
        color, sign = (TRUTH, "&#10003;") if self.passed else (ERROR, "&#10007;")
        style = f"border-left: 4px solid {color}; padding: 4px 10px"
        return f'<div style="{style}">{sign} {html.escape(repr(self))}</div>'


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


@dataclass(frozen=True, repr=False, eq=False)
class Exercise:
    """A function to be written again. Call it with yours: it answers with a `Check`, never raises.

    Parameters
    ----------
    task : str
        The signature, which begins with the name, and what is returned, with shapes and units.
    solution : callable
        The library's function.
    cases : mapping from words to a tuple of arguments
        Chosen so that every mistake gives a wrong answer somewhere.
    mistakes : mapping from a hint to a callable
        Wrong functions that students write, and what to tell them.
    same : callable
        `same(found, expected) -> bool`.

    Examples
    --------
    >>> double = Exercise("double(x) -> 2 x", lambda x: 2 * x, {"x = 3": (3,)},
    ...                   {"twice, not to the power of two": lambda x: x * x})
    >>> double(lambda x: x + x), double(lambda x: x**2), double(lambda x: x)
    (passed, not yet: twice, not to the power of two, not yet: for x = 3 expected 6, got 3)
    """

    task: str
    solution: Callable[..., Any]
    cases: Mapping[str, tuple[Any, ...]]
    mistakes: Mapping[str, Callable[..., Any]]
    same: Callable[[Any, Any], bool] = close

    @property
    def name(self) -> str:
        """The name of the function that is to be written."""
        return self.task.partition("(")[0]

    def __call__(self, function: Callable[..., Any]) -> Check:
        """Check a student's function."""
        hint = self._hint(function)
        return Check(self.name, not hint, hint)

    def __repr__(self) -> str:
        return f"check_{self.name}(your function): {self.task}"

    def _hint(self, function: Callable[..., Any]) -> str:
        """The hint for a function; empty where it is right."""
        if not callable(function):
            return f"give the function itself, check_{self.name}(my_{self.name}), without a call"
        found, expected = self._answers(function), self._answers(self.solution)
        right = [self._agree(*pair) for pair in zip(found, expected, strict=True)]
        if all(right):
            return ""
        if all(answer is None or answer is ... for answer in found):
            return f"it returns nothing yet; the task is {self.task}"
        for hint, mistake in self.mistakes.items():
            if all(map(self._agree, found, self._answers(mistake))):
                return hint
        first = right.index(False)
        return f"for {list(self.cases)[first]} expected {_text(expected[first])}, " + (
            f"but it raised {type(found[first]).__name__}: {found[first]}"
            if isinstance(found[first], Exception)
            else f"got {_text(found[first])}"
        )

    def _answers(self, function: Callable[..., Any]) -> list[Any]:
        return [_answer(function, arguments) for arguments in self.cases.values()]

    def _agree(self, found: Any, expected: Any) -> bool:
        if isinstance(found, Exception) or isinstance(expected, Exception):
            return type(found) is type(expected)
        return _numbers(found) is not None and bool(self.same(found, expected))


def _answer(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """What a function returns for copies of the arguments, or the exception that it raises."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            return function(*copy.deepcopy(arguments))
        except Exception as error:
            return error


def _numbers(answer: Any) -> Array | None:
    """An answer as an array of floats, whatever its shape; None where it is none."""
    try:
        return None if answer is None else np.asarray(answer, float)
    except Exception:  # an answer may be any object at all
        return None


def _pair(found: Any, expected: Any) -> tuple[Array, Array]:
    return np.asarray(found, float), np.asarray(expected, float)


def _text(answer: Any) -> str:
    """An answer to six digits; of a long array the shape and how it starts."""
    array = _numbers(answer)
    if array is None:
        return f"something of type {type(answer).__name__}"
    if array.ndim == 0:
        return f"{float(array):.6g}"
    if array.size > 6:
        return f"an array {array.shape} that starts {_text(array.ravel()[:3])}"
    return f"[{', '.join(_text(part) for part in array)}]"
