"""Small compiled loops that the kernels of several packages call: segments apart, cells of a grid.

They take plain numbers and rows of arrays, check nothing, and are called from compiled loops only.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .arrays import Array
from .compiled import compiled
from .segments import MIN_LENGTH

Indices = NDArray[np.int64]
Window = Indices | tuple[int, int, int, int]
#: Weight of the angle in the segment distance (A 2.7.7).
ANGULAR_WEIGHT = 0.66
#: Weight of the distance across.
ACROSS_WEIGHT = 0.09
#: Weight of the least distance from an end point.
APART_WEIGHT = 0.25
#: Segments whose angle is this near to a right one, radians, have two mean directions.
PERPENDICULAR = 1e-9
#: What is shorter, in metres, is rounding; so is a sine that much larger than a cosine.
SAME = 1e-9
#: A 2.7.10: what remains of a match value for each T_p between two segments that do not meet.
FADING = 0.95
#: A point of a line, metres, and its unit direction.
Line = tuple[float, float, float, float]
#: Thresholds of a match: distance, far and long in metres, and whether D is of whole segments.
Rule = tuple[float, float, float, bool]


@compiled
def describe_one(s: Array, out: Array) -> None:
    """A row of what `describe` returns, for one segment, (2, 2)."""
    out[0], out[1] = (s[0, 0] + s[1, 0]) / 2, (s[0, 1] + s[1, 1]) / 2
    dx, dy = s[1, 0] - s[0, 0], s[1, 1] - s[0, 1]
    norm = np.hypot(dx, dy)
    out[2], out[3], out[4] = 0.0, 0.0, norm / 2
    if norm >= MIN_LENGTH:
        out[2], out[3] = dx / norm, dy / norm


@compiled
def describe(s: Array) -> Array:
    """Middle, unit direction (0 without length) and half length of segments, `(n, 5)`, metres."""
    out = np.empty((len(s), 5))
    for i in range(len(s)):
        describe_one(s[i], out[i])
    return out


@compiled
def turn_between(a: float, b: float) -> float:
    """Angle from one line's direction to another's, radians, in `[-pi/2, pi/2)`."""
    turn = b - a + np.pi / 2
    return (turn if 0.0 <= turn < np.pi else turn % np.pi) - np.pi / 2  # % takes long


@compiled
def length_of(s: Array) -> float:
    """Length of one segment, (2, 2), metres."""
    return np.hypot(s[1, 0] - s[0, 0], s[1, 1] - s[0, 1])


@compiled
def line_through(s: Array) -> Line:
    """The line from the first end of a segment, (2, 2), to the other: one with a length."""
    x, y, size = s[0, 0], s[0, 1], length_of(s)
    return x, y, (s[1, 0] - x) / size, (s[1, 1] - y) / size


@compiled
def seen_from(line: Line, s: Array) -> tuple[float, float, float, float]:
    """Metres along a line and to the left of it: of one end of a segment, (2, 2), and the other."""
    x, y, dx, dy = line
    px, py, qx, qy = s[0, 0] - x, s[0, 1] - y, s[1, 0] - x, s[1, 1] - y
    return px * dx + py * dy, py * dx - px * dy, qx * dx + qy * dy, qy * dx - qx * dy


@compiled
def off_segment(x: float, y: float, s: Array) -> float:
    """Distance of a point from a segment, a (2, 2) array, metres."""
    return np.sqrt(_square_off(x, y, s))


@compiled
def _square_off(x: float, y: float, s: Array) -> float:
    """Square of the distance of a point from a segment."""
    dx, dy = s[1, 0] - s[0, 0], s[1, 1] - s[0, 1]
    rx, ry = x - s[0, 0], y - s[0, 1]
    square = dx * dx + dy * dy
    t = 0.0 if square == 0.0 else min(max((rx * dx + ry * dy) / square, 0.0), 1.0)
    return (rx - t * dx) ** 2 + (ry - t * dy) ** 2


@compiled
def apart(u: Array, v: Array) -> float:
    """D_uv: least distance from an end point of one to the other, (2, 2) array each, metres."""
    least = np.inf
    for k in range(2):
        least = min(least, _square_off(u[k, 0], u[k, 1], v), _square_off(v[k, 0], v[k, 1], u))
    return np.sqrt(least)


@compiled
def boxes_apart(s: Array, i: int, t: Array, j: int) -> float:
    """Metres along x or y between the boxes of segments i of s and j of t: they are no nearer."""
    most = -np.inf
    for axis in range(2):
        a, b, c, d = s[i, 0, axis], s[i, 1, axis], t[j, 0, axis], t[j, 1, axis]
        most = max(most, min(a, b) - max(c, d), min(c, d) - max(a, b))
    return most


@compiled
def mean_line_terms(a: Array, b: Array) -> tuple[float, float]:
    """D_ang and D_uva, metres, of two segments with equal weights, described by (5,) arrays.

    Both middles lie as far from the mean line, which halves the angle: so D_uva is that distance,
    and the longer half times the sine of half the angle.
    """
    ax, ay, bx, by = a[2], a[3], b[2], b[3]
    if ax == 0.0 and ay == 0.0:
        ax, ay = (bx, by) if bx != 0.0 or by != 0.0 else (1.0, 0.0)
    if bx == 0.0 and by == 0.0:
        bx, by = ax, ay
    dot, cross = ax * bx + ay * by, abs(ax * by - ay * bx)
    if dot < 0.0:
        dot, bx, by = -dot, -bx, -by
    x, y, aside = (a[0] - b[0]) / 2, (a[1] - b[1]) / 2, max(a[4], b[4]) * cross
    most = (abs(y * (ax + bx) - x * (ay + by)) + aside) / np.sqrt(2.0 + 2.0 * dot)
    if dot <= PERPENDICULAR:  # two mean directions: the smaller value counts
        other = (abs(y * (ax - bx) - x * (ay - by)) + aside) / np.sqrt(2.0 - 2.0 * dot)
        most = min(most, other)
    return (a[4] + b[4]) * cross / (1.0 + dot), most


@compiled
def distance_below(u: Array, v: Array, a: Array, b: Array, most: float) -> float:
    """Segment distance (A 2.7.7) of two segments, metres; infinity where it is not below `most`.

    Segments are (2, 2) arrays, which a and b, (5,) arrays, describe.
    """
    turn = abs(a[2] * b[3] - a[3] * b[2])
    if ANGULAR_WEIGHT * (a[4] + b[4]) * turn / 2 >= most:  # tan(a / 2) >= sin(a) / 2
        return np.inf
    angular, across = mean_line_terms(a, b)
    so_far = ANGULAR_WEIGHT * angular + ACROSS_WEIGHT * across
    if so_far >= most:
        return np.inf
    distance = so_far + APART_WEIGHT * apart(u, v)
    return distance if distance < most else np.inf


@compiled
def _overlap(s: Array, a: Array, i: int, t: Array, j: int, far: float) -> tuple[float, float, bool]:
    """What segment j of t says to the described segment i of s, both in one frame, metres.

    The length of i that it covers when projected on it; how far it lies off the line of i there
    (infinite where all of it is farther than `far`); and whether it reaches both sides of the line.
    """
    u0, v0, u1, v1 = seen_from((s[i, 0, 0], s[i, 0, 1], a[i, 2], a[i, 3]), t[j])
    if min(v0, v1) > far or max(v0, v1) < -far:
        return 0.0, np.inf, False
    low, high = max(min(u0, u1), 0.0), min(max(u0, u1), 2 * a[i, 4])
    if high - low <= SAME:
        return 0.0, np.inf, False
    slope = (v1 - v0) / (u1 - u0)
    off = max(abs(v0 + slope * (low - u0)), abs(v0 + slope * (high - u0)))
    return high - low, off, min(v0, v1) <= SAME and max(v0, v1) >= -SAME


@compiled
def hausdorff(u: Array, v: Array) -> float:
    """The smaller of the two directed Hausdorff distances of segments `(2, 2)` (A 2.39), metres."""
    there = back = 0.0
    for k in range(2):
        there = max(there, off_segment(v[k, 0], v[k, 1], u))
        back = max(back, off_segment(u[k, 0], u[k, 1], v))
    return min(there, back)


@compiled
def match_value(s: Array, a: Array, i: int, t: Array, b: Array, j: int, rule: Rule) -> float:
    """Length, metres, on which segment i of s and j of t agree (A 2.7.10); 0 for no match."""
    distance, far, long, whole = rule
    on_i, off_i, past_i = _overlap(s, a, i, t, j, far)
    if on_i == 0.0:
        return 0.0
    on_j, off_j, past_j = _overlap(t, b, j, s, i, far)
    if on_j == 0.0:
        return 0.0
    apart = hausdorff(s[i], t[j]) if whole else min(off_i, off_j)
    if apart > far:
        return 0.0
    if not (past_i and past_j):
        return (on_i + on_j) / 2 * FADING ** (apart / distance)
    # two looks at one long wall cross as well, at next to no angle: A would lose them
    across = abs(a[i, 2] * b[j, 3] - a[i, 3] * b[j, 2])
    steep = across > abs(a[i, 2] * b[j, 2] + a[i, 3] * b[j, 3]) + SAME
    return 0.0 if steep and 2 * min(a[i, 4], b[j, 4]) > long else (on_i + on_j) / 2


@compiled
def replace_by_mean(s: Array, a: int, b: int, share: float, direction: float) -> float:
    """Row a of `(n, 2, 2)`, metres, becomes the mean of rows a and b; its length.

    It runs in a direction, radians, through the mean of both middles, that of b with a share, and
    spans the projections of all four end points.
    """
    dx, dy = np.cos(direction), np.sin(direction)
    x = (1 - share) * (s[a, 0, 0] + s[a, 1, 0]) / 2 + share * (s[b, 0, 0] + s[b, 1, 0]) / 2
    y = (1 - share) * (s[a, 0, 1] + s[a, 1, 1]) / 2 + share * (s[b, 0, 1] + s[b, 1, 1]) / 2
    line = x, y, dx, dy
    (low, high), (begin, end) = span(s[a], line), span(s[b], line)
    low, high = min(low, begin), max(high, end)
    place_on_line(s[a], line, low, high)
    return high - low


@compiled
def order_by_first(order: Indices, rows: Array) -> None:
    """Write which of the rows `(n, k)` comes at each place, by their first column: Shell's sort."""
    count, step = len(order), 1
    while 3 * step < count:
        step = 3 * step + 1
    for k in range(count):
        order[k] = k
    while step > 0:
        for i in range(step, count):
            one, k = order[i], i
            while k >= step and rows[order[k - step], 0] > rows[one, 0]:
                order[k] = order[k - step]
                k -= step
            order[k] = one
        step //= 3


@compiled
def root_of(parent: Indices, i: int) -> int:
    """What stands for the set of i, where each points to another or to itself; halves the way."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@compiled
def join_sums(p: Array, q: Array, out: Array) -> None:
    """Weight, centre and scatter of two sets together, (6,) each; nothing cancels far away."""
    w = p[0] + q[0]
    dx, dy, part = q[1] - p[1], q[2] - p[2], p[0] * q[0] / w
    out[0], out[1], out[2] = w, p[1] + q[0] / w * dx, p[2] + q[0] / w * dy
    out[3], out[4] = p[3] + q[3] + part * dx * dx, p[4] + q[4] + part * dx * dy
    out[5] = p[5] + q[5] + part * dy * dy


@compiled
def span(s: Array, line: Line) -> tuple[float, float]:
    """Low and high projection of a segment, (2, 2), on a line, metres."""
    a, _, b, _ = seen_from(line, s)
    return min(a, b), max(a, b)


@compiled
def span_of(s: Array, members: Indices, line: Line) -> tuple[float, float]:
    """Low and high projection of some of the segments, (n, 2, 2), on a line, metres."""
    low, high = np.inf, -np.inf
    for i in members:
        begin, end = span(s[i], line)
        low, high = min(low, begin), max(high, end)
    return low, high


@compiled
def gap_along(u: Array, v: Array, dx: float, dy: float) -> float:
    """Metres between two segments, (2, 2) each, along a unit direction; below 0 they overlap."""
    (low, high), (begin, end) = span(u, (0.0, 0.0, dx, dy)), span(v, (0.0, 0.0, dx, dy))
    return max(low, begin) - min(high, end)


@compiled
def place_on_line(s: Array, line: Line, low: float, high: float) -> None:
    """Put a segment, (2, 2), on a line, from `low` to `high` along it, metres."""
    x, y, dx, dy = line
    s[0, 0], s[0, 1] = x + low * dx, y + low * dy
    s[1, 0], s[1, 1] = x + high * dx, y + high * dy


class Nodes(NamedTuple):
    """Nodes of a quadtree, four a block, and which blocks hold an occupied cell, `(b,)`."""

    vis: NDArray[np.int32]
    occ: NDArray[np.int32]
    holds: NDArray[np.bool_]


@compiled
def leaves_in(nodes: Nodes, window: Window, todo: Indices, found: Indices) -> int:
    """Write node, x, y (cells) and level of the leaves in a window into `found`, `(n, 4)`.

    All of them, or where blocks that hold an occupied cell are marked, occupied cells alone.
    `window` is left, low, right and high; `todo`, `(3 levels + 4, 4)`, is room to work in, its
    first row holds the root. Returns the number of leaves.
    """
    vis, occ, holds, count, waiting = nodes.vis, nodes.occ, nodes.holds, 0, 1
    every = len(holds) == 0
    while waiting > 0:
        waiting -= 1
        block, x, y = todo[waiting, 0], todo[waiting, 1], todo[waiting, 2]
        level = todo[waiting, 3] - 1
        side = 1 << level
        for q in range(4):
            at_x, at_y = x + side * (q & 1), y + side * (q >> 1)
            if at_x >= window[2] or at_y >= window[3]:
                continue
            if at_x + side <= window[0] or at_y + side <= window[1]:
                continue
            node = 4 * block + q
            child = ~np.int64(vis[node])
            if child >= 0 and (every or holds[child]):
                todo[waiting, 0], todo[waiting, 1] = child, at_x
                todo[waiting, 2], todo[waiting, 3] = at_y, level
                waiting += 1
            elif child < 0 and (every or 2 * np.int64(occ[node]) > vis[node]):
                found[count, 0], found[count, 1] = node, at_x
                found[count, 2], found[count, 3] = at_y, level
                count += 1
    return count
