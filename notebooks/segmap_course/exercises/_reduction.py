"""Exercises of the chapters on Basic, Hybrid and fuzzy clustering."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from segmap import kernels
from segmap.angles import axial_difference, axial_mean_of_two
from segmap.arrays import Array
from segmap.reduction import basic_offline, basic_online, hough, hybrid
from segmap.segments import angle, extreme_projections, length, midpoint

from .. import literal
from ..literal.reduction import basic
from ._answers import same_segment
from ._exercise import Exercise
from .draws import maps as draws_maps


# ------------------------------------------------------------------------------ Basic
def _matches(a: Array, b: Array, distance: float, angle: float) -> bool:
    return len(basic_offline([a, b], distance=distance, angle=angle)) == 1


def _merged(a: Array, b: Array) -> Array:
    return basic_offline([a, b], distance=10.0, angle=np.pi / 2).segments[0]


def _gaps(a: Array, b: Array) -> Array:
    """Distances of the four pairs of end points, `(2, 2)`, metres."""
    return np.linalg.norm(a[:, None] - b[None, :], axis=-1)


def _turn(a: Array, b: Array) -> float:
    return float(abs(axial_difference(angle(a), angle(b))))


def _directed_turn(a: Array, b: Array) -> float:
    (ax, ay), (bx, by) = a[1] - a[0], b[1] - b[0]
    return float(abs(np.arctan2(ay, ax) - np.arctan2(by, bx)))


def _near(a: Array, b: Array, distance: float) -> bool:
    return bool(_gaps(a, b).min() < distance)


_FLAT, _STEEP = draws_maps.wall((1, 0), 2, 0), draws_maps.wall((0, 2), 3, 85)

check_matches = Exercise(
    "matches(a, b, distance, angle) -> bool: whether some end point of segment a (2, 2) is closer "
    "than distance, metres, to one of b, and their lines differ by less than angle, radians",
    _matches,
    {
        words: (a, b, 0.25, np.radians(10))
        for words, a, b in (
            ("end to end on one wall", _FLAT, draws_maps.wall((3.1, 0), 2, 5)),
            ("the same, with swapped ends", _FLAT, draws_maps.wall((3.1, 0), 2, 5)[::-1]),
            (
                "walls at 1 and 179 degrees",
                draws_maps.wall((1, 0), 2, 1),
                draws_maps.wall((3, 0), 2, 179),
            ),
            ("a corner", _FLAT, draws_maps.wall((2, 1), 2, 90)),
            ("a piece beside the middle of a wall", _FLAT, draws_maps.wall((1, 0.02), 1, 0)),
            ("one wall that begins where the other does", _FLAT, draws_maps.wall((2, 0.1), 4, 0)),
            ("walls turned by 30 degrees", _FLAT, draws_maps.wall((2.8, 0.4), 1.6, 30)),
            ("ends exactly 0.25 m apart", _FLAT, np.array([(2.25, 0.0), (4, 0)])),
            ("middles that meet and ends that do not", _FLAT, draws_maps.wall((1, 0), 5, 2)),
        )
    }
    | {"a corner, to 1 degree": (_FLAT, draws_maps.wall((2, 1), 2, 90), 0.25, np.radians(1))},
    {
        "lines have no direction: 1 and 179 degrees lie 2 degrees apart, use axial_difference": (
            lambda a, b, d, t: _near(a, b, d) and abs(angle(a) - angle(b)) < t
        ),
        "swapping the end points must change nothing: segments have no direction": (
            lambda a, b, d, t: _near(a, b, d) and _directed_turn(a, b) < t
        ),
        "angle is in radians: compare radians with radians": (
            lambda a, b, d, t: _near(a, b, d) and np.degrees(_turn(a, b)) < t
        ),
        "angle is in radians already: this lets nearly every turn through": (
            lambda a, b, d, t: _near(a, b, d) and _turn(a, b) < np.degrees(t)
        ),
        "near end points are not enough: at a corner they meet too, compare the angles": (
            lambda a, b, d, t: _near(a, b, d)
        ),
        "similar angles are not enough: two end points must be near": (
            lambda a, b, d, t: _turn(a, b) < t
        ),
        "both conditions must hold, not one of them": (
            lambda a, b, d, t: _near(a, b, d) or _turn(a, b) < t
        ),
        "the end points must be near, not the middles": (
            lambda a, b, d, t: np.hypot(*(midpoint(a) - midpoint(b))) < d and _turn(a, b) < t
        ),
        "try all four pairs of end points: the end of one may meet the start of the other": (
            lambda a, b, d, t: np.diag(_gaps(a, b)).min() < d and _turn(a, b) < t
        ),
        "one pair of near end points is enough: take the smallest of the four distances": (
            lambda a, b, d, t: _gaps(a, b).max() < d and _turn(a, b) < t
        ),
        "both tests are strict: exactly at the distance is not closer": (
            lambda a, b, d, t: _gaps(a, b).min() <= d and _turn(a, b) < t
        ),
    },
    draw=draws_maps.matches,
    own=(basic_offline, basic_online, kernels.become_mean, basic),
)

Mean = Callable[[Array, Array], Any]


def _direction(a: Array, b: Array) -> Array:
    return axial_mean_of_two(angle(a), angle(b), length(a), length(b))


def _plain_direction(a: Array, b: Array) -> float:
    return float(np.average([angle(a), angle(b)], weights=[length(a), length(b)]))


def _middle(a: Array, b: Array) -> Array:
    return np.average([midpoint(a), midpoint(b)], axis=0, weights=[length(a), length(b)])


def _on_line(direction: Mean = _direction, through: Mean = _middle) -> Mean:
    """A merge whose line has another direction, or runs through another point."""
    return lambda a, b: extreme_projections(
        np.concatenate([a, b]), through(a, b), float(direction(a, b))
    )


def _half_way(a: Array, b: Array) -> Array:
    return (midpoint(a) + midpoint(b)) / 2


def _longer(a: Array, b: Array) -> Array:
    return a if length(a) >= length(b) else b


def _farthest(a: Array, b: Array) -> Array:
    """The two of four end points that lie farthest apart."""
    ends = np.concatenate([a, b])
    return ends[list(np.unravel_index(np.argmax(_gaps(ends, ends)), (4, 4)))]


def _of_length(a: Array, b: Array) -> Array:
    """A segment as long as both together, about the mean middle."""
    way = _direction(a, b)
    half = (length(a) + length(b)) / 2 * np.array([np.cos(way), np.sin(way)])
    return _middle(a, b) + np.array([-half, half])


check_merged = Exercise(
    "merged(a, b) -> (2, 2) metres: the segment that takes the place of two; its line has the "
    "length-weighted mean direction and middle, its ends are the extreme projections of all four",
    _merged,
    {
        "two pieces of one wall": (_FLAT, draws_maps.wall((3.5, 0.1), 1, 5)),
        "a short piece that overlaps a long one": (
            draws_maps.wall((0, 0), 4, 30),
            draws_maps.wall((1, 1), 1, 34),
        ),
        "walls at 1 and 179 degrees": (
            draws_maps.wall((1, 0), 2, 1),
            draws_maps.wall((3, 0), 1, 179),
        ),
        "upright walls": (_STEEP, draws_maps.wall((0.1, 4), 2, 93)),
        "a piece in the middle of a wall": (_FLAT, draws_maps.wall((1, 0.05), 0.5, 3)),
    },
    {
        "the plain mean of 1 and 179 degrees is a wall across: use axial_mean_of_two": (
            _on_line(_plain_direction)
        ),
        "the direction is weighted by length: a short piece knows little of it": (
            _on_line(lambda a, b: axial_mean_of_two(angle(a), angle(b)))
        ),
        "the middle is weighted by length, as the direction is": _on_line(through=_half_way),
        "direction and middle are weighted by length": (
            _on_line(lambda a, b: axial_mean_of_two(angle(a), angle(b)), _half_way)
        ),
        "the longer segment has the greater weight: here they are exchanged": (
            _on_line(lambda a, b: axial_mean_of_two(angle(a), angle(b), length(b), length(a)))
        ),
        "np.cos and np.sin take radians: no degrees": (
            _on_line(lambda a, b: np.degrees(_direction(a, b)))
        ),
        "the farthest two end points do not lie on the mean line: project them on it": _farthest,
        "the mean of the end points is too short, and depends on which end comes first": (
            lambda a, b: (a + b) / 2
        ),
        "the line is the mean of both, not the one of the longer segment": (
            _on_line(lambda a, b: angle(_longer(a, b)), lambda a, b: midpoint(_longer(a, b)))
        ),
        "the length follows from the projections: it is no sum, for the two may overlap": (
            _of_length
        ),
    },
    same_segment,
    draw=draws_maps.merged,
    own=(basic_offline, basic_online, kernels.become_mean, basic),
)


# ----------------------------------------------------------------------------- Hybrid
def _brought(rho: float, theta: float, near: float) -> Array:
    """The representative of (rho, theta) that is nearest to another theta."""
    turns = float(np.round((near - theta) / np.pi))
    return np.array([-rho if turns % 2 else rho, theta + turns * np.pi])


def _by_slope(segment: Array, near: float) -> Array:
    """By y = m x + q, which does not exist for upright walls."""
    (x, y), (dx, dy) = segment[0], segment[1] - segment[0]
    slope = dy / dx
    theta = np.arctan2(1.0, -slope)
    return _brought((y - slope * x) * np.sin(theta), theta, near)


def _whole_turns(segment: Array, near: float) -> Array:
    rho, theta = hough(segment)
    return np.array([rho, theta + 2 * np.pi * np.round((near - theta) / (2 * np.pi))])


def _of_the_segment(segment: Array, near: float) -> Array:
    """The angle along the wall, in the place of the one across it."""
    along, (x, y) = float(angle(segment)), midpoint(segment)
    return _brought(x * np.cos(along) + y * np.sin(along), along, near)


def _with(segment: Array, near: float, *, rho: Any = None, theta: Any = None) -> Array:
    """The right line with one of its two numbers replaced."""
    right = hough(segment, near)
    return np.array([right[0] if rho is None else rho, right[1] if theta is None else theta])


check_hough = Exercise(
    "hough(segment, near) -> [rho, theta], metres and radians: the line of a segment (2, 2) by its "
    "normal; of all the pairs that are this line, the one whose theta is nearest to `near`",
    hough,
    {
        f"{words}, near {near} degrees": (np.array(ends, float), float(np.radians(near)))
        for words, ends, near in (
            ("a slanted wall", [(0, 1), (4, 4)], 130),
            ("an upright wall", [(2, -1), (2, 3)], 5),
            ("the same upright wall", [(2, -1), (2, 3)], 176),
            ("a wall that leans to the right", [(2.0, 0.0), (2.1, 2.0)], 3),
            ("a level wall below the origin", [(3, -2), (-1, -2)], 92),
            ("a slanted wall", [(-3, -1), (-1, -2)], 250),
            ("a wall that leans to the left", [(5.0, 0.0), (4.9, 2.0)], 181),
        )
    },
    {
        "an upright wall has no slope: take the angle of the normal with atan2, and rho from any "
        "point of the wall as x cos(theta) + y sin(theta)": _by_slope,
        "(rho, theta) and (-rho, theta + pi) are one line: add the half turns that bring theta "
        "nearest to `near`": lambda segment, near: hough(segment),
        "half a turn of theta makes the normal look the other way: rho changes its sign": (
            lambda segment, near: _with(segment, near, rho=hough(segment)[0])
        ),
        "a line is the same after half a turn already: round in steps of pi, not of 2 pi": (
            _whole_turns
        ),
        "theta is the angle of the normal: a quarter turn from that of the segment": (
            _of_the_segment
        ),
        "rho is right; theta is the angle of the normal, not of the segment, and has to be brought "
        "near": lambda segment, near: _with(segment, near, theta=angle(segment)),
        "rho has a sign: it is negative where the normal looks away from the wall": (
            lambda segment, near: _with(segment, near, rho=abs(hough(segment, near)[0]))
        ),
        "rho is the distance of the origin from the line, along its normal, not from the middle of "
        "the segment": lambda segment, near: _with(segment, near, rho=np.hypot(*midpoint(segment))),
        "rho comes first, then theta": lambda segment, near: hough(segment, near)[::-1],
        "theta is wanted in radians": lambda segment, near: hough(segment, near) * [1, 180 / np.pi],
    },
    draw=draws_maps.hough,
    own=(hough, hybrid, literal.hough),
)
