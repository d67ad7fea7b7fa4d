"""The loops that lay a polyline through a chain of segments: plain Python, compiled when called.

Segments are `(m, 2, 2)` arrays, corners the first `count` rows of an array of points, metres.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from ...kernels import SAME, hausdorff
from .._runner import Indices


@compiled
def _distance(p: Array, q: Array) -> float:
    return np.hypot(p[0] - q[0], p[1] - q[1])


@compiled
def nearest_piece(s: Array, corners: Array, count: int) -> tuple[float, int]:
    """Distance of a segment `(2, 2)` from its nearest piece (A 2.39), and which; ties: first."""
    best, at = np.inf, 0
    for k in range(count - 1):
        far = hausdorff(s, corners[k : k + 2])
        if far < best - SAME:
            best, at = far, k
    return best, at


@compiled
def _begin(s: Array, corners: Array) -> None:
    """The two end points that lie farthest apart; ties: the first pair."""
    most = 0.0
    for a in range(2 * len(s)):
        for b in range(a + 1, 2 * len(s)):
            p, q = s[a // 2, a % 2], s[b // 2, b % 2]
            if _distance(p, q) > most + SAME:
                most = _distance(p, q)
                for c in range(2):
                    corners[0, c], corners[1, c] = p[c], q[c]


@compiled
def _put_in(s: Array, corners: Array, count: int, k: int) -> int:
    """Replace piece k, from a to b, by a-s, s and s-b; how many corners there are then."""
    a, b, first = corners[k], corners[k + 1], 0
    straight = _distance(a, s[0]) + _distance(s[1], b)
    if _distance(a, s[1]) + _distance(s[0], b) < straight - SAME:
        first = 1
    new = np.empty((2, 2))
    more = 0
    for end in (first, 1 - first):
        if min(_distance(a, s[end]), _distance(s[end], b)) >= SAME:
            new[more, 0], new[more, 1] = s[end, 0], s[end, 1]
            more += 1
    for j in range(count - 1, k, -1):
        corners[j + more, 0], corners[j + more, 1] = corners[j, 0], corners[j, 1]
    for j in range(more):
        corners[k + 1 + j, 0], corners[k + 1 + j, 1] = new[j, 0], new[j, 1]
    return count + more


@compiled
def _prune(s: Array, corners: Array, count: int, tolerance: float, owner: Indices) -> int:
    """Leave out inner corners while all stay near; how many corners are left.

    `owner` counts the pieces that each segment is near: one less corner is two pieces less and one
    more, so each try looks at three pieces only.
    """
    for i in range(len(s)):
        owner[i] = 0
        for k in range(count - 1):
            owner[i] += hausdorff(s[i], corners[k : k + 2]) < tolerance
    k, link = 1, np.empty((2, 2))
    while k < count - 1:
        for c in range(2):
            link[0, c], link[1, c] = corners[k - 1, c], corners[k + 1, c]
        fits = _distance(link[0], link[1]) >= SAME
        for gone in (False, True):
            for i in range(len(s)):
                if fits:
                    pieces = owner[i] + (hausdorff(s[i], link) < tolerance)
                    pieces -= hausdorff(s[i], corners[k - 1 : k + 1]) < tolerance
                    pieces -= hausdorff(s[i], corners[k : k + 2]) < tolerance
                    if gone:
                        owner[i] = pieces
                    elif pieces == 0:
                        fits = False
        k += 1
        if fits:
            count -= 1
            for j in range(k - 1, count):
                corners[j, 0], corners[j, 1] = corners[j + 1, 0], corners[j + 1, 1]
            k = 1
    return count


@compiled
def trace(s: Array, tolerance: float, corners: Array, owner: Indices) -> int:
    """Write the corners of the polyline of a chain, `(2 m + 2, 2)`; how many they are.

    And for each of the m segments its nearest piece.
    """
    count = 2
    _begin(s, corners)
    for i in range(len(s)):
        owner[i] = 0
    for _ in range(len(s)):
        most, worst, at = -1.0, -1, 0
        for i in range(len(s)):
            if owner[i] == 0:
                far, k = nearest_piece(s[i], corners, count)
                if far > most + SAME:
                    most, worst, at = far, i, k
        if most < tolerance:
            break
        count = _put_in(s[worst], corners, count, at)
        owner[worst] = 1
    if count > 2:
        count = _prune(s, corners, count, tolerance, owner)
    for i in range(len(s)):
        owner[i] = nearest_piece(s[i], corners, count)[1]
    return count
