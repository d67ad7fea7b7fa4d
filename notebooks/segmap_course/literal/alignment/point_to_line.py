"""Point-to-line ICP as chapter 7 writes it (A 2.5.1, after Lu and Milios 1997; Censi 2008)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from segmap.arrays import Array
from segmap.poses import transform

from ..lines import Point


def partners(
    reference: Array, points: Array, reach: float
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Index of the nearest reference point of each point, and whether it is within reach.

    Points are `(n, 2)` and `(m, 2)`, the reach is in metres; both answers are `(m,)`.
    """
    distance = np.hypot(*(points[:, None] - reference).transpose(2, 0, 1))
    return distance.argmin(axis=1), distance.min(axis=1) < reach


def wall_normals(points: Array) -> Array:
    """Unit normal of the wall through each point, (n, 2); NaN where there is no wall.

    The neighbourhood is the smallest of 0.12, 0.24, 0.48 and 0.96 m that holds five points; a wall
    is much narrower than long.
    """
    normals = np.full(points.shape, np.nan)
    for k, point in enumerate(points):
        for radius in (0.12, 0.24, 0.48, 0.96):
            near = points[np.hypot(*(points - point).T) <= radius]
            if len(near) >= 5:
                spread, axes = np.linalg.eigh(np.cov(near.T))
                if spread[0] < 0.15 * spread[1]:
                    normals[k] = axes[:, 0]
                break
    return normals


def residuals(points: Array, feet: Array, normals: Array) -> Array:
    """How far each point lies from its wall, across the wall, metres."""
    return np.asarray(((points - feet) * normals).sum(axis=1))


def weights(r: Array) -> Array:
    """1 where a residual is small, near 0 where it is many times the usual one."""
    sigma = max(1.4826 * np.median(abs(r)), 0.01)
    return np.asarray(1 / (1 + (r / (2 * sigma)) ** 2))


def best_move(points: Array, feet: Array, normals: Array) -> Array:
    """Small shift x, y in metres and turn about the origin in radians that fits best, (3,)."""
    (x, y), (n_x, n_y) = points.T, normals.T
    J = np.column_stack([n_x, n_y, x * n_y - y * n_x])
    r = residuals(points, feet, normals)
    WJ = weights(r)[:, None] * J
    return -np.linalg.solve(WJ.T @ J, WJ.T @ r)


def one_step(pose: Array, reference: Array, normals: Array, scan: Array, reach: float) -> Array:
    """The best move of a scan that lies at a pose: x, y and a turn about the robot, (3,)."""
    points = transform((0, 0, pose[2]), scan)
    nearest, near = partners(reference, points + pose[:2], reach)
    near &= ~np.isnan(normals[nearest, 0])
    feet = reference[nearest[near]] - pose[:2]
    return best_move(points[near], feet, normals[nearest[near]])


def icp(
    reference: Array, scan: Array, start: Array, reach: float = 0.6, last: float = 0.12
) -> Array:
    """Poses of the scan from its start to where it comes to rest, (k, 3).

    Reference and scan are points `(n, 2)`, each in the frame of its robot; at most 250 in the scan.
    Partners are sought within `reach` metres at first and within `last` in the end.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the walls leave a direction wholly free.

    Examples
    --------
    >>> side = np.column_stack([np.arange(30) / 10, np.zeros(30)])
    >>> corner = np.concatenate([side, side[:, ::-1]])
    >>> icp(corner, corner - (0.05, 0.02), np.zeros(3))[-1].round(3) + 0.0
    array([0.05, 0.02, 0.  ])
    """
    normals, size = wall_normals(reference), np.sqrt((scan**2).sum(axis=1).mean())
    poses = [np.array(start, float)]
    for _ in range(60):
        move = one_step(poses[-1], reference, normals, scan, reach)
        poses.append(poses[-1] + move)
        length = max(np.hypot(*move[:2]), size * abs(move[2]))
        if length < 1e-4 and reach <= last:
            break
        if length < 0.02:
            reach = max(reach / 2, last)
    return np.array(poses)


def point_to_line_step(
    points: Sequence[Point],
    feet: Sequence[Point],
    normals: Sequence[Point],
    weights: Sequence[float] | None = None,
    span: float = 1.0,
) -> tuple[float, float, float]:
    """Small motion that brings points nearest to their walls: x, y in metres, turn in radians.

    Each point has a place on its wall, its foot, and the normal of the wall; the turn is one about
    the origin. The sum of the squared offsets across the walls is least. Of equally good motions
    the smallest is taken, a turn counted as the length by which it moves a point at `span` metres.

    Examples
    --------
    >>> wall = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]
    >>> step = point_to_line_step([(x, 0.5) for x, _ in wall], wall, [(0.0, 1.0)] * 3)
    >>> [round(part, 9) + 0.0 for part in step]
    [0.0, -0.5, 0.0]
    """
    hessian, gradient = [[0.0] * 3 for _ in range(3)], [0.0] * 3
    for k, ((x, y), (fx, fy), (nx, ny)) in enumerate(zip(points, feet, normals, strict=True)):
        row = nx, ny, (x * ny - y * nx) / span
        offset = (x - fx) * nx + (y - fy) * ny
        weight = 1.0 if weights is None else weights[k]
        for i in range(3):
            gradient[i] += weight * row[i] * offset
            for j in range(3):
                hessian[i][j] += weight * row[i] * row[j]
    x, y, turn = least_solution(hessian, [-g for g in gradient])
    return x, y, turn / span


def least_solution(matrix: list[list[float]], right: list[float]) -> list[float]:
    """Smallest solution of a symmetric system without negative eigenvalues: conjugate gradients."""
    solution, rest, way = [0.0] * len(right), right[:], right[:]
    first = size = sum(r * r for r in rest)
    while size > 1e-24 * first:
        image = [sum(a * w for a, w in zip(row, way, strict=True)) for row in matrix]
        part = size / sum(a * w for a, w in zip(image, way, strict=True))
        solution = [f + part * w for f, w in zip(solution, way, strict=True)]
        rest = [r - part * a for r, a in zip(rest, image, strict=True)]
        before, size = size, sum(r * r for r in rest)
        way = [r + size / before * w for r, w in zip(rest, way, strict=True)]
    return solution


def rows_of(points: Array, normals: Array) -> Array:
    """How the residual of each point changes with x, y and a turn about the origin, (n, 3)."""
    (x, y), (n_x, n_y) = points.T, normals.T
    return np.column_stack([n_x, n_y, x * n_y - y * n_x])


def covariance_of(rows: Array, weights: Array, sigma: float) -> Array:
    """Covariance of x, y and turn, (3, 3), where residuals err by sigma, metres."""
    H = rows.T @ (weights[:, None] * rows)
    return np.asarray(sigma**2 * np.linalg.inv(H))
