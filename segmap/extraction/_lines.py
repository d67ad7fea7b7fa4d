"""Lines through runs of points, and how far points lie off them. Compiled when called.

A line is (x, y, dx, dy): a point of it and its unit direction; points and `ease` as in `_kernels`.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ..kernels import Line, place_on_line


@compiled
def fit_total(p: Array, ease: Array, start: int, stop: int) -> Line:
    """Centre and unit direction of the total least squares line of a run, metres."""
    n = x = y = sxx = syy = sxy = 0.0
    for i in range(start, stop):
        w = ease[i] * ease[i]
        n, x, y = n + w, x + w * p[i, 0], y + w * p[i, 1]
    x, y = x / n, y / n
    for i in range(start, stop):
        u, v = (p[i, 0] - x) * ease[i], (p[i, 1] - y) * ease[i]
        sxx += u * u
        syy += v * v
        sxy += u * v
    turn = 0.5 * np.arctan2(2 * sxy, sxx - syy)
    return x, y, np.cos(turn), np.sin(turn)


@compiled
def fit_algebraic(p: Array, start: int, stop: int) -> Line:
    """A 3.1-3.3: foot of the origin, direction of `a x + b y = 1` for a run, or NaN; metres."""
    sxx = syy = sxy = sx = sy = 0.0
    for i in range(start, stop):
        sxx += p[i, 0] * p[i, 0]
        syy += p[i, 1] * p[i, 1]
        sxy += p[i, 0] * p[i, 1]
        sx += p[i, 0]
        sy += p[i, 1]
    det, trace = sxx * syy - sxy * sxy, sxx + syy
    a, b = sx * syy - sy * sxy, sy * sxx - sx * sxy
    square = a * a + b * b
    if det <= 1e-12 * (trace * trace) or square == 0.0:
        return np.nan, np.nan, np.nan, np.nan
    norm = np.sqrt(square)
    return a * det / square, b * det / square, -b / norm, a / norm


@compiled
def write_chord(p: Array, start: int, stop: int, line: Line, out: Array, k: int) -> float:
    """Write the extreme projections of a run on a line into row k; return its length, metres."""
    x, y, dx, dy = line
    low, high = np.inf, -np.inf
    for i in range(start, stop):
        u = (p[i, 0] - x) * dx + (p[i, 1] - y) * dy
        low, high = min(low, u), max(high, u)
    place_on_line(out[k], line, low, high)
    return high - low


@compiled
def off(p: Array, i: int, line: Line) -> float:
    """Distance of one point from a line, metres."""
    return abs((p[i, 1] - line[1]) * line[2] - (p[i, 0] - line[0]) * line[3])


@compiled
def farthest(p: Array, ease: Array, start: int, stop: int, line: Line) -> tuple[int, float]:
    """Index of the point of a run farthest from a line, and its distance times its ease, metres."""
    run = p[start:stop]  # counted from 0: the compiler need not look out for negative indices
    own = ease[start:stop]
    index, most = 0, -1.0
    for i in range(len(run)):
        apart = off(run, i, line) * own[i]
        if apart > most:
            index, most = i, apart
    return start + index, most
