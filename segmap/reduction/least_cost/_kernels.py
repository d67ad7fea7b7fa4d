"""The loops of least cost that choose which clusters merge: who is near whom, the cheapest first.

Members of a cluster, and its neighbours, are linked lists: `first`, then `after`, -1 at the end.
"""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from ...kernels import apart, slot_of
from ...segments import MIN_LENGTH
from ._fit_kernels import (
    EQUAL,
    WIDE,
    Indices,
    Limits,
    Room,
    describe_one,
    distance_between,
    draw,
    fit,
    join_sums,
    length_of,
)

#: Key, both clusters, both versions, and whether the key is the cost of a fit or an estimate.
Entry = tuple[float, int, int, int, int, int]


class State(NamedTuple):
    """Clusters while they merge: n inputs, and as many clusters at first."""

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


@compiled
def rounded(cost: float) -> float:
    """Costs that are equal but for rounding become the same number."""
    return np.floor(cost / EQUAL + 0.5) * EQUAL


@compiled
def longer(state: State, a: int, b: int) -> bool:
    """Whether the segment of b is longer than that of a."""
    return length_of(state.drawn[b]) > length_of(state.drawn[a]) + MIN_LENGTH


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
def cell_of(s: Array, k: int, steps: int, cell: float, slots: int, around: int) -> int:
    """Slot of one of nine cells around the one that holds the k-th sample of a segment."""
    x = s[0, 0] + k / steps * (s[1, 0] - s[0, 0])
    y = s[0, 1] + k / steps * (s[1, 1] - s[0, 1])
    column, row = int(np.floor(x / cell)), int(np.floor(y / cell))
    return slot_of(column + around // 3 - 1, row + around % 3 - 1, slots)


@compiled
def fill(s: Array, steps: Indices, cell: float, begin: Indices, held: Indices) -> None:
    """Count the samples of each cell into `begin` (`held` is empty), or store their segments."""
    for i in range(len(s)):
        last = -1
        for k in range(steps[i] + 1):
            slot = cell_of(s[i], k, steps[i], cell, len(begin) - 1, 4)
            if slot == last:
                continue
            last = slot
            if len(held):
                begin[slot] -= 1
                held[begin[slot]] = i
            else:
                begin[slot] += 1


@compiled
def keep(nearest: Array, who: Indices, i: int, j: int, value: float) -> None:
    """Put a neighbour into the list of the nearest of i, where it is among them (ties: lower)."""
    at = who.shape[1]
    while at > 0 and (
        value < nearest[i, at - 1] or (value == nearest[i, at - 1] and j < who[i, at - 1])
    ):
        at -= 1
        if at + 1 < who.shape[1]:
            nearest[i, at + 1], who[i, at + 1] = nearest[i, at], who[i, at]
    if at < who.shape[1]:
        nearest[i, at], who[i, at] = value, j


@compiled
def nearest_neighbours(
    state: State, sizes: Array, steps: Indices, begin: Indices, held: Indices, who: Indices
) -> None:
    """Write the indices of the nearest of each input, `(n, k)`, -1 where there are no more.

    Of those nearer than the reach, by the distance of quality. `sizes` are the side of a cell and
    the reach, metres; a cell is twice the reach or more. Samples are half a cell apart: who is
    within reach has one in one of nine cells.
    """
    cell, reach = sizes[0], sizes[1]
    s, d, nearest = state.s, state.d, np.full(who.shape, np.inf)
    for i in range(len(s)):
        state.mark[i] = i
        for at in range(9 * (steps[i] + 1)):
            slot = cell_of(s[i], at // 9, steps[i], cell, len(begin) - 1, at % 9)
            for k in range(begin[slot], begin[slot + 1]):
                j = held[k]
                if j < i or state.mark[j] == i:
                    continue
                state.mark[j] = i
                dx, dy, most = d[i, 0] - d[j, 0], d[i, 1] - d[j, 1], d[i, 4] + d[j, 4] + reach
                if dx * dx + dy * dy > most * most:
                    continue
                if apart(s[i], s[j]) <= reach or crosses(s[i], s[j]):
                    value = rounded(distance_between(s[i], s[j], d[i], d[j]))
                    keep(nearest, who, i, j, value)
                    keep(nearest, who, j, i, value)


# ------------------------------------------------------------------ step 3: a first estimate
@compiled
def span(s: Array, frame: Array) -> tuple[float, float]:
    """Low and high projection of a segment, (2, 2), on a line that is described by (5,)."""
    a = (s[0, 0] - frame[0]) * frame[2] + (s[0, 1] - frame[1]) * frame[3]
    b = (s[1, 0] - frame[0]) * frame[2] + (s[1, 1] - frame[1]) * frame[3]
    return min(a, b), max(a, b)


@compiled
def estimate(state: State, room: Room, a: int, b: int, limits: Limits) -> float:
    """What it costs to draw the larger cluster's segment out over the smaller one's, metres."""
    drawn, link, members = state.drawn, state.link, state.link[b, 2] - state.link[a, 2]
    describe_one(drawn[b if longer(state, a, b) else a], room.frame)
    low_a, high_a = span(drawn[a], room.frame)
    low_b, high_b = span(drawn[b], room.frame)
    if max(low_a, low_b) - min(high_a, high_b) > limits.gap:
        return np.inf
    larger = members > 0 or (members == 0 and longer(state, a, b))
    big, small = (b, a) if larger else (a, b)
    describe_one(drawn[big], room.frame)
    x, y, dx, dy = room.frame[0], room.frame[1], room.frame[2], room.frame[3]
    low_a, high_a = span(drawn[a], room.frame)
    low_b, high_b = span(drawn[b], room.frame)
    draw(x, y, dx, dy, min(low_a, low_b), max(high_a, high_b), room)
    total, i = -state.sums[small, 6], link[small, 3]
    while i >= 0 and total <= WIDE * limits.penalty:
        total += distance_between(state.s[i], room.line, state.d[i], room.frame)
        i = state.after[i]
    return total


@compiled
def push(heap: list[Entry], state: State, room: Room, a: int, b: int, limits: Limits) -> None:
    """Put a pair on the heap by its estimate, unless that is far too dear."""
    q = estimate(state, room, a, b, limits)
    if q <= WIDE * limits.penalty:
        key = rounded(max(q, 0.0) / WIDE)
        heapq.heappush(heap, (key, a, b, state.link[a, 1], state.link[b, 1], 0))


# ------------------------------------------------------------------ step 4: the cheapest first
@compiled
def gather(state: State, room: Room, a: int, b: int) -> int:
    """Write the members of two clusters side by side; how many."""
    count = 0
    for c in (a, b):
        i = state.link[c, 3]
        while i >= 0:
            room.who[count] = i
            for k in range(2):
                room.ends[count, 2 * k], room.ends[count, 2 * k + 1] = (
                    state.s[i, k, 0],
                    state.s[i, k, 1],
                )
            for k in range(5):
                room.about[count, k] = state.d[i, k]
            i, count = state.after[i], count + 1
    return count


@compiled
def fit_pair(state: State, room: Room, a: int, b: int, limits: Limits) -> float:
    """Cost of the best segment for two clusters; it stays in `fits`, for as long as both last."""
    drawn, link, fitted, fits = state.drawn, state.link, state.fitted, state.fits
    if fitted[a, 0] == b and fitted[a, 1] == link[a, 1] and fitted[a, 2] == link[b, 1]:
        return fits[a, 4]
    most = state.sums[a, 6] + state.sums[b, 6] + WIDE * limits.penalty
    join_sums(state.sums[a], state.sums[b], room.sums)
    long = drawn[b if longer(state, a, b) else a]
    cost = fit(state.s, room, gather(state, room, a, b), limits, long, most)
    fitted[a, 0], fitted[a, 1], fitted[a, 2] = b, link[a, 1], link[b, 1]
    for k in range(4):
        fits[a, k] = room.line[k // 2, k % 2]
    fits[a, 4] = cost
    return cost


@compiled
def merge(state: State, room: Room, a: int, b: int) -> None:
    """Let cluster b go into cluster a: segment, cost, sums, members, version, neighbours."""
    link = state.link
    join_sums(state.sums[a], state.sums[b], room.sums)
    for k in range(6):
        state.sums[a, k] = room.sums[k]
    state.sums[a, 6] = state.fits[a, 4]
    for k in range(4):
        state.drawn[a, k // 2, k % 2] = state.fits[a, k]
    state.after[link[a, 4]] = link[b, 3]
    link[a, 4] = link[b, 4]
    link[a, 1] += 1
    link[a, 2] += link[b, 2]
    link[b, 0] = a
    join_neighbours(state, a, b)


@compiled
def root(link: Indices, c: int) -> int:
    """The living cluster that a cluster went into."""
    while link[c, 0] != c:
        link[c, 0] = link[link[c, 0], 0]
        c = link[c, 0]
    return c


@compiled
def join_neighbours(state: State, a: int, b: int) -> None:
    """One list of neighbours for a: living ones, each once, without a itself."""
    link, near = state.link, state.near
    state.mark[a] = link[a, 1] * len(link) + a + len(link)
    stamp, first, last = state.mark[a], -1, -1
    for c in (a, b):
        entry = link[c, 5]
        while entry >= 0:
            after, other = near[entry, 1], root(link, near[entry, 0])
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
def merge_all(state: State, room: Room, limits: Limits) -> None:
    """Merge clusters, the cheapest pair first, until every merge costs more than the penalty."""
    link, near = state.link, state.near
    heap = [(0.0, 0, 0, 0, 0, 0)]  # the compiler learns what an entry is
    heap.pop()
    for a in range(len(link)):
        entry = link[a, 5]
        while entry >= 0:
            if near[entry, 0] > a:
                push(heap, state, room, a, near[entry, 0], limits)
            entry = near[entry, 1]
    while len(heap):
        _, a, b, of_a, of_b, exact = heapq.heappop(heap)
        if link[a, 0] != a or link[b, 0] != b or link[a, 1] != of_a or link[b, 1] != of_b:
            continue
        cost = fit_pair(state, room, a, b, limits)
        delta = rounded(cost - (state.sums[a, 6] + state.sums[b, 6]))
        if not exact:
            if not delta <= limits.penalty:
                continue
            if len(heap) and delta > heap[0][0]:
                heapq.heappush(heap, (delta, a, b, of_a, of_b, 1))
                continue
        merge(state, room, a, b)
        entry = link[a, 5]
        while entry >= 0:
            push(heap, state, room, min(a, near[entry, 0]), max(a, near[entry, 0]), limits)
            entry = near[entry, 1]
