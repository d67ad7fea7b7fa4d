"""Polylines (A 2.7.10): scan by scan, a chain of segments that match becomes a line with bends."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from ...arrays import Array, Metres, Segments, at_least, at_most, checked
from ...compiled import compiled
from ...kernels import SAME, Rule, describe, describe_one, hausdorff, match_value, root_of
from ...segments import length
from .._index import Index, empty_index, enter, leave, meeting, wider
from .._runner import Indices, Reduction, Rows, Steps, run_online

#: Between the places of two pieces in the ring, at first.
GAP = 64


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
    >>> found = polyline(SegmentMap(bend, scan=[0, 1, 0]), tolerance=0.10)
    >>> found, found.segments[:, 1].round(6).tolist()
    (Reduction(polyline: 3 -> 3 segments), [[0.9, 0.02], [1.8, 0.3], [3.0, 0.3]])
    """
    rule = distance, far, long, False

    def steps(rows: Rows) -> Steps:
        new, n = rows.segments, len(rows.segments)
        unit = max(2 * far, float(length(new).mean()) if n else 0.0)
        about, state = describe(new), _empty_map(2 * n + 2, unit)
        links, pieces = np.empty((4, n), np.int64), np.empty(n, np.int64)
        for first, stop in rows.scans():
            used, live = state.counts.tolist()
            state = _with_room(state, used + 3 * (live + stop - first) + 1)
            _add(state, new, about, first, stop, rule, tolerance, bridge, links, pieces)
            yield int(state.counts[1])
        into = state.into[: state.counts[0]]
        while (into[into] != into).any():
            into = into[into]
        order, piece = np.empty(int(state.counts[1]), np.int64), state.after[0]
        for k in range(len(order)):
            order[k], piece = piece, state.after[piece]
        place = np.full(len(into), -1)
        place[order] = np.arange(len(order))
        return state.s[order], place[into[pieces]]

    return run_online("polyline", map, steps, splits=True)


class State(NamedTuple):
    """The map: all pieces that ever were; those that are left in a ring, and an index of them.

    Piece 0 is none: it joins the ends of the ring.
    """

    s: Array  # (room, 2, 2), metres
    about: Array  # (room, 5) what `describe` says of each
    into: Indices  # the piece that took each in; its own index while it is left
    before: Indices  # neighbours in the ring
    after: Indices
    place: Indices  # ascending along the ring, with gaps
    chain: Indices  # a segment of the scan that each piece matches, or -1
    next: Indices  # the next piece of that chain
    touched: Indices  # the pieces that have a chain
    near: Indices  # room for neighbours, and for the members of a chain
    counts: Indices  # (2,) how many pieces there ever were, 0 among them, and how many are left
    places: Index


def _empty_map(room: int, unit: float) -> State:
    into, before, after, place, next, touched = np.zeros((6, room), np.int64)
    return State(
        s=np.zeros((room, 2, 2)),
        about=np.empty((room, 5)),
        into=into,
        before=before,
        after=after,
        place=place,
        chain=np.full(room, -1),
        next=next,
        touched=touched,
        near=np.empty(room + 1, np.int64),
        counts=np.array([1, 0]),
        places=empty_index(room, unit),
    )


def _with_room(state: State, room: int) -> State:
    """The same map, with room for at least so many pieces."""
    if room <= len(state.s):
        return state
    larger, old = _empty_map(max(room, 2 * len(state.s)), state.places.unit), len(state.s)
    for name, values in state._asdict().items():
        if name not in ("counts", "places"):
            getattr(larger, name)[:old] = values[:old]
    return larger._replace(counts=state.counts, places=wider(state.places, len(larger.s)))


# ------------------------------------------------------------------ the line through a chain
@compiled
def _distance(p: Array, q: Array) -> float:
    return np.hypot(p[0] - q[0], p[1] - q[1])


@compiled
def _nearest_piece(s: Array, corners: Array, count: int) -> tuple[float, int]:
    """Distance of a segment `(2, 2)` from its nearest piece (A 2.39), and which; ties: first.

    A line has the corners in the first `count` rows of an array of points.
    """
    best, at = np.inf, 0
    for k in range(count - 1):
        far = hausdorff(s, corners[k : k + 2])
        if far < best - SAME:
            best, at = far, k
    return best, at


@compiled
def _put_in(s: Array, corners: Array, count: int, k: int) -> int:
    """Replace piece k, from a to b, by a-s, s and s-b; how many corners there are then."""
    a, b, first = corners[k], corners[k + 1], 0
    straight = _distance(a, s[0]) + _distance(s[1], b)
    if _distance(a, s[1]) + _distance(s[0], b) < straight - SAME:
        first = 1
    new = np.empty((2, 2))
    more = 0
    for end in (first, 1 - first):
        if min(_distance(a, s[end]), _distance(s[end], b)) >= SAME:
            new[more, 0], new[more, 1] = s[end, 0], s[end, 1]
            more += 1
    for j in range(count - 1, k, -1):
        corners[j + more, 0], corners[j + more, 1] = corners[j, 0], corners[j, 1]
    for j in range(more):
        corners[k + 1 + j, 0], corners[k + 1 + j, 1] = new[j, 0], new[j, 1]
    return count + more


@compiled
def _prune(s: Array, corners: Array, count: int, tolerance: float, owner: Indices) -> int:
    """Leave out inner corners while all stay near; how many corners are left.

    `owner` counts the pieces that each segment is near: one less corner is two pieces less and one
    more, so each try looks at three pieces only.
    """
    for i in range(len(s)):
        owner[i] = 0
        for k in range(count - 1):
            owner[i] += hausdorff(s[i], corners[k : k + 2]) < tolerance
    k, link = 1, np.empty((2, 2))
    while k < count - 1:
        for c in range(2):
            link[0, c], link[1, c] = corners[k - 1, c], corners[k + 1, c]
        fits = _distance(link[0], link[1]) >= SAME
        for gone in (False, True):
            for i in range(len(s)):
                if fits:
                    pieces = owner[i] + (hausdorff(s[i], link) < tolerance)
                    pieces -= hausdorff(s[i], corners[k - 1 : k + 1]) < tolerance
                    pieces -= hausdorff(s[i], corners[k : k + 2]) < tolerance
                    if gone:
                        owner[i] = pieces
                    elif pieces == 0:
                        fits = False
        k += 1
        if fits:
            count -= 1
            for j in range(k - 1, count):
                corners[j, 0], corners[j, 1] = corners[j + 1, 0], corners[j + 1, 1]
            k = 1
    return count


@compiled
def _trace(s: Array, tolerance: float, corners: Array, owner: Indices) -> int:
    """Write the corners of the polyline of a chain, `(2 m + 2, 2)`; how many they are.

    And for each of the m segments its nearest piece.
    """
    count, most = 2, 0.0
    for a in range(2 * len(s)):  # the two end points that lie farthest apart; ties: the first pair
        owner[a // 2] = 0
        for b in range(a + 1, 2 * len(s)):
            p, q = s[a // 2, a % 2], s[b // 2, b % 2]
            if _distance(p, q) > most + SAME:
                most = _distance(p, q)
                for c in range(2):
                    corners[0, c], corners[1, c] = p[c], q[c]
    for _ in range(len(s)):
        most, worst, at = 0.0, 0, 0
        for i in range(len(s)):
            if owner[i] == 0:
                far, k = _nearest_piece(s[i], corners, count)
                if far > most + SAME:
                    most, worst, at = far, i, k
        if most < tolerance:
            break
        count = _put_in(s[worst], corners, count, at)
        owner[worst] = 1
    if count > 2:
        count = _prune(s, corners, count, tolerance, owner)
    for i in range(len(s)):
        owner[i] = _nearest_piece(s[i], corners, count)[1]
    return count


# ------------------------------------------------------------------ the map and a scan
@compiled
def _place(state: State, p: Array, q: Array, behind: int) -> int:
    """A new piece from p to q, behind another one of the ring; which it is."""
    b, place, ahead = state.counts[0], state.place, state.after[behind]
    state.counts[0] += 1
    state.counts[1] += 1
    if ahead > 0 and place[ahead] - place[behind] < 2:  # no gap is left there: all get new ones
        k = 0
        while state.after[k] != 0:
            place[state.after[k]] = place[k] + GAP
            k = state.after[k]
    place[b] = (place[behind] + place[ahead]) // 2 if ahead > 0 else place[behind] + GAP
    for c in range(2):
        state.s[b, 0, c], state.s[b, 1, c] = p[c], q[c]
    describe_one(state.s[b], state.about[b])
    state.into[b], state.before[b], state.after[b] = b, behind, ahead
    state.before[ahead] = b
    state.after[behind] = b
    enter(state.places, b, state.s[b], 0.0)
    return b


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

    Members are pieces of the map, in its order, then segments of `(n, 2, 2)`.
    """
    m = len(members)
    s, corners, owner = np.empty((m, 2, 2)), np.empty((2 * m + 2, 2)), np.empty(m, np.int64)
    for i in range(m):
        source = state.s if i < old else new
        for k in range(2):
            s[i, k, 0], s[i, k, 1] = source[members[i], k, 0], source[members[i], k, 1]
    count, behind = _trace(s, tolerance, corners, owner), state.before[members[0]]
    for i in range(old):
        b = members[i]
        state.after[state.before[b]], state.before[state.after[b]] = state.after[b], state.before[b]
        state.chain[b] = -1
        state.counts[1] -= 1
        leave(state.places, b)
    for k in range(count - 1):
        owned = _distance(corners[k], corners[k + 1]) <= bridge
        for i in range(m):
            owned = owned or owner[i] == k
        if not owned:
            continue
        behind = _place(state, corners[k], corners[k + 1], behind)
        for i in range(m):
            if owner[i] == k and i < old:
                state.into[members[i]] = behind
            elif owner[i] == k:
                pieces[members[i]] = behind


@compiled
def _gather(state: State, links: Indices, r: int) -> tuple[int, int]:
    """Write the members of chain r: its pieces in the order of the map, its segments ascending.

    How many pieces, and how many members.
    """
    members, count, b = state.near, 0, links[1, r]
    while b >= 0:
        at = count
        while at > 0 and state.place[members[at - 1]] > state.place[b]:
            members[at] = members[at - 1]
            at -= 1
        members[at] = b
        count, b = count + 1, state.next[b]
    old, i = count, links[2, r]
    while i >= 0:
        members[count] = i
        count, i = count + 1, links[3, i]
    return old, count


@compiled
def _add(
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
    """Take the segments `first` to `stop` of `(n, 2, 2)`; write the piece of each.

    `links` has a row each for the segment that stands for the chain of each; the first piece and
    the first segment of the chain; and the segment that comes next in it.
    """
    root, touched = links[0], 0
    for i in range(first, stop):
        links[0, i], links[1, i], links[2, i] = i, -1, -1
    for i in range(first, stop):
        for k in range(meeting(state.places, new[i], rule[1], state.near)):
            b = state.near[k]
            if match_value(state.s, state.about, b, new, about, i, rule) <= SAME:
                continue
            if state.chain[b] < 0:
                state.chain[b], state.touched[touched] = i, b
                touched += 1
            else:
                root[root_of(root, i)] = root_of(root, state.chain[b])
    for k in range(touched):
        b = state.touched[k]
        r = root_of(root, state.chain[b])
        state.next[b] = links[1, r]
        links[1, r] = b
    for i in range(stop - 1, first - 1, -1):
        r = root_of(root, i)
        links[3, i] = links[2, r]
        links[2, r] = i
    for i in range(first, stop):
        if root[i] == i and links[1, i] >= 0:
            old, count = _gather(state, links, i)
            _replace(state, new, state.near[:count], old, tolerance, bridge, pieces)
    for i in range(first, stop):
        if root[i] == i and links[1, i] < 0:
            pieces[i] = _place(state, new[i, 0], new[i, 1], state.before[0])
