"""Loops that find the occupied cell nearest to a place, in the tree.

Coordinates are in cells of the root. Only single cells are ever occupied: ends of beams split their
leaves all the way down.
"""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

Counts = NDArray[np.int32]
Whole = NDArray[np.int64]
Holds = NDArray[np.bool_]


@compiled
def occupied_blocks(vis: Counts, occ: Counts, root: int, used: int) -> Holds:
    """Which blocks hold an occupied cell (occupancy above 0.5), themselves or below.

    One for each of the b blocks in use, (b,) bool array; counts `(n,)`, four a block.

    A block comes before those below it, except where a root was doubled: those are done last.
    """
    holds, doubled, count = np.zeros(used, np.bool_), np.empty(64, np.int64), 0
    while root >= 0:
        doubled[count], inside = root, -1
        for node in range(4 * root, 4 * root + 4):
            inside = max(inside, ~vis[node] if ~vis[node] < root else -1)
        root, count = inside, count + 1
    for k in range(used + count):
        block = used - 1 - k if k < used else doubled[count - 1 - (k - used)]
        for node in range(4 * block, 4 * block + 4):
            below = ~np.int64(vis[node])
            if holds[below] if below >= 0 else 2 * occ[node] > vis[node]:
                holds[block] = True
    return holds


@compiled
def _beside(at: float, low: int, width: int) -> float:
    """Distance of a coordinate from the centres of the cells from `low` on."""
    return max(low + 0.5 - at, at - (low + width - 0.5), 0.0)


@compiled
def _nearest_of_four(vis: Counts, occ: Counts, first: int, dx: float, dy: float) -> float:
    """Smallest squared distance of four single cells; `dx`, `dy` to the centre of the first."""
    best = np.inf
    for q in range(4):
        if 2 * occ[first + q] > vis[first + q]:
            away = (dx + (q & 1)) ** 2 + (dy + (q >> 1)) ** 2
            best = min(best, away)
    return best


@compiled
def _nearest_below(
    vis: Counts,
    occ: Counts,
    holds: Holds,
    root: int,
    left: int,
    low: int,
    level: int,
    x: float,
    y: float,
    best: float,
    todo: Whole,
) -> float:
    """Squared distance to the nearest occupied cell's centre in a square, where below `best`.

    `root` is the block of the square's children. They are visited nearest first; squares that lie
    beyond the best so far are not entered. `todo` is room to work in.
    """
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = root, left, low, level
    waiting = 1
    while waiting:
        waiting -= 1
        block, left, low, level = todo[waiting]
        half = 1 << (level - 1)
        if _beside(x, left, 2 * half) ** 2 + _beside(y, low, 2 * half) ** 2 >= best:
            continue
        if level == 1:
            found = _nearest_of_four(vis, occ, 4 * block, left + 0.5 - x, low + 0.5 - y)
            best = min(best, found)
            continue
        dx, dy = left + half - x, low + half - y
        nearest = (dx <= 0) + 2 * (dy <= 0)
        flip = 1 if abs(dx) > abs(dy) else 2
        for turn in (3, flip, 3 - flip, 0):  # the last one put there is the first one taken
            q = nearest ^ turn
            child = ~np.int64(vis[4 * block + q])
            if child >= 0 and holds[child]:
                todo[waiting, 0], todo[waiting, 3] = child, level - 1
                todo[waiting, 1], todo[waiting, 2] = left + half * (q & 1), low + half * (q >> 1)
                waiting += 1
    return best


@compiled
def _descend(vis: Counts, path: Whole, top: int, i: int, j: int) -> int:
    """Level of the leaf that holds a cell; `path[level]` becomes the blocks on the way."""
    level = top
    while True:
        level -= 1
        child = vis[4 * path[level + 1] + ((i >> level) & 1) + 2 * ((j >> level) & 1)]
        if child >= 0:
            return level
        path[level] = ~np.int64(child)


@compiled
def _nearest_square(
    vis: Counts, occ: Counts, holds: Holds, top: int, x: float, y: float, path: Whole, todo: Whole
) -> float:
    """Squared distance of a place to the nearest occupied cell's centre.

    From the cell that holds the place upwards, sisters first, until nothing nearer lies outside.
    `path[top]` is the root, the rest of `path` and `todo` room to work in.
    """
    most = (1 << top) - 1.0
    i, j = int(min(max(x, 0.0), most)), int(min(max(y, 0.0), most))
    level, best = _descend(vis, path, top, i, j), np.inf
    if level == 0:
        first, level = 4 * path[1], 1
        best = _nearest_of_four(vis, occ, first, (i & -2) + 0.5 - x, (j & -2) + 0.5 - y)
    while level < top:
        width, quarter = 1 << level, ((i >> level) & 1) + 2 * ((j >> level) & 1)
        left, low = i & -width, j & -width
        border = 0.5 + min(x - left, left + width - x, y - low, low + width - y)
        if border > 0 and border * border >= best:
            break
        aside_x, aside_y = left ^ width, low ^ width
        dx, dy = _beside(x, aside_x, width) ** 2, _beside(y, aside_y, width) ** 2
        for turn in (1, 2, 3):
            child = int(~np.int64(vis[4 * path[level + 1] + (quarter ^ turn)]))
            if child >= 0 and holds[child] and dx * (turn & 1) + dy * (turn >> 1) < best:
                to_x, to_y = aside_x if turn & 1 else left, aside_y if turn & 2 else low
                best = _nearest_below(vis, occ, holds, child, to_x, to_y, level, x, y, best, todo)
        level += 1
    return best


@compiled
def _descent_square(
    vis: Counts, occ: Counts, holds: Holds, top: int, x: float, y: float, path: Whole, todo: Whole
) -> float:
    """The same by B's descent: always into the occupied child whose centre is nearest (B 4.3)."""
    best, left, low = np.inf, 0.0, 0.0
    for level in range(top - 1, -1, -1):
        half, chosen, best = 0.5 * (1 << level), -1, np.inf
        for q in range(4):
            node = 4 * path[level + 1] + q
            child = ~np.int64(vis[node])
            if holds[child] if child >= 0 else 2 * occ[node] > vis[node]:
                dx = left + half + 2 * half * (q & 1) - x
                dy = low + half + 2 * half * (q >> 1) - y
                if dx * dx + dy * dy < best:
                    best, chosen = dx * dx + dy * dy, q
        left, low = left + 2 * half * (chosen & 1), low + 2 * half * (chosen >> 1)
        path[level] = ~np.int64(vis[4 * path[level + 1] + chosen])
    return best


@compiled
def distances(
    vis: Counts,
    occ: Counts,
    holds: Holds,
    root: int,
    top: int,
    frame: Array,
    points: Array,
    poses: Array,
    exact: bool,
) -> Array:
    """Sum over points `(n, 2)` of the distance to the nearest occupied cell, at poses `(k, 3)`.

    In cells; `frame` is the corner of the root and the side of a cell.
    """
    found, path = np.zeros(len(poses)), np.empty(top + 1, np.int64)
    todo, side = np.empty((3 * top + 4, 4), np.int64), frame[2]
    path[top] = root
    for k in range(len(poses)):
        c, s = np.cos(poses[k, 2]), np.sin(poses[k, 2])
        dx, dy = poses[k, 0] - frame[0], poses[k, 1] - frame[1]
        for m in range(len(points)):
            x = (c * points[m, 0] - s * points[m, 1] + dx) / side
            y = (s * points[m, 0] + c * points[m, 1] + dy) / side
            if exact:
                found[k] += np.sqrt(_nearest_square(vis, occ, holds, top, x, y, path, todo))
            else:
                found[k] += np.sqrt(_descent_square(vis, occ, holds, top, x, y, path, todo))
    return found
