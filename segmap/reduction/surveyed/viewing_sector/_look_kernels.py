"""What a scan says of the map (A 2.7.5): metres, and shares of lengths, t."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....compiled import compiled
from ....kernels import length_of
from ..._index import LEVEL, Index, enter, leave, meeting
from ..._runner import Indices

#: Lengths closer than this, in metres, are equal; so are mean distances within TIE.
SAME, TIE = 1e-9, 1e-12
#: Turns by which a sector is looked at wider, for what rounding would hide.
ROUNDING = 1e-6
#: What a stretch of a scan says of a wall.
MATCHES, HIDES, GONE = 0.0, 1.0, 2.0


class Walls(NamedTuple):
    """Segments with what lies behind them: of the map, or of one scan."""

    s: Array  # (n, 2, 2)
    sums: Array  # (n, 6) number of points, their mean, and xx, xy, yy of their scatter about it
    node: Indices  # of the family tree that each wall of the map is; the input for a scan


class Claims(NamedTuple):
    """What a scan says of the map, wall after wall."""

    wall: Indices  # which wall of the map
    segment: Indices  # a stretch of which segment of the scan matches
    data: Array  # (q, 5) t0 and t1 of it, its mean distance from the wall, where it falls on that
    gone_of: Indices  # walls that have lost a piece
    gone: Array  # (g, 2) where that piece was


class Room(NamedTuple):
    """Room to work in, for c segments of the scan and q claims."""

    marks: Array  # (3 c, 6) what the scan says of one wall: what, from, to, t0, t1, mean distance
    cuts: Array  # (6 c + 2 q + 2,)
    head: Indices  # (c,) first claim on each segment of the scan, lowest wall first
    after: Indices  # (q,)
    stretch: Array  # (c + 2 q, 2) t0 and t1 of the stretches that the claims share out
    owner: Indices  # (c + 2 q, 3) segment, claim that gets it, wall of the new map that it joins
    first: Indices  # first piece of each wall in the new map
    arcs: Index  # sectors of the segments, in turns: 2 j, and what is beyond a turn, 2 j + 1
    arc: Array  # (2, 2) one of them
    beside: Indices  # (2 c + 1,) those that may be in a sector
    seen: Indices  # (c,) the last wall that each was compared with


@compiled
def cross(px: float, py: float, a: Array, b: Array) -> float:
    """Twice the area of the triangle of a point and two points, (2,) array each."""
    return (a[0] - px) * (b[1] - py) - (a[1] - py) * (b[0] - px)


@compiled
def _seen(s: Array, px: float, py: float, narrow: float) -> float:
    """Twice the area between a segment, (2, 2), and the sensor; 0 for one that is seen edge on."""
    double = cross(px, py, s[0], s[1])
    far = np.hypot(s[0, 0] - px, s[0, 1] - py) * np.hypot(s[1, 0] - px, s[1, 1] - py)
    return double if abs(double) >= max(narrow * far, SAME * length_of(s)) else 0.0


@compiled
def share(left: float, right: float) -> float:
    """Share of the length of a wall where a ray meets it, from the areas on both sides of it."""
    return left / (left + right) if left + right != 0.0 else 0.0


@compiled
def _view(
    wall: Array, s: Array, px: float, py: float, double: float, limit: float, out: Array, n: int
) -> int:
    """Steps 1 to 3: append what the stretches of s in the sector of a wall say of it.

    A row of `out` is: what, where it falls on the wall, t0, t1, mean distance. How many there are.
    """
    sign, t0, t1 = 1.0 if double > 0.0 else -1.0, 0.0, 1.0
    left0, left1 = sign * cross(px, py, wall[0], s[0]), sign * cross(px, py, wall[0], s[1])
    if left0 < 0.0 and left1 <= 0.0:
        return n
    right0, right1 = sign * cross(px, py, s[0], wall[1]), sign * cross(px, py, s[1], wall[1])
    if right0 < 0.0 and right1 <= 0.0:
        return n
    if left0 < 0.0:
        t0 = max(t0, left0 / (left0 - left1))
    elif left1 < 0.0:
        t1 = min(t1, left0 / (left0 - left1))
    if right0 < 0.0:
        t0 = max(t0, right0 / (right0 - right1))
    elif right1 < 0.0:
        t1 = min(t1, right0 / (right0 - right1))
    size = length_of(wall)
    h0 = sign * cross(wall[0, 0], wall[0, 1], wall[1], s[0]) / size
    h1 = sign * cross(wall[0, 0], wall[0, 1], wall[1], s[1]) / size
    a = b = t1
    if h1 != h0:  # nothing is cut off that lies at the limit
        a, b = (limit - h0) / (h1 - h0), (-limit - h0) / (h1 - h0)
        a, b = min(a, b), max(a, b)
        a = a if min(a - t0, t1 - a) * abs(h1 - h0) > SAME else t0
        b = b if min(b - t0, t1 - b) * abs(h1 - h0) > SAME else t0
    begin, own = t0, length_of(s)
    for end in (a, max(a, b), t1):
        if (end - begin) * own > SAME:
            h = h0 + (begin + end) / 2 * (h1 - h0)
            out[n, 0] = HIDES if h > limit + SAME else GONE if h < -limit - SAME else MATCHES
            u = size * share(left0 + begin * (left1 - left0), right0 + begin * (right1 - right0))
            v = size * share(left0 + end * (left1 - left0), right0 + end * (right1 - right0))
            out[n, 1], out[n, 2], out[n, 3], out[n, 4] = min(u, v), max(u, v), begin, end
            v, w = h0 + begin * (h1 - h0), h0 + end * (h1 - h0)
            out[n, 5] = abs(v + w) / 2
            if v * w < 0.0:  # the mean of what changes its sign
                out[n, 5] = (v * v + w * w) / (2 * (abs(v) + abs(w)))
            n += 1
        begin = max(begin, end)
    return n


@compiled
def sort(values: Array, count: int) -> None:
    """Sort a few numbers in place, by insertion."""
    for i in range(1, count):
        value, k = values[i], i
        while k > 0 and values[k - 1] > value:
            values[k] = values[k - 1]
            k -= 1
        values[k] = value


@compiled
def _lost(room: Room, count: int, min_length: float, k: int, claims: Claims, g: int) -> int:
    """Step 5: append the pieces of wall k that were seen through, and by no other stretch held."""
    marks, cuts = room.marks, room.cuts
    for i in range(count):
        cuts[2 * i], cuts[2 * i + 1] = marks[i, 1], marks[i, 2]
    sort(cuts, 2 * count)
    begin, end = 0.0, -1.0
    for c in range(2 * count):
        gone = held = False
        if c + 1 < 2 * count:
            middle = (cuts[c] + cuts[c + 1]) / 2
            for i in range(count):
                if marks[i, 1] <= middle <= marks[i, 2]:
                    gone = gone or marks[i, 0] == GONE
                    held = held or marks[i, 0] != GONE
            if cuts[c + 1] - cuts[c] <= SAME:
                continue
        if gone and not held:
            begin = begin if end >= begin else cuts[c]
            end = cuts[c + 1]
        else:
            if end > begin and end - begin >= min_length - SAME:
                if g < len(claims.gone):
                    claims.gone_of[g], claims.gone[g, 0], claims.gone[g, 1] = k, begin, end
                g += 1
            begin, end = 0.0, -1.0
    return g


@compiled
def _sector(a: Array, b: Array, px: float, py: float, arc: Array) -> None:
    """Write where the sector from point a to b, (2,) array each, begins and ends, in turns."""
    begin = np.arctan2(a[1] - py, a[0] - px) / (2 * np.pi) % 1.0
    width = (np.arctan2(b[1] - py, b[0] - px) / (2 * np.pi) - begin) % 1.0
    arc[0, 0], arc[1, 0] = begin, begin + (width if width <= 0.75 else 0.0)  # 0, but for rounding


@compiled
def look(
    map: Walls,
    scan: Walls,
    p: Array,
    distance: float,
    min_length: float,
    forget: bool,
    room: Room,
    claims: Claims,
) -> tuple[int, int]:
    """How many claims and how many pieces that are gone; written as far as there is room."""
    found, g, marks, arc, px, py = 0, 0, room.marks, room.arc, p[0], p[1]
    for j in range(len(scan.s)):
        if _seen(scan.s[j], px, py, 0.0) == 0.0:
            continue
        _sector(scan.s[j, 1], scan.s[j, 0], px, py, arc)
        room.seen[j] = -1
        enter(room.arcs, 2 * j, arc, 0.0)
        if arc[1, 0] > 1.0:  # it ends in the next turn
            arc[0, 0], arc[1, 0] = 0.0, arc[1, 0] - 1.0
            enter(room.arcs, 2 * j + 1, arc, 0.0)
    for k in range(len(map.s)):
        wall = map.s[k]
        double = _seen(wall, px, py, 1e-6)
        if double == 0.0:
            continue
        a, b = (0, 1) if double > 0.0 else (1, 0)
        _sector(wall[a], wall[b], px, py, arc)
        n, any_gone = 0, False
        for _ in range(2 if arc[1, 0] > 1.0 - ROUNDING or arc[0, 0] < ROUNDING else 1):
            for i in range(meeting(room.arcs, arc, ROUNDING, room.beside)):
                j = room.beside[i] // 2
                if room.seen[j] == k:
                    continue
                room.seen[j], before = k, n
                n = _view(wall, scan.s[j], px, py, double, distance, marks, n)
                for m in range(before, n):
                    any_gone = any_gone or marks[m, 0] == GONE
                    if marks[m, 0] == MATCHES:
                        if found < len(claims.wall):
                            claims.wall[found], claims.segment[found] = k, j
                            data = claims.data[found]
                            data[0], data[1], data[2] = marks[m, 3], marks[m, 4], marks[m, 5]
                            data[3], data[4] = marks[m, 1], marks[m, 2]
                        found += 1
            turn = 1.0 if arc[0, 0] < ROUNDING else -1.0
            arc[0, 0], arc[1, 0] = arc[0, 0] + turn, arc[1, 0] + turn
        if forget and any_gone:
            g = _lost(room, n, min_length, k, claims, g)
    for j in range(2 * len(scan.s)):
        if room.arcs.link[j, LEVEL] >= 0:
            leave(room.arcs, j)
    return found, g
