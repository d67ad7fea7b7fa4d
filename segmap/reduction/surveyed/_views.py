"""What a scan says of the walls of a map: steps 1 to 3 of the viewing sector (A 2.7.5)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array
from ...compiled import compiled
from ...kernels import length_of
from .lines import SAME, Point, Segment

#: What a stretch of a scan says of a wall: it lies on it, before it, or behind it.
SAYS = "matches", "hides", "gone"


class View(NamedTuple):
    """What stretch t0 to t1 of a segment of a scan says of the stretch u0 to u1 of a wall, metres.

    `off` is its mean distance from the line of the wall.
    """

    wall: int
    segment: int
    says: str
    t0: float
    t1: float
    u0: float
    u1: float
    off: float


@compiled
def cross(a: Array | Point, b: Array | Point, c: Array | Point) -> float:
    """Twice the area of a triangle: above 0 where c lies to the left of the way from a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@compiled
def facing(p: Array, s: Array, narrow: float) -> float:
    """Twice the area between a segment and the sensor; 0 for one that is seen edge on."""
    double, far = cross(p, s[0], s[1]), 1.0
    for end in range(2):
        far *= math.hypot(s[end, 0] - p[0], s[end, 1] - p[1])
    return double if abs(double) >= max(narrow * far, SAME * length_of(s)) else 0.0


@compiled
def share(left: float, right: float) -> float:
    """Share of the length of a wall at which a ray meets it, from the areas on both sides of it."""
    return left / (left + right) if left + right != 0 else 0.0


@compiled
def mean_off(a: float, b: float) -> float:
    """Mean of |h| while h goes evenly from a to b."""
    return abs(a + b) / 2 if a * b >= 0 else (a * a + b * b) / (2 * (abs(a) + abs(b)))


@compiled
def stretches_seen(
    walls: Array, scan: Array, p: Array, distance: float
) -> list[tuple[int, int, int, float, float, float, float, float]]:
    """Steps 1 to 3: the stretches of a scan inside the sectors of walls, cut where h is +-distance.

    Rows as of a `View`, with the place of what it says in `SAYS`.
    """
    found = []
    for k in range(len(walls)):
        a, b = walls[k, 0], walls[k, 1]
        double, size = facing(p, walls[k], 1e-6), length_of(walls[k])
        sign = 1.0 if double > 0 else -1.0
        for j in range(len(scan) if double != 0 else 0):
            s = scan[j]
            left, left_end = sign * cross(p, a, s[0]), sign * cross(p, a, s[1])
            right, right_end = sign * cross(p, s[0], b), sign * cross(p, s[1], b)
            t0, t1 = 0.0, 1.0
            for begin, end in ((left, left_end), (right, right_end)):
                if begin < 0:
                    t0 = max(t0, begin / (begin - end)) if end > 0 else 2.0
                elif end < 0:
                    t1 = min(t1, begin / (begin - end))
            if t0 >= t1 or facing(p, s, 0.0) == 0:
                continue
            h0, h1 = sign * cross(a, b, s[0]) / size, sign * cross(a, b, s[1]) / size
            cuts = [t0]
            if h1 != h0:  # nothing is cut off that lies at the limit
                at_limit = (distance - h0) / (h1 - h0), (-distance - h0) / (h1 - h0)
                for t in (min(at_limit), max(at_limit)):
                    if min(t - t0, t1 - t) * abs(h1 - h0) > SAME:
                        cuts.append(t)
            cuts.append(t1)
            for n in range(1, len(cuts)):
                begin, end = cuts[n - 1], cuts[n]
                if (end - begin) * length_of(s) <= SAME:
                    continue
                h = h0 + (begin + end) / 2 * (h1 - h0)
                says = 1 if h > distance + SAME else 2 if h < -distance - SAME else 0
                u = size * share(
                    left + begin * (left_end - left), right + begin * (right_end - right)
                )
                v = size * share(left + end * (left_end - left), right + end * (right_end - right))
                off = mean_off(h0 + begin * (h1 - h0), h0 + end * (h1 - h0))
                found.append((k, j, says, begin, end, min(u, v), max(u, v), off))
    return found


def views(
    walls: Sequence[Segment], scan: Sequence[Segment], p: Point, distance: float
) -> list[View]:
    """What the segments of a scan, taken from p, say of walls: wall after wall."""
    found = stretches_seen(as_rows(walls), as_rows(scan), np.array(p, float), distance)
    return [View(k, j, SAYS[says], *where) for k, j, says, *where in found]


def as_rows(segments: ArrayLike) -> Array:
    """Segments as an array (n, 2, 2), metres."""
    return np.array(segments, float).reshape(-1, 2, 2)
