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
#: What a reduction returns: its outputs, and of each input the output that it went into, or -1.
Found = tuple[list[Segment], list[int]]

#: Shorter than this a segment has no angle; lengths and gaps that differ by less are equal. Metres.
SAME = 1e-9


def segment_length(s: Segment) -> float:
    """Length of a segment, metres."""
    return math.hypot(s[1][0] - s[0][0], s[1][1] - s[0][1])


def line_angle(s: Segment) -> float:
    """Angle of a segment from its first end to its second, radians, of either sign."""
    return math.atan2(s[1][1] - s[0][1], s[1][0] - s[0][0])


def line_of(s: Segment) -> Line:
    """First end point of a segment, and its unit direction."""
    (x0, y0), (x1, y1) = s
    n = segment_length(s)
    return x0, y0, (x1 - x0) / n, (y1 - y0) / n


def seen_from(line: Line, p: Point) -> tuple[float, float]:
    """How far a point lies along a line and to the left of it, metres."""
    x, y, dx, dy = line
    return (p[0] - x) * dx + (p[1] - y) * dy, (p[1] - y) * dx - (p[0] - x) * dy


def span_on(line: Segment, s: Segment) -> tuple[float, float]:
    """Low and high projection of a segment on another, from its first end point on."""
    low, high = sorted(seen_from(line_of(line), p)[0] for p in s)
    return low, high


def gap_along(u: Segment, v: Segment, angle: float) -> float:
    """Metres between two segments along a direction; negative where they overlap."""
    c, s = math.cos(angle), math.sin(angle)
    a, b = ([p[0] * c + p[1] * s for p in ends] for ends in (u, v))
    return max(min(a), min(b)) - min(max(a), max(b))


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


def axial_difference(a: float, b: float) -> float:
    """From b to a for lines without direction: in `[-pi/2, pi/2)`, radians."""
    return (a - b + math.pi / 2) % math.pi - math.pi / 2


def point_to_segment(p: Point, s: Segment) -> float:
    """Distance of a point from a segment, metres: from its line, or beyond an end from that end."""
    length = segment_length(s)
    if length == 0:
        return math.dist(p, s[0])
    along, across = seen_from(line_of(s), p)
    if along < 0:
        return math.dist(p, s[0])
    if along > length:
        return math.dist(p, s[1])
    return abs(across)


def extreme_projections(points: Sequence[Point], line: Line) -> list[tuple[float, float]]:
    """Segment on a line that just spans the projections of points."""
    x, y, dx, dy = line
    u = [seen_from(line, p)[0] for p in points]
    return [(x + w * dx, y + w * dy) for w in (min(u), max(u))]


def spanning(
    x: float, y: float, angle: float, points: Sequence[Point]
) -> list[tuple[float, float]]:
    """Segment through (x, y) at an angle that just spans the projections of points."""
    return extreme_projections(points, (x, y, math.cos(angle), math.sin(angle)))


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
