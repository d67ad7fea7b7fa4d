"""Loops of the quadtree: cells found and split, rays walked leaf by leaf (B 4.2 to 4.4).

A tree is an array of nodes in blocks of four, the children of one square. `vis[node]` of a leaf is
the number of rays that crossed it; of an inner node it is `~block` (negative), the block of its
children. Cells are counted from the root's lower left corner. `path[level]` is the block of the
square of `2^level` cells that holds the cell found last: the next cell is mostly near.
"""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

Counts = NDArray[np.int32]
Cells = NDArray[np.int64]

#: Levels that a path can hold: no root is larger than 2^31 cells a side.
DEPTH = 32
#: Counts stop here: one more and `vis` would turn into a place. At ten scans a second of 682 beams
#: the leaf of a robot that stands still gets there in four days.
MOST = 2**31 - 1
#: No cell is further away than this, so that whole numbers hold it.
FAR = 2.0**60


@compiled
def cells_of(
    points: Array, corner: Array, resolution: float, root: Cells, side: int
) -> tuple[Cells, bool, bool]:
    """Cells of points `(n, 2)` counted from the root's; whether all are finite, and inside it.

    One division and then the floor: `//` and multiplying by the inverse give other cells.
    """
    cells, finite, inside = np.empty(points.shape, np.int64), True, True
    for k in range(len(points)):
        for i in range(2):
            away = points[k, i] - corner[i]
            if abs(away) < FAR * resolution:
                at = np.int64(np.floor(away / resolution)) - root[i]
            else:
                at = np.int64(FAR if away > 0 else -FAR)
                finite = finite and np.isfinite(away)
            inside = inside and 0 <= at < side
            cells[k, i] = at
    return cells, finite, inside


@compiled
def _common(x: int, y: int, other_x: int, other_y: int, level: int) -> int:
    """Level, from this one up, of the smallest square that holds both cells."""
    differ = (x ^ other_x) | (y ^ other_y)
    while differ >> level:
        level += 1
    return level


@compiled
def _descend(vis: Counts, path: Cells, level: int, x: int, y: int) -> tuple[int, int]:
    """Leaf that holds a cell, and the level of its side, from the block `path[level]` down."""
    block = path[level]
    while True:
        level -= 1
        node = 4 * block + ((x >> level) & 1) + 2 * ((y >> level) & 1)
        if vis[node] >= 0:
            return node, level
        block = ~np.int64(vis[node])
        path[level] = block


@compiled
def _split_down(
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
) -> tuple[int, int, int]:
    """Split a leaf about a cell down to level `last`; new leaves start with `vis = first`."""
    while level > last:
        for child in range(4 * used, 4 * used + 4):
            vis[child], occ[child] = first, 0
        vis[node], occ[node] = ~used, 0
        path[level] = used
        level -= 1
        node = 4 * used + ((x >> level) & 1) + 2 * ((y >> level) & 1)
        used += 1
    return node, level, used


@compiled
def split_to_cells(
    vis: Counts, occ: Counts, used: int, root: int, top: int, cells: Cells, done: int, inherit: bool
) -> tuple[int, int]:
    """Split the leaves of cells `(n, 2)` down to single cells (B 4.2.2), from cell `done` on.

    Returns the blocks used and the cells done: it stops early where the arrays get full.
    """
    path = np.zeros(DEPTH, np.int64)
    path[top] = root
    level, x, y = top, 0, 0
    for k in range(done, len(cells)):
        if 4 * (used + top) > len(vis):
            return used, k
        level = _common(x, y, cells[k, 0], cells[k, 1], level)
        x, y = cells[k, 0], cells[k, 1]
        node, level = _descend(vis, path, level, x, y)
        first = vis[node] if inherit else 1
        node, level, used = _split_down(vis, occ, path, node, used, level, 0, x, y, first)
        level += 1
    return used, len(cells)


@compiled
def count_ends(vis: Counts, occ: Counts, root: int, top: int, cells: Cells) -> None:
    """Count end points in their cells, and the ray of each where it is not the cell's first.

    Cells `(n, 2)` are counted from the lower left one of the root.
    """
    path = np.zeros(DEPTH, np.int64)
    path[top] = root
    level, x, y = top, 0, 0
    for k in range(len(cells)):
        level = _common(x, y, cells[k, 0], cells[k, 1], level)
        x, y = cells[k, 0], cells[k, 1]
        node, level = _descend(vis, path, level, x, y)
        if occ[node] > 0 or vis[node] == 0:
            vis[node] = min(vis[node], MOST - 1) + 1
        occ[node] = min(occ[node], MOST - 1) + 1
        level += 1


@compiled
def walk_rays(
    vis: Counts,
    occ: Counts,
    used: int,
    root: int,
    top: int,
    sensor: Cells,
    ends: Cells,
    done: int,
    masked: int,
    largest: int,
    add: int,
) -> tuple[int, int]:
    """Add to `vis` of every leaf that holds a cell of a ray, but for its last `masked` steps (B
    4.4).

    The sensor's cell, (2,) int array, and the ends', `(n, 2)`, are counted from the root's corner.
    Of the cells that Bresenham takes, the end's and its neighbours are those of the last two steps
    along the longer axis. A square is entered and left once, so each leaf counts once a ray. Leaves
    above level `largest` are split on the way, handing their counts on. Returns the blocks used and
    the rays done, from ray `done` on: it stops early where the arrays get full.
    """
    path = np.zeros(DEPTH, np.int64)
    path[top] = root
    level, x, y = top, sensor[0], sensor[1]
    for k in range(done, len(ends)):
        dx, dy = ends[k, 0] - sensor[0], ends[k, 1] - sensor[1]
        long, short, steep, rest = _slope_of(dx, dy)
        last = max(abs(dx), abs(dy)) - masked
        sign_x, sign_y = (1 if dx >= 0 else -1), (1 if dy >= 0 else -1)
        step, across = 0, 0
        while step <= last:
            new_x = sensor[0] + sign_x * (across if steep else step)
            new_y = sensor[1] + sign_y * (step if steep else across)
            level = _common(x, y, new_x, new_y, level)
            x, y = new_x, new_y
            node, level = _descend(vis, path, level, x, y)
            if level > largest:
                if 4 * (used + top) > len(vis):
                    return used, k
                node, level, used = _split_down(
                    vis, occ, path, node, used, level, largest, x, y, vis[node]
                )
            vis[node] = min(vis[node], MOST - add) + add
            to_x, to_y = _room_ahead(x, sign_x, level), _room_ahead(y, sign_y, level)
            along, aside = (to_y, to_x) if steep else (to_x, to_y)
            step, across = _beyond(step, across, along, aside, long, short, rest)
            level += 1
    return used, len(ends)


@compiled
def _beyond(
    step: int, across: int, along: int, aside: int, long: int, short: int, rest: int
) -> tuple[int, int]:
    """The first step past the end of a leaf `along` steps ahead, or past its side `aside` across.

    Also how many steps across are made by then.
    """
    reach = (step + along) * short + rest
    if reach < (across + aside) * long:
        return step + along, reach // long
    across += aside
    return (across * long - rest + short - 1) // short, across


@compiled
def _slope_of(dx: int, dy: int) -> tuple[int, int, bool, int]:
    """Longer and shorter side of a ray, whether y is the longer, and what rounds its steps.

    After k steps along the longer side, `(k short + rest) // long` along the shorter are made, from
    either end: Bresenham's loop always runs in increasing order.
    """
    steep = abs(dy) > abs(dx)
    long, short = max(abs(dx), abs(dy), 1), min(abs(dx), abs(dy))
    half = (long - 1) // 2
    return long, short, steep, half if (dy if steep else dx) > 0 else long - 1 - half


@compiled
def _room_ahead(at: int, sign: int, level: int) -> int:
    """Cells from this one, in a direction, to the first beyond its square of `2^level` cells."""
    inside = at & ((1 << level) - 1)
    return (1 << level) - inside if sign > 0 else inside + 1


@compiled
def leaves_at(vis: Counts, root: int, top: int, cells: Cells) -> Cells:
    """Leaf of each cell `(n, 2)`; -1 outside the root."""
    path = np.zeros(DEPTH, np.int64)
    path[top] = root
    side, level, x, y = 1 << top, top, 0, 0
    found = np.full(len(cells), -1, np.int64)
    for k in range(len(cells)):
        if 0 <= cells[k, 0] < side and 0 <= cells[k, 1] < side:
            level = _common(x, y, cells[k, 0], cells[k, 1], level)
            x, y = cells[k, 0], cells[k, 1]
            found[k], level = _descend(vis, path, level, x, y)
            level += 1
    return found
