"""The loops of global alignment: which segments are similar, and which scans share two.

Segments of all scans lie in one array `(n, 2, 2)`, metres; scan k has those from `first[k]` up to
`first[k + 1]`; `d` is what `describe` says of them, `(n, 5)`.
"""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from .._metrics_loops import ACROSS, ANGULAR, APART, apart, mean_line_terms
from ..arrays import Array

Indices = NDArray[np.int64]


@compiled
def similar(s: Array, d: Array, u: int, v: int, most: float) -> float:
    """Distance of segments u and v (A 2.7.7), metres; infinity where it is not below `most`.

    Of s `(n, 2, 2)`, metres, described by d `(n, 5)`.
    """
    reach = most / APART + d[u, 4] + d[v, 4]
    if abs(d[u, 0] - d[v, 0]) >= reach or abs(d[u, 1] - d[v, 1]) >= reach:
        return np.inf
    turn = abs(d[u, 2] * d[v, 3] - d[u, 3] * d[v, 2])
    if ANGULAR * (d[u, 4] + d[v, 4]) * turn / 2 >= most:  # tan(a / 2) >= sin(a) / 2
        return np.inf
    angular, across = mean_line_terms(s[u], s[v], d[u], d[v])
    so_far = ANGULAR * angular + ACROSS * across
    if so_far >= most:
        return np.inf
    found = so_far + APART * apart(s[u], s[v])
    return found if found < most else np.inf


@compiled
def _two_apart(s: Array, d: Array, pairs: Indices, count: int, most: float) -> bool:
    """Whether two of the pairs `(p, 2)` are similar neither in one scan nor in the other."""
    for a in range(count):
        for b in range(a):
            if (
                similar(s, d, pairs[a, 0], pairs[b, 0], most) == np.inf
                and similar(s, d, pairs[a, 1], pairs[b, 1], most) == np.inf
            ):
                return True
    return False


@compiled
def shared(
    s: Array,
    d: Array,
    first: Indices,
    i: int,
    j: int,
    most: float,
    sine: float,
    out: Indices,
    away: Array,
) -> int:
    """Write the similar pairs of scans i and j and their distances; return how many.

    Pairs of segments go to `out`, (r, 2) int array, and distances to `away`, (r,) array, metres; no
    more than they hold. 0 where no two of them are unlike each other (A 2.5.1).
    """
    n = 0
    for u in range(first[i], first[i + 1]):
        for v in range(first[j], first[j + 1]):
            if n == len(out) or abs(d[u, 2] * d[v, 3] - d[u, 3] * d[v, 2]) >= sine:
                continue
            found = similar(s, d, u, v, most)
            if found < most:
                out[n, 0], out[n, 1], away[n] = u, v, found
                n += 1
    return n if _two_apart(s, d, out, n, most) else 0


@compiled
def similar_pairs(
    s: Array, d: Array, first: Indices, arcs: Indices, most: float, sine: float
) -> tuple[Indices, Indices, Array]:
    """Similar segments of the scans that each arc `(m, 2)` joins.

    The arc of each pair, (p,) int array, the pairs, (p, 2) int array, their distances, (p,) array,
    metres.
    """
    arc, pairs, away = np.empty(64, np.int64), np.empty((64, 2), np.int64), np.empty(64)
    n = 0
    for k in range(len(arcs)):
        i, j = arcs[k, 0], arcs[k, 1]
        room = n + (first[i + 1] - first[i]) * (first[j + 1] - first[j])
        if room > len(arc):
            size = 2 * room
            arc = np.concatenate((arc[:n], np.empty(size - n, np.int64)))
            pairs = np.concatenate((pairs[:n], np.empty((size - n, 2), np.int64)))
            away = np.concatenate((away[:n], np.empty(size - n)))
        found = shared(s, d, first, i, j, most, sine, pairs[n:], away[n:])
        arc[n : n + found] = k
        n += found
    return arc[:n], pairs[:n], away[:n]


@compiled
def fewest(
    s: Array,
    d: Array,
    first: Indices,
    way: Array,
    start: int,
    reach: float,
    most: float,
    sine: float,
) -> Indices:
    """The fewest scans from `start` on of which each shares two walls with the next (A 2.5.1).

    Indices, ascending, (c,) int array. Neighbours are at most `reach` metres of way, `(k,)` for all
    scans, apart. Ends at the last scan that can be reached.
    """
    before = np.full(len(way), -1, np.int64)
    wave = np.array([start])
    last = start
    pairs, away = np.empty((4096, 2), np.int64), np.empty(4096)
    while len(wave):
        wider = np.empty(len(way), np.int64)
        n = 0
        for i in wave:
            for j in range(i + 1, len(way)):
                if way[j] - way[i] > reach and j > i + 1:
                    break
                if before[j] < 0 and shared(s, d, first, i, j, most, sine, pairs, away) > 0:
                    before[j], wider[n], last = i, j, max(last, j)
                    n += 1
        wave = wider[:n]
    out = np.empty(len(way), np.int64)
    n = 0
    while last != start:
        out[n] = last
        last, n = before[last], n + 1
    out[n] = start
    return out[: n + 1][::-1]
