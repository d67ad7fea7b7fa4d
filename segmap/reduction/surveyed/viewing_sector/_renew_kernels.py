"""The map after a scan: pieces that are kept, and stretches that join them (A 2.7.5)."""

from __future__ import annotations

import numpy as np

from ....arrays import Array
from ....compiled import compiled
from ....kernels import join_sums, lay, length_of, span
from ._look_kernels import (
    SAME,
    TIE,
    Claims,
    Room,
    Walls,
    cross,
    share,
    sort,
)


@compiled
def _write_part(
    wall: Array, sums: Array, t0: float, t1: float, out: Walls, w: int, node: int
) -> None:
    """Put the part t0 to t1 of a wall, and its share of the running sums, into row w."""
    to, of = out.s[w], out.sums[w]
    out.node[w] = node
    dx, dy = wall[1, 0] - wall[0, 0], wall[1, 1] - wall[0, 1]
    size, f = np.hypot(dx, dy), t1 - t0
    if max(t0, 1.0 - t1) * size <= SAME:  # all of it, with its own points
        for e in range(2):
            to[e, 0], to[e, 1] = wall[e, 0], wall[e, 1]
        for i in range(6):
            of[i] = sums[i]
        return
    to[0, 0], to[0, 1] = wall[0, 0] + t0 * dx, wall[0, 1] + t0 * dy
    to[1, 0], to[1, 1] = wall[0, 0] + t1 * dx, wall[0, 1] + t1 * dy
    dx, dy, shift = dx / size, dy / size, ((t0 + t1) / 2 - 0.5) * size
    along = sums[0] * f * (f * size) * (f * size) / 12
    across = f * (sums[3] * dy * dy - 2 * sums[4] * dx * dy + sums[5] * dx * dx)
    of[0], of[1], of[2] = sums[0] * f, sums[1] + shift * dx, sums[2] + shift * dy
    of[3] = along * dx * dx + across * dy * dy
    of[4] = (along - across) * dx * dy
    of[5] = along * dy * dy + across * dx * dx


@compiled
def _keep(
    map: Walls,
    claims: Claims,
    found: tuple[int, int],
    min_length: float,
    rejoin: bool,
    room: Room,
    out: Walls,
    first_node: int,
    family: Array,
) -> tuple[int, int]:
    """Step 5: write the pieces of all walls that stay; how many pieces and new nodes there are."""
    w, c, g, nodes, cuts = 0, 0, 0, 0, room.cuts
    for k in range(len(map.s)):
        room.first[k] = w
        size, begin, cut = length_of(map.s[k]), 0.0, 0
        while c < found[0] and claims.wall[c] == k:
            if not rejoin:
                cuts[cut], cuts[cut + 1] = claims.data[c, 3], claims.data[c, 4]
                cut += 2
            c += 1
        sort(cuts, cut)
        lost, more = g, True
        while more:
            more = g < found[1] and claims.gone_of[g] == k
            end = claims.gone[g, 0] if more else size
            if end - begin >= min_length - SAME or (g == lost and not more):
                a = begin
                for i in range(cut + 1):
                    b = cuts[i] if i < cut else end
                    if i < cut and min(b - a, end - b) < min_length - SAME:
                        continue
                    node = map.node[k]
                    if a != 0.0 or b != size:
                        family[nodes, 0], family[nodes, 1] = node, b / size - a / size
                        node, nodes = first_node + nodes, nodes + 1
                    _write_part(map.s[k], map.sums[k], a / size, b / size, out, w, node)
                    w += 1
                    a = b
            if more:
                begin = claims.gone[g, 1]
                g += 1
    room.first[len(map.s)] = w
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
        size, cuts[0], cuts[1], count, start = length_of(scan.s[j]), 0.0, 1.0, 2, n
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
def renew(
    map: Walls,
    scan: Walls,
    p: Array,
    claims: Claims,
    found: tuple[int, int],
    min_length: float,
    rejoin: bool,
    room: Room,
    out: Walls,
    first_node: int,
    family: Array,
    given: Array,
) -> tuple[int, int, int]:
    """Steps 4 to 7: write the map after a scan; how many walls, new nodes and gifts there are.

    A piece is a new node, whose parent and share of it go into a row of `family`; a gift, a row of
    `given`, is: input, node, metres of the input.
    """
    w, nodes = _keep(map, claims, found, min_length, rejoin, room, out, first_node, family)
    stretches, gifts = _share_out(scan, claims, found[0], room), 0
    # sums before lines: the pieces must lie where they were while stretches look for theirs
    for r in range(stretches):
        j, c, t0, t1 = room.owner[r, 0], room.owner[r, 1], room.stretch[r, 0], room.stretch[r, 1]
        s, piece, size = scan.s[j], -1, (t1 - t0) * length_of(scan.s[j])
        if c >= 0:  # the piece beside the middle of where the stretch falls on its wall
            k = claims.wall[c]
            wall, long, u, least = map.s[k], length_of(map.s[k]), 0.0, np.inf
            left, right = cross(p[0], p[1], wall[0], s[0]), cross(p[0], p[1], s[0], wall[1])
            left1, right1 = cross(p[0], p[1], wall[0], s[1]), cross(p[0], p[1], s[1], wall[1])
            for t in (t0, t1):
                u += share(left + t * (left1 - left), right + t * (right1 - right))
            dx, dy = (wall[1, 0] - wall[0, 0]) / long, (wall[1, 1] - wall[0, 1]) / long
            for i in range(room.first[k], room.first[k + 1]):
                low, high = span(out.s[i], wall[0, 0], wall[0, 1], dx, dy)
                off = max(low - long * u / 2, long * u / 2 - high, 0.0)
                if off < least - SAME:
                    piece, least = i, off
        room.owner[r, 2] = piece
        _write_part(s, scan.sums[j], t0, t1, out, w, first_node + nodes)
        if piece >= 0:
            join_sums(out.sums[piece], out.sums[w], out.sums[piece])
        elif c >= 0 or size >= min_length - SAME:
            family[nodes, 0], family[nodes, 1] = -1.0, 1.0
            piece, w, nodes = w, w + 1, nodes + 1
        if piece >= 0:
            given[gifts, 0], given[gifts, 1], given[gifts, 2] = scan.node[j], out.node[piece], size
            gifts += 1
    for r in range(stretches):
        if room.owner[r, 2] < 0:
            continue
        # the line of the sums, where the piece and the stretch of the scan span it
        s, own, sums = scan.s[room.owner[r, 0]], out.s[room.owner[r, 2]], out.sums[room.owner[r, 2]]
        u, v, x, y = own[1, 0] - own[0, 0], own[1, 1] - own[0, 1], sums[1], sums[2]
        turn = 0.5 * np.arctan2(2 * sums[4], sums[3] - sums[5])
        if np.hypot(2 * sums[4], sums[3] - sums[5]) <= SAME * (sums[3] + sums[5]):
            turn = np.arctan2(v, u)  # they are as wide as long
        dx, dy = np.cos(turn), np.sin(turn)
        if dx * (u - SAME * v) + dy * (v + SAME * u) < 0.0:  # SAME: a right angle is no tie
            dx, dy = -dx, -dy
        low, high = span(own, x, y, dx, dy)
        for t in (room.stretch[r, 0], room.stretch[r, 1]):
            px = s[0, 0] + t * (s[1, 0] - s[0, 0])
            py = s[0, 1] + t * (s[1, 1] - s[0, 1])
            u = (px - x) * dx + (py - y) * dy
            low, high = min(low, u), max(high, u)
        if high - low > SAME:  # else it would have no length: it stays
            lay(own, x, y, dx, dy, low, high)
    return w, nodes, gifts
