"""Hybrid (A 4.2, 5.4): near in the map and near in Hough space, scan by scan."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .. import arrays
from ..arrays import Array, Segments
from ..compiled import compiled
from ..kernels import put_in, slot_of, take_out
from ._basic import check_match
from ._hough import line_of
from ._runner import Indices, Reduction, Rows, Steps, run_online

#: Distances closer than this, in metres, are equal: rounding must not choose between two walls.
SAME = 1e-9


def hybrid(
    map: Segments,
    *,
    distance: float = 0.20,
    angle: float = np.pi / 18,
    min_length: float | None = None,
) -> Reduction:
    """Let each new segment go into the nearest one of the map whose line agrees (A 4.2).

    A line is the distance rho of the origin from it and the angle theta of its normal. A segment of
    the map is near when an end point of the new one is closer than `distance` to one of its end
    points, or to the segment beside it. The nearest whose rho and theta differ by less than
    `distance` and `angle` takes the new one in: its rho and theta become means weighted by the
    number of segments that it stands for. A new segment without such a match joins the map, unless
    it is shorter than `min_length`.

    Rho depends on the origin: moving the map can change the result, turning it about the origin
    cannot.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order.
    distance : float, metres
        0.20 m is A's middle value: wider than noise, narrower than a door.
    angle : float, radians
        Above 0, at most pi/2; 10 degrees is A's smallest.
    min_length : float, metres, or None
        None takes `distance`: the filter that A builds in.

    Returns
    -------
    Reduction
        In the order in which segments joined; parents -1 for those that were too short; with
        seconds and segments in the map for each scan.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (3, 0)], [(1, 0.02), (2, 0.02)], [(9, 0), (9.1, 0)]])
    >>> found = hybrid(wall)
    >>> found, found.parents
    (Reduction(hybrid: 3 -> 1 segments), array([ 0,  0, -1]))
    """
    check_match(map, distance, angle)
    least = least_length(distance, min_length)
    return run_online("hybrid", map, lambda rows: _steps(rows, distance, angle, least))


def least_length(distance: float, min_length: float | None) -> float:
    """Length, metres, below which a segment without a match is dropped; ValueError for none."""
    if min_length is None:
        return distance
    return arrays.number(min_length, "min_length", least=0, unit="metres")


def _steps(rows: Rows, distance: float, angle: float, min_length: float) -> Steps:
    state = empty_map(len(rows.segments))
    parents = np.full(len(rows.segments), -1, np.int64)
    for first, stop in rows.scans():
        add(state, rows.segments, first, stop, distance, angle, min_length, parents)
        yield int(state.used[0])
    return state.s[: state.used[0]].copy(), parents


class State(NamedTuple):
    """The map of Hybrid: walls, their lines, and an index of the walls by their middles.

    A wall of length l has its middle in a cell of the first of the sizes 4, 8, 16, ... distances
    that holds l and two distances more. So a wall within the distance of a point has its middle in
    one of nine cells of its size. The walls of a cell make a list, found through a hash table:
    `head[slot]`, then `after` and `before` of each wall. For maps of 1 000, 3 604, 10 000 and
    100 000 segments, each wall seen three times, this takes 1.6, 5.6, 14 and 131 ms; a look at all
    walls takes 1.7, 9.7, 50 and 3710 ms, cells of samples all along each wall 8.1 ms at 3 604.

    Parameters
    ----------
    s : (n, 2, 2) array, metres
    lines : (n, 3) array
        Rho, metres, theta, radians, and how many segments each wall stands for.
    used : (1,) int array
        How many walls there are.
    head : (slots,) int array
        First wall of each slot, -1 for none.
    after, before : (n,) int array
        Next wall of the list; the one before, or -1 - slot for the first.
    level : (n,) int array
        Size of the cell of each wall: 0 is 4 distances.
    levels : (64,) int array
        How many walls have each size.
    """

    s: Array
    lines: Array
    used: Indices
    head: Indices
    after: Indices
    before: Indices
    level: Indices
    levels: Indices


def empty_map(count: int) -> State:
    """A map with room for so many segments."""
    head = np.full(1 << int(np.ceil(np.log2(max(4 * count, 2)))), -1)
    after, before, level = np.full((3, count), -1)
    s, lines = np.empty((count, 2, 2)), np.empty((count, 3))
    return State(
        s, lines, np.zeros(1, np.int64), head, after, before, level, np.zeros(64, np.int64)
    )


@compiled
def _slot(column: int, row: int, level: int, slots: int) -> int:
    """Slot of a cell of a level: the levels share the hash table."""
    return slot_of(column + 7919 * level, row, slots)


@compiled
def _enter(state: State, b: int, distance: float) -> None:
    """Put wall b into the list of its cell; metres."""
    s, head = state.s, state.head
    length = np.hypot(s[b, 1, 0] - s[b, 0, 0], s[b, 1, 1] - s[b, 0, 1])
    level, cell = 0, 4 * distance
    while cell < length + 2 * distance:
        level, cell = level + 1, 2 * cell
    x, y = (s[b, 0, 0] + s[b, 1, 0]) / 2, (s[b, 0, 1] + s[b, 1, 1]) / 2
    slot = _slot(int(np.floor(x / cell)), int(np.floor(y / cell)), level, len(head))
    put_in(head, state.after, state.before, slot, b)
    state.level[b] = level
    state.levels[level] += 1


@compiled
def _leave(state: State, b: int) -> None:
    """Take wall b out of its list."""
    take_out(state.head, state.after, state.before, b)
    state.levels[state.level[b]] -= 1


@compiled
def _nearness(new: Array, i: int, walls: Array, b: int) -> float:
    """A 4.2: smallest of four end-point distances, and of those of ends of i beside b; metres."""
    least = np.inf
    dx, dy = walls[b, 1, 0] - walls[b, 0, 0], walls[b, 1, 1] - walls[b, 0, 1]
    length = np.hypot(dx, dy)
    for k in range(2):
        x, y = new[i, k, 0] - walls[b, 0, 0], new[i, k, 1] - walls[b, 0, 1]
        least = min(least, np.hypot(x, y), np.hypot(x - dx, y - dy))
        along = x * dx + y * dy
        if 0.0 <= along <= length * length:
            least = min(least, abs(x * dy - y * dx) / length)
    return least


@compiled
def _nearest_match(
    state: State, new: Array, i: int, rho: float, theta: float, distance: float, angle: float
) -> int:
    """The nearest wall whose line agrees with that of i; ties: lowest index; -1 for none."""
    lines, head, after, best, least = state.lines, state.head, state.after, -1, distance
    cell = 2 * distance
    for level in range(len(state.levels)):
        cell *= 2
        if state.levels[level] == 0:
            continue
        last_column, last_row = 0, 0
        for k in range(2):
            column, row = int(np.floor(new[i, k, 0] / cell)), int(np.floor(new[i, k, 1] / cell))
            for c in range(column - 1, column + 2):
                for r in range(row - 1, row + 2):
                    if k > 0 and abs(c - last_column) <= 1 and abs(r - last_row) <= 1:
                        continue
                    b = head[_slot(c, r, level, len(head))]
                    while b >= 0:
                        if abs(abs(lines[b, 0]) - abs(rho)) < distance:
                            turns = round((lines[b, 1] - theta) / np.pi)
                            sign = 1.0 if turns % 2 == 0 else -1.0
                            if (
                                abs(lines[b, 0] - sign * rho) < distance
                                and abs(lines[b, 1] - theta - turns * np.pi) < angle
                            ):
                                near = _nearness(new, i, state.s, b)
                                tie = abs(near - least) <= SAME and best >= 0
                                if b < best if tie else near < least:
                                    best, least = b, near
                        b = after[b]
            last_column, last_row = column, row
    return best


@compiled
def _absorb(
    state: State, b: int, new: Array, i: int, rho: float, theta: float, distance: float
) -> None:
    """A 4.2: count-weighted means of both lines; the extreme projections on it, metres, remain.

    Wall b takes in segment i, whose line is rho, metres, and theta, radians.
    """
    s, lines, count = state.s, state.lines, state.lines[b, 2]
    turns = round((lines[b, 1] - theta) / np.pi)
    sign = 1.0 if turns % 2 == 0 else -1.0
    rho = (count * lines[b, 0] + sign * rho) / (count + 1)
    theta = (count * lines[b, 1] + theta + turns * np.pi) / (count + 1)
    lines[b, 0], lines[b, 1], lines[b, 2] = rho, theta, count + 1
    nx, ny = np.cos(theta), np.sin(theta)
    low, high = np.inf, -np.inf
    for k in range(2):
        u, v = s[b, k, 1] * nx - s[b, k, 0] * ny, new[i, k, 1] * nx - new[i, k, 0] * ny
        low, high = min(low, u, v), max(high, u, v)
    s[b, 0, 0], s[b, 0, 1] = rho * nx - low * ny, rho * ny + low * nx
    s[b, 1, 0], s[b, 1, 1] = rho * nx - high * ny, rho * ny + high * nx
    _leave(state, b)
    _enter(state, b, distance)


@compiled
def _join(state: State, new: Array, i: int, count: float, distance: float) -> None:
    """Segment i, which stands for so many, becomes the next wall; metres."""
    b = state.used[0]
    for k in range(2):
        state.s[b, k, 0], state.s[b, k, 1] = new[i, k, 0], new[i, k, 1]
    state.lines[b, 0], state.lines[b, 1] = line_of(new, i)
    state.lines[b, 2] = count
    state.used[0] += 1
    _enter(state, b, distance)


@compiled
def add(
    state: State,
    new: Array,
    first: int,
    stop: int,
    distance: float,
    angle: float,
    min_length: float,
    parents: Indices,
) -> None:
    """Match the segments `first` to `stop` of `(n, 2, 2)` with the map; those without may join.

    Writes where each went, -1 where dropped, into `parents`, `(n,)`; metres and radians.
    """
    for i in range(first, stop):
        rho, theta = line_of(new, i)
        b = _nearest_match(state, new, i, rho, theta, distance, angle)
        parents[i] = b
        if b >= 0:
            _absorb(state, b, new, i, rho, theta, distance)
        elif np.hypot(new[i, 1, 0] - new[i, 0, 0], new[i, 1, 1] - new[i, 0, 1]) >= min_length:
            parents[i] = state.used[0]
            _join(state, new, i, 1.0, distance)


@compiled
def replace_map(state: State, segments: Array, counts: Array, distance: float) -> None:
    """Put `(m, 2, 2)` segments, metres, that stand for `(m,)` counts in the place of the map."""
    for slot in range(len(state.head)):
        state.head[slot] = -1
    for level in range(len(state.levels)):
        state.levels[level] = 0
    state.used[0] = 0
    for i in range(len(segments)):
        _join(state, segments, i, counts[i], distance)
