"""Loops of the correlative search: the pose of a window at which a scan lies best on a map.

Olson (2009), with the branch and bound of Hess et al. (2016).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

Levels = NDArray[np.uint8]
Cells = NDArray[np.int32]
Indices = NDArray[np.int64]


@compiled
def stamp_points(level: NDArray[np.uint8], cells: Indices, stamp: NDArray[np.uint8]) -> None:
    """Raise the likelihoods around each point to those of a stamp, (s, s) array, s odd, laid on it.

    The stamps of all cells `(n, 2)` lie inside of the level, (columns, rows) array of bytes.
    """
    for k in range(len(cells)):
        i, j = cells[k, 0] - len(stamp) // 2, cells[k, 1] - len(stamp) // 2
        for a in range(len(stamp)):
            for b in range(len(stamp)):
                if level[i + a, j + b] < stamp[a, b]:
                    level[i + a, j + b] = stamp[a, b]


@compiled
def mean_likelihood(levels: Levels, level: int, scans: Cells, h: int, i: int, j: int) -> float:
    """Mean likelihood, 0 to 1, under scan h moved by (i, j) cells; 0 outside of the map.

    Levels (l, columns, rows) of bytes, the cells of a scan at each heading (h, n, 2).
    """
    total = 0
    for k in range(scans.shape[1]):
        a, b = scans[h, k, 0] + i, scans[h, k, 1] + j
        if 0 <= a < levels.shape[1] and 0 <= b < levels.shape[2]:
            total += int(levels[level, a, b])
    return total / (255.0 * scans.shape[1])


@compiled
def _best_of_block(
    levels: Levels,
    scans: Cells,
    h: int,
    i: int,
    j: int,
    bound: float,
    radius: int,
    cost: float,
    reach_cost: float,
    best: float,
    todo: Indices,
    value: Array,
) -> tuple[float, int, int]:
    """Best shift of the block at (i, j), `2^top` cells a side, if better than `best`: depth first.

    `cost` is what the heading costs, `reach_cost` what a shift by the whole radius costs; `todo`
    (4 l, 3) and `value` (4 l,) are overwritten.
    """
    todo[0, 0], todo[0, 1], todo[0, 2], value[0] = len(levels) - 1, i, j, bound
    used, at_i, at_j = 1, 0, 0
    while used:
        used -= 1
        level, i, j = todo[used, 0], todo[used, 1], todo[used, 2]
        if value[used] <= best:
            continue
        if level == 0:
            score = value[used] - reach_cost * (i * i + j * j) / (radius * radius)
            if score > best:
                best, at_i, at_j = score, i, j
            continue
        half, first = 1 << (level - 1), used
        for q in range(4):
            a, b = i + half * (q // 2), j + half * (q % 2)
            if a <= radius and b <= radius:
                score = mean_likelihood(levels, level - 1, scans, h, a, b) - cost
                m = used
                while m > first and value[m - 1] > score:  # ascending: the best is taken first
                    for k in range(3):
                        todo[m, k] = todo[m - 1, k]
                    value[m] = value[m - 1]
                    m -= 1
                todo[m, 0], todo[m, 1], todo[m, 2], value[m] = level - 1, a, b, score
                used += 1
    return best, at_i, at_j


@compiled
def search(
    levels: Levels,
    scans: Cells,
    cost: Array,
    radius: int,
    reach_cost: float,
    least: float,
    bound: Array,
    block: Indices,
    todo: Indices,
    value: Array,
) -> tuple[float, int, int, int]:
    """Best score of a window, with the heading's index (-1: none above `least`) and shift in cells.

    Exact on the lattice of cells and headings: of the blocks that can hold more than the best so
    far, the one that can hold most is looked into next (of equals the first). Levels `(l, columns,
    rows)` are likelihoods of cells, then their maxima over 2, 4, ... cells a side; `scans` are the
    cells `(h, n, 2)` of the scan at each heading, `cost` `(h,)` what a heading costs; the radius
    counts cells; `bound` and `block` have room for all blocks.
    """
    width = 1 << (len(levels) - 1)
    side = 2 * radius // width + 1
    count = 0
    for h in range(len(scans)):
        for b in range(side * side):
            i, j = b // side * width - radius, b % side * width - radius
            score = mean_likelihood(levels, len(levels) - 1, scans, h, i, j) - cost[h]
            if score > least:
                bound[count], block[count] = score, h * side * side + b
                count += 1
    best, heading, shift_i, shift_j = least, -1, 0, 0
    while count:
        top = kept = 0
        for k in range(count):
            if bound[k] > best:
                bound[kept], block[kept] = bound[k], block[k]
                top = kept if bound[kept] > bound[top] else top
                kept += 1
        count = kept
        if count:
            h, b = block[top] // (side * side), block[top] % (side * side)
            i, j = b // side * width - radius, b % side * width - radius
            score, i, j = _best_of_block(
                levels, scans, h, i, j, bound[top], radius, cost[h], reach_cost, best, todo, value
            )
            bound[top] = best
            if score > best:
                best, heading, shift_i, shift_j = score, h, i, j
    return best, heading, shift_i, shift_j
