"""The map of the viewing sector, changed in place: a scan asks the walls of which it can speak."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....compiled import compiled
from ....kernels import length_of, order_by_first
from ..._index import LEVEL, Index, enter, leave, meeting
from ..._runner import Indices
from ._look_kernels import SAME, Claims, Walls

#: A stretch within `distance` of a wall's line is at least 1 - 1 / CLOSE of the way to the wall,
#: where that line passes the sensor no closer than CLOSE times the distance: so 0.6 of the way.
CLOSE = 2.5


class Map(NamedTuple):
    """Walls in no order; rows of removed ones stay empty. Without walls `near` is room to work."""

    walls: Walls
    lines: Array  # (n, 3) of each wall: unit normal, and offset in metres
    places: Array  # (n, 2) where it stands in the order of the map, and how much of that is its own
    boxes: Index  # around the walls
    rows: Indices  # (2 n + 1,) walls that a scan can speak of, in the order of the map
    near: Walls  # and they themselves


@compiled
def put(map: Map, row: int, walls: Walls, i: int, place: float, width: float) -> None:
    """Write wall i of these into a free row of the map."""
    s, to = walls.s[i], map.walls.s[row]
    for e in range(2):
        to[e, 0], to[e, 1] = s[e, 0], s[e, 1]
    for m in range(6):
        map.walls.sums[row, m] = walls.sums[i, m]
    map.walls.node[row] = walls.node[i]
    size, line = max(length_of(s), SAME), map.lines[row]
    line[0], line[1] = (s[1, 1] - s[0, 1]) / size, (s[0, 0] - s[1, 0]) / size
    line[2] = line[0] * s[0, 0] + line[1] * s[0, 1]
    map.places[row, 0], map.places[row, 1] = place, width
    enter(map.boxes, row, s, 0.0)


@compiled
def tidy(map: Map, order: Indices, out: Map) -> None:
    """Write walls of a map, in this order, into one that is empty."""
    for i in range(len(order)):
        put(out, i, map.walls, order[i], float(i), 1.0)


@compiled
def nearby(map: Map, used: int, scan: Walls, p: Array, distance: float) -> int:
    """Write the walls that a scan can match or see through, `near`; how many. It hides the rest."""
    rows, near, lines, count = map.rows, map.near, map.lines, 0
    ends = np.empty((2 * len(scan.s) + 1, 2))
    ends[0, 0], ends[0, 1] = p[0], p[1]
    for j in range(2 * len(scan.s)):
        for k in range(2):  # twice as far as need be at most 1 / 0.6 times
            ends[j + 1, k] = 2 * scan.s[j // 2, j % 2, k] - p[k]
    count = meeting(map.boxes, ends, 0.0, rows)
    for i in range(used):
        off = abs(lines[i, 0] * p[0] + lines[i, 1] * p[1] - lines[i, 2])
        if off < CLOSE * distance and map.boxes.link[i, LEVEL] >= 0:
            rows[count] = i
            count += 1
    found, order, keys, n = rows[:count].copy(), rows[:count], np.empty((count, 1)), 0
    for i in range(count):
        keys[i, 0] = map.places[found[i], 0]
    order_by_first(order, keys)
    for i in range(count):
        row = found[order[i]]
        if n == 0 or row != rows[n - 1]:  # both rules may have found it
            rows[n] = row
            for e in range(2):
                for k in range(2):
                    near.s[n, e, k] = map.walls.s[row, e, k]
            for m in range(6):
                near.sums[n, m] = map.walls.sums[row, m]
            near.node[n] = map.walls.node[row]
            n += 1
    return n


@compiled
def put_back(
    map: Map,
    used: int,
    count: int,
    claims: Claims,
    found: tuple[int, int],
    first: Indices,
    out: Walls,
    n: int,
) -> tuple[int, float]:
    """Replace those of `count` walls near that a scan spoke of by their pieces; add what is new.

    How many rows are used then; the smallest part of the order that a piece has as its own.
    """
    c, g, k, least = 0, 0, 0, 1.0
    while c < found[0] or g < found[1]:
        k = claims.wall[c] if c < found[0] else claims.gone_of[g]
        k = min(k, claims.gone_of[g]) if g < found[1] else k
        while c < found[0] and claims.wall[c] == k:
            c += 1
        while g < found[1] and claims.gone_of[g] == k:
            g += 1
        row, begin = map.rows[k], first[k]
        leave(map.boxes, row)
        place, width = map.places[row, 0], map.places[row, 1] / max(first[k + 1] - begin, 1)
        least = min(least, width)
        for i in range(begin, first[k + 1]):
            put(map, row if i == begin else used, out, i, place + (i - begin) * width, width)
            used += i > begin
    for i in range(first[count], n):  # no wall stands behind its row in the order
        put(map, used, out, i, float(used), 1.0)
        used += 1
    return used, least
