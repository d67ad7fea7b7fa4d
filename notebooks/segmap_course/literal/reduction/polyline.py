"""Polylines (A 2.7.10; Amigoni, Gasparini, Gini 2006): chains of matches become bent lines."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from ..alignment.angle_correspondence import directed_distance, match_value
from ..lines import SAME, Found, Point, Segment, by_scan, chains


def apart(u: Segment, v: Segment) -> float:
    """A 2.39: the smaller of the two directed Hausdorff distances, metres."""
    return min(directed_distance(u, v), directed_distance(v, u))


def pieces_of(corners: Sequence[Point]) -> list[Segment]:
    """The segments from corner to corner."""
    return [[a, b] for a, b in itertools.pairwise(corners)]


def nearest_piece(s: Segment, corners: Sequence[Point]) -> tuple[float, int]:
    """Distance of the nearest piece, metres, and which it is; ties: the first."""
    best, at = math.inf, 0
    for k, piece in enumerate(pieces_of(corners)):
        if (far := apart(s, piece)) < best - SAME:
            best, at = far, k
    return best, at


def farthest_ends(members: Sequence[Segment]) -> list[Point]:
    """The two end points that lie farthest apart; ties: the first pair."""
    most, found = 0.0, [members[0][0], members[0][1]]
    for a, b in itertools.combinations([p for s in members for p in s], 2):
        if math.dist(a, b) > most + SAME:
            most, found = math.dist(a, b), [a, b]
    return found


def put_in(corners: list[Point], k: int, s: Segment) -> list[Point]:
    """Replace piece k, from a to b, by a-s, s and s-b, s turned so that both links are short."""
    (a, b), (first, last) = corners[k : k + 2], s
    straight = math.dist(a, first) + math.dist(last, b)
    if math.dist(a, last) + math.dist(first, b) < straight - SAME:
        first, last = last, first
    new = [p for p in (first, last) if min(math.dist(a, p), math.dist(p, b)) >= SAME]
    return corners[: k + 1] + new + corners[k + 1 :]


def pruned(corners: list[Point], members: Sequence[Segment], tolerance: float) -> list[Point]:
    """Leave out inner corners, the first that can go each time, while all members stay near."""
    for k in range(1, len(corners) - 1):
        fewer = corners[:k] + corners[k + 1 :]
        long = math.dist(corners[k - 1], corners[k + 1]) >= SAME
        if long and all(nearest_piece(s, fewer)[0] < tolerance for s in members):
            return pruned(fewer, members, tolerance)
    return corners


def polyline_through(members: Sequence[Segment], tolerance: float) -> list[Point]:
    """Corners of a polyline that has each member within the tolerance, metres, of a piece."""
    corners, left = farthest_ends(members), list(members)
    while left:
        most, worst, at = -1.0, 0, 0
        for i, s in enumerate(left):
            far, k = nearest_piece(s, corners)
            if far > most + SAME:
                most, worst, at = far, i, k
        if most < tolerance:
            break
        corners = put_in(corners, at, left.pop(worst))
    return pruned(corners, members, tolerance)


def polyline(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    tolerance: float = 0.05,
    distance: float = 0.05,
    far: float = 0.10,
    long: float = 0.30,
    bridge: float = 0.30,
) -> Found:
    """Scan after scan, chains of segments of map and scan that match become polylines."""

    def match(u: Segment, v: Segment) -> bool:
        rule = {"distance": distance, "far": far, "long": long}
        return match_value(u, v, whole=False, **rule) > SAME

    map: list[Segment] = []
    parents = [-1] * len(segments)
    for new in by_scan(segments, scans):
        old, every = len(map), [*map, *(segments[i] for i in new)]
        near = {
            (i, j) for i in range(old) for j in range(old, len(every)) if match(every[i], every[j])
        }
        map, into = [], [-1] * len(every)
        for chain in chains(len(every), lambda i, j: (min(i, j), max(i, j)) in near):  # noqa: B023
            members = [every[i] for i in chain]
            corners = polyline_through(members, tolerance) if len(chain) > 1 else members[0]
            owned = [nearest_piece(s, corners)[1] for s in members]
            kept = [
                k
                for k, piece in enumerate(pieces_of(corners))
                if k in owned or math.dist(*piece) <= bridge
            ]
            for i, k in zip(chain, owned, strict=True):
                into[i] = len(map) + kept.index(k)
            map += [pieces_of(corners)[k] for k in kept]
        parents = [into[k] if k >= 0 else -1 for k in parents]
        for i, k in zip(new, into[old:], strict=True):
            parents[i] = k
    return map, parents
