"""Climbing and linking, for mean shift: centres move to where points are dense, and make chains.

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
from ._runner import Indices

#: Points farther away than this many deviations, where the weight is 0.011, do not pull.
REACH = 3 * (1 + 1e-9)
#: How many centres climb together, and how far apart they may start, in deviations.
LANES, SPREAD = 16, 8.0
#: Beyond this share of a quarter turn a point counts as perpendicular: it turns neither way.
PERPENDICULAR = 1 - 1e-9


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
    and the sum is at most n. Each moves by itself, so "at once" and "in turn" are the same; one
    that a step leaves where it was stays there.
    """
    strips = _in_strips(points, REACH, group)
    cuts = np.empty(len(points) + 1, np.int64)
    cuts = cuts[: _neighbours(strips.x, strips.first, cuts)]
    runs = np.searchsorted(cuts, strips.first[strips.begins])
    centres, moves = np.stack(strips[:3]), np.empty(len(cuts))
    steps = _climb(strips, cuts, runs, centres, moves, np.empty((7, LANES)), period, stop, most)
    found = np.empty_like(points)
    found[strips.order] = centres.T
    return found, steps


def link(points: Array, group: Indices, period: float, reach: float) -> Indices:
    """Chains of points `(n, 3)` of a group closer than `reach`: the lowest of each, `(n,)`."""
    parent = np.arange(len(points))
    _link(_in_strips(points, reach, group), parent, period, reach)
    return parent


@compiled
def _neighbours(x: Array, first: Indices, cuts: Indices) -> int:
    """Cut strips into runs of neighbours, all within `SPREAD` of the first: where each begins, n.

    Writes them to `cuts` and returns how many there are.
    """
    count = 0
    for r in range(len(first) - 1):
        begin = -1
        for i in range(first[r], first[r + 1]):
            if begin < 0 or i - begin == LANES or x[i] - x[begin] > SPREAD:
                cuts[count], begin = i, i
                count += 1
    cuts[count] = len(x)
    return count + 1


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
    low: int,
    high: int,
    centres: Array,
    begin: int,
    end: int,
    period: float,
    block: Array,
) -> float:
    """Move the centres `begin` to `end` of `(3, n)` once; the square of the largest move, if any.

    They see the points of the strips `low` to `high`; `block`, (7, LANES), is room to work.
    """
    rows, first = strips.rows, strips.first
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    for i in range(LANES):
        k = min(begin + i, end - 1)  # the last one fills up
        for c in range(3):
            block[c, i], block[c + 3, i] = centres[c, k], 0.0
        block[6, i] = 0.0
        left, right = min(left, centres[0, k]), max(right, centres[0, k])
        bottom, top = min(bottom, centres[1, k]), max(top, centres[1, k])
    r = _bisect(rows, low, high, np.floor((bottom - REACH) / REACH))
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
def _climb(
    strips: Strips,
    cuts: Indices,
    runs: Indices,
    centres: Array,
    moves: Array,
    block: Array,
    period: float,
    stop: float,
    most: float,
) -> int:
    """Move the centres, `(3, n)`, of each group until none moves by more than `stop`; the steps.

    A group has the runs of neighbours `runs[g]` to `runs[g + 1]`, which begin at `cuts`.
    """
    longest = 0
    for g in range(len(runs) - 1):
        steps, largest = 0, np.inf
        for k in range(runs[g], runs[g + 1]):
            moves[k] = np.inf
        while largest > stop * stop and steps < most:
            largest = 0.0
            for k in range(runs[g], runs[g + 1]):
                if moves[k] > 0:
                    low, high = strips.begins[g], strips.begins[g + 1]
                    moves[k] = _step(
                        strips, low, high, centres, cuts[k], cuts[k + 1], period, block
                    )
                largest = max(largest, moves[k])
            steps += 1
        longest = max(longest, steps)
    return longest


@compiled
def _root_of(parent: Indices, i: int) -> int:
    """Lowest member of the set of i; halves the way there."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@compiled
def _link_with(
    strips: Strips, parent: Indices, i: int, j: int, stop: int, period: float, reach: float
) -> None:
    """Unite the set of point i with those of the sorted points j to stop closer than `reach`."""
    x, y, a, order = strips.x, strips.y, strips.a, strips.order
    while j < stop and x[j] - x[i] < reach:
        dx, dy, da = x[i] - x[j], y[i] - y[j], abs(a[i] - a[j])
        da = min(da, period - da)
        if dx * dx + dy * dy + da * da < reach * reach:
            k, m = _root_of(parent, order[i]), _root_of(parent, order[j])
            parent[max(k, m)] = min(k, m)
        j += 1


@compiled
def _link(strips: Strips, parent: Indices, period: float, reach: float) -> None:
    """Unite all points of a group closer than `reach`: `parent` becomes the lowest of each set."""
    rows, first = strips.rows, strips.first
    for g in range(len(strips.begins) - 1):
        last = strips.begins[g + 1] - 1
        for r in range(strips.begins[g], last + 1):
            above = first[r + 1]
            for i in range(first[r], first[r + 1]):
                _link_with(strips, parent, i, i + 1, first[r + 1], period, reach)
                if r < last and rows[r + 1] == rows[r] + 1:
                    above = _bisect(strips.x, above, first[r + 2], strips.x[i] - reach)
                    _link_with(strips, parent, i, above, first[r + 2], period, reach)
    for i in range(len(parent)):
        parent[i] = _root_of(parent, i)
