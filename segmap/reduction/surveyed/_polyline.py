"""Polylines (A 2.7.10; Amigoni, Gasparini, Gini 2006): chains of matches become bent lines."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Annotated

import numpy as np

from ...arrays import Array, Metres, Segments, at_least, at_most, checked
from ...compiled import compiled
from ...kernels import Rule, describe, match_value
from .._runner import Reduction, Rows, Steps, run_online
from .lines import SAME, Point, Segment, point_to_segment


@checked
def polyline(
    map: Segments,
    *,
    tolerance: Metres = 0.05,
    distance: Metres = 0.05,
    far: Metres = 0.10,
    long: Metres = 0.30,
    bridge: Annotated[Metres, at_least(0), at_most(np.inf)] = 0.30,
) -> Reduction:
    """Replace chains of matching segments of the map and a scan by polylines (A 2.7.10).

    A segment of the scan and one of the map match where `alignment.match_values` is above 0;
    segments that match one after another are a chain. Its polyline begins as the line between the
    two end points that are farthest apart. While a segment of the chain is `tolerance` or more
    from its nearest piece (A 2.39), the farthest one is put in the place of that piece, with links
    to both neighbours. Then inner corners are left out, the first that can go each time, while
    every segment stays within the tolerance. Links longer than `bridge` that are the nearest piece
    of no segment are left out too: nobody saw such a wall.

    Segments of one scan are never compared: without scans the map stays as it is. A polyline runs
    through end points, not through the middle of its segments, so noise stays; it is made for
    curved and angled walls, and for maps that are drawn as outlines.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Scans come in ascending order.
    tolerance
        How far a segment may lie from its polyline; A gives no value. 0.05 m is the noise of a wall
        seen from many poses.
    distance, far, long
        As in `alignment.match_values`.
    bridge
        Longest link that nobody saw; it may be infinite, which is A's method.

    Returns
    -------
    Reduction
        Chains in the order of their first segments in the map, each from one end to the other.
        Parents name the piece that a segment was nearest to, scan after scan; a link may be the
        parent of none.

    References
    ----------
    Amigoni, Gasparini, Gini, "Building segment-based maps without pose information", Proceedings
    of the IEEE 94, 2006.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> bend = [[(0, 0), (1, 0)], [(0.9, 0.02), (2, 0.3)], [(1.8, 0.3), (3, 0.3)]]
    >>> reduction = polyline(SegmentMap(bend, scan=[0, 1, 0]), tolerance=0.10)
    >>> reduction, reduction.segments[:, 1].round(6).tolist()
    (Reduction(polyline: 3 -> 3 segments), [[0.9, 0.02], [1.8, 0.3], [3.0, 0.3]])
    """
    rule = distance, far, long, False

    def steps(rows: Rows) -> Steps:
        map: list[Segment] = []
        parents = np.full(len(rows.segments), -1)
        for begin, stop in rows.scans():
            old, new = len(map), rows.segments[begin:stop]
            every, map, into = [*map, *new.tolist()], [], np.empty(old + len(new), np.int64)
            pairs = matches(np.array(every[:old]).reshape(-1, 2, 2), new, rule)
            for chain in chains(len(every), [(i, old + j) for i, j in pairs]):
                members = [every[i] for i in chain]
                corners = polyline_through(members, tolerance) if len(chain) > 1 else members[0]
                owned = [nearest_piece(s, corners)[1] for s in members]
                pieces = pieces_between(corners)
                used = [k for k, s in enumerate(pieces) if k in owned or math.dist(*s) <= bridge]
                into[chain] = [len(map) + used.index(k) for k in owned]
                map += [pieces[k] for k in used]
            parents[:begin] = into[parents[:begin]]
            parents[begin:stop] = into[old:]
            yield len(map)
        return np.array(map).reshape(-1, 2, 2), parents

    return run_online("polyline", map, steps, splits=True)


@compiled
def matches(map: Array, scan: Array, rule: Rule) -> list[tuple[int, int]]:
    """Which segments of the map and of a scan match, `(n, 2, 2)` and `(m, 2, 2)`, metres."""
    pairs, a, b = [], describe(map), describe(scan)
    for i in range(len(map)):
        for j in range(len(scan)):
            if match_value(map, a, i, scan, b, j, rule) > SAME:
                pairs.append((i, j))
    return pairs


def chains(count: int, pairs: Sequence[tuple[int, int]]) -> list[list[int]]:
    """What is connected of the numbers 0 to count - 1, by lowest member, each ascending."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    links = np.ones(len(pairs)), tuple(np.reshape(pairs, (-1, 2)).T)
    chain = connected_components(coo_array(links, shape=(count, count)), directed=False)[1]
    members: list[list[int]] = [[] for _ in range(int(chain.max(initial=-1)) + 1)]
    for i, k in enumerate(chain.tolist()):
        members[k].append(i)
    return members


def distance_to_piece(u: Segment, v: Segment) -> float:
    """A 2.39: the smaller of the two directed Hausdorff distances, metres."""
    return min(max(point_to_segment(p, s) for p in t) for s, t in ((u, v), (v, u)))


def pieces_between(corners: Sequence[Point]) -> list[Segment]:
    """The segments from corner to corner."""
    return [[a, b] for a, b in itertools.pairwise(corners)]


def nearest_piece(s: Segment, corners: Sequence[Point]) -> tuple[float, int]:
    """Distance of the nearest piece, metres, and which it is; ties: the first."""
    best, at = math.inf, 0
    for k, piece in enumerate(pieces_between(corners)):
        if (far := distance_to_piece(s, piece)) < best - SAME:
            best, at = far, k
    return best, at


def farthest_ends(members: Sequence[Segment]) -> list[Point]:
    """The two end points that lie farthest apart; ties: the first pair."""
    most, ends = 0.0, [members[0][0], members[0][1]]
    for a, b in itertools.combinations([p for s in members for p in s], 2):
        if math.dist(a, b) > most + SAME:
            most, ends = math.dist(a, b), [a, b]
    return ends


def put_in(corners: list[Point], k: int, s: Segment) -> list[Point]:
    """Replace piece k, from a to b, by a-s, s and s-b, s turned so that both links are short."""
    (a, b), (first, last) = corners[k : k + 2], s
    straight = math.dist(a, first) + math.dist(last, b)
    if math.dist(a, last) + math.dist(first, b) < straight - SAME:
        first, last = last, first
    new = [p for p in (first, last) if min(math.dist(a, p), math.dist(p, b)) >= SAME]
    return corners[: k + 1] + new + corners[k + 1 :]


def prune(corners: list[Point], members: Sequence[Segment], tolerance: float) -> list[Point]:
    """Leave out inner corners, the first that can go each time, while all members stay near."""
    for k in range(1, len(corners) - 1):
        fewer = corners[:k] + corners[k + 1 :]
        long = math.dist(corners[k - 1], corners[k + 1]) >= SAME
        if long and all(nearest_piece(s, fewer)[0] < tolerance for s in members):
            return prune(fewer, members, tolerance)
    return corners


def polyline_through(members: Sequence[Segment], tolerance: float) -> list[Point]:
    """Corners of a polyline that has each member within the tolerance, metres, of a piece."""
    corners, outside = farthest_ends(members), list(members)
    while outside:
        most, worst, at = -1.0, 0, 0
        for i, s in enumerate(outside):
            far, k = nearest_piece(s, corners)
            if far > most + SAME:
                most, worst, at = far, i, k
        if most < tolerance:
            break
        corners = put_in(corners, at, outside.pop(worst))
    return prune(corners, members, tolerance)
