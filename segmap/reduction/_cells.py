"""Which segments of a map that changes lie near a segment: a grid of their middles.

The cells of level k are 2^k times as wide as the smallest. A segment stands in the first level
whose cells are as wide as half of it and the reach together; so it is near only what passes within
one cell of that of its middle.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ..kernels import apart, put_in, slot_of, take_out
from ..segments import length
from ._runner import Indices

#: Rounding must not hide what is just within reach.
WIDER = 1.01


class Cells(NamedTuple):
    """A grid of segments for a reach; the segments of a cell make a list, found by a hash.

    Parameters
    ----------
    reach, smallest : float, metres
        How near is near; side of the smallest cells.
    head : (slots,) int array
        First segment of each slot, -1 for none.
    after, before : (n,) int array
        Next of the list; the one before, or -1 - slot for the first.
    level : (n,) int array
        Level of each segment.
    levels : (64,) int array
        How many segments are in each level.
    middle : (n, 3) array, metres
        Middle of each segment, and half its length.
    """

    reach: float
    smallest: float
    head: Indices
    after: Indices
    before: Indices
    level: Indices
    levels: Indices
    middle: Array


def empty_cells(segments: Array, reach: float, count: int) -> Cells:
    """Cells for so many segments that are about as long as `(n, 2, 2)` others; metres."""
    head = np.full(1 << int(np.ceil(np.log2(max(2 * count, 2)))), -1)
    after, before, level = np.full((3, count), -1)
    mean = float(length(segments).mean()) if len(segments) else 0.0
    smallest = max(2 * reach, mean / 2)
    levels, middle = np.zeros(64, np.int64), np.empty((count, 3))
    return Cells(float(reach), float(smallest), head, after, before, level, levels, middle)


def wider(cells: Cells, more: int) -> Cells:
    """The same cells, with room for so many more segments."""
    after, before, level = (
        np.append(old, np.zeros(more, np.int64)) for old in (cells.after, cells.before, cells.level)
    )
    middle = np.concatenate([cells.middle, np.zeros((more, 3))])
    return cells._replace(after=after, before=before, level=level, middle=middle)


@compiled
def _slot(column: int, row: int, level: int, slots: int) -> int:
    return slot_of(column + 7919 * level, row, slots)


@compiled
def enter(cells: Cells, s: Array, b: int) -> None:
    """Put segment b of `(n, 2, 2)`, metres, into its cell."""
    head, middle = cells.head, cells.middle
    x, y = (s[b, 0, 0] + s[b, 1, 0]) / 2, (s[b, 0, 1] + s[b, 1, 1]) / 2
    half = np.hypot(s[b, 1, 0] - s[b, 0, 0], s[b, 1, 1] - s[b, 0, 1]) / 2
    middle[b, 0], middle[b, 1], middle[b, 2] = x, y, half
    level, side = 0, cells.smallest
    while side < half + WIDER * cells.reach:
        level, side = level + 1, 2 * side
    slot = _slot(int(np.floor(x / side)), int(np.floor(y / side)), level, len(head))
    put_in(head, cells.after, cells.before, slot, b)
    cells.level[b] = level
    cells.levels[level] += 1


@compiled
def leave(cells: Cells, b: int) -> None:
    """Take segment b out of its list."""
    take_out(cells.head, cells.after, cells.before, b)
    cells.levels[cells.level[b]] -= 1


@compiled
def near(cells: Cells, s: Array, u: Array, found: Indices) -> int:
    """Write which segments of `(n, 2, 2)` are within reach of u, `(2, 2)`, metres; how many.

    In no order, each once; those at the reach exactly are left out.
    """
    count, side, middle = 0, cells.smallest / 2, cells.middle
    x, y, dx, dy = u[0, 0], u[0, 1], u[1, 0] - u[0, 0], u[1, 1] - u[0, 1]
    ux, uy, half = x + dx / 2, y + dy / 2, np.hypot(dx, dy) / 2
    for level in range(len(cells.levels)):
        side *= 2
        if cells.levels[level] == 0:
            continue
        first, last = np.floor(min(x, x + dx) / side) - 1, np.floor(max(x, x + dx) / side) + 1
        for column in range(int(first), int(last) + 1):
            # the part of u that is within a cell of this column
            begin, end = 0.0, 1.0
            if dx != 0.0:
                t, w = ((column - 1) * side - x) / dx, ((column + 2) * side - x) / dx
                begin, end = min(max(min(t, w), 0.0), 1.0), max(min(max(t, w), 1.0), 0.0)
            low, high = y + begin * dy, y + end * dy
            if low > high:
                low, high = high, low
            for row in range(int(np.floor(low / side)) - 1, int(np.floor(high / side)) + 2):
                b = cells.head[_slot(column, row, level, len(cells.head))]
                while b >= 0:
                    bx, by, reach = middle[b, 0], middle[b, 1], middle[b, 2] + half + cells.reach
                    square = (bx - ux) * (bx - ux) + (by - uy) * (by - uy)
                    # another cell may share the slot
                    here = cells.level[b] == level and square < reach * reach * WIDER
                    here = here and np.floor(bx / side) == column and np.floor(by / side) == row
                    if here and apart(u, s[b]) < cells.reach:
                        found[count] = b
                        count += 1
                    b = cells.after[b]
    return count
