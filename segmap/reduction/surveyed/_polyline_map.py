"""The map that polylines are laid in: pieces in a ring, in their order, and a grid of them.

Plain loops, compiled when called; coordinates and lengths are in metres.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from ...kernels import SAME, Rule, describe_one, match_value
from .._cells import Cells, empty_cells, enter, leave, near, wider
from .._runner import Indices
from ._polyline_kernels import trace

#: Segments at `far` exactly match; the grid leaves out what is at its reach.
WIDER = 1.001


class State(NamedTuple):
    """The map: all pieces that there ever were, those that are left in a ring, and a grid of them.

    Piece 0 is none: it joins the ends of the ring. A label tells which of two pieces comes first.

    Parameters
    ----------
    s : (room, 2, 2) array, metres
    about : (room, 5) array
        What `describe` says of each.
    into : (room,) int array
        The piece that took each in; its own index while it is left.
    before, after : (room,) int array
        Neighbours in the ring.
    label : (room,) array
        Rises along the ring.
    chain, next, touched : (room,) int array
        While a scan is taken: a segment of it that each piece matches, or -1; the next piece of
        that chain; and the pieces that have a chain.
    counts : (2,) int array
        How many pieces there ever were, 0 among them, and how many are left.
    cells : Cells
    found : (room,) int array
        Room for neighbours, and for the members of a chain.
    """

    s: Array
    about: Array
    into: Indices
    before: Indices
    after: Indices
    label: Array
    chain: Indices
    next: Indices
    touched: Indices
    counts: Indices
    cells: Cells
    found: Indices


def empty_map(segments: Array, rule: Rule) -> State:
    room = 2 * len(segments) + 2
    before, after, into, behind, touched, found = np.zeros((6, room), np.int64)
    return State(
        s=np.zeros((room, 2, 2)),
        about=np.empty((room, 5)),
        into=into,
        before=before,
        after=after,
        label=np.zeros(room),
        chain=np.full(room, -1),
        next=behind,
        touched=touched,
        counts=np.array([1, 0]),
        cells=empty_cells(segments, WIDER * rule[1], room),
        found=found,
    )


def with_room(state: State, room: int) -> State:
    """The same map, with room for at least so many pieces."""
    more = max(room, 2 * len(state.s)) - len(state.s)
    if room <= len(state.s):
        return state
    longer = {
        name: np.concatenate([value, np.zeros((more, *value.shape[1:]), value.dtype)])
        for name, value in state._asdict().items()
        if name not in ("cells", "counts")
    }
    longer["chain"][-more:] = -1
    return state._replace(cells=wider(state.cells, more), **longer)


@compiled
def _root(root: Indices, i: int) -> int:
    """The segment that stands for the chain of i."""
    while root[i] != i:
        root[i] = root[root[i]]
        i = root[i]
    return i


@compiled
def _link(
    state: State, new: Array, about: Array, i: int, rule: Rule, links: Indices, count: int
) -> int:
    """Join segment i to the chains of all pieces that it matches; how many pieces have a chain."""
    root = links[0]
    for k in range(near(state.cells, state.s, new[i], state.found)):
        b = state.found[k]
        if match_value(state.s, state.about, b, new, about, i, rule) > SAME:
            if state.chain[b] < 0:
                state.chain[b], state.touched[count] = i, b
                count += 1
            else:
                root[_root(root, i)] = _root(root, state.chain[b])
    return count


@compiled
def _place(
    state: State, x: float, y: float, x2: float, y2: float, behind: int, label: float
) -> int:
    """A new piece, metres, behind another one of the ring; which it is."""
    b = state.counts[0]
    state.counts[0] += 1
    state.counts[1] += 1
    state.s[b, 0, 0], state.s[b, 0, 1], state.s[b, 1, 0], state.s[b, 1, 1] = x, y, x2, y2
    describe_one(state.s, b, state.about)
    state.into[b], state.label[b] = b, label
    state.before[b], state.after[b] = behind, state.after[behind]
    state.before[state.after[b]] = b
    state.after[behind] = b
    enter(state.cells, state.s, b)
    return b


@compiled
def _take_out(state: State, b: int) -> None:
    state.after[state.before[b]] = state.after[b]
    state.before[state.after[b]] = state.before[b]
    state.chain[b] = -1
    state.counts[1] -= 1
    leave(state.cells, b)


@compiled
def _number(state: State) -> None:
    """Give all pieces labels with room between them."""
    b, label = state.after[0], 1.0
    while b != 0:
        state.label[b] = label
        b, label = state.after[b], label + 1.0


@compiled
def _replace(
    state: State,
    new: Array,
    members: Indices,
    old: int,
    tolerance: float,
    bridge: float,
    pieces: Indices,
) -> None:
    """Put the polyline of a chain in the place of the first of its `old` pieces.

    Members are pieces of the map, in its order, then segments of `(n, 2, 2)`, metres.
    """
    m = len(members)
    s, corners, owner = np.empty((m, 2, 2)), np.empty((2 * m + 2, 2)), np.empty(m, np.int64)
    for i in range(m):
        source = state.s if i < old else new
        for k in range(2):
            s[i, k, 0], s[i, k, 1] = source[members[i], k, 0], source[members[i], k, 1]
    count = trace(s, tolerance, corners, owner)
    first, behind = state.label[members[0]], state.before[members[0]]
    for i in range(old):
        _take_out(state, members[i])
    label, following, fits = first, state.after[behind], True
    step = (state.label[following] - first) / (count - 1) if following != 0 else 1.0
    for k in range(count - 1):
        x, y, x2, y2 = corners[k, 0], corners[k, 1], corners[k + 1, 0], corners[k + 1, 1]
        owned = np.hypot(x2 - x, y2 - y) <= bridge
        for i in range(m):
            owned = owned or owner[i] == k
        if not owned:
            continue
        behind = _place(state, x, y, x2, y2, behind, label)
        fits = fits and label > state.label[state.before[behind]]
        fits = fits and (following == 0 or label < state.label[following])
        label += step
        for i in range(m):
            if owner[i] == k and i < old:
                state.into[members[i]] = behind
            elif owner[i] == k:
                pieces[members[i]] = behind
    if not fits:
        _number(state)


@compiled
def _gather(state: State, links: Indices, r: int) -> tuple[int, int]:
    """Write the members of chain r: its pieces in the order of the map, its segments ascending.

    How many pieces, and how many members.
    """
    members, count, b = state.found, 0, links[1, r]
    while b >= 0:
        place = count
        while place > 0 and state.label[members[place - 1]] > state.label[b]:
            members[place] = members[place - 1]
            place -= 1
        members[place] = b
        count, b = count + 1, state.next[b]
    old, i = count, links[2, r]
    while i >= 0:
        members[count] = i
        count, i = count + 1, links[3, i]
    return old, count


@compiled
def add(
    state: State,
    new: Array,
    about: Array,
    first: int,
    stop: int,
    rule: Rule,
    tolerance: float,
    bridge: float,
    links: Indices,
    pieces: Indices,
) -> None:
    """Take the segments `first` to `stop` of `(n, 2, 2)`, metres; write the piece of each.

    `links` has a row each for the segment that stands for the chain of each; the first piece and
    the first segment of the chain; and the segment that comes next in it.
    """
    touched = 0
    for i in range(first, stop):
        links[0, i], links[1, i], links[2, i] = i, -1, -1
    for i in range(first, stop):
        touched = _link(state, new, about, i, rule, links, touched)
    for k in range(touched):
        b = state.touched[k]
        r = _root(links[0], state.chain[b])
        state.next[b] = links[1, r]
        links[1, r] = b
    for i in range(stop - 1, first - 1, -1):
        r = _root(links[0], i)
        links[3, i] = links[2, r]
        links[2, r] = i
    for i in range(first, stop):
        if links[0, i] == i and links[1, i] >= 0:
            old, count = _gather(state, links, i)
            _replace(state, new, state.found[:count], old, tolerance, bridge, pieces)
    for i in range(first, stop):
        if links[0, i] == i and links[1, i] < 0:
            s, tail = new[i], state.before[0]
            pieces[i] = _place(
                state, s[0, 0], s[0, 1], s[1, 0], s[1, 1], tail, state.label[tail] + 1.0
            )
