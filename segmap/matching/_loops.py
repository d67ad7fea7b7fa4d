"""Loops that look for the nearest occupied cell: in the tree, and for all cells of a window.

`vis`, `occ` and `holds` are those of a map's tree. Only single cells are ever occupied, since ends
of beams split their leaves all the way down. Callers bring all arrays, since each that a loop makes
for itself takes long to compile.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

Counts = NDArray[np.int32]
Whole = NDArray[np.int64]
Holds = NDArray[np.bool_]
Singles = NDArray[np.float32]

#: Makes 64 bits of a number.
whole: Any = np.int64
#: Stands for a column without an occupied cell: more cells than a window may have a side.
FAR = 30_000


@compiled
def nearest_distances(
    vis: Counts,
    occ: Counts,
    holds: Holds,
    places: Array,
    path: Whole,
    todo: Whole,
    found: Array,
) -> None:
    """Write the sum over places `(k, n, 2)` of the distance to the nearest occupied cell's centre.

    In cells of the root. From the leaf that holds a place the search goes upwards, until nothing
    nearer lies outside. Squares wait in `todo`, as block, x, y and level, the one to look into
    first as the last; those beyond the best so far are not entered. The last of `path`,
    `(top + 1,)`, is the root's block; the rest of it and `todo` are room to work in.
    """
    top = len(path) - 1
    most = (1 << top) - 1.0
    for k in range(len(places)):
        found[k] = 0.0
        for m in range(places.shape[1]):
            x, y = places[k, m, 0], places[k, m, 1]
            i, j = whole(min(max(x, 0.0), most)), whole(min(max(y, 0.0), most))
            level, child = top, path[top]
            while child >= 0:  # down to the leaf
                path[level] = child
                level -= 1
                child = ~whole(vis[4 * child + ((i >> level) & 1) + 2 * ((j >> level) & 1)])
            best, count = np.inf, 0
            if level == 0:  # a cell: first its block of four
                todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = path[1], i & -2, j & -2, 1
                level, count = 1, 1
            while count > 0 or level < top:
                if count == 0:  # up: the three sisters of the square
                    width, quarter = 1 << level, ((i >> level) & 1) + 2 * ((j >> level) & 1)
                    left, low = i & -width, j & -width
                    border = (
                        min(min(x - left, left + width - x), min(y - low, low + width - y)) + 0.5
                    )
                    if border > 0 and border * border >= best:
                        break
                    level += 1
                    for turn in range(3, 0, -1):
                        child = ~whole(vis[4 * path[level] + (quarter ^ turn)])
                        if child >= 0 and holds[child]:
                            todo[count, 0], todo[count, 3] = child, level - 1
                            todo[count, 1] = left ^ (width * (turn & 1))
                            todo[count, 2] = low ^ (width * (turn >> 1))
                            count += 1
                    continue
                count -= 1
                block, left, low = todo[count, 0], todo[count, 1], todo[count, 2]
                below = todo[count, 3] - 1
                half = 1 << below
                dx = max(max(left + 0.5 - x, x - (left + 2 * half - 0.5)), 0.0)
                dy = max(max(low + 0.5 - y, y - (low + 2 * half - 0.5)), 0.0)
                if dx * dx + dy * dy >= best:
                    continue
                dx, dy = left + half - x, low + half - y
                nearest = (dx <= 0) + 2 * (dy <= 0)
                flip = 1 if abs(dx) > abs(dy) else 2
                for turn in (3, flip, 3 - flip, 0):  # the nearest quarter last
                    q = nearest ^ turn
                    child = ~whole(vis[4 * block + q])
                    if child >= 0 and holds[child]:
                        todo[count, 0], todo[count, 3] = child, below
                        todo[count, 1], todo[count, 2] = (
                            left + half * (q & 1),
                            low + half * (q >> 1),
                        )
                        count += 1
                    elif below == 0 and 2 * whole(occ[4 * block + q]) > vis[4 * block + q]:
                        dx, dy = left + 0.5 - x + (q & 1), low + 0.5 - y + (q >> 1)
                        best = min(best, dx * dx + dy * dy)
            found[k] += np.sqrt(best)


@compiled
def descent_distances(
    vis: Counts, occ: Counts, holds: Holds, root: int, top: int, places: Array, found: Array
) -> None:
    """The same by B's descent: always into the occupied child whose centre is nearest (B 4.3)."""
    for k in range(len(places)):
        found[k] = 0.0
        for m in range(places.shape[1]):
            x, y = places[k, m, 0], places[k, m, 1]
            best, left, low, block = np.inf, 0.0, 0.0, root
            for level in range(top - 1, -1, -1):
                half, chosen, best = 0.5 * (1 << level), 0, np.inf
                for q in range(4):
                    child = ~whole(vis[4 * block + q])
                    dx = left + half + 2 * half * (q & 1) - x
                    dy = low + half + 2 * half * (q >> 1) - y
                    cell = 2 * whole(occ[4 * block + q]) > vis[4 * block + q]
                    if (holds[child] if child >= 0 else cell) and dx * dx + dy * dy < best:
                        best, chosen = dx * dx + dy * dy, q
                left, low = left + 2 * half * (chosen & 1), low + 2 * half * (chosen >> 1)
                block = ~whole(vis[4 * block + chosen])
            found[k] += np.sqrt(best)


@compiled
def transform(grid: Counts, unit: int, room: Whole, share: Array) -> None:
    """Replace each cell of a grid `(rows, columns)` of 0 and FAR by its distance to the nearest 0.

    In place, in cells / `unit`. First along the columns; then, in each row, by the lower envelope
    of the parabolas that stand on its columns, left to right, which is exact (Meijster, Roerdink
    and Hesselink 2000). Of each parabola that is lowest anywhere `room`, `(columns, 3)`, holds its
    column, where it begins to be lowest, and its height; `share[k]` is `1 / (2 k + 2)`.
    """
    rows, columns = grid.shape
    for k in range(1, 2 * rows - 1):  # down, and up again
        i, before = (k, k - 1) if k < rows else (2 * rows - 2 - k, 2 * rows - 1 - k)
        for j in range(columns):
            grid[i, j] = grid[before, j] + 1 if grid[before, j] < grid[i, j] else grid[i, j]
    for i in range(rows):
        last = -1
        for j in range(columns):
            if grid[i, j] >= FAR:
                continue
            g, begin = whole(grid[i, j]) * grid[i, j], 0
            while last >= 0:
                v, t, h = room[last, 0], room[last, 1], room[last, 2]
                if (t - v) * (t - v) + h <= (t - j) * (t - j) + g:
                    begin = whole((g + j * j - h - v * v) * share[j - v - 1]) + 1
                    break
                last -= 1
            if begin < columns:
                last += 1
                room[last, 0], room[last, 1], room[last, 2] = j, begin, g
        until = columns
        for k in range(last, -1, -1):
            for j in range(room[k, 1], until):
                square = (j - room[k, 0]) * (j - room[k, 0]) + room[k, 2]
                grid[i, j] = whole(np.sqrt(square) * unit + 0.5)
            until = room[k, 1]


@compiled
def look_up(
    field: Counts, frame: Array, points: Singles, poses: Array, cells: Counts, found: Array
) -> None:
    """Write the sum of the field under points `(2, n)` at each pose `(k, 3)`; beyond its edge the
    edge's.

    `frame` holds left and low edge, cell side, columns, rows, and what the field's unit is worth;
    `cells`, `(n,)`, is room to work in. Single precision and whole numbers let the compiler take
    eight beams at a time.
    """
    left, low, side, columns = frame[0], frame[1], frame[2], np.int32(frame[3])
    zero, most_x, most_y = np.float32(0.0), np.float32(frame[3] - 1.0), np.float32(frame[4] - 1.0)
    for k in range(len(poses)):
        c, s = np.float32(np.cos(poses[k, 2]) / side), np.float32(np.sin(poses[k, 2]) / side)
        dx, dy = np.float32((poses[k, 0] - left) / side), np.float32((poses[k, 1] - low) / side)
        for m in range(points.shape[1]):
            x = c * points[0, m] - s * points[1, m] + dx
            y = s * points[0, m] + c * points[1, m] + dy
            x, y = min(most_x, max(zero, x)), min(most_y, max(zero, y))
            cells[m] = np.int32(y) * columns + np.int32(x)
        total = whole(0)
        for m in range(points.shape[1]):
            total += field[cells[m]]
        found[k] = total * frame[5]
