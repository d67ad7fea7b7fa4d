"""A number that is written down before the answer is seen, and the answer beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape
from typing import Any


@dataclass(frozen=True)
class Comparison:
    """What was predicted, or None, and what is right: the book compares its reader's number.

    Examples
    --------
    >>> Comparison(6, 4, "steps")
    The answer is 4 steps. You predicted 6: 2 steps too high.
    >>> Comparison(None, 4, "steps")
    The answer is 4 steps. You predicted nothing.
    """

    predicted: float | None
    answer: float
    unit: str

    def __repr__(self) -> str:
        answer = f"The answer is {self.answer:.4g} {self.unit}."
        if self.predicted is None:
            return f"{answer} You predicted nothing."
        off = self.predicted - self.answer
        away = f"{abs(off):.3g} {self.unit} too {'high' if off > 0 else 'low'}"
        return f"{answer} You predicted {self.predicted:.4g}: {away if off else 'just that'}."

    def _repr_html_(self) -> str:
        words = f'data-answer="{self.answer:.4g}" data-unit="{escape(self.unit)}"'
        return f'<p class="answer" {words}>{escape(repr(self))}</p>'


def compare_prediction(predicted: Any, answer: float, unit: str) -> Comparison:
    """The answer to the question of a chapter, and how far off the prediction was.

    It is the last line of the first cell that is tagged `reveal`. The answer is shown with four
    digits.

    Raises
    ------
    ValueError
        Where the prediction is neither a number nor None.

    Examples
    --------
    >>> compare_prediction(0.25, 0.21, "m")
    The answer is 0.21 m. You predicted 0.25: 0.04 m too high.
    """
    if predicted is None:
        return Comparison(None, float(answer), unit)
    try:
        number = float(predicted)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"a prediction must be one number, in {unit}, got {predicted!r}")
    return Comparison(number, float(answer), unit)
