"""Exercises on Basic and Hybrid: which segments match, and lines by their normals."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from segmap.angles import axial_difference
from segmap.arrays import Array
from segmap.poses import transform
from segmap.reduction import hough
from segmap.segments import angle, midpoint

from ..literal.lines import SAME, point_to_segment
from ..literal.reduction import basic
from ._answers import Cases
from ._exercise import Exercise, Rng, anywhere, edited


def _wall(middle: tuple[float, float], size: float, degrees: float) -> Array:
    """A segment (2, 2) about its middle."""
    half = size / 2 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    return np.array([middle - half, middle + half])


# ---------------------------------------------------------------------------- a match
def _pairs(rng: Rng) -> Cases:
    """Pairs that match and pairs that fail one of the tests, placed anywhere where that is safe."""
    place, shift = anywhere(rng), rng.integers(-8, 9, 2) / 4
    size, lean = rng.uniform(1.5, 3), rng.uniform(3, 7)
    limits = 0.25, np.radians(rng.uniform(8, 12))
    flat, low, high = (_wall((-size / 2, 0), size, d) for d in (0, 1, 179))
    next_to = _wall((1.1, 0), 2, lean)

    def placed(a: Array, b: Array, *given: float) -> tuple[Any, ...]:
        return transform(place, a), transform(place, b), *(given or limits)

    corner = _wall((0, size / 2), size, 90)

    def joined(gap: float, turn: float) -> Array:
        """A wall that begins so far behind the end of `flat`, turned by so much."""
        c, s = np.cos(turn), np.sin(turn)
        return np.array([(gap, 0), (gap + size * c, size * s)])

    border = np.array([[(0.0, 0), (2, 0)], [(2.25, 0), (4, 0)]]) + shift
    return {
        "end to end on one wall": placed(flat, next_to),
        "the same, with swapped ends": placed(flat, next_to[::-1]),
        "walls at 1 and 179 degrees": (low + shift, high + (size, 0) + shift, *limits),
        "a corner": placed(flat, corner),
        "a corner, to 1 degree": placed(flat, corner, 0.25, np.radians(1)),
        "a piece beside the middle of a wall": placed(flat, _wall((-size / 2, 0.02), size / 3, 0)),
        "a wall behind the piece in its middle": placed(
            _wall((-size / 2, 0.02), size / 3, 0), flat
        ),
        "two walls that begin together": placed(flat, _wall((0, 0.1), 2 * size, 0)),
        "a turn a little too large": placed(flat, joined(0.1, 1.5 * limits[1])),
        "a turn that is just small enough": placed(flat, joined(0.1, -0.8 * limits[1])),
        "a gap a little too wide": placed(flat, joined(0.375, 0)),
        "a gap that is just small enough": placed(flat, joined(0.2, 0)),
        "walls turned by 30 degrees": placed(flat, _wall((0.75, 0.4), 1.6, 30)),
        "ends exactly 0.25 m apart": (*border, *limits),
        "middles that meet and ends that do not": placed(flat, _wall((-size / 2, 0), size + 2, 2)),
    }


def _matches(a: Array, b: Array, distance: float, angle: float) -> bool:
    return _near(a, b, distance) and _turn(a, b) < angle - SAME


def _gaps(a: Array, b: Array) -> Array:
    """Distances of the four ends from the other segment, `(2, 2)`, metres: a from b, b from a."""
    pairs = ((a, b), (b, a))
    return np.array([[point_to_segment(p, t.tolist()) for p in s.tolist()] for s, t in pairs])


def _turn(a: Array, b: Array) -> float:
    return float(abs(axial_difference(angle(a), angle(b))))


def _directed_turn(a: Array, b: Array) -> float:
    (ax, ay), (bx, by) = a[1] - a[0], b[1] - b[0]
    return float(abs(np.arctan2(ay, ax) - np.arctan2(by, bx)))


def _near(a: Array, b: Array, distance: float) -> bool:
    return bool(_gaps(a, b).min() < distance - SAME)


def _by_ends(a: Array, b: Array, distance: float, angle: float) -> bool:
    """The chapter's own match."""
    return basic.match(a.tolist(), b.tolist(), distance, angle)


check_matches = Exercise(
    "matches(a, b, distance, angle) -> bool: whether some end point of one of two segments (2, 2) "
    "is closer than distance, metres, to any point of the other, and their lines differ by less "
    "than angle, radians",
    _matches,
    _pairs,
    {
        "this is the match of the chapter, which looks at end points alone: a piece beside the "
        "middle of a wall is near to the wall, too": _by_ends,
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
        "near segments are not enough: at a corner they meet too, compare the angles": (
            lambda a, b, d, t: _near(a, b, d)
        ),
        "similar angles are not enough: the segments must be near": (
            lambda a, b, d, t: _turn(a, b) < t
        ),
        "both conditions must hold, not one of them": (
            lambda a, b, d, t: _near(a, b, d) or _turn(a, b) < t
        ),
        "an end must be near, not the middles": (
            lambda a, b, d, t: np.hypot(*(midpoint(a) - midpoint(b))) < d and _turn(a, b) < t
        ),
        "the ends of both count: a long wall has none near the middle of a piece beside it, but "
        "the piece has": lambda a, b, d, t: _gaps(a, b)[0].min() < d and _turn(a, b) < t,
        "the ends of both count, also those of the first": (
            lambda a, b, d, t: _gaps(a, b)[1].min() < d and _turn(a, b) < t
        ),
        "one near end is enough: take the smallest of the four distances": (
            lambda a, b, d, t: _gaps(a, b).max() < d and _turn(a, b) < t
        ),
        "both tests are strict: exactly at the distance is not closer": (
            lambda a, b, d, t: _gaps(a, b).min() <= d and _turn(a, b) < t
        ),
    },
)


# ----------------------------------------------------------------------------- Hybrid
def _named_lines(rng: Rng) -> Cases:
    """Walls of all directions, and an angle on this side of the seam or beyond it, far off."""
    sides = itertools.cycle(rng.permutation([-1, 1]))

    def case(ends: Any, turns: int) -> tuple[Any, ...]:
        (x, y) = np.subtract(ends[1], ends[0])
        off = next(sides) * np.radians(rng.uniform(62, 85))
        return np.array(ends, float), float(np.arctan2(x, -y) + off + turns * np.pi)

    x, y, size = *rng.uniform(1, 4, 2), rng.uniform(1, 3)
    slanted, upright = [(x, y), (x + size, y + 0.7 * size)], [(x, -y), (x, size)]
    return {
        "a slanted wall": case(slanted, 0),
        "the same wall, named after half a turn": case(slanted, 1),
        "an upright wall": case(upright, 0),
        "an upright wall, named after half a turn": case(upright, 1),
        "a level wall below the origin": case([(x, -y), (-size, -y)], -1),
        "a wall that leans to the left": case([(-x, y), (-x - 0.1, y + size)], 2),
        "a slanted wall, named after three half turns": case([(-x, y), (-x - size, -y)], 3),
    }


def _line(segment: Array, near: float) -> Array:
    """The line of a segment, of which the mistakes change a part."""
    theta = (angle(segment) + np.pi / 2) % np.pi
    x, y = midpoint(segment)
    rho = x * np.cos(theta) + y * np.sin(theta)
    turns = np.round((near - theta) / np.pi)
    return np.array([-rho if turns % 2 else rho, theta + turns * np.pi])


#: By y = m x + q, which does not exist for upright walls.
_SLOPE = "np.divide(*(segment[1] - segment[0])[::-1])"
_BY_SLOPE = (
    ("(angle(segment) + np.pi / 2) % np.pi", f"np.arctan2(1.0, -{_SLOPE})"),
    ("x * np.cos(theta) + y", f"(y - {_SLOPE} * x)"),
)


def _by_quotient(segment: Array, near: float) -> Array:
    """The same with Python's own numbers, which raise where numpy warns."""
    (x0, y0), (x1, y1) = segment.tolist()
    slope = (y1 - y0) / (x1 - x0)
    theta = float(np.arctan2(1.0, -slope))
    turns = np.round((near - theta) / np.pi)
    rho = (y0 - slope * x0) * np.sin(theta)
    return np.array([-rho if turns % 2 else rho, theta + turns * np.pi])


def _whole_turns(segment: Array, near: float) -> Array:
    rho, theta = hough(segment)
    return np.array([rho, theta + 2 * np.pi * np.round((near - theta) / (2 * np.pi))])


check_hough = Exercise(
    "hough(segment, near) -> [rho, theta], metres and radians: the line of a segment (2, 2) by its "
    "normal; of all the pairs that are this line, the one whose theta is nearest to `near`",
    hough,
    _named_lines,
    {
        "an upright wall has no slope: take the angle of the normal with atan2, and rho from any "
        "point of the wall as x cos(theta) + y sin(theta)": edited(_line, *_BY_SLOPE),
        "dy / dx divides by 0 where the wall is upright: take atan2(dy, dx)": _by_quotient,
        "(rho, theta) and (-rho, theta + pi) are one line: add the half turns that bring theta "
        "nearest to `near`": lambda segment, near: hough(segment),
        "half a turn of theta makes the normal look the other way: rho changes its sign": (
            edited(_line, ("-rho if turns % 2 else rho", "rho"))
        ),
        "a line is the same after half a turn: round in steps of pi, not of 2 pi": _whole_turns,
        "theta is the angle of the normal: a quarter turn from that of the segment": (
            edited(_line, ("(angle(segment) + np.pi / 2) % np.pi", "angle(segment)"))
        ),
        "rho is right; theta is the angle of the normal, not of the segment, and has to be brought "
        "near": edited(_line, ("theta + turns * np.pi", "angle(segment)")),
        "rho has a sign: it is negative where the normal looks away from the wall": (
            edited(_line, ("-rho if turns % 2 else rho", "abs(rho)"))
        ),
        "rho is the distance of the origin from the line, along its normal, not from the middle of "
        "the segment": edited(_line, ("-rho if turns % 2 else rho", "np.hypot(x, y)")),
        "rho comes first, then theta": lambda segment, near: hough(segment, near)[::-1],
        "theta is wanted in radians": lambda segment, near: hough(segment, near) * [1, 180 / np.pi],
    },
)
