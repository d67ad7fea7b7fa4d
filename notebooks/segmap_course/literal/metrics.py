"""Segment distance and quality (A 2.7.7, 6.2.2), term by term."""

from __future__ import annotations

import math
from collections.abc import Sequence

from .lines import (
    SAME,
    Line,
    Segment,
    axial_difference,
    line_angle,
    point_to_segment,
    segment_length,
)


def nearness(u: Segment, v: Segment) -> float:
    """D_uv: the least distance from an end of one segment to the other one, metres."""
    return min(*(point_to_segment(p, v) for p in u), *(point_to_segment(p, u) for p in v))


def mean_lines(
    u: Segment, v: Segment, weight_u: float = 1.0, weight_v: float = 1.0
) -> list[tuple[float, Line]]:
    """Mean line of two segments, both where they are perpendicular.

    Each comes with `0.66 D_ang + 0.09 D_uva`, metres.
    """
    size_u, size_v = segment_length(u), segment_length(v)
    at_u = line_angle(u) if size_u >= SAME else line_angle(v) if size_v >= SAME else 0.0
    at_v = line_angle(v) if size_v >= SAME else at_u
    share, turn = weight_v / (weight_u + weight_v), axial_difference(at_v, at_u)
    turns = [turn] if abs(abs(turn) - math.pi / 2) > 1e-9 else [math.pi / 2, -math.pi / 2]
    x, y = ((1 - share) * (u[0][k] + u[1][k]) / 2 + share * (v[0][k] + v[1][k]) / 2 for k in (0, 1))
    found = []
    for direction in (at_u + share * turn for turn in turns):
        d_ang = (1 - share) * size_u * math.tan(abs(axial_difference(at_u, direction)))
        d_ang += share * size_v * math.tan(abs(axial_difference(at_v, direction)))
        dx, dy = math.cos(direction), math.sin(direction)
        d_uva = max(abs((p[1] - y) * dx - (p[0] - x) * dy) for p in (*u, *v))
        found.append((0.66 * d_ang + 0.09 * d_uva, (x, y, dx, dy)))
    return found


def segment_distance(u: Segment, v: Segment, weight_u: float = 1.0, weight_v: float = 1.0) -> float:
    """`0.66 D_ang + 0.09 D_uva + 0.25 D_uv`, metres; of two mean directions the smaller value."""
    return min(mean_lines(u, v, weight_u, weight_v))[0] + 0.25 * nearness(u, v)


def quality(before: Sequence[Segment], after: Sequence[Segment], *, scale: float = 0.050) -> float:
    """`exp(-mean distance to the nearest segment left / scale)`; scale in metres."""
    walls = [s for s in before if segment_length(s) >= SAME]  # what has no length is no wall
    if len(walls) == 0:
        return 1.0 if len(before) or len(after) else math.nan
    if len(after) == 0:
        return 0.0
    mean = sum(min(segment_distance(s, t) for t in after) for s in walls) / len(walls)
    return math.exp(-mean / scale)
