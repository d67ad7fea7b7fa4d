"""What walls that were laid together say of the pose: the offsets they leave, its covariance."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..compiled import compiled

#: Standard deviation that is assumed for the middle of a metre of wall, metres across it.
PRIOR_DEVIATION_M = 0.001
#: The assumption counts as so many measured offsets: three walls alone say too little.
PRIOR_OFFSETS = 2.0
#: Corners, and walls that are no straight lines, err together: measured errors have this many times
#: the variance (simulated rooms, tests/alignment/test_covariances.py).
WALL_VARIANCE_INFLATION = 1.7
#: Next to no pull towards where the pose is, as a share.
FAINT_INFORMATION = 1e-9
#: Variance of a free direction, square metres.
FREE_VARIANCE_M2 = 1e6
#: What two walls share that is shorter, metres, is where they meet at a corner.
CORNER_OVERLAP_M = 0.05


@compiled
def moved_segments(
    s: Array, x: float, y: float, turn: float, about_x: float, about_y: float
) -> Array:
    """Segments `(n, 2, 2)` turned about a point, then shifted; metres, radians."""
    out, c, z = np.empty_like(s), np.cos(turn), np.sin(turn)
    for i in range(len(s)):
        for k in range(2):
            u, v = s[i, k, 0] - about_x, s[i, k, 1] - about_y
            out[i, k, 0] = about_x + x + c * u - z * v
            out[i, k, 1] = about_y + y + z * u + c * v
    return out


@compiled
def constraints(s: Array, a: Array, t: Array, value: Array, rows: Array) -> int:
    """What matched segments say of a small motion of t: both ends of each common part.

    A row, of 5, holds the normal of the segment of s, the lever of a turn about the origin, the
    offset (metres) that the motion should undo, and the match value (metres) as its weight. Returns
    how many rows it wrote: two for each `value` above 0, (n, m) array, metres.
    """
    count = 0
    for i in range(len(s)):
        x, y, dx, dy, size = s[i, 0, 0], s[i, 0, 1], a[i, 2], a[i, 3], 2 * a[i, 4]
        for j in range(len(t)):
            if value[i, j] <= 0:
                continue
            low = (t[j, 0, 0] - x) * dx + (t[j, 0, 1] - y) * dy
            high = (t[j, 1, 0] - x) * dx + (t[j, 1, 1] - y) * dy
            for k in range(2):
                part = (min(max(high if k else low, 0.0), size) - low) / (high - low)
                px = t[j, 0, 0] + part * (t[j, 1, 0] - t[j, 0, 0])
                py = t[j, 0, 1] + part * (t[j, 1, 1] - t[j, 0, 1])
                rows[count, 0], rows[count, 1], rows[count, 2] = -dy, dx, px * dx + py * dy
                rows[count, 3], rows[count, 4] = (py - y) * dx - (px - x) * dy, value[i, j]
                count += 1
    return count


def wall_covariance(rows: Array, pull: Array, share: Array) -> Array:
    """Covariance `(3, 3)` of a pose, metres and radians, from the walls that were laid together.

    The noise of the walls is what they leave open. A line through points errs in its middle and,
    independently, in its slope: at its ends by three times the variance of the middle. Both fall
    with the number of points, for which the length of wall stands.

    Parameters
    ----------
    rows : (2 p, 5) array
        Of p pairs of walls, as `constraints` writes them: both ends of what they share.
    pull : (p,) array
        Weight with which each pair drew the pose to where it is.
    share : (p,) array
        Part of each pair in its wall of the scan, where that has several partners.
    """
    long = rows[::2, 4] >= CORNER_OVERLAP_M
    first, second, metres = rows[::2, :4][long], rows[1::2, :4][long], rows[::2, 4][long]
    middle, half, pull, share = (first + second) / 2, (second - first) / 2, pull[long], share[long]
    residual = share * metres @ (middle[:, 3] ** 2 + half[:, 3] ** 2 / 3)
    free = max(2 * share.sum() - 3, 0.0)  # offsets that the three numbers of the pose leave open
    variance = WALL_VARIANCE_INFLATION * (PRIOR_OFFSETS * PRIOR_DEVIATION_M**2 + residual)
    variance /= PRIOR_OFFSETS + free  # of a metre of wall
    middle, half = middle[:, :3], half[:, :3]
    noise, faint = variance * share * pull**2 / metres, FAINT_INFORMATION * np.eye(3)
    # Both ends pull: their sum moves with the middle, their difference with the slope
    drawn = 2 * (middle.T * (share * pull) @ middle + half.T * (share * pull) @ half) + faint
    erring = (
        4 * (middle.T * noise @ middle + 3 * half.T * noise @ half) + FREE_VARIANCE_M2 * faint**2
    )
    return np.asarray(np.linalg.solve(drawn, np.linalg.solve(drawn, erring).T))
