"""Squares of a quadtree in the order of its curve: which one holds a cell, and which ones touch."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from . import _kernels as kernels

#: Bits of a number apart by a place, twice as many at each step from the last to the first.
BIT_SPREADING = [(2**k, (2**64 - 1) // (2**2**k + 1)) for k in range(4, -1, -1)]
#: Left, right, below, above: where the next square lies, and from where to where the side runs.
SIDES = [((-1, 0), (0, 0), (0, 1)), ((1, 0), (1, 0), (1, 1))]
SIDES += [((0, -1), (0, 0), (1, 0)), ((0, 1), (0, 1), (1, 1))]
#: A cell and its eight neighbours.
NINE = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), -1).reshape(-1, 2)


class Squares:
    """Squares of which no two share a cell, as places on the quadtree's curve (B 2.1.2, [23]).

    `cell`, `(n, 2)`, are their lower left cells, counted from the root's; each has a side of
    `2^level` cells.
    """

    def __init__(self, cell: kernels.Cells, level: kernels.Cells) -> None:
        self.cell, self.level = cell, level
        code = _code(cell)
        self._order = np.argsort(code)
        self._code = code[self._order]

    def at(self, cells: kernels.Cells) -> kernels.Cells:
        """The square that holds each cell `(m, 2)`; -1 for none."""
        if not len(self.cell):
            return np.full(len(cells), -1)
        k = self._order[np.searchsorted(self._code, _code(np.maximum(cells, 0)), "right") - 1]
        inside = (cells - self.cell[k] >> self.level[k, None] == 0).all(1)
        return np.where(inside, k, -1)

    def borders(self) -> tuple[kernels.Cells, kernels.Cells, Array]:
        """Each border once: two squares, the smaller one first, and its ends, in cells.

        Where a side touches no square, the second is -1.
        """
        borders = []
        for k, (step, *ends) in enumerate(SIDES):
            side = (1 << self.level)[:, None]
            other = self.at(self.cell + np.where(np.array(step) > 0, side, step))
            larger = np.where(other < 0, 64, self.level[other]) - self.level
            one = np.flatnonzero((larger > 0) | ((larger == 0) & (k % 2 == 1)))
            along = self.cell[one, None] + side[one, None] * np.array(ends)
            borders.append((one, other[one], along.astype(float)))
        first, second, edges = map(np.concatenate, zip(*borders, strict=True))
        return first, second, edges


def _code(cell: kernels.Cells) -> kernels.Cells:
    """Places on the curve: the bits of x and y in turn (Morton's order)."""
    bits = cell.astype(np.uint64)
    for shift, mask in BIT_SPREADING:
        bits = (bits | bits << np.uint64(shift)) & np.uint64(mask)
    return (bits[:, 0] | bits[:, 1] << np.uint64(1)).astype(np.int64)
