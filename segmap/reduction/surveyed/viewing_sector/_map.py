"""The viewing sector, steps 4 to 7: what stays of the map, and what a scan adds to it; metres."""

from __future__ import annotations

import numpy as np

from ....arrays import Array
from ....compiled import compiled
from ....kernels import lay
from ..._runner import Indices
from ._views import SAME, TIE, Claims, Room, Walls, cross, share, size_of, sort


@compiled
def _write_part(
    wall: Array, sums: Array, t0: float, t1: float, out: Walls, w: int, node: int
) -> None:
    """Put the part t0 to t1 of a wall, and its share of the running sums, into row w."""
    to, of = out.s[w], out.sums[w]
    out.node[w] = node
    if t0 == 0.0 and t1 == 1.0:
        for e in range(2):
            to[e, 0], to[e, 1] = wall[e, 0], wall[e, 1]
        for i in range(6):
            of[i] = sums[i]
        return
    dx, dy = wall[1, 0] - wall[0, 0], wall[1, 1] - wall[0, 1]
    to[0, 0], to[0, 1] = wall[0, 0] + t0 * dx, wall[0, 1] + t0 * dy
    to[1, 0], to[1, 1] = wall[0, 0] + t1 * dx, wall[0, 1] + t1 * dy
    size, f = np.hypot(dx, dy), t1 - t0
    dx, dy, shift = dx / size, dy / size, ((t0 + t1) / 2 - 0.5) * size
    along = sums[0] * f * (f * size) * (f * size) / 12
    across = f * (sums[3] * dy * dy - 2 * sums[4] * dx * dy + sums[5] * dx * dx)
    of[0], of[1], of[2] = sums[0] * f, sums[1] + shift * dx, sums[2] + shift * dy
    of[3] = along * dx * dx + across * dy * dy
    of[4] = (along - across) * dx * dy
    of[5] = along * dy * dy + across * dx * dx


@compiled
def _add_sums(a: Array, b: Array) -> None:
    """Running sums a become those of a and b."""
    n, dx, dy = a[0] + b[0], b[1] - a[1], b[2] - a[2]
    part, both = b[0] / n, a[0] * b[0] / n
    a[0], a[1], a[2] = n, a[1] + part * dx, a[2] + part * dy
    a[3] = a[3] + b[3] + both * dx * dx
    a[4] = a[4] + b[4] + both * dx * dy
    a[5] = a[5] + b[5] + both * dy * dy


@compiled
def _keep(
    map: Walls,
    count: int,
    claims: Claims,
    found: tuple[int, int],
    min_length: float,
    rejoin: bool,
    room: Room,
    out: Walls,
    nodes: int,
    family: Array,
) -> tuple[int, int]:
    """Step 5: write the pieces of all walls that stay; how many walls and nodes there are then."""
    w, c, g, cuts = 0, 0, 0, room.cuts
    for k in range(count):
        room.first[k] = w
        size, begin, cut = size_of(map.s[k]), 0.0, 0
        while c < found[0] and claims.wall[c] == k:
            if not rejoin:
                cuts[cut], cuts[cut + 1] = claims.data[c, 3], claims.data[c, 4]
                cut += 2
            c += 1
        sort(cuts, cut)
        lost = g
        more = True
        while more:
            more = g < found[1] and claims.gone_of[g] == k
            end = claims.gone[g, 0] if more else size
            if end - begin >= min_length - SAME or (g == lost and not more):
                a = begin
                for i in range(cut + 1):
                    b = cuts[i] if i < cut else end
                    if i < cut and min(b - a, end - b) < min_length - SAME:
                        continue
                    whole = a == 0.0 and b == size
                    if not whole:
                        family[nodes, 0], family[nodes, 1] = map.node[k], b / size - a / size
                    node = map.node[k] if whole else nodes
                    nodes += 0 if whole else 1
                    _write_part(map.s[k], map.sums[k], a / size, b / size, out, w, node)
                    w += 1
                    a = b
            if more:
                begin = claims.gone[g, 1]
                g += 1
    room.first[count] = w
    return w, nodes


@compiled
def _share_out(scan: Walls, claims: Claims, found: int, room: Room) -> int:
    """Step 4: each stretch of the scan and the claim that gets it, -1 for none; how many."""
    data, cuts, n = claims.data, room.cuts, 0
    for j in range(len(scan.s)):
        room.head[j] = -1
    for c in range(found - 1, -1, -1):
        room.after[c] = room.head[claims.segment[c]]
        room.head[claims.segment[c]] = c
    for j in range(len(scan.s)):
        size, cuts[0], cuts[1], count, start = size_of(scan.s[j]), 0.0, 1.0, 2, n
        c = room.head[j]
        while c >= 0:
            cuts[count], cuts[count + 1] = data[c, 0], data[c, 1]
            count += 2
            c = room.after[c]
        sort(cuts, count)
        for i in range(count - 1):
            if (cuts[i + 1] - cuts[i]) * size <= SAME:
                continue
            middle, best, least = (cuts[i] + cuts[i + 1]) / 2, -1, np.inf
            for again in range(2):
                c = room.head[j]
                while c >= 0:
                    if data[c, 0] <= middle <= data[c, 1]:
                        if again == 0:
                            least = min(least, data[c, 2])
                        elif best < 0 and data[c, 2] <= least + TIE:
                            best = c
                    c = room.after[c]
            if n > start and room.owner[n - 1, 1] == best:
                room.stretch[n - 1, 1] = cuts[i + 1]
            else:
                room.stretch[n, 0], room.stretch[n, 1] = cuts[i], cuts[i + 1]
                room.owner[n, 0], room.owner[n, 1] = j, best
                n += 1
    return n


@compiled
def _nearest_piece(
    map: Walls, k: int, s: Array, t0: float, t1: float, p: Array, first: Indices, out: Walls
) -> int:
    """The piece of wall k beside the middle of where a stretch falls on it; -1: all gone."""
    wall, size, total = map.s[k], size_of(map.s[k]), 0.0
    left, right = cross(p[0], p[1], wall[0], s[0]), cross(p[0], p[1], s[0], wall[1])
    left1, right1 = cross(p[0], p[1], wall[0], s[1]), cross(p[0], p[1], s[1], wall[1])
    for t in (t0, t1):
        total += share(left + t * (left1 - left), right + t * (right1 - right))
    u, best, least = size * total / 2, -1, np.inf
    dx, dy = (wall[1, 0] - wall[0, 0]) / size, (wall[1, 1] - wall[0, 1]) / size
    for w in range(first[k], first[k + 1]):
        a = (out.s[w, 0, 0] - wall[0, 0]) * dx + (out.s[w, 0, 1] - wall[0, 1]) * dy
        b = (out.s[w, 1, 0] - wall[0, 0]) * dx + (out.s[w, 1, 1] - wall[0, 1]) * dy
        off = max(a - u, u - b, 0.0)
        if off < least - SAME:
            best, least = w, off
    return best


@compiled
def _join(
    map: Walls,
    scan: Walls,
    p: Array,
    claims: Claims,
    stretches: int,
    min_length: float,
    room: Room,
    out: Walls,
    w: int,
    nodes: int,
    family: Array,
    given: Array,
) -> tuple[int, int, int]:
    """Steps 4, 6 and 7: stretches join their pieces or the end of the map; as `renew`."""
    gifts = 0
    # sums before lines: the pieces must lie where they were while stretches look for theirs
    for r in range(stretches):
        j, c, t0, t1 = room.owner[r, 0], room.owner[r, 1], room.stretch[r, 0], room.stretch[r, 1]
        s, sums, piece = scan.s[j], scan.sums[j], -1
        if c >= 0:
            piece = _nearest_piece(map, claims.wall[c], s, t0, t1, p, room.first, out)
        size = (t1 - t0) * size_of(s)
        room.owner[r, 2] = piece
        _write_part(s, sums, t0, t1, out, w, nodes)
        if piece >= 0:
            _add_sums(out.sums[piece], out.sums[w])
        elif c >= 0 or size >= min_length - SAME:
            family[nodes, 0], family[nodes, 1] = -1.0, 1.0
            piece, w, nodes = w, w + 1, nodes + 1
        if piece >= 0:
            given[gifts, 0], given[gifts, 1] = scan.node[j], out.node[piece]
            given[gifts, 2] = size
            gifts += 1
    for r in range(stretches):
        if room.owner[r, 2] >= 0:
            _span(out, room.owner[r, 2], scan.s[room.owner[r, 0]], room.stretch[r])
    return w, nodes, gifts


@compiled
def _span(out: Walls, w: int, s: Array, part: Array) -> None:
    """Put piece w on the line of its sums, where it and the part t0 to t1 of s span it."""
    own, sums, low, high = out.s[w], out.sums[w], np.inf, -np.inf
    turn = 0.5 * np.arctan2(2 * sums[4], sums[3] - sums[5])
    dx, dy, x, y = np.cos(turn), np.sin(turn), sums[1], sums[2]
    if dx * (own[1, 0] - own[0, 0]) + dy * (own[1, 1] - own[0, 1]) < 0.0:
        dx, dy = -dx, -dy
    for e in range(2):
        px = s[0, 0] + part[e] * (s[1, 0] - s[0, 0])
        py = s[0, 1] + part[e] * (s[1, 1] - s[0, 1])
        u = (px - x) * dx + (py - y) * dy
        v = (own[e, 0] - x) * dx + (own[e, 1] - y) * dy
        low, high = min(low, u, v), max(high, u, v)
    lay(own, x, y, dx, dy, low, high)


@compiled
def renew(
    map: Walls,
    count: int,
    scan: Walls,
    p: Array,
    claims: Claims,
    found: tuple[int, int],
    min_length: float,
    rejoin: bool,
    room: Room,
    out: Walls,
    nodes: int,
    family: Array,
    given: Array,
) -> tuple[int, int, int]:
    """The map after a scan, written to `out`; how many walls, nodes and gifts there are then.

    A piece is a new node, whose parent and share of it go into a row of `family`; a gift, a row of
    `given`, is: input, node, metres of the input.
    """
    w, nodes = _keep(map, count, claims, found, min_length, rejoin, room, out, nodes, family)
    stretches = _share_out(scan, claims, found[0], room)
    return _join(map, scan, p, claims, stretches, min_length, room, out, w, nodes, family, given)
