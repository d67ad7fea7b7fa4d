"""Fuzzy set (A 2.7.4): walls along the axes of a building; the precise ones draw the others in."""

from __future__ import annotations

import heapq
from dataclasses import replace
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Metres, Quantity, Radians, Segments, at_most, checked
from ...compiled import compiled
from ...segments import SegmentMap, length, take_points
from ...segments import angle as angle_of
from .._index import Index, empty_index, enter, leave, meeting
from .._runner import Found, Indices, Reduction, Rows, by_lowest, run, survivors

#: Above this share of length along no axis, the building is not one for this method.
SLANTED = 0.25
#: Angles closer than this, radians, are equal.
SAME = 1e-9


@checked
def fuzzy_set(
    map: Segments,
    *,
    across: Metres = 0.20,
    along: Metres = 0.30,
    error: Metres = 0.02,
    angle: Annotated[Radians, at_most(np.pi / 4)] = np.pi / 18,
    axes: Annotated[float, Quantity("radians")] | None = None,
) -> Reduction:
    """Merge rectangles along the axes of a building (A 2.7.4; Lopez-Sanchez et al. 1998).

    Each segment within `angle` of an axis is laid on it, and carries the error with which it may
    lie beside its line. The most precise one that has a partner of its orientation, nearer than
    `across` and `along`, merges with the nearest: the precise one counts for more, and the error
    of both still covers both. This is repeated until none has a partner. Segments along no axis
    stay as they are.

    A gives neither thresholds nor how two segments merge: these are ours. A chain of merges can
    drift by more than `across`.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        With points, the error of a segment is the largest distance of a point from it; without,
        it follows from its length and its angle with the axis.
    across, along
        Rectangles farther apart across, or along, their axis never merge. 0.20 m across is wider
        than the errors of cheap robots; 0.30 m along is narrower than a door.
    error
        Smallest error of a segment.
    angle
        Segments that differ more from both axes in direction are left as they are.
    axes
        Direction of an axis of the building; None finds it from all segments, weighted by length.
        A takes that of the map.

    Returns
    -------
    Reduction
        By the first segment of each output. `doubt` says so where much of the map is along no
        axis.

    References
    ----------
    Lopez-Sanchez, Esteva, Lopez de Mantaras, Sierra, "Map generation by cooperative low-cost robots
    in structured unknown environments", Autonomous Robots 5, 1998.

    Examples
    --------
    >>> wall = [[(0, 0), (4, 0)], [(3, 0.06), (5, 0.06)], [(0, 1), (0, 3)]]
    >>> found = fuzzy_set(wall)
    >>> found.parents, found.segments[0].round(6)
    (array([0, 0, 1]), array([[0.  , 0.03],
           [5.  , 0.03]]))
    """
    doubt, limits = "", np.array([across, along])

    def reduce(rows: Rows) -> Found:
        nonlocal doubt
        s, n, sizes = rows.segments, len(rows.segments), length(rows.segments)
        turn, axis = 4 * angle_of(s), axes
        if axis is None:
            sums = (sizes * [np.sin(turn), np.cos(turn)]).sum(axis=1)
            axis = np.arctan2(*np.where(abs(sums) > SAME * sizes.sum(), sums, 0.0)) / 4
        off = np.abs((angle_of(s) - axis + np.pi / 2) % np.pi - np.pi / 2)
        upright = off > np.pi / 4 + SAME
        off = np.where(upright, np.pi / 2 - off, off)
        laid = off <= angle + SAME
        share = float(sizes[~laid].sum() / sizes.sum()) if n else 0.0
        if share > SLANTED:
            doubt = f"not orthogonal: {share:.0%} of the length is along no axis"
        kept, slanted = np.flatnonzero(laid), np.flatnonzero(~laid)
        errors = error + sizes[kept] / 2 * np.sin(off[kept])
        state = _laid(map, rows, kept, upright[kept], axis, errors, error, limits)
        last = _merge_all(state, len(kept), limits)
        alive, ends = survivors(state.into[:last])
        live = np.flatnonzero(alive)
        across, low, high, _ = state.data[live].T
        flat = np.stack([np.stack([low, across], -1), np.stack([high, across], -1)], 1)
        standing = state.upright[live][:, None, None] == 1
        out = _turned(np.where(standing, flat[..., ::-1], flat), axis)
        into = np.empty(n, np.int64)  # outputs: those of the rectangles, then each slanted one
        into[kept], into[slanted] = ends[: len(kept)], len(out) + np.arange(len(slanted))
        out = np.concatenate([out, s[slanted]])
        order, into = by_lowest(into, rows.row, len(out))
        return out[order], into

    return replace(run("fuzzy_set", map, reduce), doubt=doubt)


class State(NamedTuple):
    """Rectangles, first the n inputs, then those that merges make."""

    data: Array  # (2 n, 4) across, low, high, error, metres
    key: Indices  # (2 n, 2) error in nanometres and lowest input: the smaller is the more precise
    upright: Indices
    places: Index  # of the live ones, in the frame of the axes
    queued: Indices  # 1 for those that wait in the heap
    near: Indices  # room for those that are near
    into: Indices  # what took each in; its own index until then
    box: Array  # (2, 2) room for one of them


def _turned(points: Array, angle: float) -> Array:
    """Points `(..., 2)` turned about the origin."""
    c, s, x, y = np.cos(angle), np.sin(angle), points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], -1)


def _laid(
    map: Segments,
    rows: Rows,
    kept: Indices,
    upright: NDArray[np.bool_],
    axis: float,
    errors: Array,
    least: float,
    limits: Array,
) -> State:
    """Step 2: the kept rows laid on their axis, with their errors, or those that points tell."""
    n, up, which = len(kept), upright.astype(np.int64), np.arange(len(kept))
    s, data = _turned(rows.segments[kept], -axis), np.empty((2 * n, 4))
    key = np.zeros((2 * n, 2), np.int64)
    data[:n, 0] = (s[which, 0, 1 - up] + s[which, 1, 1 - up]) / 2
    data[:n, 1], data[:n, 2] = np.sort(s[which, :, up], axis=1).T
    data[:n, 3] = errors
    if isinstance(map, SegmentMap) and map.points is not None and map.first is not None and n:
        points, first = take_points(map.points, map.first, rows.row[kept])
        owner, turned = np.repeat(which, np.diff(first)), _turned(points, -axis)
        beside = np.abs(turned[np.arange(len(turned)), 1 - up[owner]] - data[owner, 0])
        data[:n, 3] = np.maximum(np.maximum.reduceat(beside, first[:-1]), least)
    key[:n, 0], key[:n, 1] = np.floor(data[:n, 3] * 1e9 + 0.5), rows.row[kept]
    mean = float((data[:n, 2] - data[:n, 1]).mean()) if n else 0.0
    places = empty_index(2 * n, max(1.0, 4 * limits.max(), 2 * mean))
    queued, near = np.zeros(2 * n, np.int64), np.empty(2 * n + 1, np.int64)
    flags, box = np.concatenate([up, up]), np.empty((2, 2))
    return State(data, key, flags, places, queued, near, np.arange(2 * n), box)


@compiled
def _boxed(state: State, r: int) -> Array:
    """The two end points of a rectangle, in the frame of the axes."""
    up, d = state.upright[r], state.data
    state.box[0, up], state.box[1, up] = d[r, 1], d[r, 2]
    state.box[0, 1 - up], state.box[1, 1 - up] = d[r, 0], d[r, 0]
    return state.box


@compiled
def _look(state: State, f: int, limits: Array) -> int:
    """Write those near rectangle f, without itself, to the front of `near`; how many there are."""
    d, near, count = state.data, state.near, 0
    for k in range(meeting(state.places, _boxed(state, f), max(limits[0], limits[1]), near)):
        g = near[k]
        dx, dy = abs(d[f, 0] - d[g, 0]), max(d[f, 1], d[g, 1]) - min(d[f, 2], d[g, 2])
        one_way = state.upright[g] == state.upright[f]
        if g != f and one_way and dx < limits[0] and dy < limits[1]:
            near[count] = g
            count += 1
    return count


@compiled
def _merge_all(state: State, n: int, limits: Array) -> int:
    """Steps 4 and 5 for the first n rectangles; how many there ever were.

    One without a partner waits until a merge brings a rectangle near to it: nothing else can.
    """
    d, key, near, queued, last = state.data, state.key, state.near, state.queued, n
    heap = [(0, 0, 0)]  # the compiler learns what an entry is: its key, and which
    heap.pop()
    for r in range(n):
        enter(state.places, r, _boxed(state, r), 0.0)
        heapq.heappush(heap, (key[r, 0], key[r, 1], r))
        queued[r] = 1
    while len(heap):
        f = heapq.heappop(heap)[2]
        queued[f] = 0
        if state.into[f] != f:
            continue
        g, least = -1, 0  # the nearest, to a nanometre; ties: the most precise
        for k in range(_look(state, f, limits)):
            h = near[k]
            dx, dy = abs(d[f, 0] - d[h, 0]), max(d[f, 1], d[h, 1]) - min(d[f, 2], d[h, 2])
            apart = int(np.floor((dx + max(0.0, dy)) / 2 * 1e9 + 0.5))
            tie = g >= 0 and apart == least
            first = tie and (key[h, 0], key[h, 1]) < (key[g, 0], key[g, 1])
            if g < 0 or apart < least or first:
                g, least = h, apart
        if g < 0:
            continue
        r, last = last, last + 1
        across = (d[f, 0] / d[f, 3] + d[g, 0] / d[g, 3]) / (1 / d[f, 3] + 1 / d[g, 3])
        d[r, 0], d[r, 1], d[r, 2] = across, min(d[f, 1], d[g, 1]), max(d[f, 2], d[g, 2])
        d[r, 3] = max(min(d[f, 3], d[g, 3]), abs(across - d[f, 0]), abs(across - d[g, 0]))
        key[r, 0], key[r, 1] = int(np.floor(d[r, 3] * 1e9 + 0.5)), min(key[f, 1], key[g, 1])
        state.upright[r] = state.upright[f]
        state.into[f] = state.into[g] = r
        leave(state.places, f)
        leave(state.places, g)
        enter(state.places, r, _boxed(state, r), 0.0)
        count = _look(state, r, limits)
        near[count] = r
        for k in range(count + 1):
            if queued[near[k]] == 0:
                queued[near[k]] = 1
                heapq.heappush(heap, (key[near[k], 0], key[near[k], 1], near[k]))
    return last
