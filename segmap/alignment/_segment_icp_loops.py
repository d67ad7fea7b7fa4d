"""Segment ICP: which segments correspond, A's 2.1, and the turn and shift that make it least.

Segments are `(n, 2, 2)` arrays in metres; pairs `(p, 2)` hold the indices of a current segment and
of a reference segment, current ones ascending.
"""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from .._metrics_loops import ACROSS, ANGULAR, APART, apart, describe, mean_line_terms
from ..arrays import Array

Indices = NDArray[np.int64]

#: Turns tried on either side, at each width of the search.
PLACES = 4
#: Turn and shift at most so often before the steps become finer, and by how much.
ROUNDS, FINER = 5, 4.0
#: The search ends below this step, in metres.
LEAST_STEP = 5e-5
#: What counts as less cost: metres, and metres a metre shifted. One wall across in a scan of 70
#: lessens it by 0.004; the noise of walls along a corridor by a tenth of that, and moves no scan.
LESS, SLOPE = 1e-12, 0.004


@compiled
def moved(s: Array, x: float, y: float, turn: float, about: Array) -> Array:
    """Segments, or rows of points, turned about a point, then shifted; metres, radians.

    Segments `(n, 2, 2)`, or points `(n, k, 2)`; the point they turn about is a (2,) array.
    """
    c, z = np.cos(turn), np.sin(turn)
    out = np.empty_like(s)
    for i in range(len(s)):
        for k in range(s.shape[1]):
            u, v = s[i, k, 0] - about[0], s[i, k, 1] - about[1]
            out[i, k, 0] = about[0] + x + c * u - z * v
            out[i, k, 1] = about[1] + y + z * u + c * v
    return out


@compiled
def middle(s: Array) -> Array:
    """Mean of all end points of segments `(n, 2, 2)`, (2,) array, metres.

    Turning about it leaves the shift nearly alone.
    """
    return np.array([s[:, :, 0].mean(), s[:, :, 1].mean()])


@compiled
def _pair_distance(u: Array, v: Array, a: Array, b: Array) -> float:
    """Segment distance (A 2.7.7) of two segments that a and b describe, metres."""
    angular, across = mean_line_terms(u, v, a, b)
    return ANGULAR * angular + ACROSS * across + APART * apart(u, v)


@compiled
def correspondences(
    reference: Array, r: Array, current: Array, angle: float, most: float
) -> Indices:
    """Pairs, (p, 2) int array, within both thresholds that lie beside each other.

    Thresholds in radians and metres; r describes the reference, `(n, 5)`. Without the last
    condition a wall would be drawn along its own line to its next piece, behind a door.
    """
    a, sine = describe(current), np.sin(angle)
    out = np.empty((len(current) * len(reference), 2), np.int64)
    n = 0
    for i in range(len(current)):
        x, y, dx, dy, half = a[i, 0], a[i, 1], a[i, 2], a[i, 3], a[i, 4]
        for j in range(len(reference)):
            u, v = r[j, 0] - x, r[j, 1] - y
            if abs(dx * r[j, 3] - dy * r[j, 2]) >= sine or abs(u * dx + v * dy) >= half + r[j, 4]:
                continue
            if APART * (abs(v * dx - u * dy) - (half + r[j, 4]) * sine) >= most:
                continue
            if _pair_distance(current[i], reference[j], a[i], r[j]) < most:
                out[n, 0], out[n, 1] = i, j
                n += 1
    return out[:n]


@compiled
def distances(reference: Array, r: Array, current: Array, pairs: Indices) -> Array:
    """D' of each current segment, `(m,)`, metres; infinity where it has no match.

    The mean of its distances from its matches, weighted with their lengths.
    """
    a = describe(current)
    found = np.full(len(current), np.inf)
    p = 0
    while p < len(pairs):
        i = pairs[p, 0]
        away = weight = 0.0
        while p < len(pairs) and pairs[p, 0] == i:
            j = pairs[p, 1]
            away += r[j, 4] * _pair_distance(current[i], reference[j], a[i], r[j])
            weight += r[j, 4]
            p += 1
        found[i] = away / weight
    return found


@compiled
def cost(reference: Array, r: Array, current: Array, pairs: Indices, penalty: float) -> float:
    """A 2.1 with the penalty of each segment without a match inside its bracket, metres.

    Of m current segments `(m, 2, 2)` against the reference `(n, 2, 2)`, by their pairs.
    """
    total = 0.0
    for away in distances(reference, r, current, pairs):
        total += away if away < np.inf else penalty
    return total / len(current)


@compiled
def _best_turn(
    reference: Array,
    r: Array,
    current: Array,
    pairs: Indices,
    most: float,
    about: Array,
    width: float,
) -> float:
    """Of evenly spaced turns about a point, the one with the least cost; radians (step 2)."""
    best, turn = cost(reference, r, current, pairs, most), 0.0
    for k in range(-PLACES, PLACES + 1):
        tried = k * width / PLACES
        turned = moved(current, 0.0, 0.0, tried, about)
        found = cost(reference, r, turned, pairs, most)
        if found < best - LESS:
            best, turn = found, tried
    return turn


@compiled
def ways(s: Array) -> Array:
    """Unit vectors `(k, 2)` to try: along and across each direction of the segments, axes first.

    The cost has its creases where a wall meets its line, so the way down leads along some wall.
    """
    a = describe(s)
    out = np.zeros((4 * len(s) + 4, 2))
    n = 0
    for i in range(-1, len(s)):
        x, y = (1.0, 0.0) if i < 0 else (a[i, 2], a[i, 3])
        new = x != 0.0 or y != 0.0
        for k in range(n):
            new = new and abs(out[k, 0] * y - out[k, 1] * x) > 0.02
        if new:
            for c, z in ((x, y), (-x, -y), (-y, x), (y, -x)):
                out[n, 0], out[n, 1] = c, z
                n += 1
    return out[:n]


@compiled
def best_shift(
    reference: Array, r: Array, current: Array, pairs: Indices, most: float, step: float
) -> tuple[float, float]:
    """Shift reached by steps that each lessen the cost, until none does; metres (step 4).

    Of the current segments `(m, 2, 2)`; a step is `step` metres long.
    """
    around, about = ways(current), np.zeros(2)
    best, x, y = cost(reference, r, current, pairs, most), 0.0, 0.0
    failed, k = 0, 0
    while failed < len(around):
        u, v = x + step * around[k, 0], y + step * around[k, 1]
        found = cost(reference, r, moved(current, u, v, 0.0, about), pairs, most)
        if found < best - SLOPE * step:
            best, x, y, failed = found, u, v, 0
        else:
            failed, k = failed + 1, (k + 1) % len(around)
    return x, y


@compiled
def match(
    reference: Array, current: Array, angle: float, most: float, width: float, step: float
) -> tuple[Array, Array, Array]:
    """Turn, then shift, until neither helps; again with finer steps (A 2.5.1, step 6).

    New pairs can raise the cost: each finer search sets out from the best place so far. Returns the
    motion `(3,)` that leads there, the current segments `(m, 2, 2)` there, and how far each lies
    from its matches, `(m,)`; metres and radians.
    """
    r, motion = describe(reference), np.zeros(3)
    pairs = correspondences(reference, r, current, angle, most)
    least = cost(reference, r, current, pairs, most)
    best, ended, kept = motion.copy(), current, pairs
    while step > LEAST_STEP:
        for _ in range(ROUNDS):
            about = middle(current)
            turn = _best_turn(reference, r, current, pairs, most, about, width)
            current = moved(current, 0.0, 0.0, turn, about)
            x, y = best_shift(reference, r, current, pairs, most, step)
            current = moved(current, x, y, 0.0, about)
            here = moved(motion[:2].copy().reshape(1, 1, 2), x, y, turn, about)
            motion[0], motion[1], motion[2] = here[0, 0, 0], here[0, 0, 1], motion[2] + turn
            pairs = correspondences(reference, r, current, angle, most)
            found = cost(reference, r, current, pairs, most)
            if found < least:
                least, best, ended, kept = found, motion.copy(), current, pairs
            if turn == 0.0 and x == 0.0 and y == 0.0:
                break
        motion, current, pairs = best.copy(), ended, kept
        width, step = width / FINER, step / FINER
    return best, ended, distances(reference, r, ended, kept)
