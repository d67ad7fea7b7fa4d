"""Loops of point-to-line ICP: partners of points, normals of walls, Gauss-Newton steps."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

#: A direction is not fixed by the walls where its eigenvalue is below this share of the largest:
#: walls that err by their noise alone leave a thousandth.
FREE = 0.01
#: A neighbourhood is a wall where its variance across is below this share of that along: corners
#: and bushes lie above.
NARROW = 0.15
#: A beam that meets the back of a wall at a flatter angle than this (its sine) may be noise.
BACK = 0.05


class PointGrid(NamedTuple):
    """Points of walls, sorted into square cells of side `size`, metres, from corner (x, y) on."""

    points: Array  # (n, 2), metres, cell by cell
    normals: Array  # (n, 2): unit normal of the wall through each; NaN where there is no wall
    x: float
    y: float
    size: float
    columns: int
    rows: int
    first: NDArray[np.int64]  # where the points of cell (i, j) begin: first[i * rows + j]
    sided: bool  # normals point to where each point was seen from: a thin wall has two faces


@compiled
def fit_normals(grid: PointGrid, radius: float, largest: float, enough: int) -> None:
    """Write the unit normal of the wall through each point, where its neighbours form a wall.

    The neighbourhood is doubled from `radius` (metres) until it holds `enough` points, up to
    `largest`; the normal is the minor axis of its scatter about the mean.
    """
    for k in range(len(grid.points)):
        x, y, reach, n = grid.points[k, 0], grid.points[k, 1], radius, 0
        xx = xy = yy = 0.0
        while n < enough and reach <= 1.001 * largest:
            left = max(int((x - reach - grid.x) / grid.size), 0)
            right = min(int((x + reach - grid.x) / grid.size), grid.columns - 1)
            low = max(int((y - reach - grid.y) / grid.size), 0)
            high = min(int((y + reach - grid.y) / grid.size), grid.rows - 1)
            n = 0
            sx = sy = xx = xy = yy = 0.0
            for i in range(left, right + 1):
                row = i * grid.rows
                for p in range(grid.first[row + low], grid.first[row + high + 1]):
                    dx, dy = grid.points[p, 0] - x, grid.points[p, 1] - y
                    if dx * dx + dy * dy <= reach * reach:
                        n += 1
                        sx, sy = sx + dx, sy + dy
                        xx, xy, yy = xx + dx * dx, xy + dx * dy, yy + dy * dy
            m = max(n, 1)
            xx, xy, yy = xx - sx * sx / m, xy - sx * sy / m, yy - sy * sy / m
            reach *= 2.0
        if n >= enough:
            middle, half = 0.5 * (xx + yy), math.hypot(0.5 * (xx - yy), xy)
            if middle - half < NARROW * (middle + half):
                along = 0.5 * math.atan2(2.0 * xy, xx - yy)
                grid.normals[k, 0], grid.normals[k, 1] = -math.sin(along), math.cos(along)


@compiled
def nearest(grid: PointGrid, x: float, y: float, reach: float) -> int:
    """Index of the point nearest to (x, y), ring of cells by ring; -1 where none is in reach."""
    best, found = reach * reach, -1
    i0, j0 = math.floor((x - grid.x) / grid.size), math.floor((y - grid.y) / grid.size)
    for ring in range(int(reach / grid.size) + 2):
        if ring > 1 and ((ring - 1) * grid.size) ** 2 > best:
            break
        for i in range(max(i0 - ring, 0), min(i0 + ring, grid.columns - 1) + 1):
            step = 1 if ring == 0 or i == i0 - ring or i == i0 + ring else 2 * ring
            for j in range(j0 - ring, j0 + ring + 1, step):
                if 0 <= j < grid.rows:
                    c = i * grid.rows + j
                    for k in range(grid.first[c], grid.first[c + 1]):
                        d = (grid.points[k, 0] - x) ** 2 + (grid.points[k, 1] - y) ** 2
                        if d < best:
                            best, found = d, k
    return found


@compiled
def residuals(
    grid: PointGrid, current: Array, pose: Array, reach: float, stride: int, rows: Array
) -> tuple[int, float]:
    """Write a row for each point that has a wall within reach (metres) of it; their number.

    Every `stride`-th of the current points `(m, 2)`, metres, in the robot's frame, is asked; one
    that lies behind a wall, as seen from the robot, has no row. Rows, (m, 6) array: derivative of
    the offset by x, y and heading; offset across the wall, metres; weight (left as it is); index of
    the point. Also returned is the share of those asked that have any point within reach.
    """
    c, s = math.cos(pose[2]), math.sin(pose[2])
    used = near = 0
    for k in range(0, len(current), stride):
        turned_x = c * current[k, 0] - s * current[k, 1]
        turned_y = s * current[k, 0] + c * current[k, 1]
        x, y = turned_x + pose[0], turned_y + pose[1]
        p = nearest(grid, x, y, reach)
        if p < 0:
            continue
        near += 1
        nx, ny = grid.normals[p, 0], grid.normals[p, 1]
        behind = nx * turned_x + ny * turned_y > BACK * math.hypot(turned_x, turned_y)
        if math.isnan(nx) or (grid.sided and behind):
            continue
        rows[used, 0], rows[used, 1] = nx, ny
        rows[used, 2] = ny * turned_x - nx * turned_y
        rows[used, 3] = nx * (x - grid.points[p, 0]) + ny * (y - grid.points[p, 1])
        rows[used, 5] = k
        used += 1
    return used, near / ((len(current) + stride - 1) // stride)


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
    middle = _ranked(size, used, used // 2)
    sigma = max(1.4826 * 0.5 * (middle + _ranked(size, used, (used - 1) // 2)), floor)
    for i in range(3):
        for j in range(4):
            system[i, j] = 0.0
    for k in range(used):
        weight = 1.0 / (1.0 + (rows[k, 3] / (2.0 * sigma)) ** 2)
        rows[k, 4] = weight
        for i in range(3):
            for j in range(4):
                system[i, j] += weight * rows[k, i] * rows[k, j]
    return sigma


@compiled
def gauss_newton_step(
    system: Array, span: float, a: Array, axes: Array
) -> tuple[float, float, float]:
    """Step in x, y (metres) and heading (radians); none along directions that no wall fixes.

    A heading counts as the length by which it moves a point at distance `span`, metres. Eigenvalues
    and eigenvectors come by Jacobi's rotations into `a` and `axes`, (3, 3) arrays.
    """
    for i in range(3):
        for j in range(3):
            a[i, j] = system[i, j] / ((span if i == 2 else 1.0) * (span if j == 2 else 1.0))
            axes[i, j] = 1.0 if i == j else 0.0
    for turn in range(30):
        p, q = (0, 0, 1)[turn % 3], (1, 2, 2)[turn % 3]
        if a[p, q] != 0.0:
            angle = 0.5 * math.atan2(2.0 * a[p, q], a[q, q] - a[p, p])
            c, s = math.cos(angle), math.sin(angle)
            for k in range(3):
                a[k, p], a[k, q] = c * a[k, p] - s * a[k, q], s * a[k, p] + c * a[k, q]
                u, v = axes[k, p], axes[k, q]
                axes[k, p], axes[k, q] = c * u - s * v, s * u + c * v
            for k in range(3):
                a[p, k], a[q, k] = c * a[p, k] - s * a[q, k], s * a[p, k] + c * a[q, k]
    most = max(a[0, 0], a[1, 1], a[2, 2])
    x = y = heading = 0.0
    for k in range(3):
        if a[k, k] > FREE * most:
            along = axes[0, k] * system[0, 3] + axes[1, k] * system[1, 3]
            along = (along + axes[2, k] * system[2, 3] / span) / a[k, k]
            x -= axes[0, k] * along
            y -= axes[1, k] * along
            heading -= axes[2, k] * along / span
    return x, y, heading


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
    rows: Array,
    system: Array,
    scratch: Array,
) -> tuple[float, float, int, float, int, bool]:
    """Point-to-line ICP, at most so many rounds: moves a pose `(3,)` to where the scan lies best.

    Far from the answer every `stride`-th point is enough and partners are sought within `reach`;
    near it all points count, and only partners within `last`. Rows and system hold the last step
    afterwards; scratch is a (2, 3, 3) array. Returned are sigma, the share of points near, the rows
    used, reach and stride by then, and whether it has converged.
    """
    sigma, near, used = floor, 0.0, 0
    for _ in range(rounds):
        used, near = residuals(grid, current, pose, reach, stride, rows)
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
