"""The loops of extraction: cut at gaps, split, merge, fit. Plain Python, compiled when called.

`p` are points `(n, 2)` in metres, a line is (x, y, dx, dy): a point of it and its unit direction.
"""

import numpy as np
from numpy.typing import NDArray

from ._compiled import compiled
from .arrays import Array
from .segments import MIN_LENGTH

Line = tuple[float, float, float, float]
Indices = NDArray[np.int64]


@compiled
def fit_total(p: Array) -> Line:
    """Centre and unit direction of the total least squares line of `(n, 2)` points, metres."""
    x, y = p[:, 0].mean(), p[:, 1].mean()
    sxx = syy = sxy = 0.0
    for i in range(len(p)):
        u, v = p[i, 0] - x, p[i, 1] - y
        sxx += u * u
        syy += v * v
        sxy += u * v
    turn = 0.5 * np.arctan2(2 * sxy, sxx - syy)
    return x, y, np.cos(turn), np.sin(turn)


@compiled
def fit_algebraic(p: Array) -> Line:
    """A 3.1-3.3: foot of the origin, direction of `a x + b y = 1` for `(n, 2)` points, or NaN.

    Points and foot in metres.
    """
    sxx = syy = sxy = sx = sy = 0.0
    for i in range(len(p)):
        sxx += p[i, 0] * p[i, 0]
        syy += p[i, 1] * p[i, 1]
        sxy += p[i, 0] * p[i, 1]
        sx += p[i, 0]
        sy += p[i, 1]
    det = sxx * syy - sxy * sxy
    a, b = sx * syy - sy * sxy, sy * sxx - sx * sxy
    square = a * a + b * b
    if det <= 1e-12 * (sxx + syy) ** 2 or square == 0.0:
        return np.nan, np.nan, np.nan, np.nan
    norm = np.sqrt(square)
    return a * det / square, b * det / square, -b / norm, a / norm


@compiled
def span(p: Array, line: Line, out: Array) -> float:
    """Write the extreme projections of `(n, 2)` points on a line; return its length, metres."""
    x, y, dx, dy = line
    low, high = np.inf, -np.inf
    for i in range(len(p)):
        u = (p[i, 0] - x) * dx + (p[i, 1] - y) * dy
        low, high = min(low, u), max(high, u)
    out[0, 0], out[0, 1] = x + low * dx, y + low * dy
    out[1, 0], out[1, 1] = x + high * dx, y + high * dy
    return high - low


@compiled
def farthest(p: Array, line: Line) -> tuple[int, float]:
    """Index of the one of `(n, 2)` points farthest from a line, and its distance, metres."""
    x, y, dx, dy = line
    index, most = 0, -1.0
    for i in range(len(p)):
        d = abs((p[i, 1] - y) * dx - (p[i, 0] - x) * dy)
        if d > most:
            index, most = i, d
    return index, most


@compiled
def _is_cut(a: Array, b: Array, gap: float) -> bool:
    """Whether neighbours belong to different clusters: at least a gap apart (A 3.2)."""
    return (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 >= gap * gap


@compiled
def unrolled(p: Array, gap: float, closed: bool) -> Array:
    """A closed scan `(n, 2)`, metres, turned to start at a gap, or a corner where it has none."""
    n = len(p)
    if not closed or n < 3:
        return p
    first, far = -1, 0
    most, x, y = -1.0, p[:, 0].mean(), p[:, 1].mean()
    for i in range(n):
        if first < 0 and _is_cut(p[i - 1], p[i], gap):
            first = i
        d = (p[i, 0] - x) ** 2 + (p[i, 1] - y) ** 2
        if d > most:
            far, most = i, d
    if first < 0:
        return np.concatenate((p[far:], p[:far]))
    return np.concatenate((p[first:], p[:first]))


@compiled
def cut_at_gaps(p: Array, gap: float) -> Indices:
    """Where clusters of `(n, 2)` points begin, and n last; gap in metres."""
    cuts = np.empty(len(p) + 1, np.int64)
    k = 0
    for i in range(len(p)):
        if i == 0 or _is_cut(p[i - 1], p[i], gap):
            cuts[k] = i
            k += 1
    cuts[k] = len(p)
    return cuts[: k + 1]


@compiled
def clusters(points: Array, gap: float, total: bool, closed: bool) -> Array:
    """A segment for each cluster of more than one point (A 3.2), `(k, 2, 2)`, metres."""
    p = unrolled(points, gap, closed)
    cuts = cut_at_gaps(p, gap)
    out = np.empty((len(cuts), 2, 2))
    k = 0
    for c in range(len(cuts) - 1):
        cluster = p[cuts[c] : cuts[c + 1]]
        line = fit_total(cluster) if total else fit_algebraic(cluster)
        if len(cluster) > 1 and span(cluster, line, out[k]) > MIN_LENGTH:
            k += 1
    return out[:k]


@compiled
def chord_of(p: Array) -> Line:
    """Line from first to last of `(n, 2)` points, metres; across them where these coincide."""
    dx, dy = p[-1, 0] - p[0, 0], p[-1, 1] - p[0, 1]
    norm = np.hypot(dx, dy)
    if norm >= MIN_LENGTH:
        return p[0, 0], p[0, 1], dx / norm, dy / norm
    _, _, dx, dy = fit_total(p)
    return p[0, 0], p[0, 1], -dy, dx


@compiled
def split(p: Array, tolerance: float, ends: Indices) -> int:
    """Cut a cluster `(n, 2)` at the farthest point until each chord is within tolerance, metres.

    Fills `ends` with the last index of each piece, in order; returns their number. A piece begins
    with the last point of the one before.
    """
    stack = np.empty(len(p) + 1, np.int64)
    stack[0], top, start, k = len(p) - 1, 1, 0, 0
    while top:
        end = stack[top - 1]
        chord = chord_of(p[start : end + 1])
        far, most = farthest(p[start : end + 1], chord)
        if most > tolerance and 0 < far < end - start:
            stack[top] = start + far
            top += 1
        else:
            ends[k] = start = end
            k, top = k + 1, top - 1
    return k


@compiled
def joint_error(p: Array, ends: Indices, k: int) -> float:
    """Largest distance from one line through the pieces k, k + 1 of `(n, 2)` points, metres."""
    start = ends[k - 1] if k else 0
    both = p[start : ends[k + 1] + 1]
    return farthest(both, fit_total(both))[1]


@compiled
def merge(p: Array, tolerance: float, ends: Indices, count: int) -> int:
    """Join the two neighbours that one line fits best, while it fits within tolerance, metres.

    Of points `(n, 2)`, metres, cut into `count` pieces: the last point of each, `(k,)`, changes in
    place.
    """
    errors = np.empty(max(count - 1, 0))
    for k in range(count - 1):
        errors[k] = joint_error(p, ends, k)
    while count > 1:
        best = int(np.argmin(errors[: count - 1]))
        if errors[best] > tolerance:
            break
        ends[best : count - 1] = ends[best + 1 : count].copy()
        errors[best : count - 2] = errors[best + 1 : count - 1].copy()
        count -= 1
        for k in range(max(best - 1, 0), min(best + 1, count - 1)):
            errors[k] = joint_error(p, ends, k)
    return count


@compiled
def offset(q: Array, line: Line) -> float:
    """Distance of one point, a (2,) array, from a line, metres."""
    return abs((q[1] - line[1]) * line[2] - (q[0] - line[0]) * line[3])


@compiled
def border(p: Array, start: int, corner: int, end: int) -> int:
    """First point of the second of two pieces: each point goes to the nearer line.

    Of points `(n, 2)`, metres. The chords of a split share their corner; a wall ends at the last
    beam that met it.
    """
    if corner - start < 3:
        return corner
    if end - corner < 3:
        return corner + 1
    left, right = fit_total(p[start:corner]), fit_total(p[corner + 1 : end + 1])
    while corner - start > 2 and offset(p[corner - 1], right) < offset(p[corner - 1], left):
        corner -= 1
    while end - corner > 2 and offset(p[corner], left) < offset(p[corner], right):
        corner += 1
    return corner


@compiled
def polylines(
    points: Array, gap: float, tolerance: float, min_points: int, min_length: float, closed: bool
) -> Array:
    """Segments of all clusters, split and merged, `(k, 2, 2)`, metres."""
    p = unrolled(points, gap, closed)
    cuts = cut_at_gaps(p, gap)
    out = np.empty((len(p) // min_points + 1, 2, 2))
    ends = np.empty(len(p) + 1, np.int64)
    found = 0
    for c in range(len(cuts) - 1):
        cluster = p[cuts[c] : cuts[c + 1]]
        count = merge(cluster, tolerance, ends, split(cluster, tolerance, ends))
        start = 0
        for k in range(count):
            stop = ends[k] + 1
            if k + 1 < count:
                stop = border(cluster, start, ends[k], ends[k + 1])
            piece = cluster[start:stop]
            start = stop
            if len(piece) < min_points:
                continue
            if span(piece, fit_total(piece), out[found]) >= min_length:
                found += 1
    return out[:found]
