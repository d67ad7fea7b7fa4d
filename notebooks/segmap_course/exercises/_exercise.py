"""Exercises: a student's function is compared with the library's; each known mistake has a hint."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from segmap.plotting import ERROR, TRUTH

from ._answers import Answer, Cases, agree, answered, close, text
from ._notice import Watch

#: Hidden cases are drawn again until every named mistake fails on them, at most so many times.
MOST_DRAWS = 100


@dataclass(frozen=True)
class Check:
    """What a check found: true or false, with a hint, or with what is true.

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
        said = "passed" if self.passed else "not yet"
        return f"{said}: {self.hint}" if self.hint else said

    def _repr_html_(self) -> str:
        color, sign = (TRUTH, "&#10003;") if self.passed else (ERROR, "&#10007;")
        style = f"border-left: 4px solid {color}; padding: 4px 10px"
        return f'<div style="{style}">{sign} {html.escape(repr(self))}</div>'


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
    draw : callable, optional
        `draw(rng) -> cases`: cases like those of the exercise, with other numbers.
    own : tuple of functions and modules
        Where the library has the answer, beside the solution (see `Watch`): a student's function
        that calls it is told to do without. Everything else of the library may be called.

    Examples
    --------
    >>> double = Exercise("double(x) -> 2 x", lambda x: 2 * x, {"x = 3": (3,)},
    ...                   {"twice, not to the power of two": lambda x: x * x})
    >>> double(lambda x: x + x), double(lambda x: x**2), double(lambda x: x)
    (passed, not yet: twice, not to the power of two, not yet: for x = 3 expected 6, got 3)
    """

    task: str
    solution: Callable[..., Any]
    cases: Cases
    mistakes: Mapping[str, Callable[..., Any]]
    same: Callable[[Any, Any], bool] = close
    draw: Callable[[np.random.Generator], Cases] | None = None
    own: tuple[Any, ...] = ()

    @property
    def name(self) -> str:
        """The name of the function that is to be written."""
        return self.task.partition("(")[0]

    def __call__(self, function: Callable[..., Any]) -> Check:
        """Check a student's function on the open cases."""
        return self.check(function)

    def __repr__(self) -> str:
        return f"check_{self.name}(your function): {self.task}"

    def check(self, function: Callable[..., Any], cases: Cases | None = None) -> Check:
        """Check a function on these cases, by default the open ones. Raises nothing."""
        if not callable(function):
            return self._not_yet(
                f"give the function itself, check_{self.name}(my_{self.name}), without a call"
            )
        return self.verdict(self.answers(function, cases), cases)

    def fresh(self, seed: int) -> dict[str, tuple[Any, ...]]:
        """Hidden cases from a seed: every named mistake fails on them.

        Parameters
        ----------
        seed : int
            The same seed gives the same cases, in any process.

        Raises
        ------
        ValueError
            Where the exercise has no rule for more cases.
        """
        if self.draw is None:
            raise ValueError(f"{self.name}: no rule for hidden cases; give Exercise(draw=...)")
        rng = np.random.default_rng(seed)
        for _ in range(MOST_DRAWS):
            cases = dict(self.draw(rng))
            if not self._survivors(cases):
                return cases
        raise ValueError(f"{self.name}: no draw catches {self._survivors(cases)}")

    def answers(self, function: Callable[..., Any], cases: Cases | None = None) -> list[Answer]:
        """What a student's function answers to these cases, as plain values (see `verdict`).

        Runs in the process of the student; the values can be sent as JSON.
        """
        watch = Watch(self.own, self.solution)
        watch.look_into(function)
        return answered(function, self.cases if cases is None else cases, watch)

    def expected(self, cases: Cases | None = None) -> list[Answer]:
        """What the library answers to these cases, by default the open ones, as plain values."""
        return answered(self.solution, self.cases if cases is None else cases)

    def verdict(self, answers: Sequence[Answer], cases: Cases | None = None) -> Check:
        """Judge answers that were found elsewhere: no code of the student runs here.

        Parameters
        ----------
        answers : sequence of dict
            From `answers`, for the same cases; whatever else it holds fails with a hint.
        cases : mapping, optional
            Those that were answered, by default the open ones.
        """
        cases = self.cases if cases is None else cases
        hint = self._hint(answers, cases)
        return Check(self.name, not hint, hint)

    def _not_yet(self, hint: str) -> Check:
        return Check(self.name, False, hint)

    def _hint(self, found: Sequence[Answer], cases: Cases) -> str:
        """The hint for these answers; empty where they are right."""
        if not _well_formed(found, len(cases)):
            return "the answers are not those of the cases: one plain answer for each"
        library = next((answer["library"] for answer in found if "library" in answer), None)
        if library is not None:
            return f"this is the library's; write your own ({library} ran)"
        expected = self.expected(cases)
        right = self._right(found, expected)
        if all(right):
            return ""
        if all("nothing" in answer for answer in found):
            return f"it returns nothing yet; the task is {self.task}"
        for hint, mistake in self.mistakes.items():
            if all(self._right(found, answered(mistake, cases))):
                return hint
        first = right.index(False)
        return f"for {list(cases)[first]} expected {text(expected[first])}, " + (
            f"but it raised {text(found[first])}"
            if "error" in found[first]
            else f"got {text(found[first])}"
        )

    def _right(self, found: Sequence[Answer], expected: Sequence[Answer]) -> list[bool]:
        return [agree(*pair, self.same) for pair in zip(found, expected, strict=True)]

    def _survivors(self, cases: Cases) -> list[str]:
        """The mistakes that answer all these cases like the library."""
        expected = self.expected(cases)
        return [
            hint
            for hint, mistake in self.mistakes.items()
            if all(self._right(answered(mistake, cases), expected))
        ]


def _well_formed(answers: Any, count: int) -> bool:
    return (
        isinstance(answers, list | tuple)
        and len(answers) == count
        and all(isinstance(answer, dict) for answer in answers)
    )
