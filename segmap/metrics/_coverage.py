"""What quality does not see: metres of wall that a reduction invents, and metres that it misses."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Metres, Radians, Segments, at_most, checked
from ..compiled import compiled
from ..kernels import describe, seen_from

#: No line is turned farther from another.
Right = Annotated[Radians, at_most(np.pi / 2)]


@checked
def invented(
    before: Segments, after: Segments, *, distance: Metres = 0.05, angle: Right = np.radians(5)
) -> float:
    """Metres of a reduced map where no segment of the map before lies beside it.

    Quality looks at the segments before, each as a whole: a segment after that runs across a door,
    or on behind the end of a wall, costs it little. `distance` is how far to the side a segment
    counts as lying beside another, `angle` by how much it may be turned.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(2.5, 0), (4, 0)]]
    >>> round(invented(wall, [[(0, 0.01), (5, 0.01)]]), 6)
    1.5
    """
    u, v = arrays.segments(before, "before"), arrays.segments(after, "after")
    return _metres_alone(v, u, distance, angle)


@checked
def missed(
    before: Segments, after: Segments, *, distance: Metres = 0.05, angle: Right = np.radians(5)
) -> float:
    """Metres of a map where no segment of the reduced map lies beside it, as in `invented`.

    Examples
    --------
    >>> missed([[(0, 0), (2, 0)], [(0, 1), (2, 1)]], [[(0, 0), (1.5, 0)]])
    2.5
    """
    u, v = arrays.segments(before, "before"), arrays.segments(after, "after")
    return _metres_alone(u, v, distance, angle)


def _metres_alone(map: Array, other: Array, distance: float, angle: float) -> float:
    """Metres of a map without a segment of the other beside them."""
    u, v = np.ascontiguousarray(map), np.ascontiguousarray(other)
    v = v[np.argsort(v[:, :, 0].mean(1), kind="stable")]
    a, b = describe(u), describe(v)
    reach = a[:, 4] + b[:, 4].max(initial=0.0) + distance
    first, stop = (np.searchsorted(b[:, 0], a[:, 0] + sign * reach) for sign in (-1, 1))
    limits = (float(distance), float(np.sin(angle)))
    return _uncovered_length(a, v, b, first, stop, limits, np.empty((len(v), 2)))


@compiled
def _uncovered_length(
    a: Array,
    v: Array,
    b: Array,
    first: NDArray[np.int64],
    stop: NDArray[np.int64],
    limits: tuple[float, float],
    spans: Array,
) -> float:
    """Metres of the segments described by `a`, (n, 5), outside the spans that others lie beside.

    Of the others `v`, (m, 2, 2), described by `b`, those from `first` to `stop` can.
    """
    metres = 0.0
    for i in range(len(a)):
        count = 0
        for j in range(first[i], stop[i]):
            if abs(a[i, 2] * b[j, 3] - a[i, 3] * b[j, 2]) <= limits[1]:
                count += _insert_span(a[i], v[j], limits[0], spans, count)
        reached = -a[i, 4]
        for k in range(count):
            metres += max(min(spans[k, 0], a[i, 4]) - reached, 0.0)
            reached = max(reached, spans[k, 1])
        metres += max(a[i, 4] - reached, 0.0)
    return metres


@compiled
def _insert_span(a: Array, v: Array, distance: float, spans: Array, count: int) -> bool:
    """Put where one segment lies beside another, described by (5,), among the spans in order.

    Whether it does anywhere: the part of it within the strip around the other's line.
    """
    u, p, w, q = seen_from((a[0], a[1], a[2], a[3]), v)
    start, end = 0.0, 1.0
    if p != q:
        one, other = (-distance - p) / (q - p), (distance - p) / (q - p)
        start, end = max(start, min(one, other)), min(end, max(one, other))
    if start > end or (p == q and abs(p) > distance):
        return False
    one, other = u + start * (w - u), u + end * (w - u)
    low, high, k = min(one, other), max(one, other), count
    while k > 0 and spans[k - 1, 0] > low:
        spans[k, 0], spans[k, 1], k = spans[k - 1, 0], spans[k - 1, 1], k - 1
    spans[k, 0], spans[k, 1] = low, high
    return True
