"""Loops of the quadtree: cells found and split, rays walked leaf by leaf (B 4.2 to 4.4).

A tree is an array of nodes in blocks of four, the children of one square. `vis[node]` of a leaf is
the number of rays that crossed it; of an inner node it is `~block` (negative), the block of its
children. Cells are counted from the root's lower left corner. `path[level]` is the block of the
square of `2^level` cells that holds the cell found last, since the next cell is mostly near; the
last of `path` is the root.

Callers bring all arrays, since each that a loop makes for itself takes long to compile.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import compiled

Counts = NDArray[np.int32]
Cells = NDArray[np.int64]
Holds = NDArray[np.bool_]

#: Makes 64 bits of a number: numba compiles a loop anew for the literal 0, and for 32 bits.
whole: Any = np.int64
#: Levels that a path can hold: no root is larger than 2^31 cells a side.
DEPTH = 32
#: Counts stop here: one more and `vis` would turn into a place. At ten scans a second of 682 beams
#: the leaf of a robot that stands still gets there in four days.
MOST = 2**31 - 1
#: No cell is further away than this, so that whole numbers hold it.
FAR = 2.0**60


# ------------------------------------------------------------------------ single leaves
@compiled
def cells_of(
    points: Array, corner: Array, resolution: float, root: Cells, side: int, cells: Cells
) -> int:
    """Write the cells of points `(n, 2)`, counted from the root's, into `cells`, `(n, 2)`.

    By one division and the floor: `//` and multiplying by the inverse give others. Returns 0 where
    all lie inside the root, 1 where one lies outside, 2 where one is not finite.
    """
    found = 0
    for k in range(len(points)):
        for i in range(2):
            at = np.floor((points[k, i] - corner[i]) / resolution)
            if not abs(at) < FAR:
                if not abs(points[k, i]) < np.inf:
                    found = 2
                at = FAR if at > 0 else -FAR
            cells[k, i] = whole(at) - root[i]
            if found == 0 and not 0 <= cells[k, i] < side:
                found = 1
    return found


@compiled
def _find(
    vis: Counts, path: Cells, level: int, x: int, y: int, last_x: int, last_y: int
) -> tuple[int, int]:
    """Leaf that holds a cell, and the level of its side.

    The search begins at the smallest square, from `level` up, that holds the last cell too.
    """
    differ = (x ^ last_x) | (y ^ last_y)
    while differ >> level:
        level += 1
    block = path[level]
    while True:
        level -= 1
        node = 4 * block + ((x >> level) & 1) + 2 * ((y >> level) & 1)
        block = ~whole(vis[node])
        if block < 0:
            return node, level
        path[level] = block


@compiled
def leaves_at(vis: Counts, cells: Cells, path: Cells, found: Cells) -> None:
    """Write the leaf of each cell `(n, 2)` into `found`, `(n,)`; -1 outside the root."""
    level, x, y = len(path) - 1, whole(0), whole(0)
    side = 1 << level
    for k in range(len(cells)):
        found[k] = -1
        if 0 <= cells[k, 0] < side and 0 <= cells[k, 1] < side:
            found[k], level = _find(vis, path, level, cells[k, 0], cells[k, 1], x, y)
            x, y, level = cells[k, 0], cells[k, 1], level + 1


# ----------------------------------------------------------------------------- insertion
@compiled
def _split(
    vis: Counts,
    occ: Counts,
    path: Cells,
    node: int,
    used: int,
    level: int,
    last: int,
    x: int,
    y: int,
    first: int,
) -> tuple[int, int]:
    """Split a leaf about a cell down to level `last`; new leaves start with `vis = first`.

    Returns the leaf that holds the cell then, and the blocks used.
    """
    while level > last:
        for child in range(4 * used, 4 * used + 4):
            vis[child], occ[child] = first, 0
        vis[node], occ[node] = ~used, 0
        path[level] = used
        level -= 1
        node = 4 * used + ((x >> level) & 1) + 2 * ((y >> level) & 1)
        used += 1
    return node, used


@compiled
def insert_ends(
    vis: Counts, occ: Counts, used: int, cells: Cells, ends: int, done: int, keep: bool, path: Cells
) -> tuple[int, int]:
    """Steps 1 and 2: split the leaf of each end down to a cell, and count the end there (B 4.2.2).

    Ends are `cells[1]` to `cells[ends]`. Children of a leaf `keep` its count where told to, else
    they start with 1. No split touches a cell that was counted before. Returns the blocks used and
    the cells done, from cell `done` on: it stops early where the arrays get full.
    """
    top = len(path) - 1
    level, x, y = top, cells[0, 0], cells[0, 1]
    for k in range(done, ends + 1):
        if 4 * (used + top) > len(vis):
            return used, k
        node, level = _find(vis, path, level, cells[k, 0], cells[k, 1], x, y)
        x, y = cells[k, 0], cells[k, 1]
        first = whole(vis[node] if keep else 1)
        node, used = _split(vis, occ, path, node, used, level, whole(0), x, y, first)
        if (occ[node] > 0 or vis[node] == 0) and vis[node] < MOST:  # each ray but the first
            vis[node] += 1
        if occ[node] < MOST:
            occ[node] += 1
        level = 1
    return used, ends + 1


@compiled
def walk_rays(
    vis: Counts, occ: Counts, used: int, cells: Cells, ends: int, done: int, least: int, path: Cells
) -> tuple[int, int]:
    """Step 3: add 1 to `vis` of every leaf that holds a cell of a ray, but for the mask (B 4.4).

    Rays run from `cells[0]` to each other cell. The first `ends` of them leave out their end and
    its neighbours: of the cells that Bresenham takes, those of the last two steps along the longer
    axis. A square is entered and left once, so each leaf counts once a ray. With a level `least`
    below the root's, leaves above it are split instead, and nothing is counted. Returns as
    `insert_ends`.
    """
    top = len(path) - 1
    level, x, y, add = top, cells[0, 0], cells[0, 1], least >= top
    for k in range(done, len(cells)):
        dx, dy = cells[k, 0] - cells[0, 0], cells[k, 1] - cells[0, 1]
        sign_x, sign_y = (1 if dx >= 0 else -1), (1 if dy >= 0 else -1)
        steep = abs(dy) > abs(dx)
        long, short = (abs(dy), abs(dx)) if steep else (abs(dx), abs(dy))
        last = long - 2 if k <= ends else long
        # after n steps along the longer side `(n short + rest) // long` along the shorter are made
        long += long == 0
        half = (long - 1) // 2  # Bresenham's loop always runs in increasing order
        rest = half if (dy if steep else dx) > 0 else long - 1 - half
        step, across = whole(0), whole(0)
        while step <= last:
            new_x = cells[0, 0] + sign_x * (across if steep else step)
            new_y = cells[0, 1] + sign_y * (step if steep else across)
            node, level = _find(vis, path, level, new_x, new_y, x, y)
            x, y = new_x, new_y
            if level > least:
                if 4 * (used + top) > len(vis):
                    return used, k
                first = whole(vis[node])
                node, used = _split(vis, occ, path, node, used, level, least, x, y, first)
                level = least
            if vis[node] < MOST:
                vis[node] += add
            # cells to the first beyond the leaf, along both axes
            mask = (1 << level) - 1
            to_x = mask + 1 - (x & mask) if sign_x > 0 else (x & mask) + 1
            to_y = mask + 1 - (y & mask) if sign_y > 0 else (y & mask) + 1
            along, aside = (to_y, to_x) if steep else (to_x, to_y)
            reach = (step + along) * short + rest
            if reach < (across + aside) * long:
                step, across = step + along, reach // long
            else:
                across += aside
                step = (across * long - rest + short - 1) // short
            level += 1
    return used, len(cells)


# ------------------------------------------------------------------------- the whole tree
@compiled
def leaves_in(
    vis: Counts, occ: Counts, holds: Holds, window: Cells, todo: Cells, found: Cells
) -> int:
    """Write node, x, y (cells) and level of the leaves in a window into `found`, `(n, 4)`.

    All of them, or where blocks that hold an occupied cell are marked in `holds`, `(b,)`, occupied
    cells alone. `window` is left, low, right and high; `todo`, `(4 DEPTH, 4)`, is room to work in,
    its first row holds the root. Returns the number of leaves.
    """
    count, waiting, every = 0, 1, len(holds) == 0
    while waiting > 0:
        waiting -= 1
        block, x, y = todo[waiting, 0], todo[waiting, 1], todo[waiting, 2]
        level = todo[waiting, 3] - 1
        side = 1 << level
        for q in range(4):
            at_x, at_y = x + side * (q & 1), y + side * (q >> 1)
            if at_x >= window[2] or at_y >= window[3]:
                continue
            if at_x + side <= window[0] or at_y + side <= window[1]:
                continue
            node = 4 * block + q
            child = ~whole(vis[node])
            if child >= 0 and (every or holds[child]):
                todo[waiting, 0], todo[waiting, 1] = child, at_x
                todo[waiting, 2], todo[waiting, 3] = at_y, level
                waiting += 1
            elif child < 0 and (every or 2 * whole(occ[node]) > vis[node]):
                found[count, 0], found[count, 1] = node, at_x
                found[count, 2], found[count, 3] = at_y, level
                count += 1
    return count


@compiled
def compact(
    vis: Counts,
    occ: Counts,
    root: int,
    join: bool,
    order: Cells,
    above: Cells,
    new_vis: Counts,
    new_occ: Counts,
) -> int:
    """Copy the blocks that the root reaches into new arrays, parents first; returns their number.

    The root becomes block 0. Where told to `join`, squares whose four children are alike, never hit
    and equally often crossed become leaves; their blocks stay for the next call to leave out.
    `order` and `above`, `(b,)`, are room to work in: the blocks copied, and the node above each.
    """
    order[0], count, k = root, 1, 0
    while k < count:
        for q in range(4):
            node = 4 * order[k] + q
            child = ~whole(vis[node])
            new_vis[4 * k + q], new_occ[4 * k + q] = vis[node], occ[node]
            if child >= 0:
                new_vis[4 * k + q] = ~count
                order[count], above[count] = child, 4 * k + q
                count += 1
        k += 1
    for k in range(count - 1, 0 if join else count, -1):
        first = 4 * k
        same = new_vis[first] >= 0 and new_occ[first] == 0
        for node in range(first + 1, first + 4):
            same = same and new_vis[node] == new_vis[first] and new_occ[node] == 0
        if same:
            new_vis[above[k]] = new_vis[first]
    return count


@compiled
def occupied_blocks(vis: Counts, occ: Counts, order: Cells, holds: Holds) -> None:
    """Mark in `holds`, `(b,)`, the blocks with an occupied cell, themselves or below.

    `order`, `(b,)`, has each block after those below it.
    """
    for block in order:
        for node in range(4 * block, 4 * block + 4):
            child = ~whole(vis[node])
            if holds[child] if child >= 0 else 2 * whole(occ[node]) > vis[node]:
                holds[block] = True


@compiled
def paint(first: Cells, last: Cells, value: Array, grid: Array) -> None:
    """Raise cells of a grid `(rows, columns)` to values `(n,)`, from cell x, y to before another.

    Cells `first` and `last`, `(n, 2)`, lie within the grid.
    """
    for k in range(len(value)):
        for j in range(first[k, 1], last[k, 1]):
            for i in range(first[k, 0], last[k, 0]):
                if value[k] > grid[j, i]:
                    grid[j, i] = value[k]
