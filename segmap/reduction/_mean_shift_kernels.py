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
from ..threads import team
from ._runner import Indices

#: Climbing counts in so many deviations: halves and quarters of sums need no products then.
DEVIATIONS_PER_UNIT = 32
#: Points farther away than three deviations, where the weight is 0.011, do not pull.
PULL_REACH = 3 * (1 + 1e-9) / DEVIATIONS_PER_UNIT
#: Centres move in a box that begins so far around them.
BOX_SLACK = 0.1 / DEVIATIONS_PER_UNIT
#: Points are looked for so far around the box.
BOX_REACH = PULL_REACH + 0.02 / DEVIATIONS_PER_UNIT
#: Centres that climb together.
CENTRES_PER_RUN = 16
#: Centres that climb together start at most this far apart.
RUN_EXTENT = 12 / DEVIATIONS_PER_UNIT
#: Steps until such runs of centres are made anew.
STEPS_PER_RUN = 8
#: Runs of centres that a thread takes at a time.
RUNS_PER_THREAD = 64
#: Strips of a group have numbers about as many times this as that of the group.
GROUP_STRIPS = 1 << 36
#: Beyond this share of a quarter turn a point counts as perpendicular: it turns neither way.
PERPENDICULAR_TURN_SHARE = 1 - 1e-9
#: Intervals at most this far apart, in metres, are joined.
JOINED_INTERVAL_M = 1e-9


class Strips(NamedTuple):
    """Points by group and strip, n of them in r strips."""

    x: Array  # (n,) by group, strip and first coordinate, in deviations
    y: Array
    a: Array
    order: Indices  # (n,) which point each of them is
    rows: Indices  # (r,) strips that hold points, ascending, see `GROUP_STRIPS`
    first: Indices  # (r + 1,) where each begins in the order, and n


class Runs(NamedTuple):
    """Runs of centres that climb together, r of them of n centres."""

    begin: Indices  # (r + 1,) where each begins among the centres, and n
    group: Indices  # (r,) its group
    todo: Indices  # how many steps it may still take
    moves: Array  # the square of the largest of its last moves
    centres: Array  # (3, n)


def _in_strips(points: Array, height: float, group: Indices) -> Strips:
    """Strips of a height, deviations, of points `(n, 3)` whose groups, `(n,)`, count from 0."""
    row = np.floor(points[:, 1] / height).astype(np.int64) + GROUP_STRIPS * group
    order = np.lexsort((points[:, 0], row))
    first = np.flatnonzero(np.diff(row[order], prepend=row.min() - 1))
    x, y, a = np.ascontiguousarray(points[order].T)
    return Strips(x, y, a, order, row[order[first]], np.append(first, len(order)))


def _side_by_side(at: Strips) -> Indices:
    """Where each run begins, of neighbours in a strip and in a part of it, and where all end."""
    cuts = np.union1d(np.flatnonzero(np.diff(np.floor(at.x / RUN_EXTENT))) + 1, at.first)
    nth = np.arange(len(at.x)) - np.repeat(cuts[:-1], np.diff(cuts))
    return np.append(np.flatnonzero(nth % CENTRES_PER_RUN == 0), len(nth))


def climb(
    points: Array, group: Indices, period: float, stop: float, most: float = np.inf
) -> tuple[Array, int]:
    """Where centres, which start at the points `(n, 3)`, come to, and after how many steps (A 4.8).

    All of a group, `(n,)`, move until none moves by more than `stop`, or for `most` steps. They do
    come to rest: with k(q) = max(0, exp(-q / 2) - exp(-9 / 2)), convex and falling, each step
    raises the sum of k over the points by at least exp(-9 / 2) / 2 times the square of the move,
    and the sum is at most n. Each moves by itself, so "at once" and "in turn" are the same, in any
    number of threads. So each run goes on until it rests alone; before the last one does the group
    cannot rest, and the others follow to its step, where one may move again. One that a step leaves
    where it was stays there.
    """
    n, places, period = len(points), points / DEVIATIONS_PER_UNIT, period / DEVIATIONS_PER_UNIT
    rest = (stop / DEVIATIONS_PER_UNIT) ** 2
    strips, steps = _in_strips(places, PULL_REACH, group), np.zeros(group.max() + 1, np.int64)
    moving = np.arange(n if most > 0 else 0)
    with team() as each:

        def advance(runs: Runs, bound: float) -> None:
            words = f"moving {len(moving)} of {n} pieces"
            parts = range(0, len(runs.todo), RUNS_PER_THREAD)
            each(lambda k: _move(strips, runs, k, bound, period), parts, words)

        while len(moving):
            at = _in_strips(places[moving], PULL_REACH, group[moving]) if steps.any() else strips
            moving, begin = moving[at.order], _side_by_side(at)
            of, sizes = group[moving[begin[:-1]]], np.diff(begin)
            may = np.ceil(np.minimum(2 * steps + STEPS_PER_RUN, most - steps)).astype(np.int64)
            todo, moves, centres = may[of], np.empty(len(of)), np.stack(at[:3])
            runs = Runs(begin, of, todo, moves, centres)
            advance(runs, rest)
            spare = may.copy()
            np.minimum.at(spare, of, todo)  # what no run of a group has taken
            todo -= spare[of]
            advance(runs, 0.0)
            steps += may - spare
            places[moving] = centres.T
            restless = np.bincount(of, moves > rest, len(steps)) > 0
            live = (restless & (steps < most))[of] & (moves > 0)
            moving = moving[np.repeat(live, sizes)]
    return places * DEVIATIONS_PER_UNIT, int(steps.max())


def link(points: Array, group: Indices, period: float, reach: float) -> Indices:
    """Chains of points `(n, 3)` of a group closer than `reach`: the lowest of each, `(n,)`."""
    parent = np.arange(len(points))
    _link(_in_strips(points, reach, group), parent, period, reach)
    return parent


@compiled
def _pull(near: Array, count: int, block: Array, period: float, wide: bool) -> None:
    """Add the pull of points on the centres of a `(7, CENTRES_PER_RUN)` block.

    A column of `near` is a point and a turn to add to differences of angle; they wrap where a block
    is `wide`. Its rows are the centres' coordinates, their sum of weights, and their sums of
    weighted differences (A 4.8, 4.10). For q <= 9, exp(-q / 2) is the 256th power of a Taylor
    series at q / 512 = 2 u, to 6e-14: unlike `exp`, products are done for many centres at a time.
    """
    px, py, pa, turn = near[0], near[1], near[2], near[3]
    x, y, a = block[0], block[1], block[2]
    mass, to_x, to_y, to_a = block[3], block[4], block[5], block[6]
    half = period / 2
    for k in range(count):
        for i in range(CENTRES_PER_RUN):
            dx, dy, da = px[k] - x[i], py[k] - y[i], pa[k] - a[i] + turn[k]
            if wide:
                da = da - period if da >= half else da
                da = da + period if da < -half else da
            u = dx * dx + dy * dy + da * da
            w = 0.5 + u * (-1 / 5) * (1 + u * (-1 / 3))
            w = 1 + u * (-2 / 3) * (1 - u * w)
            w = u * (1 - u * w)
            w = 1 - (w + w)
            for _ in range(8):
                w = w * w
            w = w if u <= PULL_REACH * PULL_REACH else 0.0
            mass[i] += w
            to_x[i] += w * dx
            to_y[i] += w * dy
            to_a[i] += w * da if not wide or abs(da) < half * PERPENDICULAR_TURN_SHARE else 0.0


@compiled
def _gather_points(
    strips: Strips, g: int, box: Array, near: Array, period: float
) -> tuple[int, bool]:
    """Write the points of a group that may pull a centre in a box, (3, 2): how many, for `_pull`.

    They are turned to the box's side, unless it is too wide to have one: the second answer.
    """
    x_min, x_max = box[0, 0] - BOX_REACH, box[0, 1] + BOX_REACH
    y_min, y_max = box[1, 0] - BOX_REACH, box[1, 1] + BOX_REACH
    middle, reach = (box[2, 0] + box[2, 1]) / 2, (box[2, 1] - box[2, 0]) / 2 + BOX_REACH
    wide, half = reach >= period / 2, period / 2
    if wide:
        reach = half = np.inf
    count, last = 0, np.int64(np.floor(y_max / PULL_REACH)) + GROUP_STRIPS * g
    first = np.int64(np.floor(y_min / PULL_REACH)) + GROUP_STRIPS * g
    for r in range(np.searchsorted(strips.rows, first), len(strips.rows)):
        if strips.rows[r] > last:
            break
        i = strips.first[r]
        x_here = strips.x[i : strips.first[r + 1]]
        for k in range(i + np.searchsorted(x_here, x_min), i + np.searchsorted(x_here, x_max)):
            x, y, a = strips.x[k], strips.y[k], strips.a[k]
            turn = -period if a - middle > half else period if a - middle < -half else 0.0
            near[0, count], near[1, count], near[2, count], near[3, count] = x, y, a, turn
            count += (y >= y_min) & (y <= y_max) & (abs(a - middle + turn) <= reach)  # no branch
    return count, wide


@compiled
def _move(strips: Strips, runs: Runs, start: int, bound: float, period: float) -> None:
    """Let a part of the runs take their steps, each until its largest move is within the bound."""
    centres, block, box = runs.centres, np.zeros((7, CENTRES_PER_RUN)), np.zeros((3, 2))
    near = np.empty((4, len(strips.x)))
    for run in range(start, min(start + RUNS_PER_THREAD, len(runs.todo))):
        begin, end, count, wide, largest = runs.begin[run], runs.begin[run + 1], -1, False, np.inf
        while runs.todo[run] > 0 and largest > bound:
            within = count >= 0
            for c in range(3):
                for i in range(CENTRES_PER_RUN):
                    at = centres[c, min(begin + i, end - 1)]  # the last one fills up
                    block[c, i], block[c + 3, i], block[6, i] = at, 0.0, 0.0
                    within &= (at >= box[c, 0]) & (at <= box[c, 1])
            if not within:
                for c in range(3):
                    box[c, 0] = centres[c, begin:end].min() - BOX_SLACK
                    box[c, 1] = centres[c, begin:end].max() + BOX_SLACK
                count, wide = _gather_points(strips, runs.group[run], box, near, period)
            _pull(near, count, block, period, wide)
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
            runs.todo[run], runs.moves[run] = runs.todo[run] - 1, largest


@compiled
def _link(strips: Strips, parent: Indices, period: float, reach: float) -> None:
    """Unite all points of a group closer than `reach`: `parent` becomes the lowest of each set."""
    x, y, a, order, first = strips.x, strips.y, strips.a, strips.order, strips.first
    for r in range(len(strips.rows)):
        for i in range(first[r], first[r + 1]):
            for s in range(r, min(r + 2, len(strips.rows))):  # its strip and the next
                if strips.rows[s] > strips.rows[r] + 1:
                    continue
                j, stop = first[s], first[s + 1]
                j = i + 1 if s == r else j + np.searchsorted(x[j:stop], x[i] - reach)
                while j < stop and x[j] - x[i] < reach:
                    k, m = order[i], order[j]
                    dx, dy, da = x[i] - x[j], y[i] - y[j], abs(a[i] - a[j])
                    da = min(da, period - da)
                    if parent[k] != parent[m] and dx * dx + dy * dy + da * da < reach * reach:
                        k, m = root_of(parent, k), root_of(parent, m)
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
        if chain[i] != last or low[i] > spans[count - 1, 1] + JOINED_INTERVAL_M:
            last, spans[count, 0], spans[count, 1] = chain[i], low[i], high[i]
            count += 1
        spans[count - 1, 1] = max(spans[count - 1, 1], high[i])
        into[i] = count - 1
    return count
