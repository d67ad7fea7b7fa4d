"""Angle correspondence (A 2.5.1, 3.3.1; Amigoni, Gasparini and Gini 2006): every pair of angles."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence

from segmap.poses import transform

from ..lines import (
    SAME,
    Segment,
    axial_difference,
    line_angle,
    line_of,
    point_to_segment,
    seen_from,
)

Pose = tuple[float, float, float]


def covered(u: Segment, v: Segment) -> float:
    """Length of u, metres, that v covers when it is projected on u."""
    low, high = sorted(seen_from(line_of(u), p)[0] for p in v)
    return max(0.0, min(high, math.dist(*u)) - max(low, 0.0))


def directed_distance(u: Segment, v: Segment) -> float:
    """A 2.39: distance from u of the farthest point of v, which is one of its ends; metres."""
    return max(point_to_segment(p, u) for p in v)


def intersect(u: Segment, v: Segment) -> bool:
    """Whether two segments that are not parallel share a point, or nearly so."""
    ax, ay, bx, by = (w[1][k] - w[0][k] for w in (u, v) for k in (0, 1))
    rx, ry, det = v[0][0] - u[0][0], v[0][1] - u[0][1], ax * by - ay * bx
    on_u, on_v = rx * by - ry * bx, rx * ay - ry * ax
    return det != 0 and all(-SAME <= part / det <= 1 + SAME for part in (on_u, on_v))


def distance_beside(u: Segment, v: Segment) -> float:
    """Largest distance from the line of u, metres, of the part of v that lies beside u."""
    (a, off_a), (b, off_b) = sorted(seen_from(line_of(u), p) for p in v)
    slope = (off_b - off_a) / (b - a)
    return max(abs(off_a + slope * (t - a)) for t in (max(a, 0.0), min(b, math.dist(*u))))


def match_value(
    u: Segment,
    v: Segment,
    distance: float = 0.05,
    far: float = 0.10,
    long: float = 0.30,
    apart: Callable[[Segment, Segment], float] = directed_distance,
) -> float:
    """A 2.7.10: the length, metres, on which two segments agree, less what they lie apart.

    Zero where they are farther apart than `far`, or cross steeply and are both longer than `long`.
    How far they are apart is A's 2.39, or with `distance_beside` that of the part that both cover.
    """
    lengths = covered(u, v), covered(v, u)
    if min(lengths) <= SAME or (off := min(apart(u, v), apart(v, u))) > far:
        return 0.0
    if not intersect(u, v):
        return sum(lengths) / 2 * 0.95 ** (off / distance)
    steep = abs(axial_difference(line_angle(u), line_angle(v))) > math.pi / 4 + SAME
    both_long = min(math.dist(*u), math.dist(*v)) > long
    return 0.0 if steep and both_long else sum(lengths) / 2


def crossing(u: Segment, v: Segment) -> tuple[float, float]:
    """Where the lines of two segments meet."""
    ax, ay, bx, by = (w[1][k] - w[0][k] for w in (u, v) for k in (0, 1))
    along = ((v[0][0] - u[0][0]) * by - (v[0][1] - u[0][1]) * bx) / (ax * by - ay * bx)
    return u[0][0] + along * ax, u[0][1] + along * ay


def transforms(
    first: Sequence[Segment], second: Sequence[Segment], similar: float
) -> Iterator[Pose]:
    """Poses that lay an angle of the second set on a similar angle of the first (step 1).

    Two angles are similar when they differ by less than `similar`, radians; each pose lays one wall
    on another and the corners on each other. A line has no direction, so half a turn more is tried.
    """
    corners = itertools.permutations(first, 2), itertools.combinations(second, 2)
    for (a, b), (c, d) in itertools.product(*corners):
        angle = axial_difference(line_angle(b), line_angle(a))
        other = axial_difference(line_angle(d), line_angle(c))
        if abs(angle) > similar and abs(axial_difference(angle, other)) < similar:
            for half in (0.0, math.pi):
                heading = line_angle(a) - line_angle(c) + half
                corner = transform((0.0, 0.0, heading), crossing(c, d))
                x, y = crossing(a, b)
                yield x - corner[0], y - corner[1], heading


def value_of(pose: Pose, first: Sequence[Segment], second: Sequence[Segment]) -> float:
    """Sum of the match values, metres, when a pose carries the second set (step 2)."""
    there = transform(pose, second).tolist()
    return sum(match_value(u, v) for u, v in itertools.product(first, there))
