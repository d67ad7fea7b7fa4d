"""Robust sparse least squares over poses that are tied by measured motions.

Grisetti et al. (2010), "A tutorial on graph-based SLAM", with Cauchy weights.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..angles import wrap
from ..arrays import Array
from ..poses import between

#: Residuals of this many standard deviations have half the weight.
SCALE = 3.0


#: Whatever their covariance says, matches of real scans err by this much, metres and radians.
REAL = np.diag([0.02, 0.02, np.radians(0.3)]) ** 2


class Edges(NamedTuple):
    """Measured motions: `relative` is the pose of `second` in the frame of `first`, `(m, 3)`."""

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    relative: Array
    information: Array


def information(covariance: Array) -> Array:
    """Information of a motion that was matched with this covariance, (3, 3) array each.

    Of x, y, heading: metres and radians.
    """
    return np.asarray(np.linalg.inv(covariance + REAL))


def residuals(poses: Array, edges: Edges) -> Array:
    """What poses leave of each edge, `(m, 3)`, metres and radians, in the frame of `first`."""
    found = between(poses[edges.first], poses[edges.second])
    return np.column_stack(
        [found[:, :2] - edges.relative[:, :2], wrap(found[:, 2] - edges.relative[:, 2])]
    )


def deviations(poses: Array, edges: Edges) -> Array:
    """Lengths of the residuals in standard deviations, `(m,)`."""
    r = residuals(poses, edges)
    return np.sqrt(np.maximum(np.einsum("mi,mij,mj->m", r, edges.information, r), 0.0))


def solve(poses: Array, edges: Edges, *, rounds: int = 30, scale: float = SCALE) -> Array:
    """Poses that fit all edges best; the first stays where it is.

    Minimises the sum of Cauchy losses of the residuals by iterated weighted Gauss-Newton.

    Parameters
    ----------
    poses : (n, 3) array, metres and radians
        Start; every pose must be tied to the first through edges.
    edges : Edges
    rounds : int
        At most so many steps.
    scale : float
        Residuals of so many standard deviations have half the weight; `inf`: plain least squares.

    Returns
    -------
    (n, 3) array, metres and radians
    """
    poses = poses.copy()
    for _ in range(rounds):
        move = _gauss_newton(poses, edges, scale)
        poses[1:] += move
        poses[:, 2] = wrap(poses[:, 2])
        if np.abs(move).max(initial=0.0) < 1e-5:
            break
    return poses


def _gauss_newton(poses: Array, edges: Edges, scale: float) -> Array:
    """One step, `(n - 1, 3)`, of all poses but the first."""
    from scipy.sparse.linalg import splu

    weight = 1.0 / (1.0 + (deviations(poses, edges) / scale) ** 2)
    information = edges.information * weight[:, None, None]
    by_first, by_second = _derivatives(poses, edges)
    hessian = _normal_matrix(len(poses), edges, information, by_first, by_second)
    gradient = np.zeros_like(poses)
    pull = np.einsum("mij,mj->mi", information, residuals(poses, edges))
    np.add.at(gradient, edges.first, np.einsum("mji,mj->mi", by_first, pull))
    np.add.at(gradient, edges.second, np.einsum("mji,mj->mi", by_second, pull))
    factors = splu(hessian[3:, 3:], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    return np.asarray(factors.solve(-gradient[1:].ravel())).reshape(-1, 3)


def _derivatives(poses: Array, edges: Edges) -> tuple[Array, Array]:
    """Derivatives `(m, 3, 3)` of the residuals by the first and by the second pose."""
    heading = poses[edges.first, 2]
    c, s = np.cos(heading), np.sin(heading)
    found = between(poses[edges.first], poses[edges.second])
    zero, one = np.zeros_like(c), np.ones_like(c)
    back = np.array([[c, s, zero], [-s, c, zero], [zero, zero, one]]).transpose(2, 0, 1)
    by_first = -back
    by_first[:, 0, 2], by_first[:, 1, 2] = found[:, 1], -found[:, 0]
    return by_first, back


def _normal_matrix(count: int, edges: Edges, information: Array, a: Array, b: Array):  # type: ignore[no-untyped-def]
    """Sparse sum of J^T W J, `(3 count, 3 count)`: four blocks for each edge."""
    from scipy.sparse import csc_matrix

    i, j = edges.first, edges.second
    rows, columns, values = [], [], []
    for left, p in ((i, a), (j, b)):
        for right, q in ((i, a), (j, b)):
            block = np.einsum("mki,mkl,mlj->mij", p, information, q)
            rows.append(
                np.broadcast_to(3 * left[:, None, None] + np.arange(3)[:, None], block.shape)
            )
            columns.append(np.broadcast_to(3 * right[:, None, None] + np.arange(3), block.shape))
            values.append(block)
    flat = [np.concatenate(parts).ravel() for parts in (values, rows, columns)]
    return csc_matrix((flat[0], (flat[1], flat[2])), shape=(3 * count, 3 * count))
