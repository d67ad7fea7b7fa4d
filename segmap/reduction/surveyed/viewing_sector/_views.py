"""The viewing sector, steps 1 to 3 and 5: what a scan says of the map; compiled when called.

Lengths are in metres. A stretch of a segment of the scan is named by the shares t0 to t1 of its
length, a stretch of a wall by metres.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....compiled import compiled
from ..._runner import Indices

#: Lengths closer than this, in metres, are equal; so are mean distances within TIE.
SAME, TIE = 1e-9, 1e-12
#: Turns by which a sector is looked at wider, for what rounding would hide.
ROUNDING = 1e-6
#: What a stretch of a scan says of a wall.
MATCHES, HIDES, GONE = 0.0, 1.0, 2.0


class Walls(NamedTuple):
    """Segments with what lies behind them: of the map, or of one scan.

    Parameters
    ----------
    s : (n, 2, 2) array, metres
    sums : (n, 6) array
        Number of points, their mean, and xx, xy, yy of their scatter about it.
    node : (n,) int array
        Node of the family tree that each wall of the map is; row of the input for a scan.
    """

    s: Array
    sums: Array
    node: Indices


class Claims(NamedTuple):
    """What a scan says of the map, wall after wall.

    Parameters
    ----------
    wall, segment : (q,) int array
        Which wall of the map a stretch of which segment of the scan matches.
    data : (q, 5) array
        t0 and t1 of the stretch, its mean distance from the wall, and where it falls on the wall.
    gone_of : (g,) int array
        Walls that have lost a piece.
    gone : (g, 2) array, metres
        Where that piece was.
    """

    wall: Indices
    segment: Indices
    data: Array
    gone_of: Indices
    gone: Array


class Room(NamedTuple):
    """Room to work in: stretches of one wall, cuts, and the stretches that the claims share out.

    Parameters
    ----------
    marks : (3 c, 6) array
        What the c segments of the scan say of one wall: what, from, to, t0, t1, mean distance.
    cuts : (6 c + 2 q + 2,) array
    head, after : (c,), (q,) int array
        Claims on each segment of the scan, lowest wall first.
    stretch : (c + 2 q, 2) array
        t0 and t1.
    owner : (c + 2 q, 3) int array
        Segment, claim that gets it, and wall of the new map that it joins; -1 for none.
    first : (m + 1,) int array
        First piece of each wall in the new map.
    bins : (2 b,) int array, b a power of two
        First segment of the scan in each bin: a circle of 1 bin, then of 2, 4, ... b bins.
    beside, near : (c,) int array
        Next segment in the bin of each; those that may be in a sector.
    """

    marks: Array
    cuts: Array
    head: Indices
    after: Indices
    stretch: Array
    owner: Indices
    first: Indices
    bins: Indices
    beside: Indices
    near: Indices


@compiled
def cross(px: float, py: float, a: Array, b: Array) -> float:
    """Twice the area of the triangle of a point and two points, (2,) array each."""
    return (a[0] - px) * (b[1] - py) - (a[1] - py) * (b[0] - px)


@compiled
def size_of(s: Array) -> float:
    return np.hypot(s[1, 0] - s[0, 0], s[1, 1] - s[0, 1])


@compiled
def share(left: float, right: float) -> float:
    """Share of the length of a wall where a ray meets it, from the areas on both sides of it."""
    return left / (left + right) if left + right != 0.0 else 0.0


@compiled
def _mean_off(a: float, b: float) -> float:
    """Mean of |h| while h goes evenly from a to b."""
    if a * b >= 0.0:
        return abs(a + b) / 2
    return (a * a + b * b) / (2 * (abs(a) + abs(b)))


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
    size = size_of(wall)
    h0 = sign * cross(wall[0, 0], wall[0, 1], wall[1], s[0]) / size
    h1 = sign * cross(wall[0, 0], wall[0, 1], wall[1], s[1]) / size
    a = b = t1
    if h1 != h0:
        a, b = (limit - h0) / (h1 - h0), (-limit - h0) / (h1 - h0)
        a, b = min(max(min(a, b), t0), t1), min(max(a, b), t1)
    begin, own = t0, size_of(s)
    for end in (a, max(a, b), t1):
        if (end - begin) * own > SAME:
            h = h0 + (begin + end) / 2 * (h1 - h0)
            out[n, 0] = HIDES if h > limit + SAME else GONE if h < -limit - SAME else MATCHES
            u = size * share(left0 + begin * (left1 - left0), right0 + begin * (right1 - right0))
            v = size * share(left0 + end * (left1 - left0), right0 + end * (right1 - right0))
            out[n, 1], out[n, 2], out[n, 3], out[n, 4] = min(u, v), max(u, v), begin, end
            out[n, 5] = _mean_off(h0 + begin * (h1 - h0), h0 + end * (h1 - h0))
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
def _sector(a: Array, b: Array, px: float, py: float) -> tuple[float, float]:
    """Where the sector from point a to b, (2,) array each, begins, and its width; in turns."""
    begin = np.arctan2(a[1] - py, a[0] - px) / (2 * np.pi)
    return begin, (np.arctan2(b[1] - py, b[0] - px) / (2 * np.pi) - begin) % 1.0


@compiled
def _fill_bins(scan: Walls, px: float, py: float, room: Room) -> None:
    """Put each segment into the smallest bin as wide as its sector that its sector begins in."""
    bins = room.bins
    for i in range(len(bins)):
        bins[i] = -1
    for j in range(len(scan.s)):
        begin, width = _sector(scan.s[j, 1], scan.s[j, 0], px, py)
        count = len(bins) // 2
        while count > 1 and width * count > 1.0:
            count //= 2
        b = count + (int(np.floor(begin * count)) & (count - 1))
        room.beside[j], bins[b] = bins[b], j


@compiled
def _beside(room: Room, begin: float, width: float) -> int:
    """Write the segments that may be in a sector, in turns, to `near`, in no order; how many."""
    found, count = 0, len(room.bins) // 2
    while count > 0:
        first = int(np.floor((begin - ROUNDING) * count)) - 1
        last = int(np.floor((begin + width + ROUNDING) * count))
        for b in range(first, min(last + 1, first + count)):
            j = room.bins[count + (b & (count - 1))]
            while j >= 0:
                room.near[found], found = j, found + 1
                j = room.beside[j]
        count //= 2
    return found


@compiled
def look(
    map: Walls,
    count: int,
    scan: Walls,
    p: Array,
    distance: float,
    min_length: float,
    forget: bool,
    room: Room,
    claims: Claims,
) -> tuple[int, int]:
    """How many claims and how many pieces that are gone; written as far as there is room."""
    found, g, marks, px, py = 0, 0, room.marks, p[0], p[1]
    _fill_bins(scan, px, py, room)
    for k in range(count):
        wall = map.s[k]
        double = cross(px, py, wall[0], wall[1])
        far = np.hypot(wall[0, 0] - px, wall[0, 1] - py) * np.hypot(
            wall[1, 0] - px, wall[1, 1] - py
        )
        if abs(double) < 1e-6 * far or double == 0.0:
            continue
        a, b = (0, 1) if double > 0.0 else (1, 0)
        begin, width = _sector(wall[a], wall[b], px, py)
        n, any_gone = 0, False
        for i in range(_beside(room, begin, width)):
            j = room.near[i]
            before = n
            n = _view(wall, scan.s[j], px, py, double, distance, marks, n)
            for m in range(before, n):
                any_gone = any_gone or marks[m, 0] == GONE
                if marks[m, 0] == MATCHES:
                    if found < len(claims.wall):
                        claims.wall[found], claims.segment[found] = k, j
                        data = claims.data
                        data[found, 0], data[found, 1] = marks[m, 3], marks[m, 4]
                        data[found, 2] = marks[m, 5]
                        data[found, 3], data[found, 4] = marks[m, 1], marks[m, 2]
                    found += 1
        if forget and any_gone:
            g = _lost(room, n, min_length, k, claims, g)
    return found, g
