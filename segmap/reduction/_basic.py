"""Basic (A 4.1, 5.3): pairs with near end points and similar angles become one, again and again."""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from .. import arrays
from ..arrays import Array, Segments, slips
from ..compiled import compiled
from ..kernels import become_mean, put_in, slot_of, take_out
from ._runner import Found, Indices, Reduction, Rows, Steps, run, run_online


def basic_offline(map: Segments, *, distance: float = 0.20, angle: float = np.pi / 18) -> Reduction:
    """Merge pairs of segments of the whole map until none matches (A 4.1).

    Two segments match when some pair of their end points is closer than `distance` and their angles
    differ by less than `angle`. They become the span of their four end points on the mean line,
    weighted by length. The order is part of the method: each segment in turn takes in all that
    match it as it grows; passes are repeated until one merges nothing. A long wall and a piece of
    its middle have far end points, and are never merged.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        The scans of a map are ignored.
    distance : float, metres
        0.20 m is A's middle value: wider than noise, narrower than a door.
    angle : float, radians
        Above 0, at most pi/2; 10 degrees is A's smallest.

    Returns
    -------
    Reduction
        In the order of the segments that took the others in.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (1, 0)], [(1.1, 0), (2, 0)], [(0, 0), (0, 1)]])
    >>> found = basic_offline(wall)
    >>> found, found.parents
    (Reduction(basic_offline: 3 -> 2 segments), array([0, 0, 1]))
    """
    check_match(map, distance, angle)
    return run("basic_offline", map, lambda rows: _offline(rows, distance, angle))


def basic_online(map: Segments, *, distance: float = 0.20, angle: float = np.pi / 18) -> Reduction:
    """Basic after every scan: its segments join the map, which then converges (A 4.1).

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order; without scans this is `basic_offline`.
    distance : float, metres
    angle : float, radians
        As in `basic_offline`.

    Returns
    -------
    Reduction
        In the order in which segments joined; with seconds and live segments for each scan.

    Raises
    ------
    ValueError
        As in `basic_offline`.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> wall = SegmentMap([[(0, 0), (1, 0)], [(1.1, 0), (2, 0)], [(0, 0), (0, 1)]], scan=[0, 1, 1])
    >>> basic_online(wall).scan_live
    array([1, 2])
    """
    check_match(map, distance, angle)
    return run_online("basic_online", map, lambda rows: _online(rows, distance, angle))


def check_match(map: Segments, distance: float, angle: float) -> None:
    """Refuse a distance that is not positive, metres, or an angle beyond a quarter turn, radians.

    Raises
    ------
    ValueError
        Naming the argument and what was expected.
    """
    arrays.positive("metres", distance=distance)
    slips.check_lengths(map, distance=distance)
    arrays.number(angle, "angle", above=0, most=np.pi / 2, unit="radians")


def _offline(rows: Rows, distance: float, angle: float) -> Found:
    state = _start(rows.segments)
    _converge(state, 0, len(rows.segments), distance, angle)
    return _outputs(state)


def _online(rows: Rows, distance: float, angle: float) -> Steps:
    state, live = _start(rows.segments), 0
    for first, stop in rows.scans():
        live += stop - first - _converge(state, first, stop, distance, angle)
        yield live
    return _outputs(state)


def _outputs(state: State) -> Found:
    """The live segments, and which of them each segment went into, through however many merges."""
    parents = state.parents
    while not state.alive[parents].all():
        parents = parents[parents]
    return state.s[state.alive > 0], (np.cumsum(state.alive) - 1)[parents]


class State(NamedTuple):
    """The map of Basic, and a grid of the end points of its live segments.

    Only pairs with a new or changed member can match, and a match needs end points closer than the
    distance. So end points are kept in cells of that size, a hash table of lists, and a pass visits
    only the segments that have such a pair: all others would find nothing to merge. A map of
    100 000 segments takes 0.3 s; a compiled look at all pairs takes 3.1 s.

    Parameters
    ----------
    s : (n, 2, 2) array, metres
    angles, lengths : (n,) array, radians and metres
    alive : (n,) int array
        1 for segments of the map.
    parents : (n,) int array
        Which segment took each in; its own index until then.
    head : (slots,) int array
        First end point of each slot, -1 for none.
    after, before : (2 n,) int array
        Of end point `2 i + k`, which is end k of segment i: the next of the list, and the one
        before, or -1 - slot for the first.
    """

    s: Array
    angles: Array
    lengths: Array
    alive: Indices
    parents: Indices
    head: Indices
    after: Indices
    before: Indices


def _start(segments: Array) -> State:
    """State of segments `(n, 2, 2)`, metres, none of which is in the map yet."""
    n, d = len(segments), segments[:, 1] - segments[:, 0]
    head = np.full(1 << max(int(np.ceil(np.log2(max(4 * n, 2)))), 1), -1)
    after, before = np.full((2, 2 * n), -1)
    angles, lengths = np.arctan2(d[:, 1], d[:, 0]), np.hypot(d[:, 0], d[:, 1])
    alive, parents = np.zeros(n, np.int64), np.arange(n)
    return State(segments.copy(), angles, lengths, alive, parents, head, after, before)


@compiled
def _enter(state: State, i: int, cell: float) -> None:
    """Put both end points of segment i into the grid of cells of a side, metres."""
    s, head = state.s, state.head
    for k in range(2):
        column, row = int(np.floor(s[i, k, 0] / cell)), int(np.floor(s[i, k, 1] / cell))
        put_in(head, state.after, state.before, slot_of(column, row, len(head)), 2 * i + k)


@compiled
def _leave(state: State, i: int) -> None:
    """Take both end points of a segment out of the grid."""
    for e in range(2 * i, 2 * i + 2):
        take_out(state.head, state.after, state.before, e)


@compiled
def _next_match(state: State, a: int, last: int, distance: float, angle: float) -> int:
    """Lowest live segment above `last` that matches a (A 4.1), -1 for none; metres and radians."""
    s, angles, head, after, found = state.s, state.angles, state.head, state.after, len(state.s)
    for k in range(2):
        x, y = s[a, k, 0], s[a, k, 1]
        column, row = int(np.floor(x / distance)), int(np.floor(y / distance))
        for i in range(column - 1, column + 2):
            for j in range(row - 1, row + 2):
                e = head[slot_of(i, j, len(head))]
                while e >= 0:
                    b = e // 2
                    if last < b < found and b != a:
                        dx, dy = x - s[b, e % 2, 0], y - s[b, e % 2, 1]
                        if dx * dx + dy * dy < distance * distance:
                            turn = (angles[a] - angles[b] + np.pi / 2) % np.pi - np.pi / 2
                            found = b if abs(turn) < angle else found
                    e = after[e]
    return found if found < len(s) else -1


@compiled
def _merge(state: State, a: int, b: int, distance: float) -> None:
    """A 4.1: b goes into a, on the length-weighted mean line; the extreme projections remain.

    Writes to rows a and b of the state's arrays; cells of the grid have the side `distance`.
    """
    share = state.lengths[b] / (state.lengths[a] + state.lengths[b])
    turn = (state.angles[b] - state.angles[a] + np.pi / 2) % np.pi - np.pi / 2
    _leave(state, a)
    _leave(state, b)
    state.angles[a] += share * turn
    state.lengths[a] = become_mean(state.s, a, b, share, state.angles[a])
    state.alive[b], state.parents[b] = 0, a
    _enter(state, a, distance)


@compiled
def _converge(state: State, first: int, stop: int, distance: float, angle: float) -> int:
    """Add the segments `first` to `stop` to the map and pass over it until nothing merges.

    Each visited segment takes in, in index order, every one that matches it as it grows. Metres and
    radians. Returns how many died.
    """
    now, later, died = [first], [first], 0  # heaps of indices: this pass and the next
    now.pop()
    later.pop()
    for i in range(first, stop):
        state.alive[i] = 1
        _enter(state, i, distance)
    for i in range(first, stop):
        heapq.heappush(now, i)
        b = _next_match(state, i, -1, distance, angle)
        while 0 <= b < first:
            heapq.heappush(now, b)
            b = _next_match(state, i, b, distance, angle)
    while len(now):
        previous = -1
        while len(now):
            a = heapq.heappop(now)
            if a == previous or state.alive[a] == 0:
                continue
            previous, before = a, died
            b = _next_match(state, a, -1, distance, angle)
            while b >= 0:
                _merge(state, a, b, distance)
                died += 1
                b = _next_match(state, a, b, distance, angle)
            b = _next_match(state, a, -1, distance, angle) if died > before else -1
            while b >= 0:
                heapq.heappush(now if b > a else later, b)
                b = _next_match(state, a, b, distance, angle)
        now, later = later, now
    return died
