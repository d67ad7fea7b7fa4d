"""An index of boxes that come and go: which of them meet another box, in plain compiled loops.

A box of size s, the longer of its sides, has its middle in a cell of the first of the sizes unit,
2 units, 4 units, ... that holds s. So the boxes of one size that meet a box have their middles in
it, or within half a cell around it. The boxes of a cell make a list, found through a hash table.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ..kernels import put_in, slot_of, take_out
from ._runner import Indices


class Boxes(NamedTuple):
    """The index. Lengths and coordinates are in metres.

    Parameters
    ----------
    low, high : (n, 2) array
        Corners of each box, which the owner writes before it enters one.
    head : (slots,) int array
        First box of each slot, -1 for none.
    after, before : (n,) int array
        Next box of the list; the one before, or -1 - slot for the first.
    cell : (n, 3) int array
        Column, row and level of the cell of each; level -1 for a box that is not in the index.
    levels : (64,) int array
        How many boxes have each size.
    top : (1,) int array
        One more than the highest box that ever entered.
    unit : float
        Side of the smallest cells.
    """

    low: Array
    high: Array
    head: Indices
    after: Indices
    before: Indices
    cell: Indices
    levels: Indices
    top: Indices
    unit: float


def empty_boxes(count: int, unit: float) -> Boxes:
    """An index with room for so many boxes."""
    head = np.full(1 << int(np.ceil(np.log2(max(4 * count, 2)))), -1)
    after, before = np.full((2, count), -1)
    cell, levels = np.full((count, 3), -1), np.zeros(64, np.int64)
    corners = np.empty((2, count, 2))
    top = np.zeros(1, np.int64)
    return Boxes(corners[0], corners[1], head, after, before, cell, levels, top, float(unit))


@compiled
def enter(boxes: Boxes, b: int) -> None:
    """Put box b, whose corners are written, into the index."""
    low, high, head, cell = boxes.low, boxes.high, boxes.head, boxes.cell
    size = max(high[b, 0] - low[b, 0], high[b, 1] - low[b, 1])
    level, side = 0, boxes.unit
    while side < size and level < len(boxes.levels) - 1:
        level, side = level + 1, 2 * side
    column = int(np.floor((low[b, 0] + high[b, 0]) / 2 / side))
    row = int(np.floor((low[b, 1] + high[b, 1]) / 2 / side))
    cell[b, 0], cell[b, 1], cell[b, 2] = column, row, level
    slot = slot_of(column + 7919 * level, row, len(head))
    put_in(head, boxes.after, boxes.before, slot, b)
    boxes.levels[level] += 1
    boxes.top[0] = max(boxes.top[0], b + 1)


@compiled
def leave(boxes: Boxes, b: int) -> None:
    """Take box b out of the index."""
    take_out(boxes.head, boxes.after, boxes.before, b)
    boxes.levels[boxes.cell[b, 2]] -= 1
    boxes.cell[b, 2] = -1


@compiled
def meeting(boxes: Boxes, x0: float, y0: float, x1: float, y1: float, out: Indices) -> int:
    """Write the boxes that meet the one from (x0, y0) to (x1, y1), metres; how many, in no order.

    Where that would be more cells than there are boxes, all boxes are looked at instead.
    """
    low, high, cell, count = boxes.low, boxes.high, boxes.cell, 0
    cells, side = 0.0, boxes.unit / 2
    for level in range(len(boxes.levels)):
        side *= 2
        if boxes.levels[level] > 0:
            cells += ((x1 - x0) / side + 2) * ((y1 - y0) / side + 2)
    if cells >= boxes.top[0]:
        for b in range(boxes.top[0]):
            inside = low[b, 0] <= x1 and high[b, 0] >= x0 and low[b, 1] <= y1 and high[b, 1] >= y0
            if inside and cell[b, 2] >= 0:
                out[count] = b
                count += 1
        return count
    side = boxes.unit / 2
    for level in range(len(boxes.levels)):
        side *= 2
        if boxes.levels[level] == 0:
            continue
        for c in range(int(np.floor(x0 / side - 0.5)), int(np.floor(x1 / side + 0.5)) + 1):
            for r in range(int(np.floor(y0 / side - 0.5)), int(np.floor(y1 / side + 0.5)) + 1):
                b = boxes.head[slot_of(c + 7919 * level, r, len(boxes.head))]
                while b >= 0:
                    if cell[b, 0] == c and cell[b, 1] == r and cell[b, 2] == level:
                        beside = low[b, 0] > x1 or high[b, 0] < x0
                        if not (beside or low[b, 1] > y1 or high[b, 1] < y0):
                            out[count] = b
                            count += 1
                    b = boxes.after[b]
    return count
