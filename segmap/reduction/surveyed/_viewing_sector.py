"""The viewing sector (A 2.7.5; Gonzalez et al. 1994): seen again, hidden, gone or not looked at."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ...arrays import Metres, Segments, checked
from .._points import points_behind
from .._runner import Length, Reduction, Rows, Steps, run_online
from ._views import View, cross, share, views
from .lines import (
    SAME,
    Point,
    Segment,
    Sums,
    holds_most,
    line_angle,
    segment_length,
    spanning,
    sums_along,
    sums_of,
)

#: Where a stretch begins and ends along a segment: metres, or shares of its length.
Interval = tuple[float, float]


@checked
def viewing_sector(
    map: Segments,
    *,
    distance: Metres = 0.10,
    min_length: Length = 0.10,
    forget: bool = True,
    rejoin: bool = True,
    spacing: Metres = 0.05,
) -> Reduction:
    """Compare each segment with what a scan has in its sector (A 2.7.5; Gonzalez et al. 1994).

    From its place the sensor sees a segment of the map inside a sector. A stretch of the scan in
    this sector and within `distance` of its line matches: its points join those of the segment,
    whose line is fitted anew. A stretch nearer to the sensor hides it. A stretch behind it saw
    through it: what no other stretch matches or hides is removed. It is the only method here that
    forgets, hence the only one for buildings that change; but an error of the pose erases walls,
    and two segments of the map are never compared with each other.

    A cuts each segment into its matched, hidden and unseen pieces and keeps each, which makes maps
    longer; `rejoin` keeps them as one, and is ours. So are `min_length` and the order of the map.

    Parameters
    ----------
    map : SegmentMap
        With the places of the sensor, and best with points: `build_map(..., keep_points=True)`.
        Scans come in ascending order.
    distance
        A stretch of the scan nearer than this to a line matches it (A's delta): 0.10 m is wider
        than the noise of a pose and narrower than an open door.
    min_length
        Shorter pieces are neither removed nor added.
    forget
        Whether to remove what was seen through.
    rejoin
        False cuts the map at the ends of what was matched, as A does.
    spacing
        As in `weighted_line_fitting`.

    Returns
    -------
    Reduction
        In the order of the map: pieces where their segment was, then what each scan added. A
        segment that ends in several pieces has the one as parent that holds most of it; -1 for one
        that was removed, or is too short; with seconds and segments in the map for each scan.

    Raises
    ------
    ValueError
        For a map without places of the sensor.

    References
    ----------
    Gonzalez, Ollero, Reina, "Map building for a mobile robot equipped with a 2D laser rangefinder",
    ICRA 1994.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> door = [[(-2, 3), (2, 3)], [(-2, 3), (-1, 3)], [(1, 3), (2, 3)], [(-2, 5), (2, 5)]]
    >>> reduction = viewing_sector(SegmentMap(door, [0, 1, 1, 1], sensors=[(0, 0), (0, 0)]))
    >>> reduction.segments[:, :, 0].round(6), reduction.parents
    (array([[-2., -1.],
           [ 1.,  2.],
           [-2.,  2.]]), array([0, 0, 1, 2]))
    """
    limits = distance, max(min_length, 10 * SAME)

    def steps(rows: Rows) -> Steps:
        points, first, sensors, has_points = points_behind(map, rows, None)
        if np.isnan(sensors).any():
            raise ValueError(
                "map must tell where its sensor was: build_map(log, poses, keep_points=True) does, "
                "or SegmentMap(segments, scan, sensors=...)"
            )
        walls: list[Wall] = []
        for begin, stop in rows.scans():
            p, scan = sensors[begin].tolist(), list[Wall]()
            for i in range(begin, stop):
                s = rows.segments[i].tolist()
                s = s if cross.plain(p, s[0], s[1]) <= 0 else s[::-1]
                size = segment_length(s)
                behind = points[first[i] : first[i + 1]].tolist() if has_points else []
                sums = sums_of(behind) if has_points else sums_along(s, size / spacing)
                scan.append(Wall(s, sums, {i: size}))
            walls = take_scan(walls, scan, p, limits, forget, rejoin)
            yield len(walls)
        out = np.array([wall.ends for wall in walls]).reshape(-1, 2, 2)
        return out, holds_most([wall.shares for wall in walls], len(rows.segments))

    return run_online("viewing_sector", map, steps, splits=True)


class Wall(NamedTuple):
    """A segment of the map, its running sums, and the metres that it holds of each input."""

    ends: Segment
    sums: Sums
    shares: dict[int, float]


def at(s: Segment, t: float) -> Point:
    """Point of a segment at a share t of its length."""
    return s[0][0] + t * (s[1][0] - s[0][0]), s[0][1] + t * (s[1][1] - s[0][1])


def kept_pieces(
    size: float, seen: Sequence[tuple[str, float, float]], min_length: float, forget: bool
) -> list[Interval]:
    """Step 5: what stays of a wall, metres along it: all but what was only seen through."""
    cuts = sorted({0.0, size, *(u for _, *ends in seen for u in ends)})
    gone: list[Interval] = []
    for a, b in pairwise(cuts):
        says = [word for word, low, high in seen if low < (a + b) / 2 < high]
        if says and set(says) == {"gone"}:
            start = gone.pop()[0] if gone and a - gone[-1][1] <= SAME else a
            gone.append((start, b))
    gone = [(a, b) for a, b in gone if forget and b - a >= min_length - SAME]
    edges = [0.0, *(u for piece in gone for u in piece), size]
    pieces = list(zip(edges[::2], edges[1::2], strict=True))
    return [(a, b) for a, b in pieces if not gone or b - a >= min_length - SAME]


def cut_pieces(pieces: list[Interval], seen: Sequence[View], min_length: float) -> list[Interval]:
    """What stays of a wall, cut at the ends of what matches, as A has it."""
    for cut in sorted(u for v in seen if v.says == "matches" for u in (v.u0, v.u1)):
        for k, (a, b) in enumerate(pieces):
            if min(cut - a, b - cut) >= min_length - SAME:
                pieces = [*pieces[:k], (a, cut), (cut, b), *pieces[k + 1 :]]
                break
    return pieces


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
    shares = {i: f * metres for i, metres in wall.shares.items()}
    return Wall((at(wall.ends, t0), at(wall.ends, t1)), sums, shares)


def join(wall: Wall, parts: Sequence[Wall]) -> Wall:
    """Step 6: sums add, the line is that of the sums, and it spans all end points."""
    if not parts:
        return wall
    sums, shares = wall.sums, dict(wall.shares)
    for other in parts:
        sums = sums + other.sums
        for i, metres in other.shares.items():
            shares[i] = shares.get(i, 0.0) + metres
    theta, own = sums.direction(), line_angle(wall.ends)
    if math.hypot(2 * sums.xy, sums.xx - sums.yy) <= SAME * (sums.xx + sums.yy):
        theta = own  # they are as wide as long
    if math.cos(own + SAME - theta) < 0:  # SAME: a right angle is no tie
        theta += math.pi
    ends = spanning(sums.x, sums.y, theta, [q for one in (wall, *parts) for q in one.ends])
    # what would have no length stays
    return Wall(ends if segment_length(ends) > SAME else wall.ends, sums, shares)


def stretches(claims: Sequence[View], size: float) -> list[tuple[float, float, int]]:
    """Step 4: each stretch of a scan segment and the claim that gets it, -1 for none."""
    cuts = sorted({0.0, 1.0, *(t for v in claims for t in (v.t0, v.t1))})
    pieces: list[tuple[float, float, int]] = []
    for begin, end in pairwise(cuts):
        if (end - begin) * size <= SAME:
            continue
        middle = (begin + end) / 2
        near = [(v.off, c) for c, v in enumerate(claims) if v.t0 <= middle <= v.t1]
        least = min(near, default=(0.0, -1))[0]
        best = next((c for off, c in near if off <= least + 1e-12), -1)
        if pieces and pieces[-1][2] == best:
            pieces[-1] = pieces[-1][0], end, best
        else:
            pieces.append((begin, end, best))
    return pieces


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
    seen: dict[int, list[View]] = {}
    claims: list[list[View]] = [[] for _ in scan]
    for view in views([w.ends for w in walls], [s.ends for s in scan], p, distance):
        seen.setdefault(view.wall, []).append(view)
        if view.says == "matches":
            claims[view.segment].append(view)
    pieces = {}
    for k, row in seen.items():
        if any(view.says != "hides" for view in row):  # what is hidden alone stays as it is
            words = [(view.says, view.u0, view.u1) for view in row]
            stay = kept_pieces(segment_length(walls[k].ends), words, min_length, forget)
            pieces[k] = stay if rejoin else cut_pieces(stay, row, min_length)
    parts: dict[int, list[list[Wall]]] = {k: [[] for _ in row] for k, row in pieces.items()}
    new = []
    for s, its in zip(scan, claims, strict=True):
        size = segment_length(s.ends)
        for t0, t1, c in stretches(its, size):
            own = part(s, t0, t1)
            if c >= 0 and pieces[its[c].wall]:
                k = its[c].wall
                u = middle_on(walls[k].ends, own.ends, p)
                off = [max(a - u, u - b, 0.0) for a, b in pieces[k]]
                parts[k][next(i for i, d in enumerate(off) if d <= min(off) + SAME)].append(own)
            elif c >= 0 or (t1 - t0) * size >= min_length - SAME:
                new.append(own)
    after = []
    for k, wall in enumerate(walls):
        if k not in pieces:
            after.append(wall)
            continue
        size = segment_length(wall.ends)
        for (a, b), got in zip(pieces[k], parts[k], strict=True):
            after.append(join(part(wall, a / size, b / size), got))
    return after + new


def middle_on(wall: Segment, stretch: Segment, p: Point) -> float:
    """Middle, metres along a wall, of where a stretch falls on it along the rays from p."""
    area = cross.plain
    shares = [share.plain(area(p, wall[0], q), area(p, q, wall[1])) for q in stretch]
    return segment_length(wall) * sum(shares) / 2
