"""What lies where: an index of boxes that come and go, which finds those that meet another box.

A box stands in the first level whose cells are as wide as it, in the cell of its middle; each level
is twice as wide as the one before. The boxes of a cell make a list, found through a hash table: a
wall a kilometre away takes no memory.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ._runner import Indices

#: Column of `Index.link`: the next box in the same cell.
AFTER_COLUMN = 0
#: Column of `Index.link`: the box before it in the same cell.
BEFORE_COLUMN = 1
#: Column of `Index.link`: its cell.
CELL_COLUMN = 2
#: Column of `Index.link`: the level of its cell, -1 for a box that is not in the index.
LEVEL_COLUMN = 3


class Index(NamedTuple):
    """Boxes by their number, around segments or their ends; lengths are in metres.

    Parameters
    ----------
    box : (n, 4) array
        Low x, low y, high x and high y.
    link : (n, 4) int array
        Next box of the list of its cell, -1 for none; the one before, or -1 - slot for the first;
        the address of the cell; and its level, -1 for a box that is not in the index.
    head : (slots,) int array
        First box of each slot, -1 for none.
    levels : (65, 2) array
        How many boxes are in each level, and half the size of the largest that ever was; and how
        many there are in all.
    unit : float
        Side of the smallest cells.
    """

    box: Array
    link: Indices
    head: Indices
    levels: Array
    unit: float


def empty_index(count: int, unit: float) -> Index:
    """An index with room for so many boxes."""
    head = np.full(1 << int(np.ceil(np.log2(max(2 * count, 2)))), -1)
    box, link = np.empty((count, 4)), np.full((count, 4), -1)
    return Index(box, link, head, np.zeros((65, 2)), float(unit))


def by_cell(s: Array, unit: float) -> Indices:
    """Order of segments, `(n, 2, 2)`, in which those of one size and place stand side by side."""
    size = np.maximum(np.ptp(s, axis=1).max(axis=1), unit)
    level = np.ceil(np.log2(size / unit))
    column, row = np.floor(s.mean(axis=1).T / (unit * 2**level))
    return np.lexsort((row, column, level))


@compiled
def _address(column: int, row: int, level: int) -> int:
    """A number for a cell, other than that of all near it: cells of a column stand side by side."""
    return ((column + (level << 40)) * 73856093 + row) & 0x3FFFFFFFFFFFFFFF


@compiled
def _box(points: Array, reach: float) -> tuple[float, float, float, float]:
    """Low x, low y, high x and high y of the box around points, `(k, 2)`, grown by a reach."""
    x0, y0, x1, y1 = np.inf, np.inf, -np.inf, -np.inf
    for k in range(len(points)):
        x0, y0 = min(x0, points[k, 0]), min(y0, points[k, 1])
        x1, y1 = max(x1, points[k, 0]), max(y1, points[k, 1])
    return x0 - reach, y0 - reach, x1 + reach, y1 + reach


@compiled
def enter(index: Index, b: int, points: Array, reach: float) -> None:
    """Put the box around points, `(k, 2)`, grown by a reach, into the index as number b."""
    box, link, head, levels = index.box, index.link, index.head, index.levels
    x0, y0, x1, y1 = _box(points, reach)
    box[b, 0], box[b, 1], box[b, 2], box[b, 3] = x0, y0, x1, y1
    size = max(x1 - x0, y1 - y0)
    level, side = 0, index.unit
    while side < size and level < len(levels) - 2:  # what is wider still is in the last level
        level, side = level + 1, 2 * side
    column, row = int(np.floor((x0 + x1) / 2 / side)), int(np.floor((y0 + y1) / 2 / side))
    link[b, CELL_COLUMN], link[b, LEVEL_COLUMN] = _address(column, row, level), level
    slot = link[b, CELL_COLUMN] & (len(head) - 1)
    link[b, AFTER_COLUMN], link[b, BEFORE_COLUMN] = head[slot], -1 - slot
    if head[slot] >= 0:
        link[head[slot], BEFORE_COLUMN] = b
    head[slot] = b
    levels[level, 0] += 1
    levels[-1, 0] += 1
    levels[level, 1] = max(levels[level, 1], size / 2)


@compiled
def enter_all(index: Index, s: Array) -> None:
    """Put the boxes around segments, `(n, 2, 2)`, into the index."""
    for b in range(len(s)):
        enter(index, b, s[b], 0.0)


@compiled
def take_out(index: Index, b: int) -> None:
    """Take box b out of the index."""
    link = index.link
    after, before = link[b, AFTER_COLUMN], link[b, BEFORE_COLUMN]
    if before < 0:
        index.head[-1 - before] = after
    else:
        link[before, AFTER_COLUMN] = after
    if after >= 0:
        link[after, BEFORE_COLUMN] = before
    index.levels[link[b, LEVEL_COLUMN], 0] -= 1
    index.levels[-1, 0] -= 1
    link[b, LEVEL_COLUMN] = -1


@compiled
def meeting(index: Index, points: Array, reach: float, out: Indices) -> int:
    """Write the boxes that meet the one around points, `(k, 2)`, grown by a reach; how many.

    Each once, in no order; what is farther by a rounding error, too. `out` needs room for one more
    than there are boxes.
    """
    box, link, head, levels, count = index.box, index.link, index.head, index.levels, 0
    x0, y0, x1, y1 = _box(points, reach + 1e-9 + 1e-15 * (abs(points[0, 0]) + abs(points[0, 1])))
    side, level, unvisited = index.unit, 0, levels[-1, 0]
    while unvisited > 0:
        if levels[level, 0] > 0:
            unvisited -= levels[level, 0]
            half = levels[level, 1]
            first, last = np.floor((x0 - half) / side), np.floor((x1 + half) / side)
            low, high = np.floor((y0 - half) / side), np.floor((y1 + half) / side)
            if (last - first + 1) * (high - low + 1) > len(box):  # fewer boxes than cells
                for b in range(len(box)):
                    beside = box[b, 0] > x1 or box[b, 2] < x0 or box[b, 1] > y1 or box[b, 3] < y0
                    if link[b, LEVEL_COLUMN] == level and not beside:
                        out[count] = b
                        count += 1
            else:
                for column in range(int(first), int(last) + 1):
                    for row in range(int(low), int(high) + 1):
                        cell = _address(column, row, level)
                        b = head[cell & (len(head) - 1)]
                        while b >= 0:
                            beside = (box[b, 0] > x1) | (box[b, 2] < x0)
                            above = (box[b, 1] > y1) | (box[b, 3] < y0)
                            out[count] = b
                            # another cell may share the slot
                            count += not (beside | above | (link[b, CELL_COLUMN] != cell))
                            b = link[b, AFTER_COLUMN]
        side, level = 2 * side, level + 1
    return count
