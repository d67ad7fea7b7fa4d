"""Loops of the quadtree: cells found and split, each ray cast leaf by leaf (B 4.2 to 4.4).

A tree is an array of nodes in blocks of four, the children of one square. `vis[node]` of a leaf is
the number of rays that crossed it; of an inner node it is `~block` (negative), the block of its
children. Cells are counted from the root's lower left corner. `path[level]` is the block of the
square of `2^level` cells that holds the cell found last, since the next cell is mostly near; the
last of `path` is the root.

Callers bring all arrays, since each that a loop makes for itself takes long to compile.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import compiled

Counts = NDArray[np.int32]
Cells = NDArray[np.int64]
Holds = NDArray[np.bool_]
#: From one level to another.
Span = tuple[int, int]

#: Makes 64 bits of a number: numba compiles a loop anew for the literal 0, and for 32 bits.
whole: Any = np.int64
#: Levels that a path can hold: no root is larger than 2^31 cells a side.
DEPTH = 32
#: Counts stop here: one more and `vis` would turn into a place. At ten scans a second of 682 beams
#: the leaf of a robot that stands still gets there in four days.
MOST_COUNT = 2**31 - 1
#: No cell is further away than this, so that whole numbers hold it.
FARTHEST_CELL = 2.0**60


class Blocks(NamedTuple):
    """Both counts of all nodes, `(4 b,)`."""

    vis: Counts
    occ: Counts


class Scan(NamedTuple):
    """Places `(n, 2)`, metres: of the sensor, of ends of beams, and where others left its range."""

    sensor: Array
    points: Array
    free: Array


class Frame(NamedTuple):
    """Where cells lie: corner `(2,)` and resolution, metres, and the root: its cell and side."""

    corner: Array
    resolution: float
    root: Cells
    side: int


class Room(NamedTuple):
    """Room to work in: for the cells of a scan, the path, and where on its way a ray goes on."""

    cells: Cells
    path: Cells
    at: Cells


# ------------------------------------------------------------------------ single leaves
@compiled
def cells_of(points: Array, frame: Frame, cells: Cells) -> int:
    """Write the cells of points `(n, 2)`, counted from the root's, into `cells`, `(n, 2)`.

    By one division and the floor: `//` and multiplying by the inverse give others. Returns 0 where
    all lie inside the root, 1 where one lies outside, 2 where one is not finite.
    """
    fault, corner, root = 0, frame.corner, frame.root
    for k in range(len(points)):
        for i in range(2):
            at = np.floor((points[k, i] - corner[i]) / frame.resolution)
            if not abs(at) < FARTHEST_CELL:
                if not abs(points[k, i]) < np.inf:
                    fault = 2
                at = FARTHEST_CELL if at > 0 else -FARTHEST_CELL
            cells[k, i] = whole(at) - root[i]
            if fault == 0 and not 0 <= cells[k, i] < frame.side:
                fault = 1
    return fault


@compiled
def _find_leaf(
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
def leaves_at(vis: Counts, cells: Cells, path: Cells, leaves: Cells) -> None:
    """Write the leaf of each cell `(n, 2)` into `found`, `(n,)`; -1 outside the root."""
    level, x, y = len(path) - 1, whole(0), whole(0)
    side = 1 << level
    for k in range(len(cells)):
        leaves[k] = -1
        if 0 <= cells[k, 0] < side and 0 <= cells[k, 1] < side:
            leaves[k], level = _find_leaf(vis, path, level, cells[k, 0], cells[k, 1], x, y)
            x, y, level = cells[k, 0], cells[k, 1], level + 1


# ----------------------------------------------------------------------------- insertion
@compiled
def _split_leaf(
    blocks: Blocks, path: Cells, node: int, used: int, levels: Span, x: int, y: int, first: int
) -> tuple[int, int]:
    """Split a leaf about a cell from one level down to another; new leaves get `vis = first`.

    Returns the leaf that holds the cell then, and the blocks used.
    """
    (vis, occ), (level, last) = blocks, levels
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
def _insert_ends(
    blocks: Blocks, used: int, ends: int, done: int, keep: bool, room: Room
) -> tuple[int, int]:
    """Steps 1 and 2: split the leaf of each end down to a cell, and count the end there (B 4.2.2).

    Ends are `cells[1]` to `cells[ends]`. Children of a leaf `keep` its count where told to, else
    they start with 1. No split touches a cell that was counted before. Returns the blocks used and
    the cells done, from cell `done` on: it stops early where the arrays get full.
    """
    (vis, occ), cells, path, top = blocks, room.cells, room.path, len(room.path) - 1
    level, x, y = top, cells[0, 0], cells[0, 1]
    for k in range(done, ends + 1):
        if 4 * (used + top) > len(vis):
            return used, k
        node, level = _find_leaf(vis, path, level, cells[k, 0], cells[k, 1], x, y)
        x, y = cells[k, 0], cells[k, 1]
        first = whole(vis[node] if keep else 1)
        node, used = _split_leaf(blocks, path, node, used, (level, whole(0)), x, y, first)
        if (occ[node] > 0 or vis[node] == 0) and vis[node] < MOST_COUNT:  # each ray but the first
            vis[node] += 1
        if occ[node] < MOST_COUNT:
            occ[node] += 1
        level = 1
    return used, ends + 1


@compiled
def _walk_rays(
    blocks: Blocks, used: int, ends: int, done: int, least: int, room: Room
) -> tuple[int, int]:
    """Step 3: add 1 to `vis` of every leaf that holds a cell of a ray, but for the mask (B 4.4).

    Rays run from `cells[0]` to each other cell. The first `ends` of them leave out their end and
    its neighbours: of the cells that Bresenham takes, those of the last two steps along the longer
    axis. A square is entered and left once, so each leaf counts once a ray. Leaves above the level
    `least` are split first. Returns as `_insert_ends`.

    With `u` along the longer axis and `v` along the shorter, from the sensor's cell, a ray has come
    to `v = (u short + rest) // long` after `u` steps.
    """
    vis, (cells, path, at) = blocks.vis, room
    top = len(path) - 1
    level, x, y = top, cells[0, 0], cells[0, 1]
    for k in range(done, len(cells)):
        dx, dy = cells[k, 0] - cells[0, 0], cells[k, 1] - cells[0, 1]
        sign_x, sign_y = (1 if dx >= 0 else -1), (1 if dy >= 0 else -1)
        steep = abs(dy) > abs(dx)
        long, short = (abs(dy), abs(dx)) if steep else (abs(dx), abs(dy))
        last = long - 2 if k <= ends else long
        if last < 0:
            continue
        long += long == 0
        # Bresenham's loop always runs in increasing order, and of two cells as near takes the first
        forward = (sign_y if steep else sign_x) > 0
        rest = (long - 1) // 2 if forward else long // 2
        reach, u, v = last * short + rest, at[0], at[1]
        while u <= last and v * long <= reach:
            new_x = cells[0, 0] + sign_x * (v if steep else u)
            new_y = cells[0, 1] + sign_y * (u if steep else v)
            node, level = _find_leaf(vis, path, level, new_x, new_y, x, y)
            x, y = new_x, new_y
            if level > least and 4 * (used + top) > len(vis):
                at[0], at[1] = u, v
                return used, k
            if level > least:
                first = whole(vis[node])
                node, used = _split_leaf(blocks, path, node, used, (level, least), x, y, first)
                level = least
            if vis[node] < MOST_COUNT:
                vis[node] += 1
            side = whole(1) << level
            back_x = x & (side - 1) if sign_x > 0 else side - 1 - (x & (side - 1))
            back_y = y & (side - 1) if sign_y > 0 else side - 1 - (y & (side - 1))
            u_min, v_min = (u - back_y, v - back_x) if steep else (u - back_x, v - back_y)
            at_u, at_v = (u_min + side) * short + rest, (v_min + side) * long
            if at_u < at_v:
                u, v = u_min + side, at_u // long
            else:
                u, v = (at_v - rest + short - 1) // short, v_min + side
            level += 1
        at[0] = at[1] = 0
    return used, len(cells)


@compiled
def insert(
    blocks: Blocks, used: int, scan: Scan, frame: Frame, done: int, finest: int, room: Room
) -> tuple[int, int]:
    """Insert a scan.

    Rays split leaves above the level `finest`, where that is not negative. Returns the blocks used
    and how far it came, `len(scan.points) + len(cells)` in the end: with more room it goes on from
    there. -1 says that a place lies outside the root or is not finite, and nothing was done.
    """
    ends, top, cells = len(scan.points), len(room.path) - 1, room.cells
    if done == 0:
        outside = cells_of(scan.sensor, frame, cells[:1])
        outside += cells_of(scan.points, frame, cells[1 : ends + 1])
        if outside + cells_of(scan.free, frame, cells[ends + 1 :]) > 0:
            return used, -1
        done = 1
    if done <= ends:
        used, done = _insert_ends(blocks, used, ends, done, finest >= 0, room)
        if done <= ends:
            return used, done
    least = min(finest, top) if finest >= 0 else top
    used, k = _walk_rays(blocks, used, ends, done - ends, least, room)
    return used, ends + k


# ------------------------------------------------------------------------- the whole tree
@compiled
def compact(blocks: Blocks, root: int, join: bool, order: Cells, above: Cells, new: Blocks) -> int:
    """Copy the blocks that the root reaches into new arrays, parents first; returns their number.

    The root becomes block 0. Where told to `join`, squares whose four children are alike, never hit
    and equally often crossed become leaves.
    `order` and `above`, `(b,)`, are room to work in: the blocks copied, and the node above each.
    """
    (vis, occ), (new_vis, new_occ) = blocks, new
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
            new_vis[above[k]], order[k] = new_vis[first], -1
    used = 0
    for k in range(count):  # move up to where blocks that were joined lay
        if order[k] >= 0:
            for q in range(4):
                node, place = 4 * k + q, 4 * used + q
                new_vis[place], new_occ[place] = new_vis[node], new_occ[node]
            if k > 0:
                new_vis[4 * order[above[k] >> 2] + (above[k] & 3)] = ~used
            order[k] = used
            used += 1
    return used


@compiled
def occupied_blocks(vis: Counts, occ: Counts, holds: Holds) -> None:
    """Mark in `holds`, `(b,)`, the blocks with an occupied cell, themselves or below.

    Most blocks come before those below them; roots that were doubled do not, and take another turn.
    """
    changed = True
    while changed:
        changed = False
        for block in range(len(holds) - 1, -1, -1):
            for node in range(4 * block, 4 * block + 4):
                child = ~whole(vis[node])
                full = holds[child] if child >= 0 else 2 * whole(occ[node]) > vis[node]
                if full and not holds[block]:
                    holds[block] = changed = True


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
