"""Loops over a whole tree: its leaves, equal children that join, grids that leaves paint."""

import numpy as np

from .._compiled import compiled
from ..arrays import Array
from ._loops import DEPTH, Cells, Counts


@compiled
def all_leaves(vis: Counts, root: int, top: int, used: int) -> Cells:
    """Node, x, y (cells) and level of every leaf, `(n, 4)`."""
    found = np.empty((3 * used + 1, 4), np.int64)
    todo = np.empty((4 * DEPTH, 4), np.int64)
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = root, 0, 0, top
    count, waiting = 0, 1
    while waiting:
        waiting -= 1
        block, x, y, level = todo[waiting]
        half = 1 << (level - 1)
        for q in range(4):
            node, at_x, at_y = 4 * block + q, x + half * (q & 1), y + half * (q >> 1)
            if vis[node] >= 0:
                row = found[count]
                row[0], row[1], row[2], row[3] = node, at_x, at_y, level - 1
                count += 1
            else:
                row = todo[waiting]
                row[0], row[1], row[2], row[3] = ~np.int64(vis[node]), at_x, at_y, level - 1
                waiting += 1
    return found[:count]


@compiled
def joined(vis: Counts, occ: Counts, root: int, used: int) -> tuple[Counts, Counts, int]:
    """The tree without squares whose four children are alike, never hit and equally often crossed.

    New arrays without gaps, and the blocks used; the root is block 0.
    """
    order, above = _parents_first(vis, root, used)
    for k in range(len(order) - 1, 0, -1):
        a = 4 * order[k]
        same = vis[a] >= 0 and occ[a] == 0
        for node in range(a + 1, a + 4):
            same = same and vis[node] == vis[a] and occ[node] == 0
        if same:
            vis[above[order[k]]] = vis[a]
            order[k] = -1
    return _compact(vis, occ, order)


@compiled
def reached(vis: Counts, occ: Counts, root: int, room: int) -> tuple[Counts, Counts, int]:
    """The tree as new arrays, of blocks `(4 room,)`, that hold what the root reaches alone.

    Also the blocks used; the root is block 0.
    """
    return _compact(vis, occ, _parents_first(vis, root, room)[0])


@compiled
def _parents_first(vis: Counts, root: int, room: int) -> tuple[Cells, Cells]:
    """Blocks that the root reaches, parents before children, and the node above each block."""
    order, above = np.empty(room, np.int64), np.full(room, -1, np.int64)
    order[0], count = root, 1
    for k in range(room):
        if k < count:
            for node in range(4 * order[k], 4 * order[k] + 4):
                if vis[node] < 0:
                    order[count] = ~np.int64(vis[node])
                    above[order[count]] = node
                    count += 1
    return order[:count], above


@compiled
def _compact(vis: Counts, occ: Counts, order: Cells) -> tuple[Counts, Counts, int]:
    """Copies of the blocks in this order, those marked -1 left out."""
    place = np.full(len(vis) // 4, -1, np.int64)
    used = 0
    for block in order:
        if block >= 0:
            place[block] = used
            used += 1
    new_vis, new_occ = np.empty(4 * used, np.int32), np.empty(4 * used, np.int32)
    for block in order:
        if block >= 0:
            for q in range(4):
                node, new = 4 * block + q, 4 * place[block] + q
                new_occ[new] = occ[node]
                new_vis[new] = vis[node] if vis[node] >= 0 else ~place[~np.int64(vis[node])]
    return new_vis, new_occ, used


@compiled
def painted(rows: int, columns: int, at: Cells, level: Cells, value: Array) -> Array:
    """Largest value of the leaves in each cell of a grid `(rows, columns)`, row 0 lowest.

    `at` are the leaves' cells `(n, 2)` in the grid, perhaps outside, `level` their sides; leaves
    below level 0 are within one cell.
    """
    grid = np.full((rows, columns), -np.inf)
    for k in range(len(at)):
        width = 1 << max(level[k], 0)
        for i in range(max(at[k, 0], 0), min(at[k, 0] + width, columns)):
            for j in range(max(at[k, 1], 0), min(at[k, 1] + width, rows)):
                grid[j, i] = max(grid[j, i], value[k])
    return grid
