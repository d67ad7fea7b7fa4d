"""Kernels of point-to-line ICP: points in cells, normals of walls, partners of points, descent."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled

#: A neighbourhood is a wall where its variance across is below this share of that along: corners
#: and bushes lie above.
WALL_VARIANCE_RATIO = 0.15
#: A beam that meets the back of a wall at a flatter angle than this (its sine) may be noise.
BACK = 0.05
#: Smallest radius within which a wall's direction is fitted, metres: ten times the noise of a
#: laser.
SMALLEST_FIT_M = 0.12
#: Largest such radius, metres: it holds five beams of half a degree at 25 m.
LARGEST_FIT_M = 1.0
#: Points that are enough to show whether they form a wall.
LEAST_FIT_POINTS = 5
#: A direction is not fixed by the walls where its eigenvalue is below this share of the largest:
#: walls that err by their noise alone leave a thousandth.
FREE_EIGENVALUE_RATIO = 0.01


class PointGrid(NamedTuple):
    """Points of walls, sorted into square cells of side `size`, metres, from corner (x, y) on."""

    points: Array  # (n, 2), metres, cell by cell
    normals: Array  # (n, 2): unit normal of the wall through each; NaN: no wall; inf: not yet asked
    viewpoints: Array  # (n, 2), metres: where each was seen from, if `sided`
    x: float
    y: float
    size: float
    columns: int
    rows: int
    first: NDArray[np.int32]  # where the points of cell (i, j) begin: first[i * rows + j]
    sided: bool  # normals point to where each point was seen from: a thin wall has two faces


@compiled
def place_clouds(
    clouds: Array, counts: NDArray[np.int64], poses: Array, far: float, placed: Array, seen: Array
) -> int:
    """Write the points of clouds placed at poses, and where each was seen from; their number.

    Clouds `(n, 2)`, metres, one after the other, `counts` points each; poses `(k, 3)`. Points with
    a coordinate of `far` (metres) or more are left out.
    """
    k = used = 0
    for cloud in range(len(poses)):
        x, y = poses[cloud, 0], poses[cloud, 1]
        c, s = math.cos(poses[cloud, 2]), math.sin(poses[cloud, 2])
        for _ in range(counts[cloud]):
            placed[used, 0] = x + c * clouds[k, 0] - s * clouds[k, 1]
            placed[used, 1] = y + s * clouds[k, 0] + c * clouds[k, 1]
            seen[used, 0], seen[used, 1] = x, y
            k += 1
            if abs(placed[used, 0]) < far and abs(placed[used, 1]) < far:
                used += 1
    return used


@compiled
def bounding_box(points: Array) -> tuple[float, float, float, float]:
    """Least x and y, largest x and y of points `(n, 2)`, at least one."""
    x_min = x_max = points[0, 0]
    y_min = y_max = points[0, 1]
    for k in range(1, len(points)):
        x_min, x_max = min(x_min, points[k, 0]), max(x_max, points[k, 0])
        y_min, y_max = min(y_min, points[k, 1]), max(y_max, points[k, 1])
    return x_min, y_min, x_max, y_max


@compiled
def sort_points(grid: PointGrid, points: Array, viewpoints: Array) -> None:
    """Write points and viewpoints `(n, 2)`, metres, cell by cell; `first` is zero before.

    `first` has two entries more than there are cells.
    """
    for k in range(len(points)):
        i, j = int((points[k, 0] - grid.x) / grid.size), int((points[k, 1] - grid.y) / grid.size)
        grid.first[i * grid.rows + j + 2] += 1
    for c in range(2, len(grid.first)):
        grid.first[c] += grid.first[c - 1]
    for k in range(len(points)):
        i, j = int((points[k, 0] - grid.x) / grid.size), int((points[k, 1] - grid.y) / grid.size)
        p = grid.first[i * grid.rows + j + 1]
        grid.first[i * grid.rows + j + 1] += 1
        grid.points[p, 0], grid.points[p, 1] = points[k, 0], points[k, 1]
        grid.normals[p, 0] = grid.normals[p, 1] = math.inf
        if grid.sided:
            grid.viewpoints[p, 0], grid.viewpoints[p, 1] = viewpoints[k, 0], viewpoints[k, 1]


@compiled
def fit_normal(grid: PointGrid, k: int) -> None:
    """Write the unit normal of the wall through a point, where its neighbours form a wall.

    The neighbourhood is doubled until it holds enough points; the normal is the minor axis of its
    scatter about the mean.
    """
    points, first, size, columns = grid.points, grid.first, grid.size, grid.columns
    x, y, reach, n = points[k, 0], points[k, 1], SMALLEST_FIT_M, 0
    xx = xy = yy = 0.0
    while n < LEAST_FIT_POINTS and reach <= 1.001 * LARGEST_FIT_M:
        low = max(int((y - reach - grid.y) / size), 0)
        high = min(int((y + reach - grid.y) / size), grid.rows - 1)
        n = 0
        sx = sy = xx = xy = yy = 0.0
        for i in range(
            max(int((x - reach - grid.x) / size), 0),
            min(int((x + reach - grid.x) / size), columns - 1) + 1,
        ):
            for p in range(first[i * grid.rows + low], first[i * grid.rows + high + 1]):
                dx, dy = points[p, 0] - x, points[p, 1] - y
                if dx * dx + dy * dy <= reach * reach:
                    n += 1
                    sx, sy = sx + dx, sy + dy
                    xx, xy, yy = xx + dx * dx, xy + dx * dy, yy + dy * dy
        m = max(n, 1)
        xx, xy, yy = xx - sx * sx / m, xy - sx * sy / m, yy - sy * sy / m
        reach *= 2.0
    nx = ny = math.nan
    middle, half = 0.5 * (xx + yy), math.hypot(0.5 * (xx - yy), xy)
    if n >= LEAST_FIT_POINTS and middle - half < WALL_VARIANCE_RATIO * (middle + half):
        ny, nx = half_angle(xx - yy, -2.0 * xy)
        if grid.sided and nx * (grid.viewpoints[k, 0] - x) + ny * (grid.viewpoints[k, 1] - y) < 0:
            nx, ny = -nx, -ny
    grid.normals[k, 0], grid.normals[k, 1] = nx, ny


@compiled
def first_of(count: int, step: int) -> int:
    """Where every `step`-th of so many points, an odd step, lies evenly between both ends."""
    return (count - 1) * (step + 1) // 2 % step


@compiled
def wall_residuals(
    grid: PointGrid,
    current: Array,
    pose: Array,
    reach: float,
    stride: int,
    partner: NDArray[np.int64],
    rows: Array,
) -> tuple[int, float]:
    """Write a row for each point that has a wall within reach (metres) of it; their number.

    Every `stride`-th of the current points `(m, 2)`, metres, in the robot's frame, is asked, see
    `first_of`; one that lies behind a wall, as seen from the robot, has no row. Rows, (m, 6) array:
    derivative of the offset by x, y and heading; offset across the wall, metres; weight (left as it
    is); index of the point. Also returned is the share of those asked that have any point within
    reach.

    `partner`, (m,), holds the nearest point of each as of the step before, and then of this, -1 for
    none. No other can be nearer than within the distance of that one, or of the beam's before: the
    cells so far are looked through.
    """
    points, normals, first = grid.points, grid.normals, grid.first
    x_min, y_min, size = grid.x, grid.y, grid.size
    columns, height, sided = grid.columns, grid.rows, grid.sided
    c, s = math.cos(pose[2]), math.sin(pose[2])
    used = near = 0
    p = -1
    begin = first_of(len(current), stride)
    for k in range(begin, len(current), stride):
        turned_x = c * current[k, 0] - s * current[k, 1]
        turned_y = s * current[k, 0] + c * current[k, 1]
        x, y = turned_x + pose[0], turned_y + pose[1]
        best, radius, guess = reach * reach, reach, partner[k] if partner[k] >= 0 else p
        if guess >= 0:
            dx, dy = points[guess, 0] - x, points[guess, 1] - y
            far = dx * dx + dy * dy
            if far < best:
                best, radius = far * (1 + 1e-15) + 1e-300, math.sqrt(far) + 1e-9
        p = -1
        low = max(int((y - radius - y_min) / size), 0)
        high = min(int((y + radius - y_min) / size), height - 1)
        for i in range(
            max(int((x - radius - x_min) / size), 0),
            min(int((x + radius - x_min) / size), columns - 1) + 1 if low <= high else 0,
        ):
            for q in range(first[i * height + low], first[i * height + high + 1]):
                dx, dy = points[q, 0] - x, points[q, 1] - y
                if dx * dx + dy * dy < best:
                    best, p = dx * dx + dy * dy, q
        partner[k] = p
        if p < 0:
            continue
        near += 1
        if math.isinf(normals[p, 0]) or math.isinf(normals[p, 1]):
            fit_normal(grid, p)  # another thread may be doing the same: it writes the same
        nx, ny = normals[p, 0], normals[p, 1]
        inward = nx * turned_x + ny * turned_y
        behind = inward > 0.0 and inward > BACK * math.hypot(turned_x, turned_y)
        if math.isnan(nx) or (sided and behind):
            continue
        rows[used, 0], rows[used, 1] = nx, ny
        rows[used, 2] = ny * turned_x - nx * turned_y
        rows[used, 3] = nx * (x - points[p, 0]) + ny * (y - points[p, 1])
        rows[used, 5] = k
        used += 1
    return used, near / ((len(current) - begin + stride - 1) // stride)


@compiled
def point_to_line(
    grid: PointGrid,
    current: Array,
    pose: Array,
    reach: float,
    last: float,
    floor: float,
    span: float,
    stride: int,
    rounds: int,
    partner: NDArray[np.int64],
    rows: Array,
    system: Array,
    scratch: Array,
) -> tuple[float, float, int, float, int, bool]:
    """Point-to-line ICP, at most so many rounds: moves a pose `(3,)` to where the scan lies best.

    Far from the answer every `stride`-th point is enough and partners are sought within `reach`;
    near it all points count, and only partners within `last`. Partners are -1 at first. Rows and
    system hold the last step afterwards; scratch is a (2, 3, 3) array. Returned are sigma, the
    share of points near, the rows used, reach and stride by then, and whether it has converged.
    """
    sigma, near, used = floor, 0.0, 0
    for _ in range(rounds):
        used, near = wall_residuals(grid, current, pose, reach, stride, partner, rows)
        if used < 6:
            break
        sigma = normal_equations(rows, used, floor, system)
        x, y, heading = gauss_newton_step(system, span, scratch[0], scratch[1])
        pose[0] += x
        pose[1] += y
        pose[2] += heading
        far = max(math.hypot(x, y), abs(heading) * span)
        if far < 1e-4 and stride == 1 and reach <= last:
            return sigma, near, used, reach, stride, True
        if far < 0.02 and reach > last:
            reach = max(0.5 * reach, last)
        elif far < 0.02:
            stride = 1
    return sigma, near, used, reach, stride, False


@compiled
def _value_of_rank(values: Array, count: int, rank: int) -> float:
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
    middle = below = _value_of_rank(size, used, used // 2)
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
