"""Loops of the correlative search: the pose of a window at which a scan lies best on a map.

Olson (2009), with the branch and bound of Hess et al. (2016).
"""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

Level = NDArray[np.uint8]
Indices = NDArray[np.int32]


@compiled
def likelihood(
    points: Array, corner: Array, columns: int, rows: int, cell: float, stamp: Level
) -> Level:
    """How likely a point is in each cell, 0 to 255: the largest of the stamps put on map points.

    Points `(n, 2)`, metres; cells of side `cell`, metres, from the corner on; the stamp, (s, s)
    array, s odd, lies with its middle on each point; (columns, rows) array of bytes.
    """
    level, r = np.zeros((columns, rows), np.uint8), len(stamp) // 2
    for k in range(len(points)):
        i = int((points[k, 0] - corner[0]) / cell)
        j = int((points[k, 1] - corner[1]) / cell)
        for a in range(max(i - r, 0), min(i + r, columns - 1) + 1):
            for b in range(max(j - r, 0), min(j + r, rows - 1) + 1):
                level[a, b] = max(level[a, b], stamp[a - i + r, b - j + r])
    return level


@compiled
def widened(level: Level, step: int) -> Level:
    """Largest of each cell and those `step` cells to the right, above, and both.

    Both levels are (columns, rows) array of bytes.
    """
    columns, rows = level.shape
    wide = level.copy()
    for i in range(columns - step):
        for j in range(rows):
            wide[i, j] = max(wide[i, j], level[i + step, j])
    for i in range(columns):
        for j in range(rows - step):
            wide[i, j] = max(wide[i, j], wide[i, j + step])
    return wide


@compiled
def overlay(level: Level, cells: Indices, i: int, j: int) -> float:
    """Mean likelihood, 0 to 1, under the cells `(n, 2)` of a scan moved by (i, j) cells."""
    columns, rows = level.shape
    total = 0
    for k in range(len(cells)):
        a, b = cells[k, 0] + i, cells[k, 1] + j
        if 0 <= a < columns and 0 <= b < rows:
            total += int(level[a, b])
    return total / (255.0 * len(cells))


@compiled
def _turned_cells(
    current: Array, start: Array, heading: float, corner: Array, cell: float
) -> Indices:
    """Cells of points at the start, turned by a further heading, (n, 2) int array.

    Points `(n, 2)`, metres, in the robot's frame; start, (3,) array, metres and radians.
    """
    c, s = np.cos(start[2] + heading), np.sin(start[2] + heading)
    found = np.empty((len(current), 2), np.int32)
    for k in range(len(current)):
        x = c * current[k, 0] - s * current[k, 1] + start[0] - corner[0]
        y = s * current[k, 0] + c * current[k, 1] + start[1] - corner[1]
        found[k, 0], found[k, 1] = int(np.floor(x / cell)), int(np.floor(y / cell))
    return found


@compiled
def _best_within(
    levels: tuple[Level, ...],
    cells: Indices,
    block: tuple[int, int],
    bound: float,
    radius: int,
    cost: float,
    away: float,
    best: float,
) -> tuple[float, int, int]:
    """Best shift of one block of `2^top` cells a side, if better than `best`: depth first.

    `cost` is what the heading costs, `away` what a shift by the whole radius costs.
    """
    top = len(levels) - 1
    todo, value = np.empty((4 * top + 4, 3), np.int64), np.empty(4 * top + 4)
    todo[0, 0], todo[0, 1], todo[0, 2], value[0] = top, block[0], block[1], bound
    used, at_i, at_j = 1, 0, 0
    while used:
        used -= 1
        level, i, j = todo[used, 0], todo[used, 1], todo[used, 2]
        if value[used] <= best:
            continue
        if level == 0:
            score = value[used] - away * (i * i + j * j) / (radius * radius)
            if score > best:
                best, at_i, at_j = score, i, j
            continue
        half, first = 1 << (level - 1), used
        for q in range(4):
            a, b = i + half * (q // 2), j + half * (q % 2)
            if a <= radius and b <= radius:
                score = overlay(levels[level - 1], cells, a, b) - cost
                m = used
                while m > first and value[m - 1] > score:  # ascending: the best is taken first
                    todo[m], value[m] = todo[m - 1], value[m - 1]
                    m -= 1
                todo[m, 0], todo[m, 1], todo[m, 2], value[m] = level - 1, a, b, score
                used += 1
    return best, at_i, at_j


@compiled
def search(
    levels: tuple[Level, ...],
    corner: Array,
    cell: float,
    current: Array,
    start: Array,
    headings: Array,
    radius: int,
    away: float,
    least: float,
) -> tuple[float, int, int, int]:
    """Best score of a window and its heading's index (-1: none above `least`) and shift in cells.

    Points `(n, 2)`, metres, in the robot's frame; start, (3,) array, metres and radians, in the
    map's; headings, (h,) array, radians, from the start's. Exact on the lattice of cells and
    headings: blocks are looked into in the order of what they can at best hold.
    """
    width = 1 << (len(levels) - 1)
    blocks = 2 * radius // width + 1
    scans = np.empty((len(headings), len(current), 2), np.int32)
    bound = np.empty((len(headings), blocks, blocks))
    cost = away * (headings / max(np.abs(headings).max(), 1e-9)) ** 2
    for h in range(len(headings)):
        scans[h] = _turned_cells(current, start, headings[h], corner, cell)
        for a in range(blocks):
            for b in range(blocks):
                i, j = a * width - radius, b * width - radius
                bound[h, a, b] = overlay(levels[-1], scans[h], i, j) - cost[h]
    best, heading, shift_i, shift_j = least, -1, 0, 0
    flat = bound.ravel()
    for place in np.argsort(-flat):
        if flat[place] <= best:
            break
        h, a, b = place // blocks**2, place // blocks % blocks, place % blocks
        block = (a * width - radius, b * width - radius)
        score, i, j = _best_within(
            levels, scans[h], block, flat[place], radius, cost[h], away, best
        )
        if score > best:
            best, heading, shift_i, shift_j = score, h, i, j
    return best, heading, shift_i, shift_j
