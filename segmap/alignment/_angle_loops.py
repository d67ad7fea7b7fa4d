"""The loops of angle correspondence: plain Python, compiled when called.

A *corner* is a row of 10 numbers for two segments i, j that are not parallel: where their lines
meet (x, y), the direction of i, the turn from i to j in (0, pi), between which distances from the
meeting point i lies along its direction and j along its own, and the lengths of both.
"""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array
from ..kernels import describe, off_segment
from ._sight_loops import least_hidden

#: Thresholds of a match: distance, far and long in metres, and whether D is of whole segments.
Rule = tuple[float, float, float, bool]

#: A 2.7.10: what remains of a match value for each T_p between two segments that do not meet.
FADING = 0.95
#: A pivot of less than this share of the whole says nothing.
SINGULAR = 1e-9


@compiled
def _extent(s: Array, x: float, y: float, dx: float, dy: float) -> tuple[float, float]:
    """Between which distances from (x, y) along (dx, dy) a segment `(2, 2)` lies, metres."""
    a = (s[0, 0] - x) * dx + (s[0, 1] - y) * dy
    b = (s[1, 0] - x) * dx + (s[1, 1] - y) * dy
    return min(a, b), max(a, b)


@compiled
def corners(s: Array, pairs: NDArray[np.int64]) -> Array:
    """Corners `(k, 10)` of pairs `(k, 2)` of segments `(n, 2, 2)`, metres and radians."""
    found = np.empty((len(pairs), 10))
    for k in range(len(pairs)):
        p, q = s[pairs[k, 0]], s[pairs[k, 1]]
        px, py, qx, qy = p[1, 0] - p[0, 0], p[1, 1] - p[0, 1], q[1, 0] - q[0, 0], q[1, 1] - q[0, 1]
        angle = np.arctan2(py, px)
        turn = (np.arctan2(qy, qx) - angle) % np.pi
        ux, uy, vx, vy = np.cos(angle), np.sin(angle), np.cos(angle + turn), np.sin(angle + turn)
        far = ((q[0, 0] - p[0, 0]) * vy - (q[0, 1] - p[0, 1]) * vx) / (ux * vy - uy * vx)
        x, y = p[0, 0] + far * ux, p[0, 1] + far * uy
        found[k, :4] = np.array((x, y, angle, turn))
        found[k, 4], found[k, 5] = _extent(p, x, y, ux, uy)
        found[k, 6], found[k, 7] = _extent(q, x, y, vx, vy)
        found[k, 8], found[k, 9] = np.hypot(px, py), np.hypot(qx, qy)
    return found


@compiled
def _shared(a: float, b: float, c: float, d: float, way: int) -> float:
    """Length that the intervals a..b and c..d (looked at the other way for -1) share, metres."""
    return min(b, d) - max(a, c) if way == 1 else min(b, -c) - max(a, -d)


@compiled
def _superposed(a: Array, b: Array, way: int) -> tuple[float, float, float]:
    """Pose that carries corner b onto corner a, `(10,)` each; metres and radians.

    The longer walls decide the turn (A 3.3.1).
    """
    at_i, at_j = min(a[8], b[8]) ** 2, min(a[9], b[9]) ** 2
    heading = a[2] - b[2] + at_j / (at_i + at_j) * (a[3] - b[3]) + (0.0 if way == 1 else np.pi)
    c, s = np.cos(heading), np.sin(heading)
    return a[0] - c * b[0] + s * b[1], a[1] - s * b[0] - c * b[1], heading


@compiled
def superpose(first: Array, second: Array, angle: float, share: float) -> Array:
    """Poses that superpose similar corners, and by how many metres of wall: `(m, 4)`.

    Both walls of the one must cover those of the other by a share of the shorter.
    """
    found, count = np.empty((1024, 4)), 0
    for a in first:
        for b in second:
            if abs(a[3] - b[3]) > angle:
                continue
            for way in (1, -1):  # a line has no direction: half a turn more is as good
                on_i = _shared(a[4], a[5], b[4], b[5], way)
                on_j = _shared(a[6], a[7], b[6], b[7], way)
                if on_i < share * min(a[8], b[8]) or on_j < share * min(a[9], b[9]):
                    continue
                if count == len(found):
                    found = np.concatenate((found, np.empty_like(found)))
                x, y, heading = _superposed(a, b, way)
                found[count] = np.array((x, y, heading, on_i + on_j))
                count += 1
    return found[:count]


@compiled
def moved(s: Array, pose: Array) -> Array:
    """Segments `(n, 2, 2)`, metres, carried by a pose `(3,)`, metres and radians."""
    out, cos, sin = np.empty_like(s), np.cos(pose[2]), np.sin(pose[2])
    for i in range(len(s)):
        for k in range(2):
            out[i, k, 0] = pose[0] + cos * s[i, k, 0] - sin * s[i, k, 1]
            out[i, k, 1] = pose[1] + sin * s[i, k, 0] + cos * s[i, k, 1]
    return out


@compiled
def _common(s: Array, a: Array, i: int, t: Array, j: int, far: float) -> tuple[float, float, bool]:
    """What segment j of t says to the described segment i of s, both in one frame, metres.

    The length of i that it covers when projected on it; how far it lies off the line of i there
    (infinite where all of it is farther than `far`); and whether it reaches both sides of the line.
    """
    x, y, dx, dy = s[i, 0, 0], s[i, 0, 1], a[i, 2], a[i, 3]
    x0, y0, x1, y1 = t[j, 0, 0] - x, t[j, 0, 1] - y, t[j, 1, 0] - x, t[j, 1, 1] - y
    v0, v1 = y0 * dx - x0 * dy, y1 * dx - x1 * dy
    if min(v0, v1) > far or max(v0, v1) < -far:
        return 0.0, np.inf, False
    u0, u1 = x0 * dx + y0 * dy, x1 * dx + y1 * dy
    low, high = max(min(u0, u1), 0.0), min(max(u0, u1), 2 * a[i, 4])
    if high <= low:
        return 0.0, np.inf, False
    slope = (v1 - v0) / (u1 - u0)
    off = max(abs(v0 + slope * (low - u0)), abs(v0 + slope * (high - u0)))
    return high - low, off, v0 * v1 <= 0


@compiled
def _hausdorff(u: Array, v: Array) -> float:
    """The smaller of the two directed Hausdorff distances of segments `(2, 2)` (A 2.39), metres."""
    there = max(off_segment(v[0, 0], v[0, 1], u), off_segment(v[1, 0], v[1, 1], u))
    back = max(off_segment(u[0, 0], u[0, 1], v), off_segment(u[1, 0], u[1, 1], v))
    return min(there, back)


@compiled
def match_value(s: Array, a: Array, i: int, t: Array, b: Array, j: int, rule: Rule) -> float:
    """Length, in metres, that two described segments say together (A 2.7.10); 0 for no match.

    Segment i of s `(n, 2, 2)`, which a `(n, 5)` describes, and j of t `(m, 2, 2)`, which b does, in
    one frame, metres.
    """
    distance, far, long, whole = rule
    on_i, off_i, past_i = _common(s, a, i, t, j, far)
    if on_i == 0.0:
        return 0.0
    on_j, off_j, past_j = _common(t, b, j, s, i, far)
    if on_j == 0.0:
        return 0.0
    apart = _hausdorff(s[i], t[j]) if whole else min(off_i, off_j)
    if apart > far:
        return 0.0
    if not (past_i and past_j):
        return (on_i + on_j) / 2 * FADING ** (apart / distance)
    # two looks at one long wall cross as well, at next to no angle: A would lose them
    across = abs(a[i, 2] * b[j, 3] - a[i, 3] * b[j, 2])
    steep = across > abs(a[i, 2] * b[j, 2] + a[i, 3] * b[j, 3])
    return 0.0 if steep and 2 * min(a[i, 4], b[j, 4]) > long else (on_i + on_j) / 2


@compiled
def match_values(s: Array, t: Array, rule: Rule) -> Array:
    """Match value of every pair, `(n, m)`, metres, of segments in one frame."""
    a, b, found = describe(s), describe(t), np.empty((len(s), len(t)))
    for i in range(len(s)):
        for j in range(len(t)):
            found[i, j] = match_value(s, a, i, t, b, j, rule)
    return found


@compiled
def values(s: Array, t: Array, poses: Array, rule: Rule) -> Array:
    """Value of each pose `(k, 3)` of t in the frame of s: the sum of match values, metres."""
    a, found = describe(s), np.zeros(len(poses))
    for k in range(len(poses)):
        there = moved(t, poses[k])
        b = describe(there)
        for i in range(len(s)):
            for j in range(len(there)):
                found[k] += match_value(s, a, i, there, b, j, rule)
    return found


@compiled
def distinct(poses: Array, worth: Array, most: int, place: float, turn: float) -> NDArray[np.int64]:
    """Indices `(k,)` of the best poses, best first, each unlike all before it (metres, radians)."""
    chosen, count = np.empty(most, np.int64), 0
    for k in np.argsort(-worth, kind="mergesort"):
        new = True
        for c in chosen[:count]:
            dx, dy = poses[k, 0] - poses[c, 0], poses[k, 1] - poses[c, 1]
            around = abs((poses[k, 2] - poses[c, 2] + np.pi) % (2 * np.pi) - np.pi)
            new = new and (dx * dx + dy * dy > place * place or around > turn)
        if new:
            chosen[count] = k
            count += 1
        if count == most:
            break
    return chosen[:count]


@compiled
def constraints(s: Array, t: Array, value: Array) -> Array:
    """What matched segments say of a small motion of t, `(k, 5)`: both ends of each common part.

    A row holds the normal of the segment of s, the lever of a turn about the origin, the offset
    (metres) that the motion should undo, and the match value (metres) as its weight.
    """
    found, count = np.empty((2 * int(np.sum(value > 0)), 5)), 0
    for i in range(len(s)):
        x, y = s[i, 0, 0], s[i, 0, 1]
        length = np.hypot(s[i, 1, 0] - x, s[i, 1, 1] - y)
        dx, dy = (s[i, 1, 0] - x) / length, (s[i, 1, 1] - y) / length
        for j in range(len(t)):
            if value[i, j] <= 0:
                continue
            low = (t[j, 0, 0] - x) * dx + (t[j, 0, 1] - y) * dy
            high = (t[j, 1, 0] - x) * dx + (t[j, 1, 1] - y) * dy
            for k in range(2):
                inside = min(max(low if k == 0 else high, 0.0), length)
                part = (inside - low) / (high - low)
                px = t[j, 0, 0] + part * (t[j, 1, 0] - t[j, 0, 0])
                py = t[j, 0, 1] + part * (t[j, 1, 1] - t[j, 0, 1])
                off = (py - y) * dx - (px - x) * dy
                found[count] = np.array((-dy, dx, px * dx + py * dy, off, value[i, j]))
                count += 1
    return found


@compiled
def _solved(rows: Array) -> tuple[float, float, float]:
    """Small motion x, y, turn that undoes the offsets of weighted `constraints`, rows `(k, 5)`.

    Metres and radians; 0 where they do not fix it.
    """
    m = np.zeros((3, 4))
    for r in rows:
        for i in range(3):
            for k in range(4):
                m[i, k] += r[4] * r[i] * r[k]
    size = m[0, 0] + m[1, 1] + m[2, 2]
    for i in range(3):
        if m[i, i] <= SINGULAR * size:
            return 0.0, 0.0, 0.0
        for j in range(i + 1, 3):
            m[j] -= m[j, i] / m[i, i] * m[i]
    turn = -m[2, 3] / m[2, 2]
    y = -(m[1, 3] + m[1, 2] * turn) / m[1, 1]
    return -(m[0, 3] + m[0, 2] * turn + m[0, 1] * y) / m[0, 0], y, turn


@compiled
def refined(s: Array, t: Array, pose: Array, rounds: int, rule: Rule) -> Array:
    """The pose of t in the frame of s, (3,) array, metres and radians, made better.

    Segments s `(n, 2, 2)` and t `(m, 2, 2)`, metres: it moves until matched ones lie on each other,
    where that gains value.
    """
    found, worth = pose.copy(), match_values(s, moved(t, pose), rule).sum()
    for _ in range(rounds):
        there = moved(t, found)
        x, y, turn = _solved(constraints(s, there, match_values(s, there, rule)))
        c, d, at_x, at_y = np.cos(turn), np.sin(turn), found[0], found[1]
        found = np.array((x + c * at_x - d * at_y, y + d * at_x + c * at_y, found[2] + turn))
    return found if match_values(s, moved(t, found), rule).sum() >= worth else pose


@compiled
def weighed(
    s: Array, from_s: Array, t: Array, from_t: Array, poses: Array, margin: float, rule: Rule
) -> Array:
    """Value of each pose, and length hidden from places `from_s` and `from_t`: `(k, 2)`, metres."""
    found = np.empty((len(poses), 2))
    for k in range(len(poses)):
        there, places = moved(t, poses[k]), from_t.copy()
        c, d = np.cos(poses[k, 2]), np.sin(poses[k, 2])
        for i in range(len(places)):
            places[i, 0] = poses[k, 0] + c * from_t[i, 0] - d * from_t[i, 1]
            places[i, 1] = poses[k, 1] + d * from_t[i, 0] + c * from_t[i, 1]
        found[k, 0] = match_values(s, there, rule).sum()
        found[k, 1] = least_hidden(from_s, s, there, margin)
        found[k, 1] += least_hidden(places, there, s, margin)
    return found
