"""What plain loops over segments need: points `(x, y)` in metres, angles in radians, running sums.

Nothing here is compiled: a surveyed method compiles what it does for each pair, and no more.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...kernels import SAME as SAME
from .._runner import Indices

Point = Sequence[float]
Segment = Sequence[Point]
#: A point of a line, metres, and its unit direction.
Line = tuple[float, float, float, float]


def segment_length(s: Segment) -> float:
    """Length of a segment, metres."""
    return math.hypot(s[1][0] - s[0][0], s[1][1] - s[0][1])


def line_angle(s: Segment) -> float:
    """Angle of a segment from its first end to its second, radians, of either sign."""
    return math.atan2(s[1][1] - s[0][1], s[1][0] - s[0][0])


def axial_difference(a: float, b: float) -> float:
    """From b to a for lines without direction: in `[-pi/2, pi/2)`, radians."""
    return (a - b + math.pi / 2) % math.pi - math.pi / 2


def seen_from(line: Line, p: Point) -> tuple[float, float]:
    """How far a point lies along a line and to the left of it, metres."""
    x, y, dx, dy = line
    return (p[0] - x) * dx + (p[1] - y) * dy, (p[1] - y) * dx - (p[0] - x) * dy


def gap_along(u: Segment, v: Segment, angle: float) -> float:
    """Metres between two segments along a direction; negative where they overlap."""
    c, s = math.cos(angle), math.sin(angle)
    a, b = ([p[0] * c + p[1] * s for p in ends] for ends in (u, v))
    return max(min(a), min(b)) - min(max(a), max(b))


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


def parents_of(groups: Iterable[Iterable[int]], count: int) -> Indices:
    """Of each of so many segments the index of the group that it is in; -1 for none."""
    parents = np.full(count, -1)
    for k, group in enumerate(groups):
        for i in group:
            parents[i] = k
    return parents


def holds_most(shares: Sequence[Mapping[int, float]], count: int) -> Indices:
    """The output that holds most of each of so many inputs, -1 for none; ties: the first.

    Each output tells what it holds of its inputs: metres, or points.
    """
    most, owner = [0.0] * count, np.full(count, -1)
    for amounts in shares:
        for i, share in amounts.items():
            most[i] = max(most[i], share)
    for k in range(len(shares) - 1, -1, -1):
        for i, share in shares[k].items():
            if most[i] > 0 and share >= most[i] - SAME:
                owner[i] = k
    return owner


@dataclass
class Sums:
    """Number, mean and scatter about the mean of points: as exact far from the origin as near.

    `xx`, `xy`, `yy` are square metres.
    """

    n: float
    x: float
    y: float
    xx: float
    xy: float
    yy: float

    def __add__(self, other: Sums) -> Sums:
        n, dx, dy = self.n + other.n, other.x - self.x, other.y - self.y
        share, both = other.n / n, self.n * other.n / n
        return Sums(
            n,
            self.x + share * dx,
            self.y + share * dy,
            self.xx + other.xx + both * dx * dx,
            self.xy + other.xy + both * dx * dy,
            self.yy + other.yy + both * dy * dy,
        )

    def direction(self) -> float:
        """Angle of the line that fits best, radians: it goes through the mean."""
        return 0.5 * math.atan2(2 * self.xy, self.xx - self.yy)


def sums_of(points: Sequence[Point]) -> Sums:
    """Running sums of points, metres."""
    n = float(len(points))
    x, y = sum(p[0] for p in points) / n, sum(p[1] for p in points) / n
    xx = sum((p[0] - x) * (p[0] - x) for p in points)
    xy = sum((p[0] - x) * (p[1] - y) for p in points)
    yy = sum((p[1] - y) * (p[1] - y) for p in points)
    return Sums(n, x, y, xx, xy, yy)


def sums_along(s: Segment, n: float) -> Sums:
    """Running sums of so many points that lie evenly on a segment."""
    (ax, ay), (bx, by) = s
    dx, dy = bx - ax, by - ay
    return Sums(
        n, (ax + bx) / 2, (ay + by) / 2, n * dx * dx / 12, n * dx * dy / 12, n * dy * dy / 12
    )
