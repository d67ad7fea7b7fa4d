"""The loops of least cost's first phase: which segments may merge, and the cheapest pair first."""

from __future__ import annotations

from typing import NamedTuple

from ...arrays import Array
from ...compiled import compiled
from ...kernels import apart, describe_one, join_sums, length_of, place_on_line, span
from ...segments import MIN_LENGTH
from .._index import Index, enter, meeting
from .._runner import Indices
from ._fit_kernels import (
    ESTIMATE_PENALTIES,
    Limits,
    Room,
    distance_between,
    fit_cheapest_line,
    insert_ranked,
    load_member,
    rounded,
)

#: So many pairs and members are fitted between two words about how far the merging is: 5 ms.
WORK = 2000


class State(NamedTuple):
    """Clusters while they merge: n inputs, and as many clusters at first.

    Members of a cluster, and its neighbours, are linked lists, -1 at the end.
    """

    s: Array  # (n, 2, 2) inputs
    d: Array  # (n, 5) middle, direction and half length of each
    drawn: Array  # (n, 2, 2) the segment of each cluster
    sums: Array  # (n, 7) weight, centre, scatter xx, xy, yy; cost
    link: Indices  # (n, 6) parent, version, members, first and last member, first neighbour
    after: Indices  # (n,) the member behind a member
    near: Indices  # (p, 2) a neighbour, and the entry behind it
    mark: Indices  # (n,) when a cluster was last seen in a list of neighbours
    fitted: Indices  # (n, 3) the last fit of each cluster: with which other, versions of both
    fits: Array  # (n, 5) its segment and cost
    heap: Array  # (h, 6) key, both clusters, their versions, 1 for the cost of a fit, 0 estimated
    size: Indices  # (2,) entries on the heap, and how many were taken off


# ------------------------------------------------------------------ step 1: who may merge
@compiled
def crosses(u: Array, v: Array) -> bool:
    """Whether two segments cross in a point inside both."""
    ax, ay = u[1, 0] - u[0, 0], u[1, 1] - u[0, 1]
    bx, by = v[1, 0] - v[0, 0], v[1, 1] - v[0, 1]
    p = ax * (v[0, 1] - u[0, 1]) - ay * (v[0, 0] - u[0, 0])
    q = ax * (v[1, 1] - u[0, 1]) - ay * (v[1, 0] - u[0, 0])
    r = bx * (u[0, 1] - v[0, 1]) - by * (u[0, 0] - v[0, 0])
    t = bx * (u[1, 1] - v[0, 1]) - by * (u[1, 0] - v[0, 0])
    return p * q < 0.0 and r * t < 0.0


@compiled
def nearest_neighbours(
    s: Array,
    d: Array,
    reach: float,
    part: Indices,
    places: Index,
    near: Indices,
    nearest: Array,
    who: Indices,
) -> None:
    """Enter some inputs; write the indices of the nearest of each, `(n, k)`, -1 for no more.

    Of those within reach, by the distance of quality, which is written too.
    """
    for i in part:
        for k in range(meeting(places, s[i], reach, near)):
            j = near[k]
            if apart(s[i], s[j]) <= reach or crosses(s[i], s[j]):
                value = rounded(distance_between(s[j], s[i], d[j], d[i]))
                insert_ranked(nearest, who, i, j, value)
                insert_ranked(nearest, who, j, i, value)
        enter(places, i, s[i], 0.0)


# ------------------------------------------------------------------ steps 3 and 4: the cheapest
@compiled
def _second_is_longer(state: State, a: int, b: int) -> bool:
    """Whether the segment of b is longer than that of a."""
    return length_of(state.drawn[b]) > length_of(state.drawn[a]) + MIN_LENGTH


@compiled
def _before(heap: Array, i: int, j: int) -> bool:
    """Whether entry i of the heap is cheaper than entry j (ties: the lower clusters)."""
    c = 0
    while c < 2 and heap[i, c] == heap[j, c]:
        c += 1
    return heap[i, c] < heap[j, c]


@compiled
def _swap(heap: Array, i: int, j: int) -> None:
    """Let two entries of the heap change places."""
    for c in range(heap.shape[1]):
        heap[i, c], heap[j, c] = heap[j, c], heap[i, c]


@compiled
def _put(state: State, key: float, a: int, b: int, exact: int) -> None:
    """Put a pair on the heap: an array, so that it stays between two calls."""
    heap, link, k = state.heap, state.link, state.size[0]
    heap[k, 0], heap[k, 1], heap[k, 2], heap[k, 5] = key, a, b, exact
    heap[k, 3], heap[k, 4] = link[a, 1], link[b, 1]
    state.size[0] += 1
    while k > 0 and _before(heap, k, (k - 1) // 2):
        _swap(heap, k, (k - 1) // 2)
        k = (k - 1) // 2


@compiled
def _take_first(state: State) -> int:
    """Take the cheapest pair off the heap; the row in which it now stands."""
    heap, last, k = state.heap, state.size[0] - 1, 0
    state.size[0], state.size[1] = last, state.size[1] + 1
    _swap(heap, 0, last)
    while True:
        child = 2 * k + 1
        if child + 1 < last and _before(heap, child + 1, child):
            child += 1
        if child >= last or not _before(heap, child, k):
            return last
        _swap(heap, k, child)
        k = child


@compiled
def _estimate(state: State, room: Room, a: int, b: int, limits: Limits) -> None:
    """Put a pair on the heap by an estimate of its cost, unless that is far too dear.

    That is what it costs to draw the larger cluster's segment out over the smaller one's.
    """
    drawn, link, line = state.drawn, state.link, room.frame
    members, longer = link[b, 2] - link[a, 2], _second_is_longer(state, a, b)
    describe_one(drawn[b if longer else a], line)
    low_a, high_a = span(drawn[a], line[0], line[1], line[2], line[3])
    low_b, high_b = span(drawn[b], line[0], line[1], line[2], line[3])
    if max(low_a, low_b) - min(high_a, high_b) > limits.gap:
        return
    big, small = (b, a) if members > 0 or (members == 0 and longer) else (a, b)
    describe_one(drawn[big], line)
    low_a, high_a = span(drawn[a], line[0], line[1], line[2], line[3])
    low_b, high_b = span(drawn[b], line[0], line[1], line[2], line[3])
    low, high = min(low_a, low_b), max(high_a, high_b)
    place_on_line(room.line, line[0], line[1], line[2], line[3], low, high)
    describe_one(room.line, line)
    total, i = -state.sums[small, 6], link[small, 3]
    while i >= 0 and total <= ESTIMATE_PENALTIES * limits.penalty:
        total += distance_between(state.s[i], room.line, state.d[i], line)
        i = state.after[i]
    if total <= ESTIMATE_PENALTIES * limits.penalty:
        key = rounded(max(total, 0.0) / ESTIMATE_PENALTIES)
        _put(state, key, a, b, 0)


@compiled
def _fit_pair(state: State, room: Room, a: int, b: int, limits: Limits) -> float:
    """Cost of the best segment for two clusters; it stays in `fits`, for as long as both last."""
    link, fitted, fits, count = state.link, state.fitted, state.fits, 0
    if fitted[a, 0] == b and fitted[a, 1] == link[a, 1] and fitted[a, 2] == link[b, 1]:
        return fits[a, 4]
    most = state.sums[a, 6] + state.sums[b, 6] + ESTIMATE_PENALTIES * limits.penalty
    join_sums(state.sums[a], state.sums[b], room.sums)
    for c in (a, b):
        i = link[c, 3]
        while i >= 0:
            load_member(room, count, i, state.s, state.d)
            i, count = state.after[i], count + 1
    long = state.drawn[b if _second_is_longer(state, a, b) else a]
    fitted[a, 0], fitted[a, 1], fitted[a, 2] = b, link[a, 1], link[b, 1]
    fits[a, 4] = fit_cheapest_line(state.s, room, count, limits, long, most)
    for k in range(4):
        fits[a, k] = room.line[k // 2, k % 2]
    return fits[a, 4]


@compiled
def _merge_clusters(state: State, a: int, b: int) -> None:
    """Let cluster b go into cluster a: segment, cost, sums, members, version, neighbours."""
    link, near = state.link, state.near
    join_sums(state.sums[a], state.sums[b], state.sums[a])
    state.sums[a, 6] = state.fits[a, 4]
    for k in range(4):
        state.drawn[a, k // 2, k % 2] = state.fits[a, k]
    state.after[link[a, 4]] = link[b, 3]
    link[a, 4] = link[b, 4]
    link[a, 1] += 1
    link[a, 2] += link[b, 2]
    link[b, 0] = a
    # one list of neighbours: living ones, each once, without a itself
    stamp, first, last = link[a, 1] * len(link) + a + len(link), -1, -1
    state.mark[a] = stamp
    for c in (a, b):
        entry = link[c, 5]
        while entry >= 0:
            after, other = near[entry, 1], near[entry, 0]
            while link[other, 0] != other:  # the living cluster that it went into
                link[other, 0] = link[link[other, 0], 0]
                other = link[other, 0]
            if state.mark[other] != stamp:
                state.mark[other] = stamp
                near[entry, 0], near[entry, 1] = other, -1
                if last >= 0:
                    near[last, 1] = entry
                else:
                    first = entry
                last = entry
            entry = after
    link[a, 5] = first


@compiled
def estimate_all(state: State, room: Room, part: Indices, limits: Limits) -> None:
    """Put some clusters on the heap, each with the later ones of its neighbours."""
    link, near = state.link, state.near
    for a in part:
        entry = link[a, 5]
        while entry >= 0:
            if near[entry, 0] > a:
                _estimate(state, room, a, near[entry, 0], limits)
            entry = near[entry, 1]


@compiled
def merge_some(state: State, room: Room, limits: Limits) -> None:
    """Merge clusters, the cheapest pair first, until every merge costs more than the penalty.

    Or for a while, until there were `WORK` pairs and members, or the heap is nearly full.
    """
    link, near, heap, size, work = state.link, state.near, state.heap, state.size, 0
    while size[0] > 0 and size[0] + len(link) <= len(heap) and work < WORK:
        k = _take_first(state)
        a, b, of_a, of_b = int(heap[k, 1]), int(heap[k, 2]), heap[k, 3], heap[k, 4]
        exact, work = heap[k, 5], work + 1
        if link[a, 0] != a or link[b, 0] != b or link[a, 1] != of_a or link[b, 1] != of_b:
            continue
        work += link[a, 2] + link[b, 2]
        cost = _fit_pair(state, room, a, b, limits)
        delta = rounded(cost - (state.sums[a, 6] + state.sums[b, 6]))
        if not exact:
            if not delta <= limits.penalty:
                continue
            if size[0] > 0 and delta > heap[0, 0]:
                _put(state, delta, a, b, 1)
                continue
        _merge_clusters(state, a, b)
        entry = link[a, 5]
        while entry >= 0:
            _estimate(state, room, min(a, near[entry, 0]), max(a, near[entry, 0]), limits)
            entry = near[entry, 1]
