"""The loops of Fusion: plain Python, compiled when called.

Neighbours are found in a grid of square cells, kept as a hash table: a segment lies in every cell
that a sample of it falls into, samples at most half a cell apart. Walking along the longest segment
one cell at a time, the nine cells around each step hold all that can lie in its strip.
"""

import heapq

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array
from ._cells import slot_of

Indices = NDArray[np.int64]
Grid = tuple[Indices, Indices, Indices, float]
Line = tuple[float, float, float, float]

#: Lengths, shifts and gaps closer than this, in metres, are equal.
SAME = 1e-9


@compiled
def place(s: Array, lengths: Array, cell: float, stop: Indices, held: Indices) -> None:
    """Count segments into `stop` (held empty), or store them downwards from there."""
    for i in range(len(s)):
        steps = int(np.ceil(2 * lengths[i] / cell))
        last = -1
        for k in range(steps + 1):
            x = s[i, 0, 0] + k / steps * (s[i, 1, 0] - s[i, 0, 0])
            y = s[i, 0, 1] + k / steps * (s[i, 1, 1] - s[i, 0, 1])
            slot = slot_of(int(np.floor(x / cell)), int(np.floor(y / cell)), len(stop))
            if slot == last:
                continue
            last = slot
            if len(held):
                stop[slot] -= 1
                held[stop[slot]] = i
            else:
                stop[slot] += 1


@compiled
def build_grid(s: Array, lengths: Array, cell: float) -> Grid:
    """Segments `(n, 2, 2)` by cell, metres: `held[first[slot]:stop[slot]]`."""
    slots = 1
    while slots < 4 * len(s):
        slots *= 2
    count = np.zeros(slots, np.int64)
    place(s, lengths, cell, count, np.empty(0, np.int64))
    stop = np.cumsum(count)
    held = np.empty(stop[-1], np.int64)
    first = stop.copy()
    place(s, lengths, cell, first, held)
    return first, stop, held, cell


@compiled
def take(
    slot: int, grid: Grid, alive: NDArray[np.bool_], seen: Indices, mark: int, out: Indices
) -> int:
    """Write the live segments of a cell that were not seen yet; forget the dead ones for good."""
    first, stop, held, _ = grid
    count, i = 0, first[slot]
    while i < stop[slot]:
        j = held[i]
        if not alive[j]:
            stop[slot] -= 1
            held[i] = held[stop[slot]]
            continue
        i += 1
        if seen[j] != mark:
            seen[j] = mark
            out[count] = j
            count += 1
    return count


@compiled
def measure(q: Array, line: Line, out: Array) -> None:
    """Write the projections and offsets of a segment: low, high twice, a (4,) array, metres."""
    x, y, dx, dy = line
    u0, u1 = (q[0, 0] - x) * dx + (q[0, 1] - y) * dy, (q[1, 0] - x) * dx + (q[1, 1] - y) * dy
    v0, v1 = (q[0, 1] - y) * dx - (q[0, 0] - x) * dy, (q[1, 1] - y) * dx - (q[1, 0] - x) * dy
    out[0], out[1], out[2], out[3] = min(u0, u1), max(u0, u1), min(v0, v1), max(v0, v1)


@compiled
def _can_enter(m: Array, tolerance: float) -> bool:
    """Whether some shift of the strip within `tolerance` holds a measured segment."""
    wide = 2 * (tolerance + SAME)
    return m[3] - m[2] <= wide and m[3] <= wide and m[2] >= -wide


@compiled
def inside(m: Array, shift: float, tolerance: float) -> bool:
    """Whether the strip at `shift`, metres, holds a measured segment, a (4,) array (A 4.4.1)."""
    return m[3] - tolerance <= shift + SAME and shift - SAME <= m[2] + tolerance


@compiled
def _gather(
    s: Array,
    line: Line,
    half: float,
    tolerance: float,
    grid: Grid,
    alive: NDArray[np.bool_],
    seen: Indices,
    mark: int,
    near: Indices,
    measured: Array,
) -> int:
    """Collect all that may be in a chain through the longest segment; returns their number.

    Walks both ways from its middle for as long as the collected projections reach on.
    """
    cell, count = grid[3], 0
    for way in (1, -1):
        reach, k = half, 0
        while k * cell <= reach + cell:
            column = int(np.floor((line[0] + way * k * cell * line[2]) / cell))
            row = int(np.floor((line[1] + way * k * cell * line[3]) / cell))
            for a in range(column - 1, column + 2):
                for b in range(row - 1, row + 2):
                    slot = slot_of(a, b, len(grid[0]))
                    new = take(slot, grid, alive, seen, mark, near[count:])
                    kept = count
                    for c in range(count, count + new):
                        near[kept] = near[c]
                        measure(s[near[c]], line, measured[kept])
                        kept += _can_enter(measured[kept], tolerance)
                    count = kept
            reach = reach_on(measured[:count], way, reach)
            k += 1
    return count


@compiled
def reach_on(measured: Array, way: int, reach: float) -> float:
    """How far to one side, metres, a chain of the `(k, 4)` measured leads, whatever its shift."""
    longer = True
    while longer:
        longer = False
        for m in measured:
            near, far = (m[0], m[1]) if way == 1 else (-m[1], -m[0])
            if far > reach and near <= reach + SAME:
                reach, longer = far, True
    return reach


@compiled
def chain(
    measured: Array, order: Indices, longest: int, shift: float, tolerance: float
) -> tuple[int, int]:
    """The chain through the longest segment: a range of `order`, whose members are inside."""
    start, reach, holds = 0, -np.inf, False
    for k in range(len(order)):
        m = measured[order[k]]
        if not inside(m, shift, tolerance):
            continue
        if m[0] > reach + SAME:
            if holds:
                return start, k
            start = k
        holds = holds or order[k] == longest
        reach = max(reach, m[1])
    return start, len(order)


@compiled
def total_length(
    measured: Array, lengths: Array, order: Indices, longest: int, shift: float, tolerance: float
) -> float:
    """Sum of the lengths, metres, of the members of the chain; `measured` is `(k, 4)`."""
    start, stop = chain(measured, order, longest, shift, tolerance)
    total = 0.0
    for k in range(start, stop):
        if inside(measured[order[k]], shift, tolerance):
            total += lengths[order[k]]
    return total


@compiled
def members(
    measured: Array, near: Indices, order: Indices, longest: int, shift: float, tolerance: float
) -> tuple[Indices, float, float]:
    """Sorted indices `(k,)` of the chain's members, and the span of their projections, metres."""
    start, stop = chain(measured, order, longest, shift, tolerance)
    found = np.empty(stop - start, np.int64)
    count, low, high = 0, np.inf, -np.inf
    for k in range(start, stop):
        m = measured[order[k]]
        if inside(m, shift, tolerance):
            found[count] = near[order[k]]
            low, high = min(low, m[0]), max(high, m[1])
            count += 1
    return np.sort(found[:count]), low, high


@compiled
def possible_shifts(measured: Array, tolerance: float) -> Array:
    """0 and where a segment enters or leaves the strip, within the tolerance, `(k,)`, metres."""
    shifts = np.zeros(2 * len(measured) + 1)
    count = 1
    for m in measured:
        for t in (m[3] - tolerance, m[2] + tolerance):
            if abs(t) <= tolerance:
                shifts[count] = t
                count += 1
    return shifts[:count]


@compiled
def _comes_first(a: Indices, b: Indices) -> bool:
    """Whether sorted indices a come before b, as words in a dictionary."""
    for k in range(min(len(a), len(b))):
        if a[k] != b[k]:
            return a[k] < b[k]
    return len(a) < len(b)


@compiled
def best_strip(
    measured: Array, lengths: Array, near: Indices, longest: int, tolerance: float
) -> tuple[float, Indices, float, float]:
    """Shift of the greatest total length, metres; ties: smallest, then first indices `(k,)`."""
    order, shifts = np.argsort(measured[:, 0]), possible_shifts(measured, tolerance)
    totals = np.empty(len(shifts))
    for k in range(len(shifts)):
        totals[k] = total_length(measured, lengths, order, longest, shifts[k], tolerance)
    greatest = totals >= totals.max() - SAME
    least = np.abs(shifts[greatest]).min()
    chosen, shift, low, high = near[:0], 0.0, 0.0, 0.0
    for k in range(len(shifts)):
        if greatest[k] and abs(shifts[k]) <= least + SAME:
            found, a, b = members(measured, near, order, longest, shifts[k], tolerance)
            if len(chosen) == 0 or _comes_first(found, chosen):
                chosen, shift, low, high = found, shifts[k], a, b
    return shift, chosen, low, high


@compiled
def line_through(q: Array, length: float) -> Line:
    """Middle, metres, and unit direction of a segment, a (2, 2) array."""
    return (
        (q[0, 0] + q[1, 0]) / 2,
        (q[0, 1] + q[1, 1]) / 2,
        (q[1, 0] - q[0, 0]) / length,
        (q[1, 1] - q[0, 1]) / length,
    )


@compiled
def fuse(s: Array, tolerance: float) -> tuple[Array, Indices]:
    """Fuse segments that all have a length: outputs `(m, 2, 2)`, metres, and parents `(n,)`."""
    n = len(s)
    out, parents, count = np.empty((n, 2, 2)), np.full(n, -1, np.int64), 0
    if n == 0:
        return out, parents
    lengths = np.hypot(s[:, 1, 0] - s[:, 0, 0], s[:, 1, 1] - s[:, 0, 1])
    grid = build_grid(s, lengths, max(4 * tolerance, lengths.mean()))
    alive, seen = np.ones(n, np.bool_), np.full(n, -1, np.int64)
    near, measured = np.empty(n, np.int64), np.empty((n + 1, 4))
    falling = np.argsort(-lengths)
    entered, head = 0, 0
    equal = [0]  # a heap: live segments as long as the longest, lowest index on top
    equal.pop()
    while True:
        # A 4.4.4, step 1: the longest segment
        while head < n and not alive[falling[head]]:
            head += 1
        if head == n:
            return out[:count], parents
        while entered < n and lengths[falling[entered]] >= lengths[falling[head]] - SAME:
            heapq.heappush(equal, falling[entered])
            entered += 1
        i = heapq.heappop(equal)
        if not alive[i]:
            continue
        # steps 2 to 5: the strip, parallel to it, with the longest chain
        line = line_through(s[i], lengths[i])
        k = _gather(s, line, lengths[i] / 2, tolerance, grid, alive, seen, i, near, measured)
        longest = int(np.flatnonzero(near[:k] == i)[0])
        shift, chosen, low, high = best_strip(
            measured[:k], lengths[near[:k]], near[:k], longest, tolerance
        )
        # step 6: one segment for the chain
        x, y, dx, dy = line[0] - shift * line[3], line[1] + shift * line[2], line[2], line[3]
        out[count] = np.array(((x + low * dx, y + low * dy), (x + high * dx, y + high * dy)))
        parents[chosen] = count
        alive[chosen] = False
        count += 1
