"""Open exercises, with more than one right answer: predict and test, break it, a log of one's own.

To add one, write it in a file beside this one and import it in the course's `__init__.py`. Its task
says how near a guess must be, or what input is admitted; a judge refuses other input by
`raise ValueError(...)` and answers with the numbers that the method gave. There
are no hidden cases.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from segmap.arrays import Array

from .._answers import numbers, plain, type_name
from .._exercise import Check


class Open:
    """What all open exercises share: a name."""

    task: str

    @property
    def name(self) -> str:
        """The name in the course, with which the task begins."""
        return self.task.partition("(")[0]

    def __repr__(self) -> str:
        return self.task

    def _check(self, hint: str, praise: str = "") -> Check:
        return Check(self.name, not hint, hint or praise)


@dataclass(frozen=True, repr=False, eq=False)
class Prediction(Open):
    """A number that is written down before it is measured. Call it with the number.

    Examples
    --------
    >>> week = Prediction("predict_week(guess): hours of a week", lambda: 168.0, "h", factor=1.1)
    >>> week(None), week(160)
    (not yet: write your number first, in h, passed: you wrote 160 h, it is 168 h)
    >>> week(24)
    not yet: you wrote 24 h, it is 168 h; near enough is within a factor of 1.1
    """

    #: The call, which begins with the name, then what is asked, the unit, and how near counts.
    task: str
    #: The true value.
    measure: Callable[[], float]
    #: Written after both numbers.
    unit: str
    #: A guess is near enough up to so many times the true value, and down to that part of it,
    factor: float = 1.0
    #: or so far from it.
    within: float = 0.0
    #: One sentence, shown with the true value.
    because: str = ""

    def __call__(self, guess: Any) -> Check:
        """Whether the number is near enough, and what is true. Raises nothing."""
        guess = None if isinstance(guess, bool) else _single(guess)
        if guess is None:
            return self._check(f"write your number first, in {self.unit}")
        true = float(self.measure())
        hint = f"you wrote {guess:.4g} {self.unit}, it is {true:.4g} {self.unit}"
        if not self._near(guess, true):
            hint += f"; near enough is {self._limit()}"
        hint += f". {self.because}" if self.because else ""
        return Check(self.name, self._near(guess, true), hint)

    def _near(self, guess: float, true: float) -> bool:
        if abs(guess - true) <= self.within + 1e-9:
            return True
        low, high = sorted((abs(guess), abs(true)))
        return guess * true > 0 and high <= self.factor * low * (1 + 1e-9)

    def _limit(self) -> str:
        near = [f"within a factor of {self.factor:g}"] if self.factor > 1 else []
        near += [f"within {self.within:g} {self.unit}"] if self.within > 0 else []
        return " or ".join(near) or "the number itself"


def _single(guess: Any) -> float | None:
    """The one finite number of an answer, else None."""
    array = numbers(guess)
    finite = array is not None and array.size == 1 and np.isfinite(array).all()
    return float(array.ravel()[0]) if array is not None and finite else None


@dataclass(frozen=True, repr=False, eq=False)
class Challenge(Open):
    """An input that fools a method. Call it with the input: an array, or a tuple of several.

    Examples
    --------
    >>> even = Challenge("break_parity(n): an odd number that is even",
    ...                  lambda n: "" if n % 2 == 0 else f"{n:.0f} is odd")
    >>> even(None)
    not yet: give your input first; the task is break_parity(n): an odd number that is even
    >>> even(3), even(4), even("four")
    (not yet: 3 is odd, passed, not yet: numbers are wanted, got str)
    """

    #: The call, which begins with the name, then what input is admissible and what fools.
    task: str
    #: From the input: empty where the method is fooled, else the reason why not. It raises
    #: ValueError for an input that is not admissible.
    judge: Callable[..., str]
    #: One sentence, shown when it is done: what this means for who uses the method.
    praise: str = ""

    def __call__(self, given: Any) -> Check:
        """Whether this input, or this tuple of several, fools the method. Raises nothing."""
        answers = [plain(part) for part in (given if isinstance(given, tuple) else (given,))]
        if not answers or any(answer is None for answer in answers):
            return self._check(f"give your input first; the task is {self.task}")
        try:
            with np.errstate(all="ignore"):
                return self._check(str(self.judge(*map(_finite, answers))), self.praise)
        except ValueError as error:
            return self._check(str(error))
        except Exception as error:  # whatever a student gives, the check says what is wrong with it
            return self._check(f"this cannot be judged, {type(error).__name__}: {error}")


def _finite(answer: Any) -> Array:
    array = numbers(answer)
    if array is None:
        raise ValueError(f"numbers are wanted, got {type_name(answer)}")
    if not np.isfinite(array).all():
        raise ValueError("finite numbers are wanted: there are nan or inf among them")
    return array


# ------------------------------------------------------------------------ what is admitted
def admit(given: Array, what: str, least: int, most: int, *, within: float = 20.0) -> Array:
    """Places `(n, 2)`, or segments `(n, 2, 2)` of any other name, as many as are wanted.

    Raises
    ------
    ValueError
        For another shape, too few or too many, and a place far away.
    """
    tail, shape = ((2,), "(n, 2)") if what == "places" else ((2, 2), "(n, 2, 2)")
    if given.shape[1:] != tail or not least <= len(given) <= most:
        raise ValueError(
            f"give {least} to {most} {what}, {shape} in metres, got shape {given.shape}"
        )
    if np.abs(given).max() > within:
        raise ValueError(f"stay within {within:g} m of (0, 0)")
    return given
