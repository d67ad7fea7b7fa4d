"""The search of segment ICP: correspondences, A's cost 2.1, and the motion of least cost.

Segments are `(n, 2, 2)` arrays in metres; `r` describes the reference, `(n, 5)`; pairs `(p, 2)`
hold the indices of a current segment and of a reference segment, current ones ascending.

No axis of any frame has a part in it: what is tried is turns about the scan's middle, and shifts
along its walls and across them. What differs by rounding only counts as equal, so that the answer
moves with the frames.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled
from ...kernels import APART_WEIGHT, describe, distance_below
from .._walls import moved_segments

Indices = NDArray[np.int64]

#: Differences of costs and of places below this, in metres, are rounding.
COST_ROUNDING_M = 1e-9
#: Directions whose sine differs by less are tried once.
SAME_WAY = 0.02


#: The best turn is looked for among so many on either side.
TURNS_PER_SIDE = 4
#: The search turns and shifts at most so often before the steps become finer.
MOST_ROUNDS_PER_STEP = 5
#: The next step is this many times finer.
STEP_DIVISOR = 4.0
#: The search ends below this step, metres.
FINEST_STEP_M = 5e-5
#: Cost in metres that a shift by one metre must save. One wall across in a scan of 70 saves 0.004;
#: the noise of walls along a corridor a tenth of that, and moves no scan.
SLOPE = 0.004


@compiled
def correspondences(
    reference: Array, r: Array, current: Array, angle: float, most: float
) -> Indices:
    """Pairs, (p, 2) int array, within both thresholds that lie beside each other.

    Thresholds in radians and metres. Without the last condition a wall would be drawn along its own
    line to its next piece, behind a door.
    """
    a, sine = describe(current), np.sin(angle)
    pairs = np.empty((len(current) * len(reference), 2), np.int64)
    n = 0
    for i in range(len(current)):
        x, y, dx, dy, half = a[i, 0], a[i, 1], a[i, 2], a[i, 3], a[i, 4]
        for j in range(len(reference)):
            u, v = r[j, 0] - x, r[j, 1] - y
            beside = abs(u * dx + v * dy) < half + r[j, 4] - COST_ROUNDING_M
            if not beside or abs(dx * r[j, 3] - dy * r[j, 2]) >= sine:
                continue
            if APART_WEIGHT * (abs(v * dx - u * dy) - (half + r[j, 4]) * sine) >= most:
                continue
            if distance_below(current[i], reference[j], a[i], r[j], most) < most:
                pairs[n, 0], pairs[n, 1] = i, j
                n += 1
    return pairs[:n]


class Matches(NamedTuple):
    """What a scan's segments are compared with, and which correspond; lengths are in metres."""

    reference: Array  # (m, 2, 2)
    r: Array  # (m, 5) what `describe` says of it
    pairs: Indices  # (p, 2), by the scan's segment
    penalty: float  # cost of a segment without a match


@compiled
def cost(matches: Matches, current: Array) -> float:
    """A 2.1 with the penalty of each segment without a match inside its bracket, metres.

    Of each current segment counts D', the mean of its distances from its matches, weighted with
    their lengths.
    """
    reference, r, pairs, penalty = matches
    a, total, p = describe(current), 0.0, 0
    for i in range(len(current)):
        distances = weight = 0.0
        while p < len(pairs) and pairs[p, 0] == i:
            j = pairs[p, 1]
            distances += r[j, 4] * distance_below(current[i], reference[j], a[i], r[j], np.inf)
            weight += r[j, 4]
            p += 1
        total += distances / weight if weight > 0.0 else penalty
    return total / len(current)


@compiled
def best_turn(
    matches: Matches, current: Array, about_x: float, about_y: float, width: float
) -> float:
    """Of evenly spaced turns about a point, the one with the least cost; radians (step 2)."""
    best, turn = cost(matches, current), 0.0
    for k in range(-TURNS_PER_SIDE, TURNS_PER_SIDE + 1):
        tried = k * width / TURNS_PER_SIDE
        turned = moved_segments(current, 0.0, 0.0, tried, about_x, about_y)
        new_cost = cost(matches, turned)
        if new_cost < best - COST_ROUNDING_M:
            best, turn = new_cost, tried
    return turn


@compiled
def ways(s: Array) -> Array:
    """Unit vectors `(k, 2)` to try: along and across each direction of the segments.

    The cost has its creases where a wall meets its line, so the way down leads along some wall. The
    direction that most metres lie along or across comes first, since the noise of one wall turns it
    least.
    """
    a = describe(s)
    c = z = 0.0  # sums of the cosines and sines of four times the angles
    for i in range(len(s)):
        double, twice = a[i, 2] ** 2 - a[i, 3] ** 2, 2.0 * a[i, 2] * a[i, 3]
        c += a[i, 4] * (double * double - twice * twice)
        z += a[i, 4] * 2.0 * double * twice
    first = np.arctan2(a[0, 3], a[0, 2])  # of the four ways of a cross the one nearest to a wall
    turn = (np.arctan2(z, c) / 4.0 - first + np.pi / 4.0) % (np.pi / 2.0) - np.pi / 4.0
    ways = np.zeros((4 * len(s) + 4, 2))
    n = 0
    for i in range(-1, len(s)):
        x, y = np.cos(first + turn), np.sin(first + turn)
        if i >= 0:
            x, y = a[i, 2], a[i, 3]
        new = x != 0.0 or y != 0.0
        for k in range(n):
            new = new and abs(ways[k, 0] * y - ways[k, 1] * x) > SAME_WAY
        if new:
            for k in range(4):  # x, y; its reverse; both normals
                ways[n, 0], ways[n, 1] = x, y
                n += 1
                x, y = (-x, -y) if k % 2 == 0 else (y, -x)
    return ways[:n]


@compiled
def best_shift(matches: Matches, current: Array, step: float) -> tuple[float, float]:
    """Shift reached by steps of so many metres that each lessen the cost, until none does (4)."""
    around, best = ways(current), cost(matches, current)
    x, y, failed, k = 0.0, 0.0, 0, 0
    while failed < len(around):
        u, v = x + step * around[k, 0], y + step * around[k, 1]
        shifted = moved_segments(current, u, v, 0.0, 0.0, 0.0)
        new_cost = cost(matches, shifted)
        if new_cost < best - SLOPE * step:
            best, x, y, failed = new_cost, u, v, 0
        else:
            failed, k = failed + 1, (k + 1) % len(around)
    return x, y


def turn_and_shift(
    reference: Array,
    current: Array,
    angle: float,
    distance: float,
    width: float,
    step: float,
) -> tuple[float, Array, Array, Indices]:
    """Turn, then shift, until neither helps; again with finer steps (A 2.5.1, step 6).

    New correspondences can raise the cost, so each finer search begins at the best place so far.
    Returns the cost there, the motion, (3,) array, the current segments there, `(m, 2, 2)`, and the
    pairs that correspond; metres and radians.
    """
    r, motion = describe(reference), np.zeros(3)
    pairs = correspondences(reference, r, current, angle, distance)
    matches = Matches(reference, r, pairs, distance)
    least, best = cost(matches, current), (motion, current, matches)
    while step > FINEST_STEP_M:
        for _ in range(MOST_ROUNDS_PER_STEP):
            px, py = current.mean((0, 1))  # a turn about the middle leaves the shift nearly alone
            turn = best_turn(matches, current, px, py, width)
            turned = moved_segments(current, 0.0, 0.0, turn, px, py)
            x, y = best_shift(matches, turned, step)
            current = moved_segments(turned, x, y, 0.0, px, py)
            c, s, (u, v) = np.cos(turn), np.sin(turn), motion[:2] - (px, py)
            motion = np.array([px + x + c * u - s * v, py + y + s * u + c * v, motion[2] + turn])
            pairs = correspondences(reference, r, current, angle, distance)
            matches = Matches(reference, r, pairs, distance)
            new_cost = cost(matches, current)
            if new_cost < least - COST_ROUNDING_M:
                least, best = new_cost, (motion, current, matches)
            if turn == 0.0 and x == 0.0 and y == 0.0:
                break
        motion, current, matches = best
        width, step = width / STEP_DIVISOR, step / STEP_DIVISOR
    return least, *best[:2], best[2].pairs
