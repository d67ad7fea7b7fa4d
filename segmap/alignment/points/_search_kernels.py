"""Kernels of the correlative search: the pose of a window at which a scan lies best on a map.

Olson (2009), with the branch and bound of Hess et al. (2016).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled

Levels = NDArray[np.uint8]
Cells = NDArray[np.uint32]  # known not to be negative: four times as fast an index
Indices = NDArray[np.int64]

#: After so many points a sum is given up where the rest cannot lift it above what is asked. Loops
#: of a length that is known beforehand take a quarter of the time.
POINTS_PER_CHUNK = 8
#: No sum.
NO_SUM = -1


class Likelihoods(NamedTuple):
    """Likelihoods of square cells, then their maxima over 2, 4, 8, ... cells a side."""

    levels: Levels  # (l, columns * rows): cell (i, j) is i * rows + j
    columns: int
    rows: int
    size: float  # side of a cell, metres


class Headings(NamedTuple):
    """The cells of a scan at each heading in the lowest corner of a window.

    Most lie inside of the map all over the window.
    """

    inside: Cells  # (h, n): cells, where no shift of the window leaves the map
    edge: NDArray[np.int32]  # (h, n, 2): columns and rows of the others that may lie on the map
    counts: Indices  # (h, 2): how many of each there are


@compiled
def fill_levels(
    levels: Levels, rows: int, points: Array, x: float, y: float, size: float, stamp: Levels
) -> None:
    """Write the likelihoods about points `(n, 2)`, metres, and their maxima, level by level.

    Cells of so many metres begin at the corner (x, y). On each point a stamp is laid, (s, s) array,
    s odd, with its only maximum in the middle: it is inside of the first level. There are more
    empty rows below than the widest maximum covers, and one row and one column above.
    """
    first, half = levels[0], len(stamp) // 2
    for k in range(len(points)):
        i, j = int((points[k, 0] - x) / size), int((points[k, 1] - y) / size)
        if first[i * rows + j] < stamp[half, half]:  # else a point lies there already
            for a in range(len(stamp)):
                begin = (i + a - half) * rows + j - half
                for b in range(len(stamp)):
                    first[begin + b] = max(first[begin + b], stamp[a, b])
    for level in range(len(levels) - 1):
        up, right = 1 << level, rows << level  # each cell, and those so much farther in both
        here, wide = levels[level], levels[level + 1]
        above, beside, across = here[up:], here[right:], here[up + right :]
        for k in range(len(across)):
            wide[k] = max(max(here[k], above[k]), max(beside[k], across[k]))
        for k in range(len(across), len(here)):
            wide[k] = max(here[k], here[min(k + up, len(here) - 1)])


@compiled
def _lay_out(
    map: Likelihoods, points: Array, start: Array, step: float, radius: int, found: Headings
) -> None:
    """Write the cells of a scan's points `(2, n)`, metres, at all headings about a start `(3,)`.

    The start is in the frame of the map's corner; a step between headings is in radians. Points
    that lie off the map wherever the window of `radius` cells moves them are left out.
    """
    x, y, at_x, at_y = points[0], points[1], start[0], start[1]
    column, row = np.empty(len(x), np.int32), np.empty(len(x), np.int32)
    for h in range(len(found.inside)):
        heading = start[2] + (h - len(found.inside) // 2) * step
        c, s = math.cos(heading), math.sin(heading)
        for k in range(len(x)):  # without a branch: SIMD
            column[k] = math.floor((c * x[k] - s * y[k] + at_x) / map.size)
            row[k] = math.floor((s * x[k] + c * y[k] + at_y) / map.size)
        inside = edge = 0
        for k in range(len(x)):
            i, j = column[k] - radius, row[k] - radius
            if 0 <= i < map.columns - 2 * radius and 0 <= j < map.rows - 2 * radius:
                found.inside[h, inside] = i * map.rows + j
                inside += 1
            elif -2 * radius <= i < map.columns and -2 * radius <= j < map.rows:
                found.edge[h, edge, 0], found.edge[h, edge, 1] = i, j
                edge += 1
        found.counts[h, 0], found.counts[h, 1] = inside, edge


@compiled
def _sums(
    map: Likelihoods,
    level: int,
    scan: Headings,
    h: int,
    i: int,
    j: int,
    side: int,
    radius: int,
    least: float,
    totals: Indices,
) -> None:
    """Write sums of likelihoods, 255 each, under scan h moved to each block of a square at (i, j).

    The square has `side` blocks of `2^level` cells a side; NO_SUM where a sum is not above `least`,
    or the block is not in the window. Outside of the map likelihoods are 0.
    """
    cells, edge = scan.inside[h], scan.edge[h]
    count, beside = scan.counts[h, 0], scan.counts[h, 1]
    for block in range(side * side):
        a, b = i + (block // side << level), j + (block % side << level)
        totals[block] = NO_SUM
        if a > 2 * radius or b > 2 * radius:
            continue
        here = map.levels[level, a * map.rows + b :]
        total, begin, left = 0, 0, 255 * (count + beside)
        while begin + POINTS_PER_CHUNK <= count and total + left > least:
            for k in range(POINTS_PER_CHUNK):
                total += int(here[cells[begin + k]])
            left -= 255 * POINTS_PER_CHUNK
            begin += POINTS_PER_CHUNK
        if total + left <= least:
            continue
        for k in range(begin, count):
            total += int(here[cells[k]])
        for k in range(beside):
            x, y = edge[k, 0] + a, edge[k, 1] + b
            if 0 <= x < map.columns and 0 <= y < map.rows:
                total += int(map.levels[level, x * map.rows + y])
        if total > least:
            totals[block] = total


@compiled
def _best_of_block(
    map: Likelihoods,
    scan: Headings,
    h: int,
    i: int,
    j: int,
    bound: float,
    radius: int,
    cost: float,
    reach_cost: float,
    best: float,
) -> tuple[float, int, int]:
    """Best shift of the block at (i, j), `2^top` cells a side, if better than `best`: depth first.

    `cost` is what the heading costs, `reach_cost` what a shift by the whole radius costs.
    """
    full, room = 255.0 * scan.inside.shape[1], 4 * len(map.levels)
    todo, value, totals = np.empty((room, 3), np.int64), np.empty(room), np.empty(4, np.int64)
    todo[0, 0], todo[0, 1], todo[0, 2], value[0] = len(map.levels) - 1, i, j, bound
    used, at_i, at_j = 1, 0, 0
    while used:
        used -= 1
        level, i, j = todo[used, 0], todo[used, 1], todo[used, 2]
        if value[used] <= best:
            continue
        if level == 0:
            away = (i - radius) * (i - radius) + (j - radius) * (j - radius)
            score = value[used] - reach_cost * away / (radius * radius)
            if score > best:
                best, at_i, at_j = score, i, j
            continue
        half, first = 1 << (level - 1), used
        _sums(map, level - 1, scan, h, i, j, 2, radius, full * (best + cost), totals)
        for q in range(4):
            if totals[q] != NO_SUM:
                a, b = i + half * (q // 2), j + half * (q % 2)
                score, m = totals[q] / full - cost, used
                while m > first and value[m - 1] > score:  # ascending: the best is taken first
                    for k in range(3):
                        todo[m, k] = todo[m - 1, k]
                    value[m] = value[m - 1]
                    m -= 1
                todo[m, 0], todo[m, 1], todo[m, 2], value[m] = level - 1, a, b, score
                used += 1
    return best, at_i, at_j


@compiled
def _heading_cost(scan: Headings, h: int, reach_cost: float) -> float:
    """What a heading costs: nothing in the middle, as much as the farthest shift at both ends."""
    middle = len(scan.inside) // 2
    return reach_cost * ((h - middle) / max(middle, 1)) ** 2


@compiled
def correlative_search(
    map: Likelihoods,
    points: Array,
    start: Array,
    step: float,
    half: int,
    radius: int,
    reach_cost: float,
    least: float,
) -> tuple[float, int, int, int]:
    """Best score of a window, with the heading's index (-1: none above `least`) and shift in cells.

    Exact on the lattice of cells and headings. The middle heading is looked into first, since its
    best bounds most of the others; then, of the blocks that can hold more than the best so far, the
    one that can hold most. Points `(2, n)` of a scan and the start `(3,)` in the frame of the map's
    corner, metres and radians; the radius counts cells, and to both sides of the middle there are
    `half` headings, a step apart.
    """
    headings, n, last = 2 * half + 1, points.shape[1], len(map.levels) - 1
    inside, edge = np.empty((headings, n), np.uint32), np.empty((headings, n, 2), np.int32)
    scan = Headings(inside, edge, np.empty((headings, 2), np.int64))
    _lay_out(map, points, start, step, radius, scan)
    width, side, full = 1 << last, 2 * radius // (1 << last) + 1, 255.0 * n
    bound, block = np.empty(headings * side * side), np.empty(headings * side * side, np.int64)
    totals = np.empty(side * side, np.int64)
    best, heading, shift_i, shift_j = least, -1, 0, 0
    count = 0
    for turn in range(headings + 1):
        if turn < headings:
            h = half + (turn + 1) // 2 * (1 if turn % 2 else -1)
            cost = _heading_cost(scan, h, reach_cost)
            _sums(map, last, scan, h, 0, 0, side, radius, full * (best + cost), totals)
            for b in range(side * side):
                if totals[b] != NO_SUM:
                    bound[count], block[count] = totals[b] / full - cost, h * side * side + b
                    count += 1
        while count and turn in (0, headings):
            top = kept = 0
            for k in range(count):
                if bound[k] > best:
                    bound[kept], block[kept] = bound[k], block[k]
                    top = kept if bound[kept] > bound[top] else top
                    kept += 1
            count = kept
            if count:
                h, b = block[top] // (side * side), block[top] % (side * side)
                i, j = b // side * width, b % side * width
                cost = _heading_cost(scan, h, reach_cost)
                score, i, j = _best_of_block(
                    map, scan, h, i, j, bound[top], radius, cost, reach_cost, best
                )
                bound[top] = best
                if score > best:
                    best, heading, shift_i, shift_j = score, h, i - radius, j - radius
    return best, heading, shift_i, shift_j
