"""Exercise of the chapter on comparing methods: the curve of a method, read at one quality."""

from typing import Any

import numpy as np

from ..arrays import Array
from ..experiments import front, reduction_at
from ._exercise import Case, Exercise, Mistake, numbers


def _same(found: Any, expected: Any) -> bool:
    """Whether two answers are the same number, or both none."""
    a, b = numbers(found), numbers(expected)
    if a is None or b is None or a.shape != b.shape:
        return False
    return np.allclose(a, b, rtol=1e-9, atol=1e-9, equal_nan=True)


def _through_all(points: Array, quality: float) -> float:
    """On lines through every run, in the order of quality."""
    q, r = points[np.argsort(points[:, 0], kind="stable")].T
    return float(np.interp(quality, q, r, right=np.nan))


def _nearest(points: Array, quality: float) -> float:
    return float(points[np.argmin(np.abs(points[:, 0] - quality)), 1])


def _best_that_reaches(points: Array, quality: float) -> float:
    return float(points[points[:, 0] >= quality, 1].max(initial=-np.inf))


def _step(points: Array, quality: float) -> float:
    best = _best_that_reaches(points, quality)
    return best if np.isfinite(best) else np.nan


def _flat_above(points: Array, quality: float) -> float:
    return float(np.interp(quality, *front(points).T))


def _none_below(points: Array, quality: float) -> float:
    ends = front(points)
    return float(np.interp(quality, ends[:, 0], ends[:, 1], left=np.nan, right=np.nan))


def _axes_swapped(points: Array, quality: float) -> float:
    return reduction_at(points[:, ::-1], quality)


#: Quality and reduction of eight runs, two of them beaten, in no order.
_RUNS = np.array(
    [(0.94, 0.30), (0.70, 0.66), (0.88, 0.42), (0.86, 0.35), (0.80, 0.60), (0.55, 0.72), (0.6, 0.5)]
)

check_reduction_at = Exercise(
    "reduction_at",
    "reduction_at(points, quality) -> float: the reduction that a method reaches at a quality, on "
    "straight lines between those of its runs (n, 2), quality and reduction, that no other beats",
    reduction_at,
    tuple(
        Case(f"seven runs at {words}", (_RUNS, quality))
        for words, quality in (
            ("quality 0.84", 0.84),
            ("the quality of a run, 0.70", 0.70),
            ("quality 0.62, next to a bad run", 0.62),
            ("quality 0.95, better than all", 0.95),
            ("quality 0.50, worse than all", 0.50),
        )
    ),
    (
        Mistake(
            "beaten runs",
            _through_all,
            "a run that another one beats in both quality and reduction is not on the curve",
        ),
        Mistake("nearest run", _nearest, "take the place between two runs, not the nearest run"),
        Mistake(
            "a staircase",
            _step,
            "between two runs the curve is a straight line, not a step",
        ),
        Mistake(
            "flat above",
            _flat_above,
            "above the best quality of all runs nothing has been reached: nan",
        ),
        Mistake(
            "nothing below",
            _none_below,
            "a map that is better than asked for will do: below all runs, the largest reduction",
        ),
        Mistake(
            "axes swapped",
            _axes_swapped,
            "quality is the first column of points, reduction the second",
        ),
    ),
    _same,
)
