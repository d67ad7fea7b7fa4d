"""How well a pose graph knows the place of each pose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses import between
from ._equations import Edge
from ._graph import deviations
from ._solver import SCALE, Solver

#: So many draws give standard deviations to a tenth of their size.
DRAWS = 32
#: What lies within this, metres, is the neighbourhood of a pose: a large room, or a few small ones.
NEARBY = 20.0


def place_deviations(
    poses: Array, edges: Edge, weight: Array, *, reach: float = NEARBY
) -> tuple[Array, Array]:
    """Standard deviation of the place of each pose, `(n,)`, as the information of all edges has it.

    The edges are drawn anew from their covariances, and the poses solved for, in the linear
    neighbourhood of the solution (Papandreou and Yuille 2010): 32 solves with one factorisation,
    instead of the inverse of a large matrix. The draws are the same at each call. All poses are
    tied to the first; `weight` counts the scans at each. The place is that relative to all others,
    and then to those within `reach` metres: after the rigid motion that fits these best.
    """
    from scipy.sparse import bsr_array
    from scipy.spatial import cKDTree

    # Derivatives of the residuals by the first and by the second pose of each edge
    m, found = len(edges.relative), between(poses[edges.first], poses[edges.second])
    heading, blocks = poses[edges.first, 2], np.zeros((m, 2, 3, 3))
    blocks[:, 1, 0, 0] = blocks[:, 1, 1, 1] = np.cos(heading)
    blocks[:, 1, 0, 1] = np.sin(heading)
    blocks[:, 1, 1, 0] = -blocks[:, 1, 0, 1]
    blocks[:, 1, 2, 2] = 1.0
    blocks[:, 0] = -blocks[:, 1]
    blocks[:, 0, 0, 2], blocks[:, 0, 1, 2] = found[:, 1], -found[:, 0]
    weight_of = 1.0 / (1.0 + (deviations(poses, edges) / SCALE) ** 2)
    known = edges.information * np.where(edges.forced, 1.0, weight_of)[:, None, None]
    ends, rows = np.stack([edges.first, edges.second], -1).ravel(), np.arange(0, 2 * m + 1, 2)
    shape = 3 * m, 3 * len(poses)
    jacobian = bsr_array((blocks.reshape(-1, 3, 3), ends, rows), shape=shape)
    draws = np.random.default_rng(0).normal(size=(m, 3, DRAWS))
    pull = (np.linalg.cholesky(known) @ draws).reshape(3 * m, DRAWS)
    pulls = (jacobian.T @ pull).T.reshape(DRAWS, -1, 3)
    solver = Solver()
    solver.add(edges)
    moved = np.ascontiguousarray(solver.moved(poses, pulls)[:, :, :2].transpose(1, 2, 0))
    places = poses[:, :2]
    tree, near_by = cKDTree(places), np.empty(len(places))
    for k, place in enumerate(places):
        near = np.sort(tree.query_ball_point(place, reach))
        near_by[k] = _left(places[near], moved[near], weight[near], near == k)[0]
    return _left(places, moved, weight, slice(None)), near_by


def _left(places: Array, moved: Array, weight: Array, asked: NDArray[np.bool_] | slice) -> Array:
    """How far those asked of places `(n, 2)` move in draws `(n, 2, d)` beside the rigid motion that
    fits all best."""
    share = weight / weight.sum()
    arm = places - share @ places
    moved = moved - np.tensordot(share, moved, 1)
    across = np.stack([-arm[:, 1], arm[:, 0]], -1)
    turn = np.einsum("n,ni,nid->d", share, across, moved) / max(share @ (arm**2).sum(1), 1e-9)
    left = moved[asked] - across[asked, :, None] * turn
    return np.asarray(np.sqrt((left**2).sum(1).mean(-1)))
