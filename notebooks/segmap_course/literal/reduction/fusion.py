"""Fusion (A 4.4), with every shift of the strip tried at every step; and scan by scan (A 2.7.9, 7).

A step of the method is a function: chapter 17 shows them one after the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from ..lines import SAME, Found, Segment, by_scan, parents_of

#: Where the two ends of a segment lie along a line, or across it, metres.
Interval = Sequence[float]
#: A wall of a map that grows, and the segments that went into it.
Wall = tuple[Segment, list[int]]
#: Takes the new segments of a scan into the walls of the map.
TakeScan = Callable[[list[Wall], Sequence[Segment], list[int]], None]


def in_strip(v: Sequence[Interval], t: float, tolerance: float) -> list[int]:
    """The segments whose two ends are at most the tolerance from the line at shift t."""
    return [i for i, ends in enumerate(v) if max(abs(w - t) for w in ends) <= tolerance + SAME]


def chain(u: Sequence[Interval], inside: Sequence[int], first: int) -> list[int]:
    """Those inside whose projections overlap one after another from the first, sorted."""
    members, todo = {first}, [first]
    while todo:
        low, high = sorted(u[todo.pop()])
        near = {i for i in inside if min(u[i]) <= high + SAME and low <= max(u[i]) + SAME}
        todo += near - members
        members |= near
    return sorted(members)


def best_strip(
    u: Sequence[Interval],
    v: Sequence[Interval],
    lengths: Sequence[float],
    first: int,
    tolerance: float,
) -> tuple[list[int], float]:
    """The longest chain and its shift; of equal ones the least shift, then the first members."""
    borders = [t for ends in v for t in (max(ends) - tolerance, min(ends) + tolerance)]
    strips = []
    for t in [0.0, *(t for t in borders if abs(t) <= tolerance + SAME)]:
        members = chain(u, in_strip(v, t, tolerance), first)
        strips.append((sum(lengths[i] for i in members), t, members))
    most = max(strips)[0] - SAME
    least = min(abs(t) for total, t, _ in strips if total >= most) + SAME
    return min((members, t) for total, t, members in strips if total >= most and abs(t) <= least)


def fuse_longest(segments: Sequence[Segment], tolerance: float) -> tuple[list[int], Segment]:
    """The best chain of the longest segment, and the one segment that takes its place."""
    lengths = [math.dist(*s) for s in segments]
    longest = max(lengths) - SAME
    first = next(i for i, size in enumerate(lengths) if size >= longest)
    (ax, ay), (bx, by) = segments[first]
    x, y, size = (ax + bx) / 2, (ay + by) / 2, lengths[first]
    dx, dy = (bx - ax) / size, (by - ay) / size
    u = [[(p[0] - x) * dx + (p[1] - y) * dy for p in s] for s in segments]
    v = [[(p[1] - y) * dx - (p[0] - x) * dy for p in s] for s in segments]
    members, t = best_strip(u, v, lengths, first, tolerance)
    ends = [w for k in members for w in u[k]]
    return members, [(x - t * dy + w * dx, y + t * dx + w * dy) for w in (min(ends), max(ends))]


def fusion(segments: Sequence[Segment], *, tolerance: float = 0.04) -> Found:
    """While the map is not empty, put one segment in the place of the best chain of the longest."""
    live = [i for i, s in enumerate(segments) if math.dist(*s) >= SAME]
    walls: list[Segment] = []
    parents = [-1] * len(segments)
    while live:
        members, wall = fuse_longest([segments[i] for i in live], tolerance)
        for k in members:
            parents[live[k]] = len(walls)
        walls.append(wall)
        live = [i for k, i in enumerate(live) if k not in members]
    return walls, parents


def online(
    segments: Sequence[Segment],
    scans: Sequence[list[int]],
    take_scan: TakeScan,
    every: int,
    tolerance: float = 0.04,
) -> list[Wall]:
    """Scan after scan into the map; Fusion of the map after every so many and the last (A 7)."""
    walls: list[Wall] = []
    for done, new in enumerate(scans, 1):
        take_scan(walls, segments, new)
        if done % every == 0 or done == len(scans):
            fused, into = fusion([ends for ends, _ in walls], tolerance=tolerance)
            members: list[list[int]] = [[] for _ in fused]
            for k, (_, those) in zip(into, walls, strict=True):
                members[k] += those
            walls = list(zip(fused, members, strict=True))
    return walls


def add_scan(walls: list[Wall], segments: Sequence[Segment], new: list[int]) -> None:
    """Each new segment joins the map as a wall of its own."""
    walls += [(segments[i], [i]) for i in new]


def fusion_online(
    segments: Sequence[Segment], scans: Sequence[int], *, tolerance: float = 0.04
) -> Found:
    """Fusion on-line (A 2.7.9): what Fusion makes of the map before and a scan, scan after scan."""
    walls = online(segments, by_scan(segments, scans), add_scan, 1, tolerance)
    return [ends for ends, _ in walls], parents_of((those for _, those in walls), len(segments))
