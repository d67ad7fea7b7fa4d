"""What all plain methods need: lengths, angles, distances and chains of plain numbers.

A point is (x, y) in metres, a segment a pair of points, an angle is in radians.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

from segmap.reduction.surveyed.lines import SAME as SAME
from segmap.reduction.surveyed.lines import Line as Line
from segmap.reduction.surveyed.lines import Point as Point
from segmap.reduction.surveyed.lines import Segment as Segment
from segmap.reduction.surveyed.lines import axial_difference as axial_difference
from segmap.reduction.surveyed.lines import extreme_projections as extreme_projections
from segmap.reduction.surveyed.lines import gap_along as gap_along
from segmap.reduction.surveyed.lines import line_angle as line_angle
from segmap.reduction.surveyed.lines import seen_from as seen_from
from segmap.reduction.surveyed.lines import segment_length as segment_length
from segmap.reduction.surveyed.lines import spanning as spanning

#: What a reduction returns: its outputs, and of each input the output that it went into, or -1.
Found = tuple[list[Segment], list[int]]


def line_of(s: Segment) -> Line:
    """First end point of a segment, and its unit direction."""
    (x0, y0), (x1, y1) = s
    n = math.dist(*s)
    return x0, y0, (x1 - x0) / n, (y1 - y0) / n


def point_to_segment(p: Point, s: Segment) -> float:
    """Distance of a point from a segment, metres: from its line, or beyond an end from that end."""
    length = math.dist(*s)
    if length == 0:
        return math.dist(p, s[0])
    along, across = seen_from(line_of(s), p)
    if along < 0:
        return math.dist(p, s[0])
    if along > length:
        return math.dist(p, s[1])
    return abs(across)


def span_on(line: Segment, s: Segment) -> tuple[float, float]:
    """Low and high projection of a segment on another, from its first end point on."""
    low, high = sorted(seen_from(line_of(line), p)[0] for p in s)
    return low, high


def placed(point: Point, pose: Sequence[float]) -> tuple[float, float]:
    """A point of the robot's frame in the frame of the pose (metres, radians).

    Examples
    --------
    >>> placed((2.0, 1.0), (5.0, 5.0, 0.0))
    (7.0, 6.0)
    """
    (x, y), (at_x, at_y, heading) = point, pose
    c, s = math.cos(heading), math.sin(heading)
    return c * x - s * y + at_x, s * x + c * y + at_y


def by_scan(segments: Sequence[Segment], scans: Sequence[int]) -> list[list[int]]:
    """The segments that have a length, scan after scan."""
    long = [i for i, s in enumerate(segments) if segment_length(s) >= SAME]
    return [[i for i in long if scans[i] == scan] for scan in sorted({scans[i] for i in long})]


def parents_of(groups: Iterable[Iterable[int]], count: int) -> list[int]:
    """Of each of so many segments the index of the group that it is in; -1 for none."""
    parents = [-1] * count
    for k, group in enumerate(groups):
        for i in group:
            parents[i] = k
    return parents


def chains(count: int, near: Callable[[int, int], bool]) -> list[list[int]]:
    """Connected sets of the numbers 0 to count - 1, by lowest member, each ascending."""
    unvisited, sets = set(range(count)), []
    while unvisited:
        chain, todo = [], [min(unvisited)]
        unvisited.discard(todo[0])
        while todo:
            i = todo.pop()
            chain.append(i)
            new = {j for j in unvisited if near(i, j)}
            unvisited -= new
            todo += new
        sets.append(sorted(chain))
    return sets


def line_at(x: float, y: float, theta: float, offset: float, ends: Sequence[Point]) -> Segment:
    """The span of all end points on a line that is shifted across by `offset`."""
    return spanning(x - offset * math.sin(theta), y + offset * math.cos(theta), theta, ends)


def is_longer(u: Segment, v: Segment) -> bool:
    """Whether a segment is longer than another."""
    return segment_length(u) > segment_length(v) + SAME
