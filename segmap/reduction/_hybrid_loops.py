"""The loops of Hybrid: plain Python, compiled when called.

A candidate passes within `distance` of an end point of the new segment. So map segments are
entered, sample by sample, into a grid of cells of 1.5 distances, a hash table of linked lists; the
nine cells around an end point hold all candidates. A segment that has moved is entered again: what
is out of date only makes more candidates, and each is measured.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array
from ..kernels import slot_of

Indices = NDArray[np.int64]

#: Distances closer than this, in metres, are equal: rounding must not choose between two walls.
SAME = 1e-9
#: Side of a cell of the grid, in distances.
CELL = 1.5


class State(NamedTuple):
    """The map of Hybrid: segments, their lines in Hough space, and the grid.

    `lines` holds rho, theta and count; `used` how many segments are in the map, how many entries
    in the grid; `entry` is (segment, next entry), `head` the first entry of a slot.
    """

    s: Array
    lines: Array
    used: Indices
    head: Indices
    entry: Indices
    seen: Indices


def start(count: int) -> State:
    """An empty map with room for `count` segments, `(n, 2, 2)`, metres."""
    slots = 1 << int(np.ceil(np.log2(max(4 * count, 2))))
    return State(
        np.empty((count, 2, 2)),
        np.empty((count, 3)),
        np.zeros(2, np.int64),
        np.full(slots, -1, np.int64),
        np.empty((16, 2), np.int64),
        np.full(count, -1, np.int64),
    )


def with_room(state: State, more: int) -> State:
    """The same state, with room in its grid for twice what it holds and so many more entries.

    Its entries are a (k, 2) int array; all else stays as it is.
    """
    used = state.used[1]
    entry = np.empty((2 * (used + more), 2), np.int64)
    entry[:used] = state.entry[:used]
    return state._replace(entry=entry, seen=np.full_like(state.seen, -1))


@compiled
def enter(state: State, b: int, distance: float) -> None:
    """Enter map segment b, a (2, 2) array, metres, into every cell of a sample of it.

    Where the cell does not hold it yet; cells are 1.5 distances, metres, wide.
    """
    s, head, entry, cell = state.s[b], state.head, state.entry, CELL * distance
    dx, dy = s[1, 0] - s[0, 0], s[1, 1] - s[0, 1]
    steps = int(np.ceil(2 * np.hypot(dx, dy) / cell)) + 1
    for k in range(steps + 1):
        x, y = s[0, 0] + k / steps * dx, s[0, 1] + k / steps * dy
        slot = slot_of(int(np.floor(x / cell)), int(np.floor(y / cell)), len(head))
        e = head[slot]
        while e >= 0 and entry[e, 0] != b:
            e = entry[e, 1]
        if e < 0:
            e = state.used[1]
            entry[e, 0], entry[e, 1] = b, head[slot]
            head[slot] = e
            state.used[1] += 1


@compiled
def nearness(a: Array, b: Array) -> float:
    """A 4.2: smallest of four end-point distances, and of those of ends of a beside b; metres.

    Of segments, (2, 2) array each.
    """
    least = np.inf
    dx, dy = b[1, 0] - b[0, 0], b[1, 1] - b[0, 1]
    length = np.hypot(dx, dy)
    for k in range(2):
        x, y = a[k, 0] - b[0, 0], a[k, 1] - b[0, 1]
        least = min(least, np.hypot(x, y), np.hypot(x - dx, y - dy))
        along = x * dx + y * dy
        if 0.0 <= along <= length * length:
            least = min(least, abs(x * dy - y * dx) / length)
    return least


@compiled
def hough(a: Array) -> tuple[float, float]:
    """Distance rho, metres, and direction theta of the normal of a (2, 2) array, in `[0, pi)`."""
    theta = (np.arctan2(a[1, 1] - a[0, 1], a[1, 0] - a[0, 0]) + np.pi / 2) % np.pi
    theta = 0.0 if theta == np.pi else theta
    x, y = (a[0, 0] + a[1, 0]) / 2, (a[0, 1] + a[1, 1]) / 2
    return x * np.cos(theta) + y * np.sin(theta), theta


@compiled
def _nearest_match(
    state: State, a: Array, rho: float, theta: float, distance: float, angle: float, mark: int
) -> int:
    """The nearest map segment whose line agrees with that of a; ties: lowest index; -1 for none."""
    cell, best, least = CELL * distance, -1, distance
    for k in range(2):
        column, row = int(np.floor(a[k, 0] / cell)), int(np.floor(a[k, 1] / cell))
        for i in range(column - 1, column + 2):
            for j in range(row - 1, row + 2):
                e = state.head[slot_of(i, j, len(state.head))]
                while e >= 0:
                    b, e = state.entry[e]
                    if state.seen[b] == mark:
                        continue
                    state.seen[b] = mark
                    turns = np.round((state.lines[b, 1] - theta) / np.pi)
                    sign = 1.0 if turns % 2 == 0 else -1.0
                    if (
                        abs(state.lines[b, 1] - theta - turns * np.pi) < angle
                        and abs(state.lines[b, 0] - sign * rho) < distance
                    ):
                        near = nearness(a, state.s[b])
                        tie = abs(near - least) <= SAME and best >= 0
                        if b < best if tie else near < least:
                            best, least = b, near
    return best


@compiled
def absorb(state: State, b: int, a: Array, rho: float, theta: float) -> None:
    """A 4.2: count-weighted means of both lines; the extreme projections on it, metres, remain.

    Map segment b takes in a, a (2, 2) array, whose line is rho (metres) and theta (radians).
    """
    s, line = state.s[b], state.lines[b]
    turns = np.round((line[1] - theta) / np.pi)
    sign = 1.0 if turns % 2 == 0 else -1.0
    line[0] = (line[2] * line[0] + sign * rho) / (line[2] + 1)
    line[1] = (line[2] * line[1] + theta + turns * np.pi) / (line[2] + 1)
    line[2] += 1
    nx, ny = np.cos(line[1]), np.sin(line[1])
    low, high = np.inf, -np.inf
    for k in range(2):
        u, v = s[k, 1] * nx - s[k, 0] * ny, a[k, 1] * nx - a[k, 0] * ny
        low, high = min(low, u, v), max(high, u, v)
    s[0, 0], s[0, 1] = line[0] * nx - low * ny, line[0] * ny + low * nx
    s[1, 0], s[1, 1] = line[0] * nx - high * ny, line[0] * ny + high * nx


@compiled
def most_entries(a: Array, b: Array, distance: float) -> int:
    """How many entries the span of two segments can take on any line, (2, 2) array each, metres."""
    dx = max(a[0, 0], a[1, 0], b[0, 0], b[1, 0]) - min(a[0, 0], a[1, 0], b[0, 0], b[1, 0])
    dy = max(a[0, 1], a[1, 1], b[0, 1], b[1, 1]) - min(a[0, 1], a[1, 1], b[0, 1], b[1, 1])
    return int(2 * np.hypot(dx, dy) / (CELL * distance)) + 4


@compiled
def add(
    state: State,
    segments: Array,
    first: int,
    distance: float,
    angle: float,
    min_length: float,
    parents: Indices,
) -> int:
    """Match segments `(m, 2, 2)` with the map, one by one; those without may join.

    Writes where each went, -1 where dropped, into `parents[first:]`. Metres and radians. Returns
    how many it took: not all where the grid has no room for the next.
    """
    for i in range(len(segments)):
        a = segments[i]
        rho, theta = hough(a)
        b = _nearest_match(state, a, rho, theta, distance, angle, first + i)
        near = state.s[b] if b >= 0 else a
        if state.used[1] + most_entries(a, near, distance) > len(state.entry):
            return i
        if b >= 0:
            absorb(state, b, a, rho, theta)
        elif np.hypot(a[1, 0] - a[0, 0], a[1, 1] - a[0, 1]) >= min_length:
            b = state.used[0]
            state.s[b] = a
            state.lines[b, 0], state.lines[b, 1], state.lines[b, 2] = rho, theta, 1.0
            state.used[0] += 1
        parents[first + i] = b
        if b >= 0:
            enter(state, b, distance)
    return len(segments)


def add_scan(
    state: State,
    segments: Array,
    first: int,
    distance: float,
    angle: float,
    min_length: float,
    parents: Indices,
) -> State:
    """The state after `add` of all segments of a scan; the same arguments.

    Segments `(m, 2, 2)` and distances in metres, the angle in radians; parents `(n,)`.
    """
    done = add(state, segments, first, distance, angle, min_length, parents)
    while done < len(segments):
        state, rest = with_room(state, 1024), segments[done:]
        done += add(state, rest, first + done, distance, angle, min_length, parents)
    return state


@compiled
def entries_of(segments: Array, distance: float) -> int:
    """Most entries that `(m, 2, 2)` segments can take; metres."""
    total = 0
    for s in segments:
        total += most_entries(s, s, distance)
    return total


@compiled
def put_all(state: State, segments: Array, counts: Array, distance: float) -> None:
    """Put `(m, 2, 2)` segments, metres, that stand for `(m,)` counts into an empty map."""
    for b in range(len(segments)):
        state.s[b] = segments[b]
        state.lines[b, 0], state.lines[b, 1] = hough(segments[b])
        state.lines[b, 2] = counts[b]
        enter(state, b, distance)
    state.used[0] = len(segments)


def replace_map(state: State, segments: Array, counts: Array, distance: float) -> State:
    """The state of another map: `(m, 2, 2)` segments, metres, that stand for `(m,)` counts."""
    state.used[:] = 0
    state.head[:] = -1
    if (needed := entries_of(segments, distance)) > len(state.entry):
        state = with_room(state, needed)
    put_all(state, segments, counts, distance)
    return state
