"""What all plain methods need: lengths, angles, distances and chains of plain numbers.

A point is (x, y) in metres, a segment a pair of points, an angle is in radians.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

Point = Sequence[float]
Segment = Sequence[Point]
#: A point of a line, metres, and its unit direction.
Line = tuple[float, float, float, float]

#: Shorter than this a segment has no angle; lengths and gaps that differ by less are equal. Metres.
SAME = 1e-9


def segment_length(s: Segment) -> float:
    """Length of a segment, metres."""
    return math.hypot(s[1][0] - s[0][0], s[1][1] - s[0][1])


def line_angle(s: Segment) -> float:
    """Angle of a segment from its first end to its second, radians, of either sign."""
    return math.atan2(s[1][1] - s[0][1], s[1][0] - s[0][0])


def parents_of(groups: Iterable[Iterable[int]], count: int) -> list[int]:
    """Of each of so many segments the index of the group that it is in; -1 for none."""
    parents = [-1] * count
    for k, group in enumerate(groups):
        for i in group:
            parents[i] = k
    return parents


def axial_difference(a: float, b: float) -> float:
    """From b to a for lines without direction: in `[-pi/2, pi/2)`, radians."""
    return (a - b + math.pi / 2) % math.pi - math.pi / 2


def point_to_segment(p: Point, s: Segment) -> float:
    """Distance of a point from a segment, metres: from its line, or beyond an end from that end."""
    length = segment_length(s)
    if length == 0:
        return math.dist(p, s[0])
    dx, dy = (s[1][0] - s[0][0]) / length, (s[1][1] - s[0][1]) / length
    along = (p[0] - s[0][0]) * dx + (p[1] - s[0][1]) * dy
    if along < 0:
        return math.dist(p, s[0])
    if along > length:
        return math.dist(p, s[1])
    return abs((p[0] - s[0][0]) * dy - (p[1] - s[0][1]) * dx)


def extreme_projections(points: Sequence[Point], line: Line) -> list[tuple[float, float]]:
    """Segment on a line that just spans the projections of points."""
    x, y, dx, dy = line
    u = [(p[0] - x) * dx + (p[1] - y) * dy for p in points]
    return [(x + w * dx, y + w * dy) for w in (min(u), max(u))]


def chains(count: int, near: Callable[[int, int], bool]) -> list[list[int]]:
    """Connected sets of the numbers 0 to count - 1, by lowest member, each ascending."""
    left, found = set(range(count)), []
    while left:
        chain, todo = [], [min(left)]
        left.discard(todo[0])
        while todo:
            i = todo.pop()
            chain.append(i)
            new = {j for j in left if near(i, j)}
            left -= new
            todo += new
        found.append(sorted(chain))
    return found
