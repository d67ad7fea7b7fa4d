"""Kernels of angle correspondence: corners laid on each other, match values, what is hidden.

A *corner* is a row of 10 numbers for two segments i, j that are not parallel: where their lines
meet (x, y), the direction of i, the turn from i to j in (0, pi), between which distances from the
meeting point i lies along its direction and j along its own, and the lengths of both. Segments are
`(n, 2, 2)` arrays in metres; `a` describes s and `b` describes t, `(n, 5)` each.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from ...kernels import Rule, describe, match_value
from .._walls import constraints, moved_segments

#: The angles of two corners differ by less, radians: a wall of 0.3 m seen with 10 mm of noise leans
#: by 3 degrees.
SIMILAR = np.radians(8)
#: Share of the shorter wall that the other one must cover, for both walls of two corners.
LEAST_COVERED_SHARE = 0.3
#: Least-squares steps of a guess that is refined.
REFINING_ROUNDS = 4
#: What stands so near to a wall, metres, does not hide it: noise, and the far end of a corner.
HIDING_MARGIN_M = 0.10
#: A pivot of less than this share of the whole is rounding.
SINGULAR = 1e-9


@compiled
def superpose(first: Array, second: Array, poses: Array) -> int:
    """Poses that superpose similar corners, and by how many metres of wall: rows of `poses`.

    The longer walls decide the turn (A 3.3.1). Returns how many there are; those beyond the last
    row are not written.
    """
    count = 0
    for i in range(len(first)):
        for j in range(len(second)):
            a, b = first[i], second[j]
            if abs(a[3] - b[3]) > SIMILAR:
                continue
            at_i, at_j = min(a[8], b[8]), min(a[9], b[9])
            turn = at_j * at_j / (at_i * at_i + at_j * at_j) * (a[3] - b[3])
            for way in range(2):  # a line has no direction: half a turn more is as good
                if way == 0:
                    on_i = min(a[5], b[5]) - max(a[4], b[4])
                    on_j = min(a[7], b[7]) - max(a[6], b[6])
                else:
                    on_i = min(a[5], -b[4]) - max(a[4], -b[5])
                    on_j = min(a[7], -b[6]) - max(a[6], -b[7])
                if on_i < LEAST_COVERED_SHARE * at_i or on_j < LEAST_COVERED_SHARE * at_j:
                    continue
                if count < len(poses):
                    heading = a[2] - b[2] + turn + way * np.pi
                    c, s = np.cos(heading), np.sin(heading)
                    poses[count, 0] = a[0] - c * b[0] + s * b[1]
                    poses[count, 1] = a[1] - s * b[0] - c * b[1]
                    poses[count, 2] = heading
                    poses[count, 3] = on_i + on_j
                count += 1
    return count


@compiled
def fill_values(s: Array, a: Array, t: Array, rule: Rule, values: Array) -> float:
    """Write the match value of every pair, metres, to `values`, (n, m) array; return their sum."""
    b, total = describe(t), 0.0
    for i in range(len(s)):
        for j in range(len(t)):
            values[i, j] = match_value(s, a, i, t, b, j, rule)
            total += values[i, j]
    return total


@compiled
def pose_values(s: Array, t: Array, poses: Array, rule: Rule, values: Array) -> None:
    """Value of each pose `(k, 3)` of t in the frame of s, metres: the sum of match values."""
    a, pairs = describe(s), np.empty((len(s), len(t)))
    for k in range(len(poses)):
        there = moved_segments(t, poses[k, 0], poses[k, 1], poses[k, 2], 0.0, 0.0)
        values[k] = fill_values(s, a, there, rule, pairs)


@compiled
def _least_move(rows: Array, count: int) -> tuple[float, float, float]:
    """Small motion x, y, turn that undoes the offsets of so many `constraints`, by least squares.

    Metres and radians; 0 where they do not fix it.
    """
    xx = xy = xt = xo = yy = yt = yo = tt = to = 0.0
    for k in range(count):
        x, y, t, off, weight = rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4]
        xx, xy = xx + weight * x * x, xy + weight * x * y
        xt, xo = xt + weight * x * t, xo + weight * x * off
        yy, yt, yo = yy + weight * y * y, yt + weight * y * t, yo + weight * y * off
        tt, to = tt + weight * t * t, to + weight * t * off
    least = SINGULAR * (xx + yy + tt)
    if xx <= least:
        return 0.0, 0.0, 0.0
    yy, yt, yo = yy - xy / xx * xy, yt - xy / xx * xt, yo - xy / xx * xo
    tt, to = tt - xt / xx * xt, to - xt / xx * xo
    if yy <= least:
        return 0.0, 0.0, 0.0
    tt, to = tt - yt / yy * yt, to - yt / yy * yo
    if tt <= least:
        return 0.0, 0.0, 0.0
    turn = -to / tt
    dy = -(yo + yt * turn) / yy
    return -(xo + xt * turn + xy * dy) / xx, dy, turn


@compiled
def refine(s: Array, t: Array, pose: Array, rule: Rule, rows: Array) -> None:
    """Move a pose of t in the frame of s, (3,) array, metres and radians, until matches lie on it.

    By weighted least squares on the `constraints`, where that gains value. `rows` is room for
    these, (2 n m, 5) array.
    """
    a, value = describe(s), np.empty((len(s), len(t)))
    x, y, heading = pose[0], pose[1], pose[2]
    before = worth = 0.0
    for k in range(REFINING_ROUNDS + 1):
        there = moved_segments(t, x, y, heading, 0.0, 0.0)
        worth = fill_values(s, a, there, rule, value)
        if k == 0:
            before = worth
        if k < REFINING_ROUNDS:
            dx, dy, turn = _least_move(rows, constraints(s, a, there, value, rows))
            c, d = np.cos(turn), np.sin(turn)
            x, y, heading = dx + c * x - d * y, dy + d * x + c * y, heading + turn
    if worth >= before:
        pose[0], pose[1], pose[2] = x, y, heading


@compiled
def _is_hidden(px: float, py: float, x: float, y: float, walls: Array) -> bool:
    """Whether a wall stands between (px, py) and (x, y), clear of both and not by its end only.

    Walls `(n, 2, 2)`, metres; one whose line passes within the margin of (x, y) hides nothing.
    """
    reach = np.hypot(x - px, y - py)
    if reach <= HIDING_MARGIN_M:
        return False
    dx, dy = (x - px) / reach, (y - py) / reach
    for k in range(len(walls)):
        x0, y0, x1, y1 = walls[k, 0, 0], walls[k, 0, 1], walls[k, 1, 0], walls[k, 1, 1]
        a, b = dx * (y0 - py) - dy * (x0 - px), dx * (y1 - py) - dy * (x1 - px)
        if a * b >= 0:
            continue
        wx, wy = x1 - x0, y1 - y0
        size, part = np.hypot(wx, wy), a / (a - b)
        ahead = dx * (x0 + part * wx - px) + dy * (y0 + part * wy - py)
        off = abs((x - x0) * wy - (y - y0) * wx) / size
        clear = HIDING_MARGIN_M / 3 < ahead < reach and off > HIDING_MARGIN_M
        if clear and min(part, 1 - part) * size > HIDING_MARGIN_M / 3:
            return True
    return False


@compiled
def hidden_length(px: float, py: float, s: Array, walls: Array, most: float) -> float:
    """Length of segments, metres, that walls hide from (px, py); it stops counting above `most`.

    Segments `(n, 2, 2)` and walls `(m, 2, 2)`, metres, in one frame; five points of each segment
    are looked at.
    """
    lost = 0.0
    for i in range(len(s)):
        wx, wy = s[i, 1, 0] - s[i, 0, 0], s[i, 1, 1] - s[i, 0, 1]
        for k in range(5):
            part = (k + 0.5) / 5
            if _is_hidden(px, py, s[i, 0, 0] + part * wx, s[i, 0, 1] + part * wy, walls):
                lost += np.hypot(wx, wy) / 5
        if lost > most:
            break
    return lost
