"""The loops of Fusion: plain Python, compiled when called. Lengths and coordinates are in metres.

A line is a point of it and its unit direction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import compiled
from ..kernels import slot_of
from ._runner import Indices

Line = tuple[float, float, float, float]
Flags = NDArray[np.bool_]

#: Lengths, shifts and gaps closer than this, in metres, are equal: rounding must not choose.
SAME = 1e-9


class Grid(NamedTuple):
    """Segments by the cells that they pass through: `held[first[slot] : stop[slot]]`.

    The neighbours of a step of one cell along a line lie in the nine cells around it. The grid
    stays, although a plain look at all live segments is as fast where there are few. Measured, in
    milliseconds, against the same sweep without a grid and against a grid that compiled loops
    built, for maps of which each wall was seen 20 and 3 times:

    | n       | plain      | older grid | this one   |
    |---------|------------|------------|------------|
    | 1 000   | 1.2, 0.9   | 4.2, 2.3   | 2.2, 1.0   |
    | 3 604   | 6.3, 9.7   | 18.8, 9.7  | 7.0, 4.2   |
    | 10 000  | 48, 69     | 37, 35     | 17, 17     |
    | 100 000 | 2350, 8390 | 340, 550   | 310, 230   |
    """

    first: Indices
    stop: Indices
    held: Indices
    cell: float


class Room(NamedTuple):
    """Room to work in, for the candidates of one strip.

    Parameters
    ----------
    near : (n,) int array
        The segments that may be in the strip.
    measured : (n + 1, 4) array, metres
        Where each begins and ends along the line, and its lower and upper offset from it.
    sizes : (n,) array, metres
        Their lengths.
    order : (n,) int array
        Candidates by where they begin.
    tried, chosen : (n,) bool array
        Members of the chain of the shift that is tried, and of the best one so far.
    shifts : (2 n + 1, 2) array, metres
        Shifts that were tried, and the length of the chain of each.
    seen : (n,) int array
        For each segment of the map, the last longest one that met it.
    """

    near: Indices
    measured: Array
    sizes: Array
    order: Indices
    tried: Flags
    chosen: Flags
    shifts: Array
    seen: Indices


@compiled
def _measure(s: Array, j: int, line: Line, wide: float, out: Array, k: int) -> bool:
    """Write low and high of segment j along a line and across it into row k, metres.

    False where an end lies farther than `wide` from the line, or one from the other across it.
    """
    x, y, dx, dy = line
    v0 = (s[j, 0, 1] - y) * dx - (s[j, 0, 0] - x) * dy
    v1 = (s[j, 1, 1] - y) * dx - (s[j, 1, 0] - x) * dy
    if abs(v0) > wide or abs(v1) > wide or abs(v1 - v0) > wide:
        return False
    u0 = (s[j, 0, 0] - x) * dx + (s[j, 0, 1] - y) * dy
    u1 = (s[j, 1, 0] - x) * dx + (s[j, 1, 1] - y) * dy
    out[k, 0], out[k, 1] = min(u0, u1), max(u0, u1)
    out[k, 2], out[k, 3] = min(v0, v1), max(v0, v1)
    return True


@compiled
def _reach_on(measured: Array, count: int, way: int, reach: float) -> float:
    """How far to one side, metres, a chain of the measured leads, whatever its shift."""
    longer = True
    while longer:
        longer = False
        for k in range(count):
            near = measured[k, 0] if way == 1 else -measured[k, 1]
            far = measured[k, 1] if way == 1 else -measured[k, 0]
            if far > reach and near <= reach + SAME:
                reach, longer = far, True
    return reach


@compiled
def _gather(
    s: Array, line: Line, wide: float, grid: Grid, parents: Indices, longest: int, room: Room
) -> int:
    """Measure all live segments that may be in a chain through the longest; how many there are.

    The longest comes first. Walks both ways from its middle for as long as the collected
    projections reach on. Dead segments leave the cells for good.
    """
    cell, first, stop, held = grid.cell, grid.first, grid.stop, grid.held
    near, measured, seen = room.near, room.measured, room.seen
    near[0], seen[longest], count = longest, longest, 1
    _measure(s, longest, line, wide, measured, 0)
    for way in (1, -1):
        reach, k, last_column, last_row = measured[0, 1], 0, 0, 0
        while k * cell <= reach + cell:
            column = int(np.floor((line[0] + way * k * cell * line[2]) / cell))
            row = int(np.floor((line[1] + way * k * cell * line[3]) / cell))
            for a in range(column - 1, column + 2):
                for b in range(row - 1, row + 2):
                    if k > 0 and abs(a - last_column) <= 1 and abs(b - last_row) <= 1:
                        continue
                    slot = slot_of(a, b, len(first))
                    e = first[slot]
                    while e < stop[slot]:
                        j = held[e]
                        if parents[j] >= 0:
                            stop[slot] -= 1
                            held[e] = held[stop[slot]]
                            continue
                        e += 1
                        if seen[j] != longest:
                            seen[j], near[count] = longest, j
                            count += _measure(s, j, line, wide, measured, count)
            last_column, last_row = column, row
            reach = _reach_on(measured, count, way, reach)
            k += 1
    return count


@compiled
def _sort_by_low(order: Indices, measured: Array) -> None:
    """Order the measured by where they begin: a heap sort."""
    for k in range(len(order)):
        order[k] = k
    start, stop = len(order) // 2, len(order)
    while stop > 1:
        if start > 0:
            start -= 1
        else:
            stop -= 1
            order[0], order[stop] = order[stop], order[0]
        root = start
        while 2 * root + 1 < stop:
            child = 2 * root + 1
            if child + 1 < stop and measured[order[child + 1], 0] > measured[order[child], 0]:
                child += 1
            if measured[order[root], 0] >= measured[order[child], 0]:
                break
            order[root], order[child] = order[child], order[root]
            root = child


@compiled
def _chain(
    measured: Array, sizes: Array, order: Indices, shift: float, half: float
) -> tuple[float, int, int]:
    """Length of the chain through candidate 0, metres, and its range in `order`.

    Only those of the range are its members that the strip of that shift holds (A 4.4.1).
    """
    total, start, reach, holds = 0.0, 0, -np.inf, False
    for k in range(len(order)):
        i = order[k]
        if measured[i, 3] - half > shift + SAME or shift - SAME > measured[i, 2] + half:
            continue
        if measured[i, 0] > reach + SAME:
            if holds:
                return total, start, k
            total, start = 0.0, k
        holds = holds or i == 0
        reach = max(reach, measured[i, 1])
        total += sizes[i]
    return total, start, len(order)


@compiled
def _comes_first(tried: Flags, chosen: Flags, near: Indices) -> bool:
    """Whether the members tried come before the chosen, as words of sorted indices do."""
    apart, of_tried, more = -1, False, False
    for k in range(len(tried)):
        if tried[k] != chosen[k] and (apart < 0 or near[k] < apart):
            apart, of_tried = near[k], tried[k]
    for k in range(len(tried)):
        more |= near[k] > apart and (chosen[k] if of_tried else tried[k])
    return apart >= 0 and more == of_tried


@compiled
def _best_strip(room: Room, order: Indices, count: int, half: float) -> tuple[float, float, float]:
    """Shift, low and high of the longest chain, metres; flags its members as chosen.

    Only where a segment enters or leaves the strip can the chain change: all these shifts are
    tried, and 0. Of equal chains the least shift wins, then the first indices.
    """
    measured, sizes, shifts = room.measured, room.sizes, room.shifts
    tried, chosen, near = room.tried[:count], room.chosen[:count], room.near[:count]
    most, least, tries = 0.0, np.inf, 0
    for k in range(-1, 2 * len(order)):
        i = order[max(k, 0) // 2]
        edge = measured[i, 2] + half if k % 2 else measured[i, 3] - half
        shift = edge if k >= 0 else 0.0
        if abs(shift) <= half:
            total, _, _ = _chain(measured, sizes, order, shift, half)
            shifts[tries, 0], shifts[tries, 1] = shift, total
            most = max(most, total)
            tries += 1
    for k in range(tries):
        if shifts[k, 1] >= most - SAME:
            least = min(least, abs(shifts[k, 0]))
    best, low, high, found = 0.0, 0.0, 0.0, False
    for k in range(tries):
        shift = shifts[k, 0]
        if shifts[k, 1] < most - SAME or abs(shift) > least + SAME:
            continue
        _, start, stop = _chain(measured, sizes, order, shift, half)
        begin, end = np.inf, -np.inf
        for j in range(count):
            tried[j] = False
        for j in range(start, stop):
            i = order[j]
            if measured[i, 3] - half <= shift + SAME and shift - SAME <= measured[i, 2] + half:
                tried[i] = True
                begin, end = min(begin, measured[i, 0]), max(end, measured[i, 1])
        if not found or _comes_first(tried, chosen, near):
            best, low, high, found = shift, begin, end, True
            for j in range(count):
                chosen[j] = tried[j]
    return best, low, high


@compiled
def fuse_all(
    s: Array,
    lengths: Array,
    falling: Indices,
    tolerance: float,
    grid: Grid,
    room: Room,
    out: Array,
    parents: Indices,
) -> int:
    """Fuse until the map is empty: writes outputs and parents; returns the number of outputs.

    Segments `(n, 2, 2)`, metres; `falling` sorts them by falling length; parents are -1 before.
    """
    count, head, wide = 0, 0, 2 * (tolerance + SAME)
    while True:
        # A 4.4.4, step 1: the longest segment, of equal ones the first
        while head < len(s) and parents[falling[head]] >= 0:
            head += 1
        if head == len(s):
            return count
        k, i = head, falling[head]
        while k < len(s) and lengths[falling[k]] >= lengths[falling[head]] - SAME:
            i = falling[k] if parents[falling[k]] < 0 and falling[k] < i else i
            k += 1
        dx, dy = (s[i, 1, 0] - s[i, 0, 0]) / lengths[i], (s[i, 1, 1] - s[i, 0, 1]) / lengths[i]
        x, y = (s[i, 0, 0] + s[i, 1, 0]) / 2, (s[i, 0, 1] + s[i, 1, 1]) / 2
        # steps 2 to 5: the strip, parallel to it, with the longest chain
        near = _gather(s, (x, y, dx, dy), wide, grid, parents, i, room)
        for k in range(near):
            room.sizes[k] = lengths[room.near[k]]
        _sort_by_low(room.order[:near], room.measured)
        _, start, stop = _chain(room.measured, room.sizes, room.order[:near], 0.0, np.inf)
        shift, low, high = _best_strip(room, room.order[start:stop], near, tolerance)
        # step 6: one segment for the chain
        x, y = x - shift * dy, y + shift * dx
        out[count, 0, 0], out[count, 0, 1] = x + low * dx, y + low * dy
        out[count, 1, 0], out[count, 1, 1] = x + high * dx, y + high * dy
        for k in range(near):
            if room.chosen[k]:
                parents[room.near[k]] = count
        count += 1
