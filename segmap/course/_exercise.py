"""Exercises: a student's function against the library's, with a hint for each known mistake."""

import copy
import html
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arrays import Array

#: Green and red as in all pictures; the words say the same.
PASSED, NOT_YET = "#009e73", "#d55e00"


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
        color, sign = (PASSED, "&#10003;") if self.passed else (NOT_YET, "&#10007;")
        style = f"border-left: 4px solid {color}; padding: 4px 10px"
        return f'<div style="{style}">{sign} {html.escape(repr(self))}</div>'


@dataclass(frozen=True)
class Case:
    """Arguments to try, and words for them."""

    words: str
    arguments: tuple[Any, ...]


@dataclass(frozen=True)
class Mistake:
    """A wrong answer that students give, and what to tell them."""

    name: str
    function: Callable[..., Any]
    hint: str


def numbers(answer: Any) -> Array | None:
    """An answer as an array of floats, whatever its shape; None where it is none."""
    try:
        return None if answer is None else np.asarray(answer, float)
    except Exception:  # an answer may be any object at all
        return None


def close(found: Any, expected: Any) -> bool:
    """Whether two answers have the same shape and values, to nine digits or 1e-9."""
    a, b = numbers(found), numbers(expected)
    if a is None or b is None or a.shape != b.shape:
        return False
    return np.allclose(a, b, rtol=1e-9, atol=1e-9)


def same_line(found: Any, expected: Any) -> bool:
    """Whether two angles, in radians, are those of one undirected line."""
    a, b = numbers(found), numbers(expected)
    if a is None or b is None or a.shape != () or not np.isfinite(a - b):
        return False
    return bool(abs(np.exp(2j * (a - b)) - 1) < 1e-8)


@dataclass(frozen=True, repr=False)
class Exercise:
    """A function to be written again. Call it with yours: it answers with a `Check`, never raises.

    Parameters
    ----------
    name : str
        Of the library's function, or of the small one given here.
    task : str
        Its signature and what it returns, with shapes and units.
    solution : callable
    cases : tuple of Case
        Chosen so that every mistake gives a wrong answer somewhere.
    mistakes : tuple of Mistake
    same : callable
        `same(found, expected) -> bool`.

    Examples
    --------
    >>> double = Exercise("double", "double(x) -> 2 x", lambda x: 2 * x, (Case("x = 3", (3,)),),
    ...                   (Mistake("squared", lambda x: x * x, "twice, not to the power of two"),))
    >>> double(lambda x: x + x), double(lambda x: x**2), double(lambda x: x)
    (passed, not yet: twice, not to the power of two, not yet: for x = 3 expected 6, got 3)
    """

    name: str
    task: str
    solution: Callable[..., Any]
    cases: tuple[Case, ...]
    mistakes: tuple[Mistake, ...] = ()
    same: Callable[[Any, Any], bool] = field(default=close)

    def __call__(self, function: Callable[..., Any]) -> Check:
        """Check a student's function."""
        hint = self._hint(function)
        return Check(self.name, not hint, hint)

    def __repr__(self) -> str:
        return f"check_{self.name}(your function): {self.task}"

    def _hint(self, function: Callable[..., Any]) -> str:
        """What to tell the author of a function; nothing where it is right."""
        if not callable(function):
            return f"give the function itself, check_{self.name}(my_{self.name}), without a call"
        found = [_answer(function, case) for case in self.cases]
        expected = [_answer(self.solution, case) for case in self.cases]
        wrong = [
            k for k, pair in enumerate(zip(found, expected, strict=True)) if not self._agree(*pair)
        ]
        if not wrong:
            return ""
        if all(answer is None or answer is ... for answer in found):
            return f"it returns nothing yet; the task is {self.task}"
        for mistake in self.mistakes:
            given = [_answer(mistake.function, case) for case in self.cases]
            if all(map(self._agree, found, given)):
                return mistake.hint
        first = wrong[0]
        return (
            f"for {self.cases[first].words} expected {_text(expected[first])}, {_got(found[first])}"
        )

    def _agree(self, found: Any, expected: Any) -> bool:
        if isinstance(found, Exception) or isinstance(expected, Exception):
            return type(found) is type(expected)
        return self.same(found, expected)


def _answer(function: Callable[..., Any], case: Case) -> Any:
    """What a function returns for copies of the arguments, or the exception that it raises."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            return function(*copy.deepcopy(case.arguments))
        except Exception as error:
            return error


def _got(found: Any) -> str:
    if isinstance(found, Exception):
        return f"but it raised {type(found).__name__}: {found}"
    return f"got {_text(found)}"


def _text(answer: Any) -> str:
    """An answer to six digits; of a long array the shape and how it starts."""
    array = numbers(answer)
    if array is None:
        return f"something of type {type(answer).__name__}"
    if array.ndim == 0:
        return f"{float(array):.6g}"
    if array.size > 6:
        return f"an array {array.shape} that starts {_text(array.ravel()[:3])}"
    return f"[{', '.join(_text(part) for part in array)}]"
