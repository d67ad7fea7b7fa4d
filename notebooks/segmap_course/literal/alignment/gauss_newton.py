"""Gauss-Newton on a pose graph (Grisetti et al. 2010)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from segmap.arrays import Array

Numbers = Sequence[float] | Array
#: The numbers of two poses, the measured pose of the second in the frame of the first, and the
#: inverse of its covariance, 3 x 3.
Edge = tuple[int, int, Numbers, Array]


def edge_residual(first: Numbers, second: Numbers, relative: Numbers) -> Array:
    """What two poses leave of the motion measured between them, in the frame of the first."""
    dx, dy, turn = second[0] - first[0], second[1] - first[1], second[2] - first[2] - relative[2]
    c, s = math.cos(first[2]), math.sin(first[2])
    wrapped = (turn + math.pi) % (2 * math.pi) - math.pi
    return np.array([c * dx + s * dy - relative[0], c * dy - s * dx - relative[1], wrapped])


def edge_jacobians(first: Numbers, second: Numbers) -> tuple[Array, Array]:
    """Derivatives of the residual by the first pose and by the second, each 3 x 3."""
    dx, dy = second[0] - first[0], second[1] - first[1]
    c, s = math.cos(first[2]), math.sin(first[2])
    by_first = [(-c, -s, c * dy - s * dx), (s, -c, -c * dx - s * dy), (0, 0, -1)]
    return np.array(by_first), np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])


def normal_equations(
    poses: Sequence[Numbers] | Array, edges: Sequence[Edge], scale: float = math.inf
) -> tuple[Array, Array]:
    """H and g: of all small changes of the poses the best one, d, solves H d = -g."""
    n = 3 * len(poses)
    H, g = np.zeros((n, n)), np.zeros(n)
    for i, j, relative, information in edges:
        r, J = edge_residual(poses[i], poses[j], relative), np.zeros((3, n))
        J[:, 3 * i : 3 * i + 3], J[:, 3 * j : 3 * j + 3] = edge_jacobians(poses[i], poses[j])
        weight = 1 / (1 + r @ information @ r / scale**2)
        H += weight * J.T @ information @ J
        g += weight * J.T @ information @ r
    return H, g


def gauss_newton(
    poses: Sequence[Numbers] | Array, edges: Sequence[Edge], scale: float = math.inf
) -> Array:
    """One step towards the poses that fit all edges best; the first pose stays.

    An edge that is left open by `scale` standard deviations has half its weight (Cauchy).

    Examples
    --------
    >>> steps = [(0, 1, (1, 0, 0), np.eye(3)), (1, 2, (1, 0, 0), np.eye(3))]
    >>> gauss_newton(np.zeros((3, 3)), [*steps, (2, 0, (-1.7, 0, 0), np.eye(3))])[:, 0].round(6)
    array([0. , 0.9, 1.8])
    """
    H, g = normal_equations(poses, edges, scale)
    step = np.linalg.solve(H[3:, 3:], -g[3:])
    return np.asarray(poses + np.append(np.zeros(3), step).reshape(-1, 3))
