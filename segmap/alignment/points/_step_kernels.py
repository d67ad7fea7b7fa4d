"""Kernels of one step of point-to-line ICP: weighted normal equations, and their principal axes."""

from __future__ import annotations

import math

from ...arrays import Array
from ...compiled import compiled

#: A direction is not fixed by the walls where its eigenvalue is below this share of the largest:
#: walls that err by their noise alone leave a thousandth.
FREE_EIGENVALUE_RATIO = 0.01


@compiled
def _ranked(values: Array, count: int, rank: int) -> float:
    """The value of that rank among the first `count`, which are put in another order (Hoare)."""
    low, high = 0, count - 1
    while low < high:
        pivot, i, j = values[(low + high) // 2], low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i, j = i + 1, j - 1
        if rank <= j:
            high = j
        elif rank >= i:
            low = i
        else:
            break
    return values[rank]


@compiled
def normal_equations(rows: Array, used: int, floor: float, system: Array) -> float:
    """Write weights into the rows, Hessian and gradient into `system`, (3, 4) array; sigma, metres.

    Of half the sum of squared offsets, with the Cauchy weights `1 / (1 + (offset / 2 sigma)^2)`;
    sigma by the median of the offsets, at least `floor`.
    """
    size = rows[:, 4]
    for k in range(used):
        size[k] = abs(rows[k, 3])
    middle = below = _ranked(size, used, used // 2)
    if used % 2 == 0:  # the largest of those before it
        below = size[0]
        for k in range(1, used // 2):
            below = max(below, size[k])
    sigma = max(1.4826 * 0.5 * (middle + below), floor)
    xx = xy = xa = yy = ya = aa = x = y = a = 0.0
    for k in range(used):
        weight = 1.0 / (1.0 + (rows[k, 3] / (2.0 * sigma)) ** 2)
        rows[k, 4] = weight
        of_x, of_y, of_a, off = rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3]
        wx, wy, wa = weight * of_x, weight * of_y, weight * of_a
        xx, xy, xa, x = xx + wx * of_x, xy + wx * of_y, xa + wx * of_a, x + wx * off
        yy, ya, y = yy + wy * of_y, ya + wy * of_a, y + wy * off
        aa, a = aa + wa * of_a, a + wa * off
    system[0, 0], system[0, 1], system[0, 2], system[0, 3] = xx, xy, xa, x
    system[1, 0], system[1, 1], system[1, 2], system[1, 3] = xy, yy, ya, y
    system[2, 0], system[2, 1], system[2, 2], system[2, 3] = xa, ya, aa, a
    return sigma


@compiled
def half_angle(x: float, y: float) -> tuple[float, float]:
    """Cosine and sine of half the angle of (x, y), which is not zero, in `(-pi/2, pi/2]`."""
    r = math.hypot(x, y)
    if x >= 0.0:
        c = math.sqrt(0.5 * (1.0 + x / r))
        return c, 0.5 * y / (r * c)
    s = math.copysign(math.sqrt(0.5 * (1.0 - x / r)), y)
    return 0.5 * y / (r * s), s


@compiled
def _principal_axes(system: Array, span: float, a: Array, axes: Array) -> float:
    """Largest eigenvalue of a Hessian; all are the diagonal of `a`, eigenvectors columns of `axes`.

    A heading counts as the length by which it moves a point at distance `span`, metres. By Jacobi's
    rotations; all arrays are (3, 3), of the system that many columns count.
    """
    for i in range(3):
        for j in range(3):
            a[i, j] = system[i, j] / ((span if i == 2 else 1.0) * (span if j == 2 else 1.0))
            axes[i, j] = 1.0 if i == j else 0.0
    for turn in range(30):
        off = a[0, 1] * a[0, 1] + a[0, 2] * a[0, 2] + a[1, 2] * a[1, 2]
        if off <= 1e-34 * (a[0, 0] * a[0, 0] + a[1, 1] * a[1, 1] + a[2, 2] * a[2, 2]):
            break
        p, q = (0, 0, 1)[turn % 3], (1, 2, 2)[turn % 3]
        if a[p, q] != 0.0:
            c, s = half_angle(a[q, q] - a[p, p], 2.0 * a[p, q])
            for k in range(3):
                a[k, p], a[k, q] = c * a[k, p] - s * a[k, q], s * a[k, p] + c * a[k, q]
                u, v = axes[k, p], axes[k, q]
                axes[k, p], axes[k, q] = c * u - s * v, s * u + c * v
            for k in range(3):
                a[p, k], a[q, k] = c * a[p, k] - s * a[q, k], s * a[p, k] + c * a[q, k]
    return max(a[0, 0], a[1, 1], a[2, 2])


@compiled
def gauss_newton_step(
    system: Array, span: float, a: Array, axes: Array
) -> tuple[float, float, float]:
    """Step in x, y (metres) and heading (radians); none along directions that no wall fixes.

    A heading counts as the length by which it moves a point at distance `span`, metres; `a` and
    `axes`, (3, 3) arrays, are overwritten.
    """
    most = _principal_axes(system, span, a, axes)
    x = y = heading = 0.0
    for k in range(3):
        if a[k, k] > FREE_EIGENVALUE_RATIO * most:
            along = axes[0, k] * system[0, 3] + axes[1, k] * system[1, 3]
            along = (along + axes[2, k] * system[2, 3] / span) / a[k, k]
            x -= axes[0, k] * along
            y -= axes[1, k] * along
            heading -= axes[2, k] * along / span
    return x, y, heading


@compiled
def uncertainty(
    system: Array, variance: float, span: float, a: Array, axes: Array, covariance: Array
) -> tuple[float, float, float]:
    """Write the covariance, (3, 3) array; the direction that no wall fixes, and its share of shift.

    That share is -1 where the walls fix all; a turn about a centre has a small one.

    Along what no wall fixes the standard deviation is one metre. `a` and `axes` are overwritten.
    """
    most = _principal_axes(system, span, a, axes)
    x = y = 0.0
    most_shift = -1.0
    for i in range(3):
        for j in range(3):
            covariance[i, j] = 0.0
    for k in range(3):
        fixed = a[k, k] > FREE_EIGENVALUE_RATIO * most
        shift = math.hypot(axes[0, k], axes[1, k])
        if not fixed and shift > most_shift:
            x, y, most_shift = axes[0, k] / (shift + 1e-300), axes[1, k] / (shift + 1e-300), shift
        axes[2, k] /= span
        for i in range(3):
            for j in range(3):
                spread = variance / a[k, k] if fixed else 1.0
                covariance[i, j] += spread * axes[i, k] * axes[j, k]
    return x, y, most_shift
