"""The viewing sector (A 2.7.5; Gonzalez et al. 1994): seen again, hidden, gone or not looked at."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from ..lines import (
    SAME,
    Found,
    Point,
    Segment,
    by_scan,
    line_angle,
    segment_length,
    spanning,
)
from ..points import Sums, sums_along, sums_of

#: Where a stretch begins and ends along a segment: metres, or shares of its length.
Interval = tuple[float, float]


class Wall(NamedTuple):
    """A segment of the map, its running sums, and the metres that it holds of each input."""

    ends: Segment
    sums: Sums
    shares: dict[int, float]


class View(NamedTuple):
    """What stretch t0 to t1 of a scan segment says of the stretch u0 to u1, metres, of a wall."""

    says: str
    t0: float
    t1: float
    u0: float
    u1: float
    off: float


def cross(a: Point, b: Point, c: Point) -> float:
    """Twice the area of a triangle: above 0 where c lies to the left of the way from a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def facing(p: Point, s: Segment, narrow: float = 0.0) -> float:
    """Twice the area between a segment and the sensor; 0 for one that is seen edge on."""
    double, far = cross(p, *s), math.dist(p, s[0]) * math.dist(p, s[1])
    return double if abs(double) >= max(narrow * far, SAME * segment_length(s)) else 0.0


def at(s: Segment, t: float) -> Point:
    """Point of a segment at a share t of its length."""
    return s[0][0] + t * (s[1][0] - s[0][0]), s[0][1] + t * (s[1][1] - s[0][1])


def share(left: float, right: float) -> float:
    """Share of the length of a wall at which a ray meets it, from the areas on both sides of it."""
    return left / (left + right) if left + right != 0 else 0.0


def mean_off(a: float, b: float) -> float:
    """Mean of |h| while h goes evenly from a to b."""
    return abs(a + b) / 2 if a * b >= 0 else (a * a + b * b) / (2 * (abs(a) + abs(b)))


def views(wall: Segment, s: Segment, p: Point, distance: float) -> list[View]:
    """Steps 1 to 3: the stretches of s inside the sector of a wall, cut where h is +-distance."""
    a, b = wall
    double, size = facing(p, wall, 1e-6), segment_length(wall)
    if double == 0 or facing(p, s) == 0:
        return []
    sign = math.copysign(1.0, double)

    def sides(t: float) -> tuple[float, float]:
        return sign * cross(p, a, at(s, t)), sign * cross(p, at(s, t), b)

    t0, t1 = 0.0, 1.0
    for begin, end in zip(sides(0), sides(1), strict=True):
        if begin < 0:
            t0 = max(t0, begin / (begin - end)) if end > 0 else 2.0
        elif end < 0:
            t1 = min(t1, begin / (begin - end))
    h0, h1 = (sign * cross(a, b, q) / size for q in s)
    cuts = [(bound - h0) / (h1 - h0) for bound in (distance, -distance) if h1 != h0]
    cuts = [t for t in cuts if min(t - t0, t1 - t) * abs(h1 - h0) > SAME]
    cuts = [t0, *sorted(cuts), t1]
    found = []
    for begin, end in pairwise(cuts):
        if (end - begin) * segment_length(s) <= SAME:
            continue
        h = h0 + (begin + end) / 2 * (h1 - h0)
        says = "hides" if h > distance + SAME else "gone" if h < -distance - SAME else "matches"
        u0, u1 = sorted(size * share(*sides(t)) for t in (begin, end))
        off = mean_off(h0 + begin * (h1 - h0), h0 + end * (h1 - h0))
        found.append(View(says, begin, end, u0, u1, off))
    return found


def union(intervals: Sequence[Interval]) -> list[Interval]:
    """Intervals that touch become one."""
    found: list[Interval] = []
    for low, high in sorted(intervals):
        if found and low <= found[-1][1] + SAME:
            found[-1] = found[-1][0], max(high, found[-1][1])
        else:
            found.append((low, high))
    return found


def minus(intervals: Sequence[Interval], others: Sequence[Interval]) -> list[Interval]:
    """What the others leave of intervals that do not overlap."""
    left = list(intervals)
    for low, high in others:
        left = [
            piece
            for a, b in left
            for piece in (
                [(a, min(b, low)), (max(a, high), b)] if low < b and high > a else [(a, b)]
            )
            if piece[1] > piece[0]
        ]
    return left


def kept_pieces(
    size: float, seen: Sequence[View], min_length: float, forget: bool, rejoin: bool
) -> list[Interval]:
    """Step 5: what stays of a wall, metres along it."""
    gone = union([(v.u0, v.u1) for v in seen if v.says == "gone"])
    gone = union(minus(gone, [(v.u0, v.u1) for v in seen if v.says != "gone"]))
    gone = [(a, b) for a, b in gone if forget and b - a >= min_length - SAME]
    kept = [(0.0, size)]
    if gone:
        kept = [(a, b) for a, b in minus(kept, gone) if b - a >= min_length - SAME]
    cuts = sorted(u for v in seen if v.says == "matches" for u in (v.u0, v.u1))
    for cut in () if rejoin else cuts:
        kept = [
            piece
            for a, b in kept
            for piece in (
                [(a, cut), (cut, b)] if min(cut - a, b - cut) >= min_length - SAME else [(a, b)]
            )
        ]
    return kept


def part(wall: Wall, t0: float, t1: float) -> Wall:
    """What a wall is from a share t0 of its length to t1."""
    s, f, size = wall.sums, t1 - t0, segment_length(wall.ends)
    if max(t0, 1 - t1) * size <= SAME:
        return wall
    dx, dy = (wall.ends[1][0] - wall.ends[0][0]) / size, (wall.ends[1][1] - wall.ends[0][1]) / size
    shift = ((t0 + t1) / 2 - 0.5) * size
    along = s.n * f * (f * size) * (f * size) / 12
    across = f * (s.xx * dy * dy - 2 * s.xy * dx * dy + s.yy * dx * dx)
    xx, yy = along * dx * dx + across * dy * dy, along * dy * dy + across * dx * dx
    sums = Sums(s.n * f, s.x + shift * dx, s.y + shift * dy, xx, (along - across) * dx * dy, yy)
    shares = {i: f * held for i, held in wall.shares.items()}
    return Wall((at(wall.ends, t0), at(wall.ends, t1)), sums, shares)


def joined(wall: Wall, parts: Sequence[Wall]) -> Wall:
    """Step 6: sums add, the line is that of the sums, and it spans all end points."""
    if not parts:
        return wall
    sums, shares = wall.sums, dict(wall.shares)
    for other in parts:
        sums = sums + other.sums
        for i, held in other.shares.items():
            shares[i] = shares.get(i, 0.0) + held
    theta, own = sums.direction(), line_angle(wall.ends)
    if math.hypot(2 * sums.xy, sums.xx - sums.yy) <= SAME * (sums.xx + sums.yy):
        theta = own  # they are as wide as long
    if math.cos(own + SAME - theta) < 0:  # SAME: a right angle is no tie
        theta += math.pi
    ends = spanning(sums.x, sums.y, theta, [q for one in (wall, *parts) for q in one.ends])
    # what would have no length stays
    return Wall(ends if segment_length(ends) > SAME else wall.ends, sums, shares)


def stretches(claims: Sequence[tuple[int, View]], size: float) -> list[tuple[float, float, int]]:
    """Step 4: each stretch of a scan segment and the claim that gets it, -1 for none."""
    cuts = sorted({0.0, 1.0, *(t for _, v in claims for t in (v.t0, v.t1))})
    found: list[tuple[float, float, int]] = []
    for begin, end in pairwise(cuts):
        if (end - begin) * size <= SAME:
            continue
        middle = (begin + end) / 2
        near = [(v.off, c) for c, (_, v) in enumerate(claims) if v.t0 <= middle <= v.t1]
        best = next((c for off, c in near if off <= min(near)[0] + 1e-12), -1)
        if found and found[-1][2] == best:
            found[-1] = found[-1][0], end, best
        else:
            found.append((begin, end, best))
    return found


def take_scan(
    walls: list[Wall],
    scan: list[Wall],
    p: Point,
    limits: tuple[float, float],
    forget: bool,
    rejoin: bool,
) -> list[Wall]:
    """The map after a scan that was taken from p."""
    distance, min_length = limits
    seen = [[views(w.ends, s.ends, p, distance) for s in scan] for w in walls]
    sizes = [segment_length(w.ends) for w in walls]
    pieces = [
        kept_pieces(size, [v for its in row for v in its], min_length, forget, rejoin)
        for size, row in zip(sizes, seen, strict=True)
    ]
    parts: list[list[list[Wall]]] = [[[] for _ in row] for row in pieces]
    new = []
    for j, s in enumerate(scan):
        claims = [(k, v) for k, row in enumerate(seen) for v in row[j] if v.says == "matches"]
        size = segment_length(s.ends)
        for t0, t1, c in stretches(claims, size):
            own = part(s, t0, t1)
            if c >= 0 and pieces[claims[c][0]]:
                k = claims[c][0]
                u = middle_on(walls[k].ends, own.ends, p)
                off = [max(a - u, u - b, 0.0) for a, b in pieces[k]]
                parts[k][next(i for i, d in enumerate(off) if d <= min(off) + SAME)].append(own)
            elif c >= 0 or (t1 - t0) * size >= min_length - SAME:
                new.append(own)
    after = []
    for wall, size, row, got in zip(walls, sizes, pieces, parts, strict=True):
        for (a, b), its in zip(row, got, strict=True):
            after.append(joined(part(wall, a / size, b / size), its))
    return after + new


def middle_on(wall: Segment, stretch: Segment, p: Point) -> float:
    """Middle, metres along a wall, of where a stretch falls on it along the rays from p."""
    found = [share(cross(p, wall[0], q), cross(p, q, wall[1])) for q in stretch]
    return segment_length(wall) * sum(found) / 2


def wall_of(i: int, s: Segment, points: Sequence[Point] | None, spacing: float) -> Wall:
    """An input as a wall: its points, or as many as `spacing` puts on it, evenly."""
    size = segment_length(s)
    if points is not None:
        return Wall(s, sums_of(points), {i: size})
    return Wall(s, sums_along(s, size / spacing), {i: size})


def viewing_sector(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    points: Sequence[Sequence[Point]] | None = None,
    sensors: Sequence[Point] = (),
    distance: float = 0.10,
    min_length: float = 0.10,
    forget: bool = True,
    rejoin: bool = True,
    spacing: float = 0.05,
) -> Found:
    """Scan after scan against the map as it was before; step 7 is the order of the map."""
    walls: list[Wall] = []
    for new in by_scan(segments, scans):
        p = sensors[scans[new[0]]]
        seen = {i: s if cross(p, s[0], s[1]) <= 0 else s[::-1] for i in new for s in [segments[i]]}
        scan = [wall_of(i, s, points[i] if points else None, spacing) for i, s in seen.items()]
        walls = take_scan(walls, scan, p, (distance, max(min_length, 10 * SAME)), forget, rejoin)
    parents = []
    for i in range(len(segments)):
        held = [wall.shares.get(i, 0.0) for wall in walls]
        most = max(held, default=0.0)
        parents.append(next(k for k, h in enumerate(held) if h >= most - SAME) if most > 0 else -1)
    return [wall.ends for wall in walls], parents
