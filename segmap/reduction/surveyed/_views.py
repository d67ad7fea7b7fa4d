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
def view_area(p: Array, s: Array, narrow: float) -> float:
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
def mix(x: float, y: float, t: float) -> float:
    """From x to y by a share t of the way."""
    return x + t * (y - x)


@compiled
def in_sector(l0: float, l1: float, r0: float, r1: float) -> tuple[float, float]:
    """Step 1: the part of a stretch inside a sector, as shares t0 to t1 of it; none: t0 > t1.

    `l0` and `l1` tell how far its ends lie inside the left ray, `r0` and `r1` inside the right one.
    """
    t0, t1 = 0.0, 1.0
    for begin, end in ((l0, l1), (r0, r1)):
        if begin < 0:
            t0 = max(t0, begin / (begin - end)) if end > 0 else 2.0
        elif end < 0:
            t1 = min(t1, begin / (begin - end))
    return t0, t1


@compiled
def cuts_at(h0: float, h1: float, t0: float, t1: float, distance: float) -> list[float]:
    """Step 2: the shares t0 to t1, and between them those where h is plus or minus the distance."""
    cuts = [t0]
    if h1 != h0:  # nothing is cut off that lies at the limit
        at_limit = (distance - h0) / (h1 - h0), (-distance - h0) / (h1 - h0)
        for t in (min(at_limit), max(at_limit)):
            if min(t - t0, t1 - t) * abs(h1 - h0) > SAME:
                cuts.append(t)
    cuts.append(t1)
    return cuts


@compiled
def says_at(h: float, distance: float) -> int:
    """What a part says that lies h from the line of a wall: its place in `SAYS`."""
    return 1 if h > distance + SAME else 2 if h < -distance - SAME else 0


@compiled
def stretches_of(
    wall: Array, s: Array, p: Array, distance: float
) -> list[tuple[int, float, float, float, float, float, float]]:
    """What a segment says of a wall: the word, its part, that of the wall, h at the ends.

    The first number is the place in `SAYS`; the next are shares of the segment, metres along the
    wall, and distances from its line, above 0 on the side of the sensor.
    """
    a, b, size, sign = wall[0], wall[1], length_of(wall), np.sign(cross(p, wall[0], wall[1]))
    l0, l1 = sign * cross(p, a, s[0]), sign * cross(p, a, s[1])
    r0, r1 = sign * cross(p, s[0], b), sign * cross(p, s[1], b)
    h0, h1 = sign * cross(a, b, s[0]) / size, sign * cross(a, b, s[1]) / size
    t0, t1 = in_sector(l0, l1, r0, r1)
    cuts, stretches = cuts_at(h0, h1, t0, t1, distance), []
    for n in range(1, len(cuts) if t0 < t1 else 0):
        t, end = cuts[n - 1], cuts[n]
        u = size * share(mix(l0, l1, t), mix(r0, r1, t))
        v = size * share(mix(l0, l1, end), mix(r0, r1, end))
        says = says_at(mix(h0, h1, (t + end) / 2), distance)
        stretches.append((says, t, end, min(u, v), max(u, v), mix(h0, h1, t), mix(h0, h1, end)))
    return stretches


@compiled
def stretches_seen(
    walls: Array, scan: Array, p: Array, distance: float
) -> list[tuple[int, int, int, float, float, float, float, float]]:
    """The stretches of a scan in the sectors of walls: rows of a `View`, its word as a number."""
    stretches = []
    for k in range(len(walls)):
        for j in range(len(scan) if view_area(p, walls[k], 1e-6) != 0 else 0):
            if view_area(p, scan[j], 0.0) == 0:
                continue
            for says, t0, t1, u0, u1, h0, h1 in stretches_of(walls[k], scan[j], p, distance):
                if (t1 - t0) * length_of(scan[j]) > SAME:
                    stretches.append((k, j, says, t0, t1, u0, u1, mean_off(h0, h1)))
    return stretches


def views(
    walls: Sequence[Segment], scan: Sequence[Segment], p: Point, distance: float
) -> list[View]:
    """What the segments of a scan, taken from p, say of walls: wall after wall."""
    stretches = stretches_seen(as_rows(walls), as_rows(scan), np.array(p, float), distance)
    return [View(k, j, SAYS[says], *where) for k, j, says, *where in stretches]


def as_rows(segments: ArrayLike) -> Array:
    """Segments as an array (n, 2, 2), metres."""
    return np.array(segments, float).reshape(-1, 2, 2)
