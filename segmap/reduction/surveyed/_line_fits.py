"""Lines with a covariance: fitted to points, compared, merged (A 2.7.3); compiled when called."""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from .._runner import Indices

#: Centre x and y, metres, angle of the normal, radians, covariance of (offset, angle) about it.
Line = tuple[float, float, float, float, float, float]


@compiled
def _variance(
    x: float, y: float, nx: float, ny: float, sx: float, sy: float, noise: Array
) -> float:
    """Variance of a point across a line, square metres, seen from (sx, sy); NaN: no place."""
    dx, dy, one = x - sx, y - sy, noise[0] * noise[0]
    square = dx * dx + dy * dy
    if not square > 0.0:
        return one
    along, across = dx * nx + dy * ny, noise[1] * (dy * nx - dx * ny)
    return one * (along * along) / square + across * across


@compiled
def _fit(p: Array, start: int, stop: int, sx: float, sy: float, noise: Array, w: Array) -> Line:
    """Steps 1 and 2: weighted line of a run of points, metres, and its covariance.

    `w` is room for a weight a point.
    """
    x = y = alpha = c = s = total = 0.0
    before = np.nan
    for i in range(start, stop):
        w[i - start] = 1.0
    for _ in range(50):
        x = y = total = xx = xy = yy = 0.0
        for i in range(start, stop):
            total += w[i - start]
            x += w[i - start] * p[i, 0]
            y += w[i - start] * p[i, 1]
        x, y = x / total, y / total
        for i in range(start, stop):
            u, v = p[i, 0] - x, p[i, 1] - y
            xx += w[i - start] * u * u
            xy += w[i - start] * u * v
            yy += w[i - start] * v * v
        alpha = 0.5 * np.arctan2(2 * xy, xx - yy) + np.pi / 2
        c, s = np.cos(alpha), np.sin(alpha)
        for i in range(start, stop):
            w[i - start] = 1 / _variance(p[i, 0], p[i, 1], c, s, sx, sy, noise)
        if abs((alpha - before + np.pi / 2) % np.pi - np.pi / 2) < 1e-12:
            break
        before = alpha
    lever = total = 0.0
    for i in range(start, stop):
        t = (p[i, 1] - y) * c - (p[i, 0] - x) * s
        lever += w[i - start] * t * t
        total += w[i - start]
    arm = 0.0 if np.isnan(sx) else (sy - y) * c - (sx - x) * s
    place, turn = noise[2] * noise[2], noise[3] * noise[3]
    rr = 1 / total + place + arm * arm * turn
    return x, y, alpha, rr, arm * turn, 1 / max(lever, 1.0) + turn


@compiled
def fit_all(
    p: Array, first: Indices, sensors: Array, noise: Array, out: Array, room: Array
) -> None:
    """Lines of all segments, `(n, 6)`."""
    for i in range(len(out)):
        found = _fit(p, first[i], first[i + 1], sensors[i, 0], sensors[i, 1], noise, room)
        out[i, 0], out[i, 1], out[i, 2] = found[0], found[1], found[2]
        out[i, 3], out[i, 4], out[i, 5] = found[3], found[4], found[5]


@compiled
def _about(line: Array, x: float, y: float) -> tuple[float, float, float]:
    """Step 3: offset of a line from (x, y), metres, and its covariances about that point."""
    c, s = np.cos(line[2]), np.sin(line[2])
    arm = (line[1] - y) * c - (line[0] - x) * s
    offset = (line[0] - x) * c + (line[1] - y) * s
    return offset, line[3] + 2 * arm * line[4] + arm * arm * line[5], line[4] + arm * line[5]


@compiled
def compare(a: Array, b: Array) -> tuple[float, Line]:
    """Steps 4 and 5, eq. 2.22-2.25: chi of the difference of two lines; the line of both."""
    x, y = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
    ra, rra, raa = _about(a, x, y)
    rb, rrb, rab = _about(b, x, y)
    turns = round((a[2] - b[2]) / np.pi)
    if turns % 2 != 0:
        rb, rab = -rb, -rab
    dr, da = ra - rb, a[2] - (b[2] + turns * np.pi)
    rr, r_a, aa = rra + rrb, raa + rab, a[5] + b[5]
    det = rr * aa - r_a * r_a
    u, v = (aa * dr - r_a * da) / det, (rr * da - r_a * dr) / det  # S^-1 dL
    r, alpha = ra - (rra * u + raa * v), a[2] - (raa * u + a[5] * v)
    f, g = (aa * rrb - r_a * rab) / det, (aa * rab - r_a * b[5]) / det  # S^-1 P_B
    h, k = (rr * rab - r_a * rrb) / det, (rr * b[5] - r_a * rab) / det
    new_rr, new_ra, new_aa = rra * f + raa * h, rra * g + raa * k, raa * g + a[5] * k
    c, s, t = np.cos(alpha), np.sin(alpha), new_ra / new_aa
    centre_x, centre_y = x + r * c - t * s, y + r * s + t * c
    return dr * u + da * v, (centre_x, centre_y, alpha, new_rr - t * new_ra, 0.0, new_aa)
