"""The points behind segments, and running sums of them, for the methods that need points."""

from __future__ import annotations

import math
from collections.abc import Sequence

from segmap.reduction.surveyed.lines import Sums as Sums
from segmap.reduction.surveyed.lines import sums_along as sums_along
from segmap.reduction.surveyed.lines import sums_of as sums_of

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
