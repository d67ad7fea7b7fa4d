"""Fusion (A 4.4, 5.6): the longest chain of segments in a strip around the longest segment.

A moves the line greedily and can miss the best strip; the sweep over all shifts is exact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Metres, Segments, checked
from ..compiled import compiled
from ..kernels import Line, line_through, order_by_first, place_on_line, seen_from
from ..segments import length
from ._index import Index, empty_index, enter_all, meeting, take_out
from ._runner import Indices, Reduction, Rows, Steps, run_offline, run_online

Flags = NDArray[np.bool_]

#: More segments take Fusion on-line more than ten seconds: it warns.
MOST_ONLINE_SEGMENTS = 40_000
#: Lengths, shifts and gaps closer than this, in metres, are equal: rounding must not choose.
FUSION_ROUNDING_M = 1e-9


@checked
def fusion(map: Segments, *, tolerance: Metres = 0.04) -> Reduction:
    """Replace chains of segments inside a strip by one segment each (A 4.4, 5.6).

    Until the map is empty: take the longest segment; among the lines parallel to it that keep it
    within `tolerance`, find the one whose strip holds the chain of greatest total length through
    it; emit the span of that chain on that line. A chain is a connected set of overlapping
    projections. There is no test of angles: a short stub across the wall is swallowed.

    Parameters
    ----------
    tolerance
        Half width of the strip. 0.04 m is about the spread of one wall seen from many poses; A
        finds that quality falls quickly beyond 0.06 m.

    Returns
    -------
    Reduction
        Longest first.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1.5, 0.03), (3, 0.03)], [(5, 0), (6, 0)]]
    >>> result = fusion(wall)
    >>> result, result.parents
    (Reduction(fusion: 3 -> 2 segments), array([0, 0, 1]))
    >>> result.segments[0].round(6)
    array([[0., 0.],
           [3., 0.]])
    """
    return run_offline("fusion", map, lambda rows: fuse(rows.segments, tolerance))


@checked
def fusion_online(map: Segments, *, tolerance: Metres = 0.04) -> Reduction:
    """Fusion of the map and each new scan, one scan after the other (A 2.7.9, table 2.16).

    A names both ways and builds the off-line one. Each pass fuses the whole map again, and a second
    pass finds more than the first: strips around fused segments reach what those around their
    members did not. So the map has fewer segments than `fusion` gives, and drifts farther from
    what was seen: compare both at equal quality.

    The time of a scan grows with the map: that of all scans with the square of the segments, 2.3 s
    for 20 000 in 2 500 scans. Maps with more than 40 000 are warned of.

    Parameters
    ----------
    tolerance
        As in `fusion`.

    Returns
    -------
    Reduction
        Longest first; with seconds and segments in the map for each scan.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> wall = [[(0, 0), (2, 0)], [(1.5, 0.05), (3, 0.05)], [(1, 0.1), (2, 0.1)]]
    >>> reduction = fusion_online(SegmentMap(wall, [0, 1, 2]), tolerance=0.05)
    >>> reduction.scan_live, reduction.parents
    (array([1, 1, 1]), array([0, 0, 0]))
    """

    def steps(rows: Rows) -> Steps:
        walls, parents = np.empty((0, 2, 2)), np.empty(len(rows.segments), np.int64)
        for first, stop in rows.scans():
            old = len(walls)
            walls, into = fuse(np.concatenate([walls, rows.segments[first:stop]]), tolerance)
            parents[:first] = into[parents[:first]]
            parents[first:stop] = into[old:]
            yield len(walls)
        return walls, parents

    return run_online("fusion_online", map, steps, most_segments=MOST_ONLINE_SEGMENTS)


def fuse(s: Array, tolerance: float) -> tuple[Array, Indices]:
    """Fusion of segments that all have a length: outputs `(m, 2, 2)`, metres, parents `(n,)`."""
    n, lengths = len(s), length(s)
    step = float(max(4 * tolerance, lengths.mean() if n else 0.0))
    near, order, seen, meets = np.full((4, n + 1), -1)
    tried, chosen = np.zeros((2, n), np.bool_)
    measured, shifts = np.empty((n + 1, 4)), np.empty((2 * n + 1, 2))
    falling, piece = np.argsort(-lengths, kind="stable"), np.empty((2, 2))
    map = s, lengths, falling, empty_index(n, step)
    state = State(*map, near, measured, order, tried, chosen, shifts, seen, meets, piece)
    out, parents = np.empty((n, 2, 2)), np.full(n, -1)
    count = _fuse_all(state, tolerance, step, out, parents)
    return out[:count], parents


class State(NamedTuple):
    """The map, and scratch arrays for the candidates of one strip; lengths are in metres."""

    s: Array  # (n, 2, 2)
    lengths: Array
    falling: Indices  # sorts the segments by falling length
    places: Index  # index of the segments that are left
    near: Indices  # the segments that may be in the strip
    measured: Array  # (n + 1, 4) where each begins and ends along the line, lowest, highest offset
    order: Indices  # candidates by where they begin
    tried: Flags  # members of the chain of the shift that is tried
    chosen: Flags  # members of the longest chain so far
    shifts: Array  # (2 n + 1, 2) shifts that were tried, and the length of the chain of each
    seen: Indices  # for each segment of the map, the last longest one that met it
    meets: Indices
    piece: Array  # (2, 2) piece of the line of the strip


@compiled
def _measure(s: Array, j: int, line: Line, wide: float, out: Array, k: int) -> bool:
    """Write low and high of segment j along a line and across it into row k.

    False where an end lies farther than `wide` from the line, or one from the other across it.
    """
    u0, v0, u1, v1 = seen_from(line, s[j])
    if max(abs(v0), abs(v1), abs(v1 - v0)) > wide:
        return False
    out[k, 0], out[k, 1] = min(u0, u1), max(u0, u1)
    out[k, 2], out[k, 3] = min(v0, v1), max(v0, v1)
    return True


@compiled
def _measure_chain(state: State, line: Line, wide: float, step: float, longest: int) -> int:
    """Measure all live segments that may be in a chain through the longest; how many there are.

    The longest comes first. Walks both ways from its middle for as long as the collected
    projections reach on, whatever their shift.
    """
    s, near, measured, seen = state.s, state.near, state.measured, state.seen
    near[0], seen[longest], count = longest, longest, 1
    _measure(s, longest, line, wide, measured, 0)
    for way in (1, -1):
        reach, at = measured[0, 1], 0.0
        while at <= reach + FUSION_ROUNDING_M:
            place_on_line(state.piece, line, way * at, way * (at + step))
            for k in range(meeting(state.places, state.piece, wide, state.meets)):
                j = state.meets[k]
                if seen[j] != longest:
                    seen[j], near[count] = longest, j
                    count += _measure(s, j, line, wide, measured, count)
            longer = True
            while longer:
                longer = False
                for k in range(count):
                    begin = measured[k, 0] if way == 1 else -measured[k, 1]
                    end = measured[k, 1] if way == 1 else -measured[k, 0]
                    if end > reach and begin <= reach + FUSION_ROUNDING_M:
                        reach, longer = end, True
            at += step
    return count


@compiled
def _in_strip(measured: Array, i: int, shift: float, half: float) -> bool:
    """Whether candidate i lies in a strip."""
    low, high = measured[i, 3] - half, measured[i, 2] + half
    return low <= shift + FUSION_ROUNDING_M and shift - FUSION_ROUNDING_M <= high


@compiled
def _chain(state: State, order: Indices, shift: float, half: float) -> tuple[float, int, int]:
    """Length of the chain through candidate 0, and its range in `order`.

    Only those of the range are its members that the strip of that shift holds (A 4.4.1).
    """
    total, start, reach, holds, measured = 0.0, 0, -np.inf, False, state.measured
    for k in range(len(order)):
        i = order[k]
        if not _in_strip(measured, i, shift, half):
            continue
        if measured[i, 0] > reach + FUSION_ROUNDING_M:
            if holds:
                return total, start, k
            total, start = 0.0, k
        holds = holds or i == 0
        reach = max(reach, measured[i, 1])
        total += state.lengths[state.near[i]]
    return total, start, len(order)


@compiled
def _comes_first(tried: Flags, chosen: Flags, near: Indices) -> bool:
    """Whether the members tried come before the chosen, as words of sorted indices do."""
    apart, of_tried, more = -1, False, False
    for k in range(len(tried)):
        if tried[k] != chosen[k] and (apart < 0 or near[k] < apart):
            apart, of_tried = near[k], tried[k]
    for k in range(len(tried)):
        more |= near[k] > apart and (chosen[k] if of_tried else tried[k])
    return apart >= 0 and more == of_tried


@compiled
def _best_strip(
    state: State, order: Indices, count: int, half: float
) -> tuple[float, float, float]:
    """Shift, low and high of the longest chain; flags its members as chosen.

    Only where a segment enters or leaves the strip can the chain change: all these shifts are
    tried, and 0. Of equal chains the least shift wins, then the first indices.
    """
    measured, shifts = state.measured, state.shifts
    tried, chosen, near = state.tried[:count], state.chosen[:count], state.near[:count]
    most, least, tries = 0.0, np.inf, 0
    for k in range(-1, 2 * len(order)):
        i = order[max(k, 0) // 2]
        edge = measured[i, 2] + half if k % 2 else measured[i, 3] - half
        shift = edge if k >= 0 else 0.0
        if abs(shift) <= half + FUSION_ROUNDING_M:
            total, _, _ = _chain(state, order, shift, half)
            shifts[tries, 0], shifts[tries, 1] = shift, total
            most = max(most, total)
            tries += 1
    for k in range(tries):
        if shifts[k, 1] >= most - FUSION_ROUNDING_M:
            least = min(least, abs(shifts[k, 0]))
    best, low, high, has_best = 0.0, 0.0, 0.0, False
    for k in range(tries):
        shift = shifts[k, 0]
        if shifts[k, 1] < most - FUSION_ROUNDING_M or abs(shift) > least + FUSION_ROUNDING_M:
            continue
        _, start, stop = _chain(state, order, shift, half)
        begin, end = np.inf, -np.inf
        for j in range(count):
            tried[j] = False
        for j in range(start, stop):
            i = order[j]
            if _in_strip(measured, i, shift, half):
                tried[i] = True
                begin, end = min(begin, measured[i, 0]), max(end, measured[i, 1])
        if not has_best or _comes_first(tried, chosen, near):
            best, low, high, has_best = shift, begin, end, True
            for j in range(count):
                chosen[j] = tried[j]
    return best, low, high


@compiled
def _fuse_all(state: State, tolerance: float, step: float, out: Array, parents: Indices) -> int:
    """Fuse until the map is empty: writes outputs and parents, -1 before; how many outputs."""
    s, lengths, falling, places = state.s, state.lengths, state.falling, state.places
    count, head, wide = 0, 0, 2 * (tolerance + FUSION_ROUNDING_M)
    enter_all(places, s)
    while True:
        # A 4.4.4, step 1: the longest segment, of equal ones the first
        while head < len(s) and parents[falling[head]] >= 0:
            head += 1
        if head == len(s):
            return count
        k, i = head, falling[head]
        while k < len(s) and lengths[falling[k]] >= lengths[falling[head]] - FUSION_ROUNDING_M:
            i = falling[k] if parents[falling[k]] < 0 and falling[k] < i else i
            k += 1
        _, _, dx, dy = line_through(s[i])
        x, y = (s[i, 0, 0] + s[i, 1, 0]) / 2, (s[i, 0, 1] + s[i, 1, 1]) / 2
        # steps 2 to 5: the strip, parallel to it, with the longest chain
        near = _measure_chain(state, (x, y, dx, dy), wide, step, i)
        order_by_first(state.order[:near], state.measured)
        _, start, stop = _chain(state, state.order[:near], 0.0, np.inf)
        shift, low, high = _best_strip(state, state.order[start:stop], near, tolerance)
        # step 6: one segment for the chain
        place_on_line(out[count], (x - shift * dy, y + shift * dx, dx, dy), low, high)
        for k in range(near):
            if state.chosen[k]:
                parents[state.near[k]] = count
                take_out(places, state.near[k])
        count += 1
