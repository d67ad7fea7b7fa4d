"""The points behind segments, and running sums of them, for the methods that need points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from .lines import Point, Segment, segment_length


def stand_ins(s: Segment, spacing: float) -> list[Point]:
    """Points on a segment whose own were not kept: one each `spacing` metres, at least two."""
    (ax, ay), (bx, by) = s
    count = max(2, math.floor(segment_length(s) / spacing + 1e-9) + 1)
    shares = [(i + 0.5) / count for i in range(count)]
    return [(ax + t * (bx - ax), ay + t * (by - ay)) for t in shares]


def points_behind(
    segments: Sequence[Segment], points: Sequence[Sequence[Point]] | None, spacing: float
) -> Sequence[Sequence[Point]]:
    """The points of each segment: those that were kept, or others in their place."""
    return [stand_ins(s, spacing) for s in segments] if points is None else points


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


def sums_of(points: Sequence[Point], weights: Sequence[float] | None = None) -> Sums:
    """Running sums of points, metres, each counted once or as often as its weight says."""
    rows = list(zip([1.0] * len(points) if weights is None else weights, points, strict=True))
    n = sum(w for w, _ in rows)
    x, y = sum(w * p[0] for w, p in rows) / n, sum(w * p[1] for w, p in rows) / n
    xx = sum(w * (p[0] - x) * (p[0] - x) for w, p in rows)
    xy = sum(w * (p[0] - x) * (p[1] - y) for w, p in rows)
    yy = sum(w * (p[1] - y) * (p[1] - y) for w, p in rows)
    return Sums(n, x, y, xx, xy, yy)


def sums_along(s: Segment, n: float) -> Sums:
    """Running sums of so many points that lie evenly on a segment."""
    (ax, ay), (bx, by) = s
    dx, dy = bx - ax, by - ay
    return Sums(
        n, (ax + bx) / 2, (ay + by) / 2, n * dx * dx / 12, n * dx * dy / 12, n * dy * dy / 12
    )
