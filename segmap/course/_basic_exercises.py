"""Exercises of the chapter on Basic: when two segments match, and what they become."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..angles import axial_difference, axial_mean_of_two
from ..arrays import Array
from ..segments import angle, extreme_projections, length, midpoint
from ._exercise import Case, Exercise, Mistake, close, numbers


def _gaps(a: Array, b: Array) -> Array:
    """Distances of the four pairs of end points, `(2, 2)`, metres."""
    d = a[:, None] - b[None, :]
    return np.hypot(d[..., 0], d[..., 1])


def _turn(a: Array, b: Array) -> float:
    return float(abs(axial_difference(angle(a), angle(b))))


def matches(a: Array, b: Array, distance: float, angle: float) -> bool:
    """Whether two segments match in Basic (A 4.1.1): near end points and similar angles, strictly.

    Parameters
    ----------
    a, b : (2, 2) array, metres
    distance : float, metres
        Some pair of end points must be closer.
    angle : float, radians
        The lines, which have no direction, must differ by less.

    Returns
    -------
    bool

    Examples
    --------
    >>> matches(np.array([(0, 0), (1, 0)]), np.array([(2, 0), (1.1, 0)]), 0.20, 0.1)
    True
    """
    return bool(_gaps(a, b).min() < distance and _turn(a, b) < angle)


def merged(a: Array, b: Array) -> Array:
    """Segment that takes the place of two in Basic (A 4.1.2).

    Parameters
    ----------
    a, b : (2, 2) array, metres

    Returns
    -------
    (2, 2) array, metres
        The extreme projections of the four end points on the mean line: direction and middle are
        means weighted by length.

    Examples
    --------
    >>> merged(np.array([(0, 0), (3, 0)]), np.array([(3.0, 0.4), (4, 0.4)]))
    array([[0. , 0.1],
           [4. , 0.1]])
    """
    return _on_line(a, b, _middle(a, b), _direction(a, b))


def _direction(a: Array, b: Array) -> float:
    return float(axial_mean_of_two(angle(a), angle(b), length(a), length(b)))


def _plain_direction(a: Array, b: Array) -> float:
    return float(np.average([angle(a), angle(b)], weights=[length(a), length(b)]))


def _middle(a: Array, b: Array) -> Array:
    return np.average([midpoint(a), midpoint(b)], axis=0, weights=[length(a), length(b)])


def _on_line(a: Array, b: Array, through: Array, direction: float) -> Array:
    return extreme_projections(np.concatenate([a, b]), through, direction)


def _farthest(a: Array, b: Array) -> Array:
    """The two of four end points that lie farthest apart."""
    ends = np.concatenate([a, b])
    i, j = np.unravel_index(np.argmax(_gaps(ends, ends)), (4, 4))
    return ends[[i, j]]


def _longer_line(a: Array, b: Array) -> Array:
    longer = a if length(a) >= length(b) else b
    return _on_line(a, b, midpoint(longer), float(angle(longer)))


def _of_length(a: Array, b: Array) -> Array:
    """As long as both together, about the mean middle."""
    way = _direction(a, b)
    half = (length(a) + length(b)) / 2 * np.array([np.cos(way), np.sin(way)])
    return _middle(a, b) + np.array([-half, half])


def same_segment(found: Any, expected: Any) -> bool:
    """Whether two answers are one segment, whichever end point comes first."""
    array = numbers(found)
    if array is None or array.shape != (2, 2):
        return False
    return close(array, expected) or close(array[::-1], expected)


def _wall(middle: tuple[float, float], size: float, degrees: float) -> Array:
    half = size / 2 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    return np.array([middle - half, middle + half])


_FLAT, _STEEP = _wall((1, 0), 2, 0), _wall((0, 2), 3, 85)


def _pair(words: str, a: Array, b: Array) -> Case:
    return Case(words, (a, b, 0.25, np.radians(10)))


check_matches = Exercise(
    "matches",
    "matches(a, b, distance, angle) -> bool: whether some end point of segment a (2, 2) is closer "
    "than distance, metres, to one of b, and their lines differ by less than angle, radians",
    matches,
    (
        _pair("end to end on one wall", _FLAT, _wall((3.1, 0), 2, 5)),
        _pair("the same, with swapped ends", _FLAT, _wall((3.1, 0), 2, 5)[::-1]),
        _pair("walls at 1 and 179 degrees", _wall((1, 0), 2, 1), _wall((3, 0), 2, 179)),
        _pair("a corner", _FLAT, _wall((2, 1), 2, 90)),
        _pair("a piece beside the middle of a wall", _FLAT, _wall((1, 0.02), 1, 0)),
        _pair("one wall that begins where the other does", _FLAT, _wall((2, 0.1), 4, 0)),
        _pair("walls turned by 30 degrees", _FLAT, _wall((2.8, 0.4), 1.6, 30)),
        _pair("ends exactly 0.25 m apart", _FLAT, np.array([(2.25, 0.0), (4, 0)])),
        Case("a corner, to 1 degree", (_FLAT, _wall((2, 1), 2, 90), 0.25, np.radians(1))),
        _pair("middles that meet and ends that do not", _FLAT, _wall((1, 0), 5, 2)),
    ),
    (
        Mistake(
            "plain angles",
            lambda a, b, d, t: _gaps(a, b).min() < d and abs(angle(a) - angle(b)) < t,
            "lines have no direction: 1 and 179 degrees lie 2 degrees apart, use axial_difference",
        ),
        Mistake(
            "with a direction",
            lambda a, b, d, t: (
                _gaps(a, b).min() < d
                and abs(np.subtract(*(np.arctan2(*(s[1] - s[0])[::-1]) for s in (a, b)))) < t
            ),
            "swapping the end points must change nothing: segments have no direction",
        ),
        Mistake(
            "degrees",
            lambda a, b, d, t: _gaps(a, b).min() < d and np.degrees(_turn(a, b)) < t,
            "angle is in radians: compare radians with radians",
        ),
        Mistake(
            "threshold in degrees",
            lambda a, b, d, t: _gaps(a, b).min() < d and _turn(a, b) < np.degrees(t),
            "angle is in radians already: this lets nearly every turn through",
        ),
        Mistake(
            "no angle",
            lambda a, b, d, t: _gaps(a, b).min() < d,
            "near end points are not enough: at a corner they meet too, compare the angles",
        ),
        Mistake(
            "no distance",
            lambda a, b, d, t: _turn(a, b) < t,
            "similar angles are not enough: two end points must be near",
        ),
        Mistake(
            "either",
            lambda a, b, d, t: _gaps(a, b).min() < d or _turn(a, b) < t,
            "both conditions must hold, not one of them",
        ),
        Mistake(
            "middles",
            lambda a, b, d, t: np.hypot(*(midpoint(a) - midpoint(b))) < d and _turn(a, b) < t,
            "the end points must be near, not the middles",
        ),
        Mistake(
            "pairs in order",
            lambda a, b, d, t: np.hypot(*(a - b).T).min() < d and _turn(a, b) < t,
            "try all four pairs of end points: the end of one may meet the start of the other",
        ),
        Mistake(
            "all ends",
            lambda a, b, d, t: _gaps(a, b).max() < d and _turn(a, b) < t,
            "one pair of near end points is enough: take the smallest of the four distances",
        ),
        Mistake(
            "border let in",
            lambda a, b, d, t: _gaps(a, b).min() <= d and _turn(a, b) < t,
            "both tests are strict: exactly at the distance is not closer",
        ),
    ),
)


def _mean_of_ends(a: Array, b: Array) -> Array:
    return np.asarray((a + b) / 2)


def _line_mistake(name: str, direction: Callable[[Array, Array], float], hint: str) -> Mistake:
    return Mistake(name, lambda a, b: _on_line(a, b, _middle(a, b), direction(a, b)), hint)


check_merged = Exercise(
    "merged",
    "merged(a, b) -> (2, 2) metres: the segment that takes the place of two; its line has the "
    "length-weighted mean direction and middle, its ends are the extreme projections of all four",
    merged,
    (
        Case("two pieces of one wall", (_FLAT, _wall((3.5, 0.1), 1, 5))),
        Case(
            "a short piece that overlaps a long one", (_wall((0, 0), 4, 30), _wall((1, 1), 1, 34))
        ),
        Case("walls at 1 and 179 degrees", (_wall((1, 0), 2, 1), _wall((3, 0), 1, 179))),
        Case("upright walls", (_STEEP, _wall((0.1, 4), 2, 93))),
        Case("a piece in the middle of a wall", (_FLAT, _wall((1, 0.05), 0.5, 3))),
    ),
    (
        _line_mistake(
            "plain mean",
            _plain_direction,
            "the plain mean of 1 and 179 degrees is a wall across: use axial_mean_of_two",
        ),
        _line_mistake(
            "direction not weighted",
            lambda a, b: float(axial_mean_of_two(angle(a), angle(b))),
            "the direction is weighted by length: a short piece knows little of it",
        ),
        Mistake(
            "middle not weighted",
            lambda a, b: _on_line(a, b, (midpoint(a) + midpoint(b)) / 2, _direction(a, b)),
            "the middle is weighted by length, as the direction is",
        ),
        Mistake(
            "nothing weighted",
            lambda a, b: _on_line(
                a,
                b,
                (midpoint(a) + midpoint(b)) / 2,
                float(axial_mean_of_two(angle(a), angle(b))),
            ),
            "direction and middle are weighted by length",
        ),
        _line_mistake(
            "weights exchanged",
            lambda a, b: float(axial_mean_of_two(angle(a), angle(b), length(b), length(a))),
            "the longer segment has the greater weight: here they are exchanged",
        ),
        _line_mistake(
            "degrees",
            lambda a, b: float(np.degrees(_direction(a, b))),
            "np.cos and np.sin take radians: no degrees",
        ),
        Mistake(
            "not projected",
            _farthest,
            "the farthest two end points do not lie on the mean line: project them on it",
        ),
        Mistake(
            "mean of end points",
            _mean_of_ends,
            "the mean of the end points is too short, and depends on which end comes first",
        ),
        Mistake(
            "line of the longer",
            _longer_line,
            "the line is the mean of both, not the one of the longer segment",
        ),
        Mistake(
            "length of both together",
            _of_length,
            "the length follows from the projections: it is no sum, for the two may overlap",
        ),
    ),
    same_segment,
)
