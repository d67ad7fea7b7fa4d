"""Point-to-line ICP as plain loops (A 2.5.1, after Lu and Milios 1997; Censi 2008)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..lines import Point, placed
from ..points import sums_of


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
    found, rest, way = [0.0] * len(right), right[:], right[:]
    first = size = sum(r * r for r in rest)
    while size > 1e-24 * first:
        image = [sum(a * w for a, w in zip(row, way, strict=True)) for row in matrix]
        part = size / sum(a * w for a, w in zip(image, way, strict=True))
        found = [f + part * w for f, w in zip(found, way, strict=True)]
        rest = [r - part * a for r, a in zip(rest, image, strict=True)]
        before, size = size, sum(r * r for r in rest)
        way = [r + size / before * w for r, w in zip(rest, way, strict=True)]
    return found


def wall_normal(points: Sequence[Point], at: Point) -> Point | None:
    """Normal of the wall that points form around a place; None where they form none.

    The neighbourhood is the smallest of 0.12, 0.24, 0.48 and 0.96 m that holds five points; a wall
    is much narrower than long.
    """
    for radius in (0.12, 0.24, 0.48, 0.96):
        near = [p for p in points if math.dist(p, at) <= radius]
        if len(near) >= 5:
            sums = sums_of(near)
            along, middle = sums.direction(), (sums.xx + sums.yy) / 2
            half = math.hypot((sums.xx - sums.yy) / 2, sums.xy)
            narrow = middle - half < 0.15 * (middle + half)
            return (-math.sin(along), math.cos(along)) if narrow else None
    return None


def point_to_line(
    reference: Sequence[Point], current: Sequence[Point], start: Point, reach: float = 0.6
) -> tuple[float, float, float]:
    """Pose of a scan of at most 250 points in the frame of another, by point-to-line ICP.

    Partners are sought as far as `reach`, metres, at first, and 0.12 m in the end.

    Examples
    --------
    >>> corner = [(0.1 * k, 0.0) for k in range(30)] + [(0.0, 0.1 * k) for k in range(30)]
    >>> x, y, turn = point_to_line(corner, [(x - 0.05, y - 0.02) for x, y in corner], (0, 0, 0))
    >>> round(x, 3), round(y, 3), abs(round(turn, 3))
    (0.05, 0.02, 0.0)
    """
    x, y, heading = start
    walls = [(p, n) for p in reference if (n := wall_normal(reference, p)) is not None]
    known = {(p[0], p[1]): n for p, n in walls}
    span = math.sqrt(sum(px * px + py * py for px, py in current) / len(current))
    for _ in range(60):
        points, feet, normals = [], [], []
        for p in current:
            turned = placed(p, (0.0, 0.0, heading))
            q = min(reference, key=lambda q: math.dist(q, (turned[0] + x, turned[1] + y)))
            if math.dist(q, (turned[0] + x, turned[1] + y)) < reach and (q[0], q[1]) in known:
                points.append(turned)  # turned about the robot
                feet.append((q[0] - x, q[1] - y))
                normals.append(known[q[0], q[1]])
        rows = zip(points, feet, normals, strict=True)
        offsets = [(p[0] - f[0]) * n[0] + (p[1] - f[1]) * n[1] for p, f, n in rows]
        ranked = sorted(abs(r) for r in offsets)
        middle = (ranked[len(ranked) // 2] + ranked[(len(ranked) - 1) // 2]) / 2
        sigma = max(1.4826 * middle, 0.01)
        weights = [1 / (1 + (r / (2 * sigma)) ** 2) for r in offsets]
        step = point_to_line_step(points, feet, normals, weights, span)
        x, y, heading = x + step[0], y + step[1], heading + step[2]
        far = max(math.hypot(step[0], step[1]), abs(step[2]) * span)
        if far < 1e-4 and reach <= 0.12:
            break
        if far < 0.02:
            reach = max(0.5 * reach, 0.12)
    return x, y, heading
