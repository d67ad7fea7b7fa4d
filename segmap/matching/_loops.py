"""Loops of the scores: cells looked up, distances transformed, nearest cells found in the tree."""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..angles import Array

Counts = NDArray[np.int32]
Whole = NDArray[np.int64]
#: A squared distance, in cells, larger than any in a window.
FAR = 2**30


@compiled
def placed(points: Array, pose: Array) -> Array:
    """Points `(n, 2)` carried by a pose."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    found = np.empty_like(points)
    for k in range(len(points)):
        found[k, 0] = c * points[k, 0] - s * points[k, 1] + pose[0]
        found[k, 1] = s * points[k, 0] + c * points[k, 1] + pose[1]
    return found


@compiled
def occupied_below(vis: Counts, occ: Counts, root: int, used: int) -> NDArray[np.bool_]:
    """Which nodes hold an occupied cell (occupancy above 0.5), themselves or below, `(4 b,)`."""
    holds = 2 * occ > vis
    order, above = np.empty(used, np.int64), np.full(used, -1, np.int64)
    order[0], count = root, 1
    for k in range(used):
        if k < count:
            for node in range(4 * order[k], 4 * order[k] + 4):
                if vis[node] < 0:
                    holds[node] = False
                    order[count] = ~np.int64(vis[node])
                    above[order[count]] = node
                    count += 1
    for k in range(count - 1, 0, -1):
        first = 4 * order[k]
        holds[above[order[k]]] = holds[first : first + 4].any()
    return holds


@compiled
def gap(at: float, low: float, width: float) -> float:
    """Distance of a coordinate from the centres of the cells from `low` on, in cells."""
    return max(low + 0.5 - at, at - (low + width - 0.5), 0.0)


@compiled
def nearest_in_tree(
    vis: Counts,
    holds: NDArray[np.bool_],
    root: int,
    top: int,
    x: float,
    y: float,
    bound: float,
    todo: Array,
) -> tuple[float, float, float]:
    """Squared distance to the nearest occupied cell's centre below `bound`, and that centre.

    In cells of the root. Children are visited nearest first, squares beyond the best are not
    entered; `todo` is room to work in.
    """
    best, at_x, at_y = bound, np.nan, np.nan
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3], todo[0, 4] = 0.0, root, 0.0, 0.0, top
    waiting = 1
    while waiting:
        waiting -= 1
        if todo[waiting, 0] >= best:
            continue
        block, left, low = int(todo[waiting, 1]), todo[waiting, 2], todo[waiting, 3]
        level = int(todo[waiting, 4]) - 1
        width, first = float(1 << level), waiting
        for q in range(4):
            node = 4 * block + q
            if not holds[node]:
                continue
            cx, cy = left + width * (q & 1), low + width * (q >> 1)
            d = gap(x, cx, width) ** 2 + gap(y, cy, width) ** 2
            if d >= best:
                continue
            if level == 0:
                best, at_x, at_y = d, cx + 0.5, cy + 0.5
                continue
            m = waiting
            while m > first and todo[m - 1, 0] < d:  # the nearest is taken first
                todo[m] = todo[m - 1]
                m -= 1
            todo[m, 0], todo[m, 1], todo[m, 2], todo[m, 3] = d, ~np.int64(vis[node]), cx, cy
            todo[m, 4] = level
            waiting += 1
    return best, at_x, at_y


@compiled
def exact_distances(
    vis: Counts, holds: NDArray[np.bool_], root: int, top: int, cells: Array
) -> Array:
    """Distance, in cells, of places `(n, 2)` to the nearest occupied cell's centre, `(n,)`.

    The centre found last bounds the search for the next place: neighbours lie near each other.
    """
    found, todo = np.empty(len(cells)), np.empty((4 * top + 4, 5))
    at_x, at_y = np.nan, np.nan
    for k in range(len(cells)):
        x, y = cells[k, 0], cells[k, 1]
        bound = np.inf
        if not np.isnan(at_x):
            bound = (at_x - x) ** 2 + (at_y - y) ** 2
        d, new_x, new_y = nearest_in_tree(vis, holds, root, top, x, y, bound, todo)
        if not np.isnan(new_x):
            at_x, at_y = new_x, new_y
        found[k] = np.sqrt(d)
    return found


@compiled
def greedy_distances(
    vis: Counts, holds: NDArray[np.bool_], root: int, top: int, cells: Array
) -> Array:
    """The same by B's descent: always into the occupied child whose centre is nearest (B 4.3)."""
    found = np.empty(len(cells))
    for k in range(len(cells)):
        x, y, block, left, low = cells[k, 0], cells[k, 1], root, 0.0, 0.0
        for level in range(top - 1, -1, -1):
            width, best, chosen = float(1 << level), np.inf, -1
            for q in range(4):
                if holds[4 * block + q]:
                    dx = left + width * ((q & 1) + 0.5) - x
                    dy = low + width * ((q >> 1) + 0.5) - y
                    if dx * dx + dy * dy < best:
                        best, chosen = dx * dx + dy * dy, q
            left, low = left + width * (chosen & 1), low + width * (chosen >> 1)
            found[k] = np.sqrt(best)
            block = int(~np.int64(vis[4 * block + chosen]))
    return found


@compiled
def paint(
    vis: Counts,
    holds: NDArray[np.bool_],
    root: int,
    top: int,
    left: int,
    low: int,
    columns: int,
    rows: int,
) -> Counts:
    """0 where a cell of a window is occupied, else FAR, `(rows, columns)`."""
    grid = np.full((rows, columns), FAR, np.int32)
    todo, waiting = np.empty((4 * top + 4, 4), np.int64), 1
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = root, -left, -low, top
    while waiting:
        waiting -= 1
        block, x, y, level = todo[waiting, 0], todo[waiting, 1], todo[waiting, 2], todo[waiting, 3]
        width = 1 << (level - 1)
        for q in range(4):
            cx, cy = x + width * (q & 1), y + width * (q >> 1)
            outside = cx >= columns or cy >= rows or cx + width <= 0 or cy + width <= 0
            if outside or not holds[4 * block + q]:
                continue
            if level == 1:
                grid[cy, cx] = 0
            else:
                todo[waiting, 0] = ~np.int64(vis[4 * block + q])
                todo[waiting, 1], todo[waiting, 2], todo[waiting, 3] = cx, cy, level - 1
                waiting += 1
    return grid


@compiled
def transform_columns(grid: Counts) -> None:
    """Replace each cell by the squared distance, in cells, to the nearest 0 of its column."""
    rows, columns = grid.shape
    away = np.full(columns, 30_000, np.int32)
    for i in range(rows):
        for j in range(columns):
            away[j] = 0 if grid[i, j] == 0 else away[j] + 1
            grid[i, j] = away[j]
    away[:] = 30_000
    for i in range(rows - 1, -1, -1):
        for j in range(columns):
            away[j] = min(away[j] + 1, grid[i, j])
            grid[i, j] = away[j] * away[j]


@compiled
def transform_rows(grid: Counts, unit: int) -> Counts:
    """Distance to the nearest 0, in cells / `unit`, from squared distances within the columns.

    Lower envelope of parabolas (Felzenszwalb and Huttenlocher 2012), a row at a time.
    """
    rows, columns = grid.shape
    found = np.empty((rows, columns), np.int32)
    vertex, until = np.empty(columns, np.int64), np.empty(columns + 1)
    for i in range(rows):
        row, last = grid[i], 0
        vertex[0], until[0], until[1] = 0, -np.inf, np.inf
        for j in range(1, columns):
            meet = meeting(row, vertex[last], j)
            while meet <= until[last]:
                last -= 1
                meet = meeting(row, vertex[last], j)
            last += 1
            vertex[last], until[last], until[last + 1] = j, meet, np.inf
        last = 0
        for j in range(columns):
            while until[last + 1] < j:
                last += 1
            square = (j - vertex[last]) ** 2 + row[vertex[last]]
            found[i, j] = round(unit * np.sqrt(square))
    return found


@compiled
def meeting(row: Counts, a: int, b: int) -> float:
    """Where the parabolas that stand on two places of a row cross."""
    return (row[b] + b * b - row[a] - a * a) / (2.0 * (b - a))


@compiled
def look_up(
    field: Counts, frame: Array, points: NDArray[np.float32], poses: Array, cells: Counts
) -> Array:
    """Sum of the field under points `(2, n)` at each pose `(k, 3)`; beyond its edge the edge's.

    `frame` holds left and low edge, cell side, columns and rows; `cells` `(n,)` is room to work in.
    Single precision and whole numbers let the compiler take eight beams at a time.
    """
    left, low, side, columns = frame[0], frame[1], frame[2], np.int32(frame[3])
    zero, most_x = np.float32(0.0), np.float32(frame[3] - 1.0)
    most_y, found = np.float32(frame[4] - 1.0), np.empty(len(poses))
    for k in range(len(poses)):
        c, s = np.float32(np.cos(poses[k, 2]) / side), np.float32(np.sin(poses[k, 2]) / side)
        dx, dy = np.float32((poses[k, 0] - left) / side), np.float32((poses[k, 1] - low) / side)
        for m in range(points.shape[1]):
            x = c * points[0, m] - s * points[1, m] + dx
            y = s * points[0, m] + c * points[1, m] + dy
            x, y = min(max(x, zero), most_x), min(max(y, zero), most_y)
            cells[m] = np.int32(y) * columns + np.int32(x)
        total = 0
        for m in range(points.shape[1]):
            total += field[cells[m]]
        found[k] = total
    return found
