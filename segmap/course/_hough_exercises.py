"""Exercise of the chapter on Hybrid: the line of a segment in Hough space."""

from typing import Any

import numpy as np

from ..arrays import Array
from ..reduction import hough
from ..segments import angle, midpoint
from ._exercise import Case, Exercise, Mistake, numbers


def _same_pair(found: Any, expected: Any) -> bool:
    """Whether two answers are the same numbers; the answers of a mistake may not be finite."""
    a, b = numbers(found), numbers(expected)
    if a is None or b is None or a.shape != b.shape:
        return False
    return np.allclose(a, b, rtol=1e-9, atol=1e-9, equal_nan=True)


def _turns(theta: float, near: float) -> float:
    """Half turns that bring theta nearest to another."""
    return float(np.round((near - theta) / np.pi))


def _brought(rho: float, theta: float, near: float) -> Array:
    """The representative of (rho, theta) that is nearest to another theta."""
    turns = _turns(theta, near)
    return np.array([-rho if turns % 2 else rho, theta + turns * np.pi])


def _by_slope(segment: Array, near: float) -> Array:
    """Through y = m x + q, which upright walls have not."""
    (x, y), (dx, dy) = segment[0], segment[1] - segment[0]
    slope = dy / dx
    theta = np.arctan2(1.0, -slope)
    return _brought((y - slope * x) * np.sin(theta), theta, near)


def _sign_kept(segment: Array, near: float) -> Array:
    return np.array([hough(segment)[0], hough(segment, near)[1]])


def _whole_turns(segment: Array, near: float) -> Array:
    rho, theta = hough(segment)
    return np.array([rho, theta + 2 * np.pi * np.round((near - theta) / (2 * np.pi))])


def _of_the_segment(segment: Array, near: float) -> Array:
    """The angle along the wall, in the place of the one across it."""
    along = angle(segment)
    x, y = midpoint(segment)
    return _brought(x * np.cos(along) + y * np.sin(along), float(along), near)


def _along_but_right_rho(segment: Array, near: float) -> Array:
    return np.array([hough(segment, near)[0], angle(segment)])


def _to_the_middle(segment: Array, near: float) -> Array:
    """The distance of the middle of the wall, in the place of that of its line."""
    return np.array([np.hypot(*midpoint(segment)), hough(segment, near)[1]])


def _always_positive(segment: Array, near: float) -> Array:
    rho, theta = hough(segment, near)
    return np.array([abs(rho), theta])


def _case(words: str, ends: list[tuple[float, float]], near: float) -> Case:
    """A wall, and the theta in degrees of the one that it is compared with."""
    return Case(f"{words}, near {near} degrees", (np.array(ends, float), float(np.radians(near))))


check_hough = Exercise(
    "hough",
    "hough(segment, near) -> [rho, theta], metres and radians: the line of a segment (2, 2) by its "
    "normal; of all the pairs that are this line, the one whose theta is nearest to `near`",
    hough,
    (
        _case("a slanted wall", [(0, 1), (4, 4)], 130),
        _case("an upright wall", [(2, -1), (2, 3)], 5),
        _case("the same upright wall", [(2, -1), (2, 3)], 176),
        _case("a wall that leans to the right", [(2.0, 0.0), (2.1, 2.0)], 3),
        _case("a level wall below the origin", [(3, -2), (-1, -2)], 92),
        _case("a slanted wall", [(-3, -1), (-1, -2)], 250),
        _case("a wall that leans to the left", [(5.0, 0.0), (4.9, 2.0)], 181),
    ),
    (
        Mistake(
            "slope",
            _by_slope,
            "an upright wall has no slope: take the angle of the normal with atan2, and rho from "
            "any point of the wall as x cos(theta) + y sin(theta)",
        ),
        Mistake(
            "not brought near",
            lambda segment, near: hough(segment),
            "(rho, theta) and (-rho, theta + pi) are one line: add the half turns that bring theta "
            "nearest to `near`",
        ),
        Mistake(
            "sign kept",
            _sign_kept,
            "half a turn of theta makes the normal look the other way: rho changes its sign",
        ),
        Mistake(
            "whole turns",
            _whole_turns,
            "a line is the same after half a turn already: round in steps of pi, not of 2 pi",
        ),
        Mistake(
            "angle of the segment",
            _of_the_segment,
            "theta is the angle of the normal: a quarter turn from that of the segment",
        ),
        Mistake(
            "angle of the segment, rho of the line",
            _along_but_right_rho,
            "rho is right; theta is the angle of the normal, not of the segment, and has to be "
            "brought near",
        ),
        Mistake(
            "always positive",
            _always_positive,
            "rho has a sign: it is negative where the normal looks away from the wall",
        ),
        Mistake(
            "distance of the middle",
            _to_the_middle,
            "rho is the distance of the origin from the line, along its normal, not from the "
            "middle of the segment",
        ),
        Mistake(
            "other order",
            lambda segment, near: hough(segment, near)[::-1],
            "rho comes first, then theta",
        ),
        Mistake(
            "degrees",
            lambda segment, near: hough(segment, near) * [1, 180 / np.pi],
            "theta is wanted in radians",
        ),
    ),
    _same_pair,
)
