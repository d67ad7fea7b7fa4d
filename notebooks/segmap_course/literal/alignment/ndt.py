"""The normal distributions transform (Biber and Strasser 2003): a scan as a distribution a cell."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from segmap.arrays import Array
from segmap.poses import compose, transform

#: A cell with fewer points has no distribution.
LEAST_CELL_POINTS = 5
#: A distribution is so thin at least, as a part of its length: a wall has a thickness.
LEAST_THICKNESS = 0.03


class Normals(NamedTuple):
    """Of each cell that holds points: its grid and index `(m, 3)`, mean `(m, 2)`, and the inverse
    of its covariance `(m, 2, 2)`, metres."""

    cells: Array
    means: Array
    inverses: Array
    side: float


def cell_indices(points: Array, side: float) -> Array:
    """Grid and index `(4, n, 3)` of points in four grids, each shifted by half a cell: no point is
    at the border of all four."""
    shifts = side / 2 * np.array([(0, 0), (1, 0), (0, 1), (1, 1)])
    index = np.floor((points + shifts[:, None]) / side).astype(int)
    grid = np.broadcast_to(np.arange(4)[:, None, None], (*index.shape[:2], 1))
    return np.concatenate([grid, index], axis=-1)


def normals_of(points: Array, side: float = 1.0) -> Normals:
    """The distribution of the points `(n, 2)` of each cell.

    Examples
    --------
    >>> wall = np.stack([np.linspace(0.05, 0.95, 10), np.full(10, 0.5)], axis=-1)
    >>> normals = normals_of(wall)
    >>> normals.means[0].round(6), bool(normals.inverses[0, 1, 1] > 100 * normals.inverses[0, 0, 0])
    (array([0.5, 0.5]), True)
    """
    keys = cell_indices(points, side)
    cells, own = np.unique(keys.reshape(-1, 3), axis=0, return_inverse=True)
    repeated, own = np.tile(points, (4, 1)), own.ravel()
    rows, means, inverses = [], [], []
    for k in np.flatnonzero(np.bincount(own) >= LEAST_CELL_POINTS):
        inside = repeated[own == k]
        size, axes = np.linalg.eigh(np.cov(inside.T))
        size = np.maximum(size, max(LEAST_THICKNESS**2 * size[1], 1e-6))
        rows.append(k)
        means.append(inside.mean(0))
        inverses.append(axes / size @ axes.T)
    moments = np.reshape(means, (-1, 2)), np.reshape(inverses, (-1, 2, 2))
    return Normals(cells[rows], *moments, side)


def ndt_step(normals: Normals, points: Array, pose: Array) -> tuple[Array, float]:
    """A Gauss-Newton step about the origin `(3,)`, and the score, of points `(n, 2)` at a pose.

    A point q from the mean of its cell scores exp(-q' S^-1 q / 2); the same number is its weight.
    """
    placed = transform(pose, points)
    row_of = {tuple(cell): k for k, cell in enumerate(normals.cells.tolist())}
    keys = cell_indices(placed, normals.side).reshape(-1, 3).tolist()
    own = np.array([row_of.get(tuple(key), -1) for key in keys])
    p, own = np.tile(placed, (4, 1))[own >= 0], own[own >= 0]
    q, inverse = p - normals.means[own], normals.inverses[own]
    weight = np.exp(-(q[:, None] @ inverse @ q[..., None])[:, 0, 0] / 2)
    rows = np.zeros((len(p), 2, 3))
    rows[:, 0, 0] = rows[:, 1, 1] = 1
    rows[:, 0, 2], rows[:, 1, 2] = -p[:, 1], p[:, 0]
    pulled = weight[:, None, None] * rows.swapaxes(1, 2) @ inverse
    H, g = (pulled @ rows).sum(0), (pulled @ q[..., None]).sum(0)[:, 0]
    return -np.linalg.lstsq(H, g, rcond=1e-9)[0], float(weight.sum())


def match_ndt(normals: Normals, points: Array, start: Array, rounds: int = 30) -> Array:
    """Poses of a descent, `(k, 3)`, the start first, until a step is below a millimetre."""
    poses = [np.asarray(start, float)]
    for _ in range(rounds):
        move, _ = ndt_step(normals, points, poses[-1])
        poses.append(compose(move, poses[-1]))
        if np.abs(move).max() < 1e-3:
            break
    return np.array(poses)
