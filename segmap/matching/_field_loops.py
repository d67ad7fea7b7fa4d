"""Loops of the distance field: occupied cells painted, distances transformed and looked up."""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

Counts = NDArray[np.int32]
Whole = NDArray[np.int64]
Holds = NDArray[np.bool_]
#: Stands for a column without an occupied cell: more cells than a window may have a side.
FAR = 30_000


@compiled
def paint(
    vis: Counts,
    occ: Counts,
    holds: Holds,
    root: int,
    top: int,
    left: int,
    low: int,
    grid: Counts,
) -> int:
    """Write 0 where a cell of a window is occupied; returns their number.

    The window is a (rows, columns) array, row 0 lowest; `left` and `low` are its corner in cells of
    the root.
    """
    rows, columns = grid.shape
    todo, waiting, count = np.empty((3 * top + 4, 4), np.int64), 1, 0
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = root, -left, -low, top
    while waiting:
        waiting -= 1
        block, x, y, level = todo[waiting]
        half = 1 << (level - 1)
        for node in range(4 * block, 4 * block + 4):
            i, j = x + half * (node & 1), y + half * ((node >> 1) & 1)
            if i >= columns or j >= rows or i + half <= 0 or j + half <= 0:
                continue
            child = ~np.int64(vis[node])
            if child >= 0 and holds[child]:
                todo[waiting, 0], todo[waiting, 1] = child, i
                todo[waiting, 2], todo[waiting, 3] = j, level - 1
                waiting += 1
            elif child < 0 and 2 * occ[node] > vis[node]:  # a cell: only those are ever hit
                grid[j, i] = 0
                count += 1
    return count


@compiled
def transform_columns(grid: Counts) -> None:
    """Replace each cell by its distance, in cells, to the nearest 0 of its column.

    In place, in a (rows, columns) array.
    """
    rows, columns = grid.shape
    away = np.full(columns, FAR, np.int32)
    for i in range(rows):
        for j in range(columns):
            away[j] = 0 if grid[i, j] == 0 else away[j] + 1
            grid[i, j] = away[j]
    away[:] = FAR
    for i in range(rows - 1, -1, -1):
        for j in range(columns):
            away[j] = min(away[j] + 1, grid[i, j])
            grid[i, j] = away[j]


@compiled
def transform_rows(grid: Counts, unit: int) -> None:
    """Replace distances within the columns by those to the nearest 0 of all, in cells / `unit`.

    In place, in a (rows, columns) array. Exact: in each row the lower envelope of the parabolas
    that stand on its columns, left to right (Meijster, Roerdink and Hesselink 2000). `since[k]` is
    where parabola k begins to be lowest.
    """
    rows, columns = grid.shape
    vertex, since = np.empty(columns, np.int64), np.empty(columns, np.int64)
    height, square = np.empty(columns, np.int64), np.empty(columns)
    share = 0.5 / np.arange(1, columns + 1)
    for i in range(rows):
        last = -1
        for j in range(columns):
            if grid[i, j] >= FAR:
                continue
            g, begin = np.int64(grid[i, j]) ** 2, 0
            while last >= 0:
                v, t, h = vertex[last], since[last], height[last]
                if (t - v) ** 2 + h <= (t - j) ** 2 + g:
                    begin = int((g + j * j - h - v * v) * share[j - v - 1]) + 1
                    break
                last -= 1
            if begin < columns:
                last += 1
                vertex[last], since[last], height[last] = j, begin, g
        until = columns
        for k in range(last, -1, -1):
            for j in range(since[k], until):
                square[j] = (j - vertex[k]) ** 2 + height[k]
            until = since[k]
        for j in range(columns):
            grid[i, j] = np.int32(np.sqrt(square[j]) * unit + 0.5)


@compiled
def look_up(field: Counts, frame: Array, points: NDArray[np.float32], poses: Array) -> Array:
    """Sum of the field under points `(2, n)` at each pose `(k, 3)`; beyond its edge the edge's.

    `frame` holds left and low edge, cell side, columns, rows, and what the field's unit is worth.
    Single precision and whole numbers let the compiler take eight beams at a time.
    """
    left, low, side, columns = frame[0], frame[1], frame[2], np.int32(frame[3])
    zero, most_x = np.float32(0.0), np.float32(frame[3] - 1.0)
    most_y, found = np.float32(frame[4] - 1.0), np.empty(len(poses))
    cells = np.empty(points.shape[1], np.int32)
    for k in range(len(poses)):
        c, s = np.float32(np.cos(poses[k, 2]) / side), np.float32(np.sin(poses[k, 2]) / side)
        dx, dy = np.float32((poses[k, 0] - left) / side), np.float32((poses[k, 1] - low) / side)
        for m in range(points.shape[1]):
            x = c * points[0, m] - s * points[1, m] + dx
            y = s * points[0, m] + c * points[1, m] + dy
            x, y = min(most_x, max(zero, x)), min(most_y, max(zero, y))
            cells[m] = np.int32(y) * columns + np.int32(x)
        total = np.int64(0)
        for m in range(points.shape[1]):
            total += field[cells[m]]
        found[k] = total * frame[5]
    return found
