"""Correlative search: the poses of a window, or of a whole map, at which a scan lies best.

Every pose on a lattice of cells and headings counts (Olson 2009); blocks of them are left out by
the most that one of their poses can score: branch and bound (Hess et al. 2016).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled

Levels = NDArray[np.uint8]
Cells = NDArray[np.int32]
Indices = NDArray[np.int64]

#: After so many points a sum is given up where the rest cannot lift it to what is asked. Loops of a
#: length that is known beforehand take a quarter of the time.
POINTS_PER_CHUNK = 8
#: Blocks that are searched between two checks for Control-C.
BLOCKS_PER_CALL = 2**20
#: Cells are counted no farther than this from the first one: more than any map has.
FARTHEST_SCAN_CELL = 2.0**20


class Lattice(NamedTuple):
    """The cells of a map, those of a scan, and the poses to try: all shifts at each heading."""

    levels: Levels  # (l, rows * columns) likelihoods, 0 to 255; their maxima over 2, 4, ... cells
    columns: int
    rows: int
    inside: NDArray[np.uint32]  # (h, n) cells before any shift, where no shift leaves the map:
    #                             known not to be negative, four times as fast an index
    edge: Cells  # (h, n, 2) columns and rows of the other points that may lie on the map
    counts: Indices  # (h, 2) how many of each there are
    east: int  # so many shifts along x, by 0, 1, ... cells
    north: int
    heading_cost: Array  # (h,) what a heading costs, in likelihoods
    shift_cost: float  # what a shift by one cell from the middle costs; by d cells, d^2 times this


class BestPoses(NamedTuple):
    """What a search found: rows of score, heading, and shift in columns and rows."""

    rows: Array  # (k, 4)
    looked: int  # how many blocks were looked into
    overflow: bool  # whether more poses score as much than there is room for


def lattice(
    levels: Levels,
    points: Array,
    start: Array,
    step: float,
    size: float,
    east: int,
    north: int,
    heading_cost: Array,
    shift_cost: float = 0.0,
) -> Lattice:
    """A scan's points `(n, 2)`, metres, on levels `(l, rows, columns)` of cells of a size, metres.

    The start `(3,)`, metres and radians from the corner of the first cell, has the middle heading
    and no shift; a step lies between two headings. The levels begin and end in zeros: as many as
    the widest maximum covers before the first cell, and one row and column behind the last.
    """
    shape, (_, rows, columns) = (len(heading_cost), len(points)), levels.shape
    room = np.empty(shape, np.uint32), np.empty((*shape, 2), np.int32), np.empty((shape[0], 2), int)
    flat = levels.reshape(len(levels), -1)
    lattice = Lattice(flat, columns, rows, *room, east, north, heading_cost, shift_cost)
    lay_out(lattice, np.ascontiguousarray(points.T), start, step, size)
    return lattice


def best_poses(lattice: Lattice, least: float, slack: float, room: int) -> BestPoses:
    """Poses that score `least` or more, and at most `slack` below the best, in likelihoods.

    With a slack below 0 a pose must be so much better than those found before: only one is kept.
    At most `room` poses are found.
    """
    headings, top = np.arange(len(lattice.counts)), len(lattice.levels) - 1
    across, up = -(-lattice.east >> top), -(-lattice.north >> top)
    state, poses, middle = np.array([least, 0, 0, 0]), np.empty((room, 4)), len(headings) // 2
    for part in (headings[middle : middle + 1], np.delete(headings, middle)):
        bound = np.empty((len(part) * across * up, 4))
        count = bound_first_blocks(lattice, part, across, up, max(state[0] - slack, least), bound)
        first = bound[np.argsort(-bound[:count, 0], kind="stable")]
        state[2], state[3] = 0, state[3] + len(bound)
        while state[2] < len(first) and state[1] <= room:
            branch_and_bound(lattice, first, least, slack, state, poses)
    best = poses[: int(state[1])]
    best = best[best[:, 0] >= state[0] - max(slack, 0)]
    return BestPoses(best, int(state[3]), state[1] > room)


# ---------------------------------------------------------------------------------- loops
@compiled
def stamp_points(cells: Levels, points: Array, corner: Array, size: float, stamp: Levels) -> None:
    """Lay a stamp on each of the points `(n, 2)`, metres: the most of all counts in a cell.

    Cells `(rows, columns)` of so many metres begin at the corner `(2,)`; a stamp, (s, s) array, s
    odd, has its only maximum in the middle, and lies inside of them.
    """
    half = len(stamp) // 2
    for k in range(len(points)):
        i, j = int((points[k, 0] - corner[0]) / size), int((points[k, 1] - corner[1]) / size)
        if cells[j, i] < stamp[half, half]:  # else a point lies there already
            for b in range(len(stamp)):
                for a in range(len(stamp)):
                    at = j + b - half, i + a - half
                    cells[at] = max(cells[at], stamp[b, a])


@compiled
def fill_maxima(levels: Levels, columns: int) -> None:
    """Write levels `(l, rows * columns)` from the second on: the most of 2, 4, ... cells a side."""
    for level in range(len(levels) - 1):
        right, up = 1 << level, columns << level  # each cell, and those so much farther in both
        here, wide = levels[level], levels[level + 1]
        beside, above, across = here[right:], here[up:], here[up + right :]
        for k in range(len(across)):
            wide[k] = max(max(here[k], beside[k]), max(above[k], across[k]))
        for k in range(len(across), len(here)):
            wide[k] = max(here[k], here[min(k + right, len(here) - 1)])


@compiled
def lay_out(lattice: Lattice, points: Array, start: Array, step: float, size: float) -> None:
    """Write the cells of points `(2, n)`, metres, at each heading: see `lattice`."""
    column, row = np.empty(points.shape[1], np.int32), np.empty(points.shape[1], np.int32)
    columns, rows, east, north = lattice.columns, lattice.rows, lattice.east, lattice.north
    for h in range(len(lattice.counts)):
        heading = start[2] + (h - len(lattice.counts) // 2) * step
        c, s = math.cos(heading), math.sin(heading)
        for k in range(points.shape[1]):  # without a branch: SIMD
            x = (c * points[0, k] - s * points[1, k] + start[0]) / size
            y = (s * points[0, k] + c * points[1, k] + start[1]) / size
            column[k] = math.floor(min(max(x, -FARTHEST_SCAN_CELL), FARTHEST_SCAN_CELL))
            row[k] = math.floor(min(max(y, -FARTHEST_SCAN_CELL), FARTHEST_SCAN_CELL))
        inside = edge = 0
        for k in range(points.shape[1]):
            i, j = column[k], row[k]
            if 0 <= i <= columns - east and 0 <= j <= rows - north:
                lattice.inside[h, inside] = j * columns + i
                inside += 1
            elif -east < i < columns and -north < j < rows:
                lattice.edge[h, edge, 0], lattice.edge[h, edge, 1] = i, j
                edge += 1
        lattice.counts[h, 0], lattice.counts[h, 1] = inside, edge


@compiled
def bound_blocks(
    lattice: Lattice,
    level: int,
    h: int,
    i: int,
    j: int,
    across: int,
    up: int,
    need: float,
    most: Array,
) -> None:
    """Write the most that a pose of each block scores, but for its shift; -inf if below `need`.

    So many blocks of `2^level` cells a side lie side by side, and so many rows of them one above
    the other, from column i and row j on.
    """
    values, cells, edge = lattice.levels[level], lattice.inside[h], lattice.edge[h]
    count, beside, cost = lattice.counts[h, 0], lattice.counts[h, 1], lattice.heading_cost[h]
    last_x, last_y = lattice.columns - 1, lattice.rows - 1
    for block in range(across * up):
        a, b = i + (block % across << level), j + (block // across << level)
        here, total, begin, rest = values[b * lattice.columns + a :], 0, 0, 255 * (count + beside)
        while begin + POINTS_PER_CHUNK <= count and total + rest >= need + cost:
            for k in range(POINTS_PER_CHUNK):
                total += int(here[cells[begin + k]])
            begin, rest = begin + POINTS_PER_CHUNK, rest - 255 * POINTS_PER_CHUNK
        if total + rest >= need + cost:
            for k in range(begin, count):
                total += int(here[cells[k]])
            begin, rest = 0, 255 * beside
        while begin < beside and total + rest >= need + cost:
            for k in range(begin, min(begin + POINTS_PER_CHUNK, beside)):
                x, y = min(max(edge[k, 0] + a, 0), last_x), min(max(edge[k, 1] + b, 0), last_y)
                total += int(values[np.uint64(y * lattice.columns + x)])
            begin, rest = begin + POINTS_PER_CHUNK, rest - 255 * POINTS_PER_CHUNK
        most[block] = total - cost if total >= need + cost else -np.inf


@compiled
def bound_first_blocks(
    lattice: Lattice, headings: Indices, across: int, up: int, need: float, blocks: Array
) -> int:
    """Write the most that each of the first blocks scores, if not below `need`; how many these are.

    Rows of 4: score, heading, and the column and row that a block begins with.
    """
    top, most, count = len(lattice.levels) - 1, np.empty(across * up), 0
    for h in headings:
        bound_blocks(lattice, top, h, 0, 0, across, up, need, most)
        for block in range(across * up):
            if most[block] >= need:
                blocks[count, 0], blocks[count, 1] = most[block], h
                blocks[count, 2], blocks[count, 3] = block % across << top, block // across << top
                count += 1
    return count


@compiled
def branch_and_bound(
    lattice: Lattice, blocks: Array, least: float, slack: float, state: Array, poses: Array
) -> None:
    """Write the poses of the first blocks, the best first, that score near the best.

    Blocks and poses are rows of 4: score, heading, column and row. `state` holds the best score,
    how many poses there are (one more than there is room for: they are too many), how many of the
    first blocks are done, and how many blocks were looked into: a call ends soon after
    `BLOCKS_PER_CALL`.
    """
    top, looked, most = len(lattice.levels) - 1, 0, np.empty(4)
    todo, value = np.empty((3 * top + 4, 3), np.int64), np.empty(3 * top + 4)
    best, count, at = state[0], int(state[1]), int(state[2])
    while at < len(blocks) and looked < BLOCKS_PER_CALL and count <= len(poses):
        need = max(best - slack, least)
        if blocks[at, 0] < need:
            at = len(blocks)
            break
        value[0], h, todo[0, 0] = blocks[at, 0], int(blocks[at, 1]), top
        todo[0, 1], todo[0, 2] = int(blocks[at, 2]), int(blocks[at, 3])
        used, at = 1, at + 1
        while used:
            used -= 1
            level, i, j = todo[used, 0], todo[used, 1], todo[used, 2]
            if level == 0:
                away = (i - lattice.east // 2) ** 2 + (j - lattice.north // 2) ** 2
                value[used] -= lattice.shift_cost * away
            if value[used] < need:
                continue
            if level == 0:
                count = drop_below(poses, count, need) if count == len(poses) else count
                if count == len(poses):
                    count += 1
                    break
                poses[count, 0], poses[count, 1] = value[used], h
                poses[count, 2], poses[count, 3] = i, j
                best, count = max(best, value[used]), count + 1
                need = max(best - slack, least)
                continue
            half, first = 1 << (level - 1), used
            across, up = 1 + (i + half < lattice.east), 1 + (j + half < lattice.north)
            bound_blocks(lattice, level - 1, h, i, j, across, up, need, most)
            looked += across * up
            for q in range(across * up):
                a, b, m = i + half * (q % across), j + half * (q // across), used
                if most[q] < need:
                    continue
                while m > first and value[m - 1] > most[q]:  # ascending: the best is taken first
                    for k in range(3):
                        todo[m, k] = todo[m - 1, k]
                    value[m] = value[m - 1]
                    m -= 1
                todo[m, 0], todo[m, 1], todo[m, 2], value[m] = level - 1, a, b, most[q]
                used += 1
    state[0], state[1], state[2], state[3] = best, count, at, state[3] + looked


@compiled
def drop_below(poses: Array, count: int, need: float) -> int:
    """Move the poses that score enough to the front; how many these are."""
    end = 0
    for k in range(count):
        if poses[k, 0] >= need:
            for m in range(4):
                poses[end, m] = poses[k, m]
            end += 1
    return end
