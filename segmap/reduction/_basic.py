"""Basic (A 4.1, 5.3): pairs with near end points and similar angles become one, again and again."""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Metres, Segments, checked
from ..compiled import compiled
from ..kernels import SAME, replace_by_mean, turn_between
from ._index import Index, empty_index, enter, meeting, take_out
from ._runner import (
    Found,
    Indices,
    Reduction,
    Rows,
    Steps,
    Turn,
    resolve_merges,
    run_offline,
    run_online,
)


@checked
def basic_offline(map: Segments, *, distance: Metres = 0.20, angle: Turn = np.pi / 18) -> Reduction:
    """Merge pairs of segments of the whole map until none matches (A 4.1).

    Two segments match when some pair of their end points is closer than `distance` and their angles
    differ by less than `angle`. They become the span of their four end points on the mean line,
    weighted by length. The order is part of the method: each segment in turn takes in all that
    match it as it grows; passes are repeated until one merges nothing. A long wall and a piece of
    its middle have far end points, and are never merged. The cost grows with the map, and faster
    with the looks at each wall: eight times as many take twenty times as long.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Its scans are ignored.
    distance
        Ends nearer than this may match: 0.20 m is A's middle value, wider than noise, narrower than
        a door.
    angle
        Largest difference of two directions that match: 10 degrees is A's smallest.

    Returns
    -------
    Reduction
        In the order of the segments that took the others in.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (1, 0)], [(1.1, 0), (2, 0)], [(0, 0), (0, 1)]])
    >>> reduction = basic_offline(wall)
    >>> reduction, reduction.parents
    (Reduction(basic_offline: 3 -> 2 segments), array([0, 0, 1]))
    """

    def reduce(rows: Rows) -> Found:
        state = _start(rows.segments, distance)
        _converge(state, 0, len(rows.segments), distance, angle)
        alive, parents = resolve_merges(state.parents)
        return state.s[alive], parents

    return run_offline("basic_offline", map, reduce)


@checked
def basic_online(map: Segments, *, distance: Metres = 0.20, angle: Turn = np.pi / 18) -> Reduction:
    """Basic after every scan: its segments join the map, which then converges (A 4.1).

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Scans come in ascending order; without scans this is `basic_offline`.
    distance, angle
        As in `basic_offline`.

    Returns
    -------
    Reduction
        In the order in which segments joined; with seconds and live segments for each scan.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> wall = SegmentMap([[(0, 0), (1, 0)], [(1.1, 0), (2, 0)], [(0, 0), (0, 1)]], scan=[0, 1, 1])
    >>> basic_online(wall).scan_live
    array([1, 2])
    """

    def steps(rows: Rows) -> Steps:
        state, live = _start(rows.segments, distance), 0
        for first, stop in rows.scans():
            live += stop - first - _converge(state, first, stop, distance, angle)
            yield live
        alive, parents = resolve_merges(state.parents)
        return state.s[alive], parents

    return run_online("basic_online", map, steps)


class State(NamedTuple):
    """The map of Basic, and an index of the end points of its live segments.

    Only pairs with a new or changed member can match, and a match needs end points closer than the
    distance. So a pass visits only the segments that have such a pair: all others would find
    nothing to merge. A map of 100 000 segments takes 0.3 s; a compiled look at all pairs 3.1 s.
    """

    s: Array  # (n, 2, 2), metres
    angles: Array
    lengths: Array
    parents: Indices  # which segment took each in; its own index until then
    ends: Index  # end k of segment i is number 2 i + k
    near: Indices  # room for what lies near


def _start(segments: Array, distance: float) -> State:
    """State of segments `(n, 2, 2)`, metres, none of which is in the map yet."""
    n, d = len(segments), segments[:, 1] - segments[:, 0]
    return State(
        s=segments.copy(),
        angles=np.arctan2(d[:, 1], d[:, 0]),
        lengths=np.hypot(d[:, 0], d[:, 1]),
        parents=np.arange(n),
        ends=empty_index(2 * n, distance),
        near=np.empty(4 * n + 1, np.int64),
    )


@compiled
def _enter(state: State, i: int) -> None:
    """Put both end points of segment i into the index."""
    for k in range(2):
        enter(state.ends, 2 * i + k, state.s[i, k : k + 1], 0.0)


@compiled
def _matching_segments(state: State, a: int, distance: float, angle: float) -> int:
    """Write the live segments that match a (A 4.1), some twice; how many; metres and radians."""
    s, near, stop, count = state.s, state.near, 0, 0
    least = max(distance - SAME, 0.0) ** 2
    for k in range(2):
        x, y = s[a, k, 0], s[a, k, 1]
        stop = count + meeting(state.ends, s[a, k : k + 1], distance, near[count:])
        for m in range(count, stop):
            b, end = near[m] // 2, near[m] % 2
            dx, dy = x - s[b, end, 0], y - s[b, end, 1]
            if b == a or dx * dx + dy * dy >= least:
                continue
            if abs(turn_between(state.angles[b], state.angles[a])) < angle - SAME:
                near[count] = b
                count += 1
    return count


@compiled
def _merge_on_mean_line(state: State, a: int, b: int) -> None:
    """A 4.1: b goes into a, on the length-weighted mean line; the extreme projections remain."""
    share = state.lengths[b] / (state.lengths[a] + state.lengths[b])
    turn = turn_between(state.angles[a], state.angles[b])
    for e in (2 * a, 2 * a + 1, 2 * b, 2 * b + 1):
        take_out(state.ends, e)
    state.angles[a] += share * turn
    state.lengths[a] = replace_by_mean(state.s, a, b, share, state.angles[a])
    state.parents[b] = a
    _enter(state, a)


@compiled
def _converge(state: State, first: int, stop: int, distance: float, angle: float) -> int:
    """Add the segments `first` to `stop` to the map and pass over it until nothing merges.

    Each visited segment takes in, in index order, every one that matches it as it grows. Metres and
    radians. Returns how many died.
    """
    now, later, died, near = [first], [first], 0, state.near  # heaps: this pass and the next
    now.pop()
    later.pop()
    for i in range(first, stop):
        _enter(state, i)
    for i in range(first, stop):
        count = _matching_segments(state, i, distance, angle) if first > 0 else 1
        if count > 0:
            heapq.heappush(now, i)
        for k in range(count if first > 0 else 0):
            if near[k] < first:
                heapq.heappush(now, near[k])
    while len(now):
        previous = -1
        while len(now):
            a = heapq.heappop(now)
            if a == previous or state.parents[a] != a:
                continue
            previous, last, next, count = a, -1, a, 0
            while next < len(state.s):
                count, next = _matching_segments(state, a, distance, angle), len(state.s)
                for k in range(count):
                    if last < near[k] < next:
                        next = near[k]
                if next < len(state.s):
                    _merge_on_mean_line(state, a, next)
                    last, died = next, died + 1
            for k in range(count if last >= 0 else 0):
                heapq.heappush(now if near[k] > a else later, near[k])
        now, later = later, now
    return died
