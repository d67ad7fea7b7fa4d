"""The loops of Basic: plain Python, compiled when called.

Only pairs with a new or changed member can match, and a match needs end points closer than
`distance`. So end points are kept in a grid of cells of that size, a hash table of linked lists
(`head[slot]`, then `after` and `before` of end point 2 i + k of segment i), and a pass visits, in
index order, only the segments that have such a pair: all others would find nothing to merge.
"""

import heapq
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array
from ..kernels import slot_of

Indices = NDArray[np.int64]


class State(NamedTuple):
    """Segments `(n, 2, 2)`, metres, what is known of each, and the grid of their end points.

    Angles, radians, and lengths, metres, `(n,)` each; parents `(n,)`.
    """

    s: Array
    angles: Array
    lengths: Array
    alive: NDArray[np.bool_]
    parents: Indices
    head: Indices
    after: Indices
    before: Indices


def start(segments: Array) -> State:
    """State of segments `(n, 2, 2)`, metres, none of which is in the map yet."""
    n = len(segments)
    d = segments[:, 1] - segments[:, 0]
    slots = 1 << max(int(np.ceil(np.log2(max(4 * n, 2)))), 1)
    return State(
        segments.copy(),
        np.arctan2(d[:, 1], d[:, 0]),
        np.hypot(d[:, 0], d[:, 1]),
        np.zeros(n, np.bool_),
        np.arange(n),
        np.full(slots, -1, np.int64),
        np.full(2 * n, -1, np.int64),
        np.full(2 * n, -1, np.int64),
    )


@compiled
def enter(state: State, i: int, cell: float) -> None:
    """Put both end points of segment i into the grid of cells of side `cell`, metres.

    Of the state's segments `(n, 2, 2)`, metres.
    """
    head, after, before = state.head, state.after, state.before
    for k in range(2):
        x, y = state.s[i, k, 0], state.s[i, k, 1]
        slot = slot_of(int(np.floor(x / cell)), int(np.floor(y / cell)), len(head))
        e = 2 * i + k
        after[e], before[e] = head[slot], -1 - slot
        if head[slot] >= 0:
            before[head[slot]] = e
        head[slot] = e


@compiled
def leave(state: State, i: int) -> None:
    """Take both end points of a segment out of the grid."""
    head, after, before = state.head, state.after, state.before
    for e in (2 * i, 2 * i + 1):
        if before[e] < 0:
            head[-1 - before[e]] = after[e]
        else:
            after[before[e]] = after[e]
        if after[e] >= 0:
            before[after[e]] = before[e]


@compiled
def match(state: State, a: int, k: int, e: int, distance: float, angle: float) -> bool:
    """Whether end point k of segment a and end point e make a match (A 4.1); both tests strict.

    Of the state's segments `(n, 2, 2)`, metres; e is 2 b and the end of segment b. Distance in
    metres, angle in radians.
    """
    b = e // 2
    dx = state.s[a, k, 0] - state.s[b, e % 2, 0]
    dy = state.s[a, k, 1] - state.s[b, e % 2, 1]
    if dx * dx + dy * dy >= distance * distance:
        return False
    turn = (state.angles[a] - state.angles[b] + np.pi / 2) % np.pi - np.pi / 2
    return abs(turn) < angle


@compiled
def _next_match(state: State, a: int, last: int, distance: float, angle: float) -> int:
    """Lowest live segment above `last` that matches a, -1 for none; metres and radians."""
    found = len(state.s)
    for k in range(2):
        column = int(np.floor(state.s[a, k, 0] / distance))
        row = int(np.floor(state.s[a, k, 1] / distance))
        for i in range(column - 1, column + 2):
            for j in range(row - 1, row + 2):
                e = state.head[slot_of(i, j, len(state.head))]
                while e >= 0:
                    b = e // 2
                    if last < b < found and b != a and match(state, a, k, e, distance, angle):
                        found = b
                    e = state.after[e]
    return found if found < len(state.s) else -1


@compiled
def merge(state: State, a: int, b: int, distance: float) -> None:
    """A 4.1: b goes into a, on the length-weighted mean line; the extreme projections remain.

    Writes to rows a and b of the state's arrays: segments `(n, 2, 2)`, metres, angles, radians.
    Cells of the grid have the side `distance`, metres.
    """
    s, la, lb = state.s, state.lengths[a], state.lengths[b]
    share = lb / (la + lb)
    turn = (state.angles[b] - state.angles[a] + np.pi / 2) % np.pi - np.pi / 2
    direction = state.angles[a] + share * turn
    dx, dy = np.cos(direction), np.sin(direction)
    x = (1 - share) * (s[a, 0, 0] + s[a, 1, 0]) / 2 + share * (s[b, 0, 0] + s[b, 1, 0]) / 2
    y = (1 - share) * (s[a, 0, 1] + s[a, 1, 1]) / 2 + share * (s[b, 0, 1] + s[b, 1, 1]) / 2
    low, high = np.inf, -np.inf
    for i in (a, b):
        for k in range(2):
            u = (s[i, k, 0] - x) * dx + (s[i, k, 1] - y) * dy
            low, high = min(low, u), max(high, u)
    leave(state, a)
    leave(state, b)
    s[a, 0, 0], s[a, 0, 1] = x + low * dx, y + low * dy
    s[a, 1, 0], s[a, 1, 1] = x + high * dx, y + high * dy
    state.angles[a], state.lengths[a] = direction, high - low
    state.alive[b], state.parents[b] = False, a
    enter(state, a, distance)


@compiled
def absorb(state: State, a: int, distance: float, angle: float) -> int:
    """The inner loop of Basic: merge into a, in index order, every b that matches as a grows.

    The state's segments `(n, 2, 2)` and the distance in metres, the angle in radians. Returns how
    many died.
    """
    died, last = 0, -1
    while True:
        last = _next_match(state, a, last, distance, angle)
        if last < 0:
            return died
        merge(state, a, last, distance)
        died += 1


@compiled
def converge(state: State, first: int, stop: int, distance: float, angle: float) -> int:
    """Add the segments `first` to `stop` to the map and pass over it until nothing merges.

    The state's segments `(n, 2, 2)` and the distance in metres, the angle in radians. Returns how
    many died.
    """
    heap, later = [first], [first]
    heap.pop()
    later.pop()
    died = 0
    for i in range(first, stop):
        state.alive[i] = True
        enter(state, i, distance)
    for i in range(first, stop):
        heapq.heappush(heap, i)
        b = _next_match(state, i, -1, distance, angle)
        while 0 <= b < first:
            heapq.heappush(heap, b)
            b = _next_match(state, i, b, distance, angle)
    while len(heap):
        previous = -1
        while len(heap):
            a = heapq.heappop(heap)
            if a == previous or not state.alive[a]:
                continue
            previous = a
            lost = absorb(state, a, distance, angle)
            died += lost
            b = _next_match(state, a, -1, distance, angle) if lost else -1
            while b >= 0:
                heapq.heappush(heap if b > a else later, b)
                b = _next_match(state, a, b, distance, angle)
        heap, later = later, heap
    return died
