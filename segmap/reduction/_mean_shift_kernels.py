"""The loops of mean shift: centres climb to where points are dense, and make chains.

Points are `(n, 3)` arrays in units of the kernel's deviations: two coordinates and an angle, which
wraps at `period`; points of different groups do not see each other. They are kept in strips of
constant second coordinate, each sorted by the first, so that all within reach of neighbouring
centres are one slice of each strip. Centres that start side by side climb together: a loop over
them is one that a processor does many at a time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ..kernels import root_of
from ..progress import announce
from ..threads import shares, team
from ._runner import Indices

#: Points farther away than this many deviations, where the weight is 0.011, do not pull.
REACH = 3 * (1 + 1e-9)
#: How many centres climb together, and how far apart they may start, in deviations.
LANES, SPREAD = 16, 8.0
#: A thread moves at least so many such runs of centres.
SHARE = 64
#: Beyond this share of a quarter turn a point counts as perpendicular: it turns neither way.
PERPENDICULAR = 1 - 1e-9
#: Intervals at most this far apart, in metres, are joined.
SAME = 1e-9


class Strips(NamedTuple):
    """Points by group and strip, n of them in r strips of g groups."""

    x: Array  # (n,) by group, strip and first coordinate, in deviations
    y: Array
    a: Array
    order: Indices  # (n,) which point each of them is
    rows: Indices  # (r,) strips that hold points, ascending within their group
    first: Indices  # (r + 1,) where each begins in the order, and n
    begins: Indices  # (g + 1,) where the strips of each group begin, and r


def _in_strips(points: Array, height: float, group: Indices) -> Strips:
    """Strips of a height, deviations, of points `(n, 3)` whose groups, `(n,)`, count from 0."""
    row = np.floor(points[:, 1] / height).astype(np.int64)
    order = np.lexsort((points[:, 0], row, group))
    row, owner = row[order], group[order]
    cuts = np.flatnonzero((np.diff(row) != 0) | (np.diff(owner) != 0)) + 1
    first = np.concatenate([[0], cuts, [len(order)]])
    begins = np.searchsorted(owner[first[:-1]], np.arange(owner[-1] + 2))
    x, y, a = np.ascontiguousarray(points[order].T)
    return Strips(x, y, a, order, row[first[:-1]], first, begins)


def climb(
    points: Array, group: Indices, period: float, stop: float, most: float = np.inf
) -> tuple[Array, int]:
    """Where centres, which start at the points `(n, 3)`, come to, and after how many steps (A 4.8).

    All of a group, `(n,)`, move until none moves by more than `stop`, or for `most` steps. They do
    come to rest: with k(q) = max(0, exp(-q / 2) - exp(-9 / 2)), convex and falling, each step
    raises the sum of k over the points by at least exp(-9 / 2) / 2 times the square of the move,
    and the sum is at most n. Each moves by itself, so "at once" and "in turn" are the same, in any
    number of threads; one that a step leaves where it was stays there.
    """
    strips, steps = _in_strips(points, REACH, group), 0
    centres, found = np.stack(strips[:3]), np.empty_like(points)
    begin, of = np.empty(len(points) + 1, np.int64), np.empty(len(points), np.int64)
    count = _side_by_side(strips, begin, of)
    moves, todo, of = np.full(count, np.inf), np.arange(count), of[:count]
    first = np.flatnonzero(np.diff(of, prepend=-1))

    def move(part: Indices) -> None:
        _move(strips, part, of, begin, centres, moves, np.empty((7, LANES)), period)

    with team() as each:
        while len(todo) and steps < most:
            announce(1 - len(todo) / count, f"{len(todo)} of {count} pieces still move")
            each(move, shares(todo, SHARE))
            restless = np.maximum.reduceat(moves, first) > stop * stop
            todo, steps = np.flatnonzero((moves > 0) & restless[of]), steps + 1
    found[strips.order] = centres.T
    return found, steps


def link(points: Array, group: Indices, period: float, reach: float) -> Indices:
    """Chains of points `(n, 3)` of a group closer than `reach`: the lowest of each, `(n,)`."""
    parent = np.arange(len(points))
    _link(_in_strips(points, reach, group), parent, period, reach)
    return parent


@compiled
def _bisect(x: Array | Indices, i: int, j: int, least: float) -> int:
    """First index of the sorted x[i:j] that is not below `least`; j where there is none."""
    while i < j:
        middle = (i + j) // 2
        if x[middle] < least:
            i = middle + 1
        else:
            j = middle
    return i


@compiled
def _pull(px: Array, py: Array, pa: Array, block: Array, period: float) -> None:
    """Add the pull of points, `(k,)` each, on the centres of a `(7, LANES)` block.

    Its rows are the centres' coordinates, their sum of weights, and their sums of weighted
    differences (A 4.8, 4.10). For q <= 9, exp(-q / 2) is the 256th power of a Taylor series at
    q / 512, to 6e-14: unlike `exp`, products are done for many centres at a time.
    """
    x, y, a = block[0], block[1], block[2]
    mass, to_x, to_y, to_a = block[3], block[4], block[5], block[6]
    half = period / 2
    for k in range(len(px)):
        for i in range(LANES):
            dx, dy, da = px[k] - x[i], py[k] - y[i], pa[k] - a[i]
            da = da - period if da >= half else da
            da = da + period if da < -half else da
            q = dx * dx + dy * dy + da * da
            z = q * (-1 / 512)
            w = 1 + z * (1 / 5) * (1 + z * (1 / 6))
            w = 1 + z * (1 / 3) * (1 + z * (1 / 4) * w)
            w = 1 + z * (1 + z * (1 / 2) * w)
            for _ in range(8):
                w = w * w
            w = w if q <= REACH * REACH else 0.0
            mass[i] += w
            to_x[i] += w * dx
            to_y[i] += w * dy
            to_a[i] += w * da if abs(da) < half * PERPENDICULAR else 0.0


@compiled
def _step(
    strips: Strips,
    g: int,
    centres: Array,
    begin: int,
    end: int,
    period: float,
    block: Array,
) -> float:
    """Move the centres `begin` to `end` of `(3, n)` once; the square of the largest move, if any.

    They see the points of their group g; `block`, (7, LANES), is room to work.
    """
    rows, first, high = strips.rows, strips.first, strips.begins[g + 1]
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    for i in range(LANES):
        k = min(begin + i, end - 1)  # the last one fills up
        for c in range(3):
            block[c, i], block[c + 3, i] = centres[c, k], 0.0
        block[6, i] = 0.0
        left, right = min(left, centres[0, k]), max(right, centres[0, k])
        bottom, top = min(bottom, centres[1, k]), max(top, centres[1, k])
    r = _bisect(rows, strips.begins[g], high, np.floor((bottom - REACH) / REACH))
    while r < high and rows[r] <= np.floor((top + REACH) / REACH):
        i = _bisect(strips.x, first[r], first[r + 1], left - REACH)
        j = _bisect(strips.x, i, first[r + 1], right + REACH)
        _pull(strips.x[i:j], strips.y[i:j], strips.a[i:j], block, period)
        r += 1
    largest = 0.0
    for i in range(end - begin):
        k, mass = begin + i, block[3, i]
        dx, dy, da = block[4, i] / mass, block[5, i] / mass, block[6, i] / mass
        x, y, a = centres[0, k] + dx, centres[1, k] + dy, centres[2, k] + da
        a = a - period if a >= period else a
        a = a + period if a < 0 else a
        if x != centres[0, k] or y != centres[1, k] or a != centres[2, k]:
            largest = max(largest, dx * dx + dy * dy + da * da)
        centres[0, k], centres[1, k], centres[2, k] = x, y, a
    return largest


@compiled
def _side_by_side(strips: Strips, begin: Indices, of: Indices) -> int:
    """Write where each run of neighbours in a strip begins, and its group; the number of runs."""
    first, count = strips.first, 0
    for g in range(len(strips.begins) - 1):
        for r in range(strips.begins[g], strips.begins[g + 1]):
            start = first[r]
            for i in range(first[r], first[r + 1]):
                far = strips.x[i] - strips.x[start] > SPREAD
                if i == first[r] or i - start == LANES or far:
                    start, begin[count], of[count] = i, i, g
                    count += 1
    begin[count] = len(strips.x)
    return count


@compiled
def _move(
    strips: Strips,
    part: Indices,
    of: Indices,
    begin: Indices,
    centres: Array,
    moves: Array,
    block: Array,
    period: float,
) -> None:
    """Move the runs of centres, `(3, n)`, that are a thread's part: the squares of their moves."""
    for k in part:
        moves[k] = _step(strips, of[k], centres, begin[k], begin[k + 1], period, block)


@compiled
def _link(strips: Strips, parent: Indices, period: float, reach: float) -> None:
    """Unite all points of a group closer than `reach`: `parent` becomes the lowest of each set."""
    x, y, a, order, first = strips.x, strips.y, strips.a, strips.order, strips.first
    for g in range(len(strips.begins) - 1):
        for r in range(strips.begins[g], strips.begins[g + 1]):
            for i in range(first[r], first[r + 1]):
                for s in range(r, min(r + 2, strips.begins[g + 1])):  # its strip and the next
                    if strips.rows[s] > strips.rows[r] + 1:
                        continue
                    stop = first[s + 1]
                    j = i + 1 if s == r else _bisect(x, first[s], stop, x[i] - reach)
                    while j < stop and x[j] - x[i] < reach:
                        dx, dy, da = x[i] - x[j], y[i] - y[j], abs(a[i] - a[j])
                        da = min(da, period - da)
                        if dx * dx + dy * dy + da * da < reach * reach:
                            k, m = root_of(parent, order[i]), root_of(parent, order[j])
                            parent[max(k, m)] = min(k, m)
                        j += 1
    for i in range(len(parent)):
        parent[i] = root_of(parent, i)


@compiled
def join(
    order: Indices, chain: Indices, low: Array, high: Array, into: Indices, spans: Array
) -> int:
    """Union of the intervals of each chain, sorted by chain and low: the number of parts.

    Writes the part of each interval, and low and high of each part.
    """
    count, last = 0, -1
    for i in order:
        if chain[i] != last or low[i] > spans[count - 1, 1] + SAME:
            last, spans[count, 0], spans[count, 1] = chain[i], low[i], high[i]
            count += 1
        spans[count - 1, 1] = max(spans[count - 1, 1], high[i])
        into[i] = count - 1
    return count
