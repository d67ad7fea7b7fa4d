"""The loops of one per wall over pairs of looks: where two scans saw the same stretch of a wall."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled
from ...kernels import SAME, length_of, line_through, seen_from
from .._index import Index, enter, meeting

Indices = NDArray[np.int64]
#: Shorter looks have no pairs, metres: their direction is mostly noise of the range.
LEAST_LOOK_M = 0.3
#: Looks at one wall lie no farther apart, metres.
PAIR_OFFSET_M = 0.25
#: Looks at one wall differ by no larger angle: sine of 10 degrees.
PAIR_TURN_SINE = 0.174
#: Looks overlap by at least this share of the shorter one.
OVERLAP = 0.5
#: A look that meets more earlier ones is paired with so many to twice as many of them, evenly.
MOST_PARTNERS = 16


class Looks(NamedTuple):
    """Looks at walls, from several scans; lengths are in metres."""

    s: Array  # (n, 2, 2)
    scan: Indices
    sensors: Array  # (n, 2) where each was, NaN where nobody knows
    places: Index  # of the looks that are paired with those before them
    near: Indices  # (n + 1,) room for neighbours


@compiled
def _overlap_of(s: Array, i: int, j: int) -> tuple[float, float, float, float]:
    """Where look j lies beside look i: from and to along i, and its offset there; metres."""
    line = line_through(s[i])
    (u, v, _, _), (_, _, dx, dy) = seen_from(line, s[j]), line
    x, y = s[j, 1, 0] - s[j, 0, 0], s[j, 1, 1] - s[j, 0, 1]
    run, rise = x * dx + y * dy, y * dx - x * dy
    low, high = max(0.0, min(u, u + run)), min(length_of(s[i]), max(u, u + run))
    return low, high, v + rise / run * (low - u), v + rise / run * (high - u)


@compiled
def _side(looks: Looks, i: int, j: int) -> float:
    """How far the sensor that saw look j is to the left of look i; NaN where nobody knows."""
    (x, y, dx, dy), place = line_through(looks.s[i]), looks.sensors[j]
    return dx * (place[1] - y) - dy * (place[0] - x)


@compiled
def find_pairs(looks: Looks, part: Indices) -> Indices:
    """Pairs `(p, 2)` of some looks and earlier ones, of other scans, at one wall, from one side."""
    s, pairs, partners = looks.s, [(0, 0)], [(0, 0, 0)]
    for i in part:
        partners.clear()
        size = length_of(s[i])
        if size < LEAST_LOOK_M:
            continue
        for k in range(meeting(looks.places, s[i], PAIR_OFFSET_M, looks.near)):
            j = looks.near[k]
            other = length_of(s[j])
            _, v0, _, v1 = seen_from(line_through(s[i]), s[j])
            if looks.scan[i] == looks.scan[j] or abs(v1 - v0) > PAIR_TURN_SINE * other:
                continue
            a, b = (i, j) if other <= size + SAME else (j, i)  # along the longer look
            low, high, one, two = _overlap_of(s, a, b)
            if high - low < OVERLAP * min(size, other) - SAME or abs(one + two) / 2 > PAIR_OFFSET_M:
                continue
            if not _side(looks, i, i) * _side(looks, i, j) < 0:
                partners.append((j, a, b))
        partners.sort()
        pairs += [each[1:] for each in partners[:: max(1, len(partners) // MOST_PARTNERS)]]
        enter(looks.places, i, s[i], 0.0)
    return np.array(pairs, np.int64)[1:]  # behind what tells the compiler the type


@compiled
def offsets(s: Array, pairs: Indices) -> Array:
    """How far the looks of each pair are apart in the middle of what they share, `(p,)`, metres."""
    apart = np.empty(len(pairs))
    for p in range(len(pairs)):
        _, _, one, two = _overlap_of(s, pairs[p, 0], pairs[p, 1])
        apart[p] = (one + two) / 2
    return apart


@compiled
def pull(
    s: Array, pairs: Indices, of: Indices, centre: Array, sigma: float, normal: Array, right: Array
) -> None:
    """Add what the pairs ask of their two scans to the normal equations, `(k, 3, 3)` and `(k, 3)`.

    A pair asks that both ends of what it shares meet, with the weight of its metres; what is far
    beyond sigma, metres, counts less.
    """
    row = np.empty(3)
    for p in range(len(pairs)):
        i, j = pairs[p, 0], pairs[p, 1]
        low, high, one, two = _overlap_of(s, i, j)
        if high <= low:
            continue
        begin_x, begin_y, dx, dy = line_through(s[i])
        far = max(abs(one), abs(two)) / (2 * sigma)
        weight = (high - low) / (sigma * (1 + far * far)) ** 2
        for side in range(2):
            k = of[i] if side == 0 else of[j]
            sign = 1.0 if side == 0 else -1.0
            for end in range(2):
                at, off = (low, one) if end == 0 else (high, two)
                x, y = begin_x + at * dx - centre[k, 0], begin_y + at * dy - centre[k, 1]
                row[0], row[1], row[2] = -dy, dx, x * dx + y * dy
                for a in range(3):
                    right[k, a] += weight * sign * off * row[a]
                    for b in range(3):
                        normal[k, a, b] += weight * row[a] * row[b]
