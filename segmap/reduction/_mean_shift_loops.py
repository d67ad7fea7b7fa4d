"""The two phases of mean shift: plain Python, compiled when called.

Places and angles are scaled to units of the kernel's deviation, in which they climb alike.
"""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..angles import Array
from ._climb_loops import climb, link

Indices = NDArray[np.int64]

#: Climbing ends when no centre moves by more than this part of sigma, or of (sx, sy) in phase 2.
STOP = 1 / 200
#: Intervals at most this far apart, in metres, are joined.
SAME = 1e-9


@compiled
def chains(label: Indices) -> tuple[Indices, Indices]:
    """Indices `(n,)` by label and ascending within it, and where each label begins, and n."""
    order = np.argsort(label, kind="mergesort")
    found = label[order]
    begins = np.flatnonzero(found[1:] != found[:-1]) + 1
    first = np.zeros(len(begins) + 2, np.int64)
    first[1:-1], first[-1] = begins, len(label)
    return order, first


@compiled
def axial_mean(angles: Array) -> float:
    """Mean angle of lines, `(n,)` radians, in `(-pi/2, pi/2]`."""
    return np.arctan2(np.sin(2 * angles).sum(), np.cos(2 * angles).sum()) / 2


@compiled
def join(low: Array, high: Array) -> tuple[Array, Array, Indices]:
    """Union of intervals, `(n,)` metres: its parts `(m,)`, and the part of each interval."""
    order = np.argsort(low, kind="mergesort")
    begin, end, part, count = np.empty_like(low), np.empty_like(low), np.empty_like(order), 0
    for i in order:
        if count == 0 or low[i] > end[count - 1] + SAME:
            begin[count], end[count] = low[i], high[i]
            count += 1
        end[count - 1] = max(end[count - 1], high[i])
        part[i] = count - 1
    return begin[:count], end[:count], part


@compiled
def collinear(
    middle: Array, half: Array, theta: float, sigma: float, out: Array, into: Indices, count: int
) -> int:
    """Phase 2 (A 4.3.4, 4.3.5) for one cluster of pieces, `(n, 2)`, of direction theta; metres.

    Writes segments to `out` from `count` on, where the pieces went to `into`, and returns the new
    count. In units of the kernel's deviations, sqrt(2) sx along and sqrt(2) sy across, phase 2 is
    phase 1 without an angle. A has the sign of b reversed in eq. 4.15.
    """
    dx, dy = np.cos(theta), np.sin(theta)
    along, across = np.sqrt(2.0) * 2 * sigma, np.sqrt(2.0) * sigma / 10
    u, v = middle[:, 0] * dx + middle[:, 1] * dy, middle[:, 1] * dx - middle[:, 0] * dy
    reach = np.abs(half[:, 0] * dx + half[:, 1] * dy)
    points = np.zeros((len(u), 3))
    points[:, 0], points[:, 1] = u / along, v / across
    centres, _ = climb(points, np.inf, STOP / np.sqrt(2.0))
    order, first = chains(link(centres, np.inf, np.sqrt(0.5)))
    for c in range(len(first) - 1):
        own = order[first[c] : first[c + 1]]
        offset = centres[own, 1].mean() * across
        begin, end, part = join(u[own] - reach[own], u[own] + reach[own])
        for k in range(len(begin)):
            for e, w in enumerate((begin[k], end[k])):
                out[count + k, e, 0] = w * dx - offset * dy
                out[count + k, e, 1] = w * dy + offset * dx
        into[own] = count + part
        count += len(begin)
    return count


@compiled
def directions(
    middle: Array, half: Array, sigma: float, bandwidth: float
) -> tuple[Array, Indices, Array]:
    """Phase 1 (A 4.3.3): centres `(n, 3)`, metres and radians, their clusters, and directions.

    Pieces have middles and halves `(n, 2)`, metres; the bandwidth is in radians a metre. Clusters
    are named by their lowest piece; the direction of its cluster, radians, stands at each piece.
    """
    unit = bandwidth * sigma
    points = np.empty((len(middle), 3))
    points[:, :2] = middle / sigma
    points[:, 2] = np.arctan2(half[:, 1], half[:, 0]) % np.pi / unit
    centres, _ = climb(points, np.pi / unit, STOP)
    label = link(centres, np.pi / unit, 2.0)
    theta = np.empty(len(middle))
    order, first = chains(label)
    for c in range(len(first) - 1):
        own = order[first[c] : first[c + 1]]
        theta[own] = axial_mean(centres[own, 2] * unit)
    centres[:, :2] *= sigma
    centres[:, 2] *= unit
    return centres, label, theta


@compiled
def lines(
    middle: Array, half: Array, label: Indices, theta: Array, sigma: float
) -> tuple[Array, Indices]:
    """Phase 2 in each cluster: segments `(m, 2, 2)`, metres, by lowest piece; that of each piece.

    Pieces as for `directions`, with the cluster and direction of each, `(n,)`.
    """
    found, into, count = np.empty((len(middle), 2, 2)), np.empty(len(middle), np.int64), 0
    order, first = chains(label)
    for c in range(len(first) - 1):
        own = order[first[c] : first[c + 1]]
        mine = np.empty(len(own), np.int64)
        count = collinear(middle[own], half[own], theta[own[0]], sigma, found, mine, count)
        into[own] = mine
    lowest = np.full(count, len(into))
    for i in range(len(into)):
        lowest[into[i]] = min(lowest[into[i]], i)
    order = np.argsort(lowest, kind="mergesort")
    rank = np.empty_like(order)
    rank[order] = np.arange(count)
    return found[order], rank[into]


@compiled
def longest_share(into: Indices, first: Indices) -> Indices:
    """Most frequent value of each into[first[i]:first[i + 1]], the lowest of equals, `(n,)`."""
    found = np.empty(len(first) - 1, np.int64)
    for i in range(len(found)):
        values = into[first[i] : first[i + 1]]
        values = values[np.argsort(values, kind="mergesort")]
        most, begin = 0, 0
        for k in range(len(values)):
            if values[k] != values[begin]:
                begin = k
            if k - begin >= most:
                most, found[i] = k - begin + 1, values[k]
    return found
