"""The loops of mean shift's second phase: plain Python, compiled when called."""

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array
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
    centres, _ = climb(points, np.inf, STOP / np.sqrt(2.0), np.inf)
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
def lines(
    middle: Array, half: Array, cluster: Indices, theta: Array, sigma: float
) -> tuple[Array, Indices]:
    """Phase 2 in each cluster, `(n,)`, of direction theta, `(k,)`: segments `(m, 2, 2)`, metres.

    Also which of them each piece went into. Pieces have middles and halves `(n, 2)`, metres.
    """
    found, into, count = np.empty((len(middle), 2, 2)), np.empty(len(middle), np.int64), 0
    order, first = chains(cluster)
    for c in range(len(theta)):
        own = order[first[c] : first[c + 1]]
        mine = np.empty(len(own), np.int64)
        count = collinear(middle[own], half[own], theta[c], sigma, found, mine, count)
        into[own] = mine
    return found[:count], into
