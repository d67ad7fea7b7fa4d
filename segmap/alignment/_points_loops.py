"""Loops of the point matchers: points in cells, normals of walls, steps of point-to-line ICP."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._compiled import compiled
from ..arrays import Array

#: Below this share of the largest eigenvalue a direction counts as not fixed by the walls.
FREE = 0.01
#: A neighbourhood is a wall when it is this much narrower than long (ratio of variances).
NARROW = 0.15
#: A beam that meets the back of a wall at a flatter angle than this (its sine) may be noise.
BACK = 0.05


class Cells(NamedTuple):
    """Points sorted into square cells: those of cell (i, j) lie at `first[c]` to `first[c + 1]`.

    `order` holds their indices before sorting; `sided` says that normals point to where each was
    seen from, so that the two faces of a thin wall are told apart.
    """

    points: Array
    corner: Array
    size: float
    columns: int
    rows: int
    first: NDArray[np.int64]
    order: NDArray[np.int64]
    sided: bool


@compiled
def in_cells(points: Array, size: float) -> Cells:
    """Points `(n, 2)`, metres, in cells of this side: a counting sort, cell by cell."""
    x, y = points[:, 0].min(), points[:, 1].min()
    columns = int((points[:, 0].max() - x) / size) + 1
    rows = int((points[:, 1].max() - y) / size) + 1
    cell = np.empty(len(points), np.int64)
    first = np.zeros(columns * rows + 1, np.int64)
    for k in range(len(points)):
        cell[k] = int((points[k, 0] - x) / size) * rows + int((points[k, 1] - y) / size)
        first[cell[k] + 1] += 1
    first = np.cumsum(first)
    at, ordered = first.copy(), np.empty_like(points)
    order = np.empty(len(points), np.int64)
    for k in range(len(points)):
        ordered[at[cell[k]]], order[at[cell[k]]] = points[k], k
        at[cell[k]] += 1
    return Cells(ordered, np.array([x, y]), size, columns, rows, first, order, False)


@compiled
def nearest(cells: Cells, x: float, y: float, reach: float) -> int:
    """Index of the point nearest to (x, y), ring of cells by ring; -1 where none is in reach.

    Among the sorted points of the cells, `(n, 2)`, metres.
    """
    best, found = reach * reach, -1
    i0 = int(np.floor((x - cells.corner[0]) / cells.size))
    j0 = int(np.floor((y - cells.corner[1]) / cells.size))
    for ring in range(int(reach / cells.size) + 2):
        if ring > 1 and ((ring - 1) * cells.size) ** 2 > best:
            break
        for i in range(max(i0 - ring, 0), min(i0 + ring, cells.columns - 1) + 1):
            step = 1 if abs(i - i0) == ring else 2 * ring
            for j in range(j0 - ring, j0 + ring + 1, max(step, 1)):
                if 0 <= j < cells.rows:
                    c = i * cells.rows + j
                    for k in range(cells.first[c], cells.first[c + 1]):
                        d = (cells.points[k, 0] - x) ** 2 + (cells.points[k, 1] - y) ** 2
                        if d < best:
                            best, found = d, k
    return found


@compiled
def spread(cells: Cells, x: float, y: float, radius: float) -> tuple[int, float, float, float]:
    """Number of points within `radius` of (x, y), and their sums of squares about their mean.

    Of the points of the cells, `(n, 2)`, metres: the sums of x x, x y and y y.
    """
    i0 = max(int((x - radius - cells.corner[0]) / cells.size), 0)
    i1 = min(int((x + radius - cells.corner[0]) / cells.size), cells.columns - 1)
    j0 = max(int((y - radius - cells.corner[1]) / cells.size), 0)
    j1 = min(int((y + radius - cells.corner[1]) / cells.size), cells.rows - 1)
    n = 0
    sx = sy = sxx = sxy = syy = 0.0
    for i in range(i0, i1 + 1):
        for k in range(cells.first[i * cells.rows + j0], cells.first[i * cells.rows + j1 + 1]):
            dx, dy = cells.points[k, 0] - x, cells.points[k, 1] - y
            if dx * dx + dy * dy <= radius * radius:
                n += 1
                sx, sy = sx + dx, sy + dy
                sxx, sxy, syy = sxx + dx * dx, sxy + dx * dy, syy + dy * dy
    m = max(n, 1)
    return n, sxx - sx * sx / m, sxy - sx * sy / m, syy - sy * sy / m


@compiled
def normals(cells: Cells, least: float, most: float, enough: int) -> Array:
    """Unit normal of the wall through each point, `(n, 2)`; NaN where the points form no wall.

    The neighbourhood grows from radius `least` (metres) until it holds `enough` points, up to
    `most`.
    """
    found = np.full((len(cells.points), 2), np.nan)
    for k in range(len(found)):
        radius, n = least, 0
        while n < enough and radius <= 1.001 * most:
            n, xx, xy, yy = spread(cells, cells.points[k, 0], cells.points[k, 1], radius)
            radius *= 2.0
        if n >= enough:
            middle, half = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
            if middle - half < NARROW * (middle + half):
                along = 0.5 * np.arctan2(2.0 * xy, xx - yy)
                found[k, 0], found[k, 1] = -np.sin(along), np.cos(along)
    return found


@compiled
def residuals(
    cells: Cells, normal: Array, current: Array, pose: Array, reach: float, stride: int
) -> tuple[Array, float]:
    """Rows of the derivative by x, y, heading, and the offset across the wall, metres, `(m, 4)`.

    Of those of the current points `(k, 2)`, in the robot's frame, that have a wall within reach of
    where the pose `(3,)` puts them, seen from the side from which the map's point was; with them
    the share that has any point there.
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    count = (len(current) + stride - 1) // stride
    rows = np.empty((count, 4))
    used = near = 0
    for k in range(0, len(current), stride):
        turned_x = c * current[k, 0] - s * current[k, 1]
        turned_y = s * current[k, 0] + c * current[k, 1]
        x, y = turned_x + pose[0], turned_y + pose[1]
        p = nearest(cells, x, y, reach)
        near += p >= 0
        if p >= 0 and not np.isnan(normal[p, 0]):
            nx, ny = normal[p, 0], normal[p, 1]
            behind = nx * turned_x + ny * turned_y > BACK * np.hypot(turned_x, turned_y)
            if cells.sided and behind:
                continue
            rows[used, 0], rows[used, 1] = nx, ny
            rows[used, 2] = ny * turned_x - nx * turned_y
            rows[used, 3] = nx * (x - cells.points[p, 0]) + ny * (y - cells.points[p, 1])
            used += 1
    return rows[:used], near / count


@compiled
def robust_weights(offset: Array, floor: float) -> tuple[Array, float]:
    """Cauchy weights `(m,)` of offsets, and their standard deviation by the median, metres."""
    sigma = max(1.4826 * np.median(np.abs(offset)), floor)
    return 1.0 / (1.0 + (offset / (2.0 * sigma)) ** 2), sigma


@compiled
def equations(rows: Array, weight: Array) -> tuple[Array, Array]:
    """Hessian `(3, 3)` and gradient `(3,)` of half the weighted sum of squared offsets.

    Of rows `(m, 4)` of `residuals`, metres and radians, with weights `(m,)`.
    """
    hessian, gradient = np.zeros((3, 3)), np.zeros(3)
    for k in range(len(rows)):
        for i in range(3):
            gradient[i] += weight[k] * rows[k, i] * rows[k, 3]
            for j in range(3):
                hessian[i, j] += weight[k] * rows[k, i] * rows[k, j]
    return hessian, gradient


@compiled
def least_move(hessian: Array, gradient: Array, span: float) -> Array:
    """Gauss-Newton step, (3,) array, metres and radians; none along directions that no wall fixes.

    A heading counts as the length by which it moves a point at distance `span`, metres.
    """
    scale = np.array([1.0, 1.0, 1.0 / span])
    value, vector = np.linalg.eigh(hessian * scale.reshape(3, 1) * scale)
    along = vector.T @ (gradient * scale)
    move = np.zeros(3)
    for k in range(3):
        if value[k] > FREE * value[2]:
            move -= vector[:, k] * along[k] / value[k]
    return move * scale


@compiled
def point_to_line(
    cells: Cells,
    normal: Array,
    current: Array,
    start: Array,
    reach: float,
    last: float,
    floor: float,
    span: float,
    stride: int,
) -> tuple[Array, Array, float, float, int]:
    """Point-to-line ICP: pose, Hessian, sigma, share of points that met a point, rows used.

    Current points `(m, 2)`, metres, in the robot's frame; start and pose, (3,) arrays, metres and
    radians, in the map's; sigma in metres. Far from the answer every `stride`-th point is enough
    and partners are sought within `reach`; near it all points count and only partners within
    `last`.
    """
    pose, hessian, sigma, near, used = start.copy(), np.zeros((3, 3)), floor, 0.0, 0
    for _ in range(60):
        rows, near = residuals(cells, normal, current, pose, reach, stride)
        used = len(rows)
        if used < 6:
            break
        weight, sigma = robust_weights(rows[:, 3], floor)
        hessian, gradient = equations(rows, weight)
        move = least_move(hessian, gradient, span)
        pose += move
        far = max(np.hypot(move[0], move[1]), abs(move[2]) * span)
        if far < 1e-4 and stride == 1 and reach <= last:
            break
        if far < 0.02 and reach > last:
            reach = max(0.5 * reach, last)
        elif far < 0.02:
            stride = 1
    return pose, hessian, sigma, near, used
