"""The loop of the quality measure: for each segment, the nearest of another map.

It computes `metrics.segment_distance` with equal weights, without trigonometry, and passes over
every pair whose lower bound exceeds the best pair found so far; so the minimum is exact.
"""

import numpy as np

from ._compiled import compiled
from .arrays import Array
from .segments import MIN_LENGTH

ANGULAR, ACROSS, APART = 0.66, 0.09, 0.25
PERPENDICULAR = 1e-9


@compiled
def describe(s: Array) -> Array:
    """Middle, unit direction (0 without length) and half length of segments, `(n, 5)`, metres."""
    out = np.zeros((len(s), 5))
    for i in range(len(s)):
        out[i, 0] = (s[i, 0, 0] + s[i, 1, 0]) / 2
        out[i, 1] = (s[i, 0, 1] + s[i, 1, 1]) / 2
        dx, dy = s[i, 1, 0] - s[i, 0, 0], s[i, 1, 1] - s[i, 0, 1]
        norm = np.hypot(dx, dy)
        out[i, 4] = norm / 2
        if norm >= MIN_LENGTH:
            out[i, 2], out[i, 3] = dx / norm, dy / norm
    return out


@compiled
def off_segment(x: float, y: float, s: Array) -> float:
    """Distance of a point from a segment, a (2, 2) array, metres."""
    dx, dy = s[1, 0] - s[0, 0], s[1, 1] - s[0, 1]
    rx, ry = x - s[0, 0], y - s[0, 1]
    square = dx * dx + dy * dy
    t = 0.0 if square == 0.0 else min(max((rx * dx + ry * dy) / square, 0.0), 1.0)
    return np.hypot(rx - t * dx, ry - t * dy)


@compiled
def apart(u: Array, v: Array) -> float:
    """D_uv: least distance from an end point of one to the other, (2, 2) array each, metres."""
    least = np.inf
    for k in range(2):
        least = min(least, off_segment(u[k, 0], u[k, 1], v), off_segment(v[k, 0], v[k, 1], u))
    return least


@compiled
def across(u: Array, v: Array, x: float, y: float, dx: float, dy: float) -> float:
    """D_uva: largest distance of an end point from the mean line through (x, y) along (dx, dy).

    Of segments, (2, 2) array each, metres.
    """
    most = 0.0
    for k in range(2):
        most = max(most, abs((u[k, 1] - y) * dx - (u[k, 0] - x) * dy))
        most = max(most, abs((v[k, 1] - y) * dx - (v[k, 0] - x) * dy))
    return most


@compiled
def mean_line_terms(u: Array, v: Array, a: Array, b: Array) -> tuple[float, float]:
    """D_ang and D_uva, metres, of two segments with equal weights, described by (5,) arrays."""
    ax, ay, bx, by = a[2], a[3], b[2], b[3]
    if ax == 0.0 and ay == 0.0:
        ax, ay = (bx, by) if bx != 0.0 or by != 0.0 else (1.0, 0.0)
    if bx == 0.0 and by == 0.0:
        bx, by = ax, ay
    dot, cross = ax * bx + ay * by, ax * by - ay * bx
    if dot < 0.0:
        bx, by = -bx, -by
    x, y = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
    norm = np.hypot(ax + bx, ay + by)
    most = across(u, v, x, y, (ax + bx) / norm, (ay + by) / norm)
    if abs(dot) <= PERPENDICULAR:  # two mean directions: the smaller value counts
        norm = np.hypot(ax - bx, ay - by)
        most = min(most, across(u, v, x, y, (ax - bx) / norm, (ay - by) / norm))
    return (a[4] + b[4]) * abs(cross) / (1.0 + abs(dot)), most


@compiled
def nearest_distances(before: Array, after: Array) -> Array:
    """Distance of each segment of `before` to the nearest one of `after`, `(n,)`, metres."""
    order = np.argsort(after[:, 0, 0] + after[:, 1, 0])
    after = after[order]
    a, b = describe(before), describe(after)
    longest = b[:, 4].max()
    found = np.empty(len(before))
    for i in range(len(before)):
        best = np.inf
        right = int(np.searchsorted(b[:, 0], a[i, 0]))
        left = right - 1
        reach = a[i, 4] + longest
        while left >= 0 or right < len(b):  # outwards from the middle of segment i
            go_left = right >= len(b) or (
                left >= 0 and a[i, 0] - b[left, 0] < b[right, 0] - a[i, 0]
            )
            j = left if go_left else right
            left, right = (left - 1, right) if go_left else (left, right + 1)
            dx, dy = abs(b[j, 0] - a[i, 0]), b[j, 1] - a[i, 1]
            if APART * (dx - reach) >= best:
                break
            bound = np.sqrt(dx * dx + dy * dy) - a[i, 4] - b[j, 4]
            if APART * bound >= best:
                continue
            angular, most = mean_line_terms(before[i], after[j], a[i], b[j])
            so_far = ANGULAR * angular + ACROSS * most
            if so_far + APART * max(bound, 0.0) < best:
                best = min(best, so_far + APART * apart(before[i], after[j]))
        found[i] = best
    return found
