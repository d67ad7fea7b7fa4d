"""Polylines (A 2.7.10; Amigoni, Gasparini, Gini 2006): chains of matches become bent lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from ...arrays import Array, Metres, Segments, at_least, at_most, checked
from ...compiled import compiled
from ...kernels import SAME, Rule, boxes_apart, describe_one, hausdorff, match_value
from ...segments import length
from .._runner import Indices, Reduction, Rows, Steps, run_online


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
        map, parents = np.empty((0, 2, 2)), np.full(len(rows.segments), -1)
        for begin, stop in rows.scans():
            old, every = len(map), np.concatenate([map, rows.segments[begin:stop]])
            count, piece = np.ones(len(every), np.int64), np.zeros(len(every), np.int64)
            bent = list[tuple[list[int], Array]]()
            for chain in chains(matches(every, old, rule)):
                corners = polyline_through(every[chain], tolerance)
                pieces = np.stack([corners[:-1], corners[1:]], 1)
                _, owned = nearest_pieces(every[chain], corners)
                stays = length(pieces) <= bridge
                stays[owned] = True
                piece[chain], count[chain] = np.cumsum(stays)[owned] - 1, 0
                count[chain[0]] = stays.sum()
                bent.append((chain, pieces[stays]))
            first = np.cumsum(count) - count  # where the pieces of each stand in the new map
            map = np.repeat(every, count, axis=0)
            for chain, pieces in bent:
                first[chain] = first[chain[0]]
                map[first[chain[0]] :][: len(pieces)] = pieces
            parents[begin:stop] = np.arange(old, len(every))
            parents[:stop] = (first + piece)[parents[:stop]]
            yield len(map)
        return map, parents

    return run_online("polyline", map, steps, splits=True)


@compiled
def matches(every: Array, old: int, rule: Rule) -> list[tuple[int, int]]:
    """Which of the first `old` segments, `(n, 2, 2)`, metres, match which of those behind them."""
    pairs, a = [], np.empty((len(every), 5))
    for i in range(old):
        for j in range(old, len(every)):
            if boxes_apart(every, i, every, j) <= rule[1] + SAME:
                describe_one(every[i], a[i])
                describe_one(every[j], a[j])
                if match_value(every, a, i, every, a, j, rule) > SAME:
                    pairs.append((i, j))
    return pairs


def chains(pairs: Sequence[tuple[int, int]]) -> list[list[int]]:
    """What pairs connect, by lowest member, each ascending."""
    chain_of: dict[int, list[int]] = {}
    for i, j in pairs:
        one, other = chain_of.setdefault(i, [i]), chain_of.setdefault(j, [j])
        if one is not other:
            one += other
            chain_of.update(dict.fromkeys(other, one))
    return sorted(sorted(chain) for chain in {id(c): c for c in chain_of.values()}.values())


@compiled
def nearest_pieces(members: Array, corners: Array) -> tuple[Array, Indices]:
    """How far the nearest piece is from each (A 2.39), metres, and which it is; ties: the first."""
    least, at = np.full(len(members), np.inf), np.zeros(len(members), np.int64)
    for i in range(len(members)):
        for k in range(len(corners) - 1):
            off = hausdorff(members[i], corners[k : k + 2])
            if off < least[i] - SAME:
                least[i], at[i] = off, k
    return least, at


@compiled
def apart(a: Array, b: Array) -> float:
    """Distance of two points, metres."""
    return np.hypot(a[0] - b[0], a[1] - b[1])


@compiled
def farthest_ends(members: Array) -> Array:
    """The two end points that lie farthest apart, `(2, 2)`; ties: the first pair."""
    points, most = members.reshape(-1, 2), 0.0
    ends = points[:2]
    for i in range(len(points)):
        for j in range(i + 1, len(points)):
            if apart(points[i], points[j]) > most + SAME:
                most, ends = apart(points[i], points[j]), np.stack((points[i], points[j]))
    return ends


@compiled
def put_in(corners: Array, k: int, s: Array) -> Array:
    """Replace piece k, from a to b, by a-s, s and s-b, s turned so that both links are short."""
    a, b, first = corners[k], corners[k + 1], 0
    if apart(a, s[1]) + apart(s[0], b) < apart(a, s[0]) + apart(s[1], b) - SAME:
        first = 1
    for end in (1 - first, first):
        if min(apart(a, s[end]), apart(s[end], b)) >= SAME:
            corners = np.concatenate((corners[: k + 1], s[end : end + 1], corners[k + 1 :]))
    return corners


@compiled
def prune(corners: Array, members: Array, tolerance: float) -> Array:
    """Leave out inner corners, the first that can go each time, while all members stay near."""
    k = 1
    while k < len(corners) - 1:
        fewer = np.concatenate((corners[:k], corners[k + 1 :]))
        can_go = apart(corners[k - 1], corners[k + 1]) >= SAME
        for off in nearest_pieces(members, fewer)[0]:
            can_go = can_go and off < tolerance
        corners, k = (fewer, 1) if can_go else (corners, k + 1)
    return corners


@compiled
def polyline_through(members: Array, tolerance: float) -> Array:
    """Corners of a polyline that has each member within the tolerance, metres, of a piece."""
    corners, is_in = farthest_ends(members), np.zeros(len(members), np.bool_)
    for _ in range(len(members)):
        far, at = nearest_pieces(members, corners)
        worst = -1
        for i in range(len(members)):
            if not is_in[i] and (worst < 0 or far[i] > far[worst] + SAME):
                worst = i
        if far[worst] < tolerance:
            break
        corners, is_in[worst] = put_in(corners, at[worst], members[worst]), True
    return prune(corners, members, tolerance)
