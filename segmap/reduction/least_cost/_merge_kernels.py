"""The loops of least cost's first phase: which segments may merge, and the cheapest pair first."""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from ...kernels import (
    ACROSS_WEIGHT,
    ANGULAR_WEIGHT,
    APART_WEIGHT,
    apart,
    describe_one,
    distance_below,
    gap_along,
    join_sums,
    length_of,
    line_through,
    mean_line_terms,
    place_on_line,
    seen_from,
    span,
)
from ...segments import MIN_LENGTH
from .._index import Index, enter, meeting
from .._runner import Indices
from ._fit_kernels import (
    ESTIMATE_PENALTIES,
    ESTIMATE_RATIO,
    Limits,
    Workspace,
    fit_cheapest_line,
    insert_ranked,
    round_off,
)

#: Pairs and members that are fitted between two reports of progress: 5 ms.
WORK = 2000
#: Clusters by the cost of their cheapest neighbour, the cheapest first (ties: the lower index).
Heap = list[tuple[float, int]]


class State(NamedTuple):
    """Clusters while they merge: n inputs, and as many clusters at first.

    Members of a cluster, and its neighbours, are linked lists, -1 at the end. Of the p pairs, pair
    q is entry 2 q in the list of one of its clusters and 2 q + 1 in that of the other. Each cluster
    knows its cheapest neighbour of a higher index.
    """

    s: Array  # (n, 2, 2) inputs
    d: Array  # (n, 5) middle, direction and half length of each
    drawn: Array  # (n, 2, 2) the segment of each cluster
    sums: Array  # (n, 7) weight, centre, scatter xx, xy, yy; cost
    link: Indices  # (n, 5) parent, members, first and last member, first neighbour
    after: Indices  # (n,) the member behind a member
    near: Indices  # (2 p, 2) a neighbour, -1 where the pair is gone, and the entry behind it
    key: Array  # (p,) cost of a pair, estimated or fitted; inf: too dear
    exact: Indices  # (p,) 1 for the cost of a fit
    mark: Indices  # (n,) the last that went into a neighbour of this cluster
    cheapest: Indices  # (n,) entry of the cheapest neighbour of a higher index
    cost: Array  # (n,) its key, inf for none


# ------------------------------------------------------------------ step 1: who may merge
@compiled
def crosses(u: Array, v: Array) -> bool:
    """Whether two segments cross in a point inside both."""
    _, p, _, q = seen_from(line_through(u), v)
    _, r, _, t = seen_from(line_through(v), u)
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

    Of those within reach, by the distance of quality, which is written too. Most are too far off
    already without the gap between the two, the slow term.
    """
    for i in part:
        for k in range(meeting(places, s[i], reach, near)):
            j = near[k]
            angular, across = mean_line_terms(d[j], d[i])
            value = ANGULAR_WEIGHT * angular + ACROSS_WEIGHT * across
            if round_off(value) > max(nearest[i, -1], nearest[j, -1]):
                continue
            off = apart(s[j], s[i])
            if off <= reach or crosses(s[i], s[j]):
                value = round_off(value + APART_WEIGHT * off)
                insert_ranked(nearest, who, i, j, value)
                insert_ranked(nearest, who, j, i, value)
        enter(places, i, s[i], 0.0)


# ------------------------------------------------------------------ steps 3 and 4: the cheapest
@compiled
def _second_is_longer(state: State, a: int, b: int) -> bool:
    """Whether the segment of b is longer than that of a."""
    return length_of(state.drawn[b]) > length_of(state.drawn[a]) + MIN_LENGTH


@compiled
def _find_cheapest(state: State, a: int, heap: Heap) -> None:
    """Find the cheapest neighbour of a higher index (ties: the lower), and put it on the heap."""
    near, key, best, least, entry = state.near, state.key, -1, np.inf, state.link[a, 4]
    while entry >= 0:
        value, other = key[entry // 2], near[entry, 0]
        if other > a and (value < least or (value == least < np.inf and other < near[best, 0])):
            best, least = entry, value
        entry = near[entry, 1]
    state.cheapest[a], state.cost[a] = best, least
    if best >= 0:
        heapq.heappush(heap, (least, a))


@compiled
def _estimate(state: State, work: Workspace, entry: int, limits: Limits) -> None:
    """Estimate the cost of a pair, `inf` where that is far too dear.

    It is what it costs to draw the larger cluster's segment out over the smaller one's.
    """
    drawn, link, pair = state.drawn, state.link, entry // 2
    a, b = state.near[entry, 0], state.near[entry ^ 1, 0]
    a, b = min(a, b), max(a, b)
    state.key[pair], state.exact[pair] = np.inf, 0
    members, longer = link[b, 1] - link[a, 1], _second_is_longer(state, a, b)
    _, _, dx, dy = line_through(drawn[b if longer else a])
    if gap_along(drawn[a], drawn[b], dx, dy) > limits.gap:
        return
    big, small = (b, a) if members > 0 or (members == 0 and longer) else (a, b)
    line = line_through(drawn[big])
    (low_a, high_a), (low_b, high_b) = span(drawn[a], line), span(drawn[b], line)
    place_on_line(work.line, line, min(low_a, low_b), max(high_a, high_b))
    describe_one(work.line, work.frame)
    total, i = -state.sums[small, 6], link[small, 2]
    while i >= 0 and total <= ESTIMATE_PENALTIES * limits.penalty:
        total += distance_below(state.s[i], work.line, state.d[i], work.frame, np.inf)
        i = state.after[i]
    if total <= ESTIMATE_PENALTIES * limits.penalty:
        state.key[pair] = round_off(max(total, 0.0) / ESTIMATE_RATIO)


@compiled
def _fit_pair(state: State, work: Workspace, a: int, b: int, limits: Limits) -> float:
    """Cost of the best segment for two clusters, which is left in `work.line`."""
    most, count = state.sums[a, 6] + state.sums[b, 6] + ESTIMATE_PENALTIES * limits.penalty, 0
    join_sums(state.sums[a], state.sums[b], work.sums)
    for c in (a, b):
        i = state.link[c, 2]
        while i >= 0:
            work.who[count] = i
            i, count = state.after[i], count + 1
    long = state.drawn[b if _second_is_longer(state, a, b) else a]
    return fit_cheapest_line(state.s, state.d, work, count, limits, long, most)


@compiled
def _merge_clusters(state: State, a: int, b: int, line: Array, cost: float) -> None:
    """Let cluster b go into cluster a: segment, cost, sums, members, neighbours."""
    link, near, mark = state.link, state.near, state.mark
    join_sums(state.sums[a], state.sums[b], state.sums[a])
    state.sums[a, 6] = cost
    for k in range(4):
        state.drawn[a, k // 2, k % 2] = line[k // 2, k % 2]
    state.after[link[a, 3]] = link[b, 2]
    link[a, 3] = link[b, 3]
    link[a, 1] += link[b, 1]
    link[b, 0] = a
    # one list of neighbours, each once, without a and b themselves
    heads, first = (link[a, 4], link[b, 4]), -1
    link[b, 4], mark[a], mark[b] = -1, b, b
    for entry in heads:
        while entry >= 0:
            after, other = near[entry, 1], near[entry, 0]
            if other >= 0 and mark[other] != b:
                mark[other], near[entry ^ 1, 0], near[entry, 1], first = b, a, first, entry
            else:
                near[entry ^ 1, 0] = -1
            entry = after
    link[a, 4] = first


@compiled
def estimate_all(state: State, work: Workspace, part: Indices, limits: Limits) -> None:
    """Enter some pairs in the lists of neighbours, and estimate what each would cost."""
    link, near = state.link, state.near
    for pair in part:
        for entry in (2 * pair, 2 * pair + 1):
            a = near[entry ^ 1, 0]
            near[entry, 1], link[a, 4] = link[a, 4], entry
        _estimate(state, work, 2 * pair, limits)


@compiled
def _drop_outdated(state: State, heap: Heap) -> None:
    """Take from the top of the heap what is no cluster's cost any more."""
    while len(heap) and heap[0][0] != state.cost[heap[0][1]]:
        heapq.heappop(heap)


@compiled
def merge_some(state: State, work: Workspace, begin: int, end: int, limits: Limits) -> bool:
    """Merge some clusters, the cheapest pair first, until each merge costs the penalty.

    False after `WORK` pairs and members, where there is more to do.
    """
    link, near, cost, heap, effort = state.link, state.near, state.cost, [(0.0, 0)], 0
    heapq.heappop(heap)  # the compiler has learned what an entry is
    for a in range(begin, end):
        if link[a, 0] == a:
            _find_cheapest(state, a, heap)
    while len(heap) and effort < WORK:
        a = heap[0][1]
        b, pair = near[state.cheapest[a], 0], state.cheapest[a] // 2
        effort += 1 + link[a, 1] + link[b, 1]
        cost_fitted = _fit_pair(state, work, a, b, limits)
        delta = round_off(cost_fitted - (state.sums[a, 6] + state.sums[b, 6]))
        if not state.exact[pair]:
            state.exact[pair] = 1
            state.key[pair] = delta if delta <= limits.penalty else np.inf
            _find_cheapest(state, a, heap)
            _drop_outdated(state, heap)
            if not (len(heap) and delta <= min(limits.penalty, heap[0][0])):
                continue
        _merge_clusters(state, a, b, work.line, cost_fitted)
        _find_cheapest(state, b, heap)
        entry = link[a, 4]
        while entry >= 0:
            _estimate(state, work, entry, limits)
            c = near[entry, 0]
            cheapest = near[state.cheapest[c], 0]
            if cheapest < 0 or cheapest == a or (c < a and state.key[entry // 2] <= cost[c]):
                _find_cheapest(state, c, heap)
            entry = near[entry, 1]
        _find_cheapest(state, a, heap)
        _drop_outdated(state, heap)
    return len(heap) == 0
