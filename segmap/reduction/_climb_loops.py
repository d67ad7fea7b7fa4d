"""The loops of climbing and linking, for mean shift: plain Python, compiled when called.

Points are `(n, 3)` arrays in units of the kernel's deviation: two coordinates and an angle, which
wraps at `period`. They are kept in strips of constant second coordinate, each sorted by the first,
so that all within reach of neighbouring centres are one slice of each strip. Centres that start
side by side climb together: a loop over them is one that a processor does many at a time.
"""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

Indices = NDArray[np.int64]

#: Points farther away than this many deviations, where the weight is 0.011, do not pull.
REACH = 3 * (1 + 1e-9)
#: How many centres climb together, and how far apart they may start, in deviations.
LANES, SPREAD = 16, 8.0
#: Beyond this share of a quarter turn a point counts as perpendicular: it turns neither way.
PERPENDICULAR = 1 - 1e-9


@compiled
def _in_strips(points: Array, height: float) -> tuple[Indices, Indices, Indices]:
    """Order `(n,)` of points `(n, 3)` by strip and first coordinate; the strips; where each begins.

    The r strips that hold points, ascending, `(r,)`; r + 1 places in the order, the last one n.
    """
    order = np.argsort(points[:, 0], kind="mergesort")
    row = np.floor(points[order, 1] / height).astype(np.int64)
    inner = np.argsort(row, kind="mergesort")
    order, row = order[inner], row[inner]
    begins = np.flatnonzero(row[1:] != row[:-1]) + 1
    first = np.zeros(len(begins) + 2, np.int64)
    first[1:-1], first[-1] = begins, len(row)
    return order, row[first[:-1]], first


@compiled
def neighbours(x: Array, first: Indices) -> Indices:
    """Cut strips, each sorted by x `(n,)`, into runs of neighbours: where each begins, and n.

    x in deviations; of a run all lie within `SPREAD` of its first.
    """
    cuts, count = np.zeros(len(x) + 1, np.int64), 0
    for r in range(len(first) - 1):
        for i in range(first[r], first[r + 1]):
            begin = cuts[count]
            if i == first[r] or i - begin == LANES or x[i] - x[begin] > SPREAD:
                count += i > 0
                cuts[count] = i
    cuts[count + 1] = len(x)
    return cuts[: count + 2]


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
def pull(px: Array, py: Array, pa: Array, block: Array, period: float) -> None:
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
def step(
    fixed: Array, rows: Indices, first: Indices, centres: Array, period: float, block: Array
) -> float:
    """Move neighbouring centres `(3, m)` once; the square of the largest move that is not lost.

    `fixed`, (3, n) array, are the points in strips; `block`, (7, LANES), is room to work.
    """
    m = centres.shape[1]
    for c in range(3):
        block[c, :m], block[c, m:] = centres[c], centres[c, m - 1]  # the last one fills up
    block[3:] = 0.0
    left, right = centres[0].min() - REACH, centres[0].max() + REACH
    lowest = int(np.floor((centres[1].min() - REACH) / REACH))
    highest = int(np.floor((centres[1].max() + REACH) / REACH))
    r = _bisect(rows, 0, len(rows), lowest)
    while r < len(rows) and rows[r] <= highest:
        i = _bisect(fixed[0], first[r], first[r + 1], left)
        j = _bisect(fixed[0], i, first[r + 1], right)
        pull(fixed[0, i:j], fixed[1, i:j], fixed[2, i:j], block, period)
        r += 1
    largest = 0.0
    for i in range(m):
        mass = block[3, i]
        dx, dy, da = block[4, i] / mass, block[5, i] / mass, block[6, i] / mass
        x, y, a = centres[0, i] + dx, centres[1, i] + dy, centres[2, i] + da
        a = a - period if a >= period else a
        a = a + period if a < 0 else a
        if x != centres[0, i] or y != centres[1, i] or a != centres[2, i]:
            largest = max(largest, dx * dx + dy * dy + da * da)
        centres[0, i], centres[1, i], centres[2, i] = x, y, a
    return largest


@compiled
def climb(points: Array, period: float, stop: float, most: float) -> tuple[Array, int]:
    """Where centres, which start at the points `(n, 3)`, come to, and after how many steps (A 4.8).

    All move until none moves by more than `stop`, or for `most` steps. They do come to rest: with
    k(q) = max(0, exp(-q / 2) - exp(-9 / 2)), convex and falling, each step raises the sum of k over
    the points by at least exp(-9 / 2) / 2 times the square of the move, and the sum is at most n.
    Each moves by itself, so "at once" and "in turn" are the same; one that a step leaves where it
    was stays there.
    """
    order, rows, first = _in_strips(points, REACH)
    fixed = points[order].T.copy()
    centres, block = fixed.copy(), np.zeros((7, LANES))
    cuts = neighbours(fixed[0], first)
    moves = np.full(len(cuts) - 1, np.inf)
    steps = 0
    while moves.max() > stop * stop and steps < most:
        for g in range(len(moves)):
            if moves[g] > 0:
                run = centres[:, cuts[g] : cuts[g + 1]]
                moves[g] = step(fixed, rows, first, run, period, block)
        steps += 1
    found = np.empty_like(points)
    for i in range(len(order)):
        found[order[i]] = centres[:, i]
    return found, steps


@compiled
def _root_of(parent: Indices, i: int) -> int:
    """Lowest member of the set of i; halves the way there."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@compiled
def _link_with(
    p: Array,
    order: Indices,
    parent: Indices,
    i: int,
    j: int,
    stop: int,
    period: float,
    reach: float,
) -> None:
    """Unite the set of point i with those of the sorted points j to stop closer than `reach`."""
    while j < stop and p[0, j] - p[0, i] < reach:
        dx, dy, da = p[0, i] - p[0, j], p[1, i] - p[1, j], abs(p[2, i] - p[2, j])
        da = min(da, period - da)
        if dx * dx + dy * dy + da * da < reach * reach:
            a, b = _root_of(parent, order[i]), _root_of(parent, order[j])
            parent[max(a, b)] = min(a, b)
        j += 1


@compiled
def link(points: Array, period: float, reach: float) -> Indices:
    """Chains of points `(n, 3)` closer than `reach`: the lowest index in that of each, `(n,)`."""
    order, rows, first = _in_strips(points, reach)
    p, parent = points[order].T.copy(), np.arange(len(points))
    for r in range(len(rows)):
        above = first[r + 1]
        for i in range(first[r], first[r + 1]):
            _link_with(p, order, parent, i, i + 1, first[r + 1], period, reach)
            if r + 1 < len(rows) and rows[r + 1] == rows[r] + 1:
                above = _bisect(p[0], above, first[r + 2], p[0, i] - reach)
                _link_with(p, order, parent, i, above, first[r + 2], period, reach)
    for i in range(len(parent)):
        parent[i] = _root_of(parent, i)
    return parent
