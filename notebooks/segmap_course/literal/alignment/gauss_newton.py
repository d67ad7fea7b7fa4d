"""Gauss-Newton on a pose graph as plain loops (Grisetti et al. 2010)."""

from __future__ import annotations

import math
from collections.abc import Sequence

Numbers = Sequence[float]
Matrix = Sequence[Sequence[float]]


def edge_residual(first: Numbers, second: Numbers, relative: Numbers) -> tuple[float, float, float]:
    """What two poses leave of the motion measured between them, in the frame of the first."""
    dx, dy = second[0] - first[0], second[1] - first[1]
    c, s = math.cos(first[2]), math.sin(first[2])
    turn = second[2] - first[2] - relative[2]
    wrapped = (turn + math.pi) % (2 * math.pi) - math.pi
    return c * dx + s * dy - relative[0], -s * dx + c * dy - relative[1], wrapped


def gauss_newton(
    poses: Sequence[Numbers],
    edges: Sequence[tuple[int, int, Numbers, Matrix]],
    scale: float = math.inf,
) -> list[list[float]]:
    """One step towards the poses that fit all edges best; the first pose stays.

    An edge is the numbers of two poses, the measured pose of the second in the frame of the first,
    and the 3 x 3 inverse of its covariance. One left open by `scale` standard deviations has half
    its weight (Cauchy).

    Examples
    --------
    >>> unit = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> steps = [(0, 1, (1, 0, 0), unit), (1, 2, (1, 0, 0), unit), (2, 0, (-1.7, 0, 0), unit)]
    >>> [round(x, 6) for x, _, _ in gauss_newton([(0, 0, 0)] * 3, steps)]
    [0, 0.9, 1.8]
    """
    size = 3 * len(poses)
    hessian, gradient = [[0.0] * size for _ in range(size)], [0.0] * size
    for i, j, relative, information in edges:
        r = edge_residual(poses[i], poses[j], relative)
        squared = sum(r[a] * information[a][b] * r[b] for a in range(3) for b in range(3))
        weight = 1 / (1 + squared / scale**2)
        c, s = math.cos(poses[i][2]), math.sin(poses[i][2])
        x, y = r[0] + relative[0], r[1] + relative[1]  # the second as the first sees it
        by_first = (-c, -s, y), (s, -c, -x), (0.0, 0.0, -1.0)
        by_second = (c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)
        columns = [(3 * i + k, [row[k] for row in by_first]) for k in range(3)]
        columns += [(3 * j + k, [row[k] for row in by_second]) for k in range(3)]
        for p, a in columns:
            pull = [weight * sum(a[k] * information[k][m] for k in range(3)) for m in range(3)]
            gradient[p] += sum(pull[m] * r[m] for m in range(3))
            for q, b in columns:
                hessian[p][q] += sum(pull[m] * b[m] for m in range(3))
    free = range(3, size)
    step = eliminated([[hessian[p][q] for q in free] for p in free], [-gradient[p] for p in free])
    rest = [[poses[k][i] + step[3 * k - 3 + i] for i in range(3)] for k in range(1, len(poses))]
    return [list(poses[0]), *rest]


def eliminated(matrix: list[list[float]], right: list[float]) -> list[float]:
    """Solution of a symmetric positive system by Gaussian elimination; both are overwritten."""
    n = len(right)
    for k in range(n):
        for i in range(k + 1, n):
            factor = matrix[i][k] / matrix[k][k]
            for j in range(k, n):
                matrix[i][j] -= factor * matrix[k][j]
            right[i] -= factor * right[k]
    for k in reversed(range(n)):
        right[k] -= sum(matrix[k][j] * right[j] for j in range(k + 1, n))
        right[k] /= matrix[k][k]
    return right
