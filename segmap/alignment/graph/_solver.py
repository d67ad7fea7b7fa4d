"""Sparse least squares over poses, with Cauchy weights.

Gauss-Newton (Grisetti et al. 2010) on a block Cholesky factor in an order of minimum degree.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ._solver_kernels import (
    Edge,
    Edges,
    Factor,
    Indices,
    advance,
    factorise,
    linearise,
    link_slots,
    substitute,
)

#: Residuals of this many standard deviations have half the weight: nine of ten true edges are
#: closed better, false loops are far beyond.
SCALE = 3.0
#: Rounds are at most so many: what is solved takes three to fifteen.
MOST_SOLVER_ROUNDS = 30
#: Steps of the solver end where no pose moves by more than this, metres and radians: a hundredth of
#: what a laser sees.
SOLVER_CONVERGED = 1e-5
#: Where no pose moves by more than this, metres and radians, the bend of the loss is used as well:
#: weights alone come closer to the minimum by a third at each step.
NEAR_MINIMUM = 0.03
#: The bend takes at most so large a part of an edge's weight: all of it would leave a pose free
#: that only this edge ties.
MOST_BENT_SHARE = 0.9
#: A loss that rises by no more than this part, and by this much an edge, is rounding.
LOSS_ROUNDING = 1e-9


class Solution(NamedTuple):
    """Poses that fit best, and whether the solver got there."""

    poses: Array  # (n, 3), metres and radians
    converged: bool  # else the rounds were used up, and the poses are still on the way
    rounds: int


def solve(
    poses: Array, edges: Edge, *, rounds: int = MOST_SOLVER_ROUNDS, scale: float = SCALE
) -> Solution:
    """Poses `(n, 3)` that fit m edges best, from some to begin with; the first stays where it is.

    Minimises the sum of Cauchy losses of the residuals by at most so many rounds; every pose must
    be tied to the first through edges. Edges left open by `scale` standard deviations have half the
    weight, but for those that are forced; `inf`: all the same. Where rounding leaves no factor, the
    bend of the loss is left out; raises LinAlgError where the information leaves a pose free even
    so.
    """
    poses = before = poses.copy()
    equations, factor = _prepared(len(poses), edges, scale)
    curved, near, size, loss = False, NEAR_MINIMUM, np.inf, np.inf
    for count in range(1, rounds + 1):
        # 1. Half the loss and its gradient
        gradient = np.zeros(poses.shape)
        now = linearise(poses, equations, MOST_BENT_SHARE * curved, gradient, np.empty((6, 3)))
        gradient[0] = 0.0
        if curved and now > loss * (1 + LOSS_ROUNDING) + LOSS_ROUNDING * len(edges.relative):
            poses, curved, near = before, False, size / 4
            continue
        # 2. The factor
        try:
            _factorise(factor, equations)
        except np.linalg.LinAlgError:
            if not curved:
                raise
            curved, near = False, 0.0
            continue
        # 3. The step
        move = -gradient[factor.pose]
        substitute(factor, move)
        before, loss, poses = poses, now, np.empty_like(poses)
        size = advance(before, move, factor.column, poses)
        if size < SOLVER_CONVERGED:
            return Solution(poses, True, count)
        curved = size < near
    return Solution(poses, False, rounds)


def moved(poses: Array, edges: Edge, pulls: Array) -> Array:
    """How far each pose moves, `(d, n, 3)`, by pulls `(d, n, 3)` at them: all is linear there.

    The edges have the weights that the poses give them.
    """
    (equations, factor), moves = _prepared(len(poses), edges, SCALE), np.empty_like(pulls)
    linearise(poses, equations, 0.0, np.zeros(poses.shape), np.empty((6, 3)))
    _factorise(factor, equations)
    for pull, move in zip(pulls.take(factor.pose, 1), moves, strict=True):
        pull[0] = 0.0  # the pose that is held
        substitute(factor, pull)
        move[:] = pull[factor.column]
    return moves


def _factorise(factor: Factor, equations: Edges) -> None:
    """Compute the factor of the equations."""
    n = len(factor.pose)
    free = factorise(factor, equations, np.zeros((n, 9)), np.empty((4, n), np.int64))
    if free >= 0:
        raise np.linalg.LinAlgError(f"the information leaves pose {free} free")


def _prepared(n: int, edges: Edge, scale: float) -> tuple[Edges, Factor]:
    """Room for the equations of all edges, and for their factor: the first of n poses is held."""
    ends = np.stack([edges.first, edges.second], -1).astype(np.int64)
    symmetric = (edges.information + edges.information.swapaxes(1, 2)) / 2
    scales = np.where(edges.forced, np.inf, np.full(len(ends), scale))
    equations = Edges(ends, edges.relative, symmetric, scales, np.empty((len(ends), 3, 9)))
    return equations, _minimum_degree_factor(n, ends)


def _minimum_degree_factor(n: int, ends: Indices) -> Factor:
    """An empty factor of n poses, in an order of minimum degree; the first pose has column 0.

    SuperLU, given a matrix with an entry for each block, tells the order and which blocks it fills.
    """
    from scipy.sparse import coo_array, diags_array, tril
    from scipy.sparse.linalg import splu

    first, second = ends[(ends > 0).all(1) & (ends[:, 0] != ends[:, 1])].T - 1
    joined = coo_array((np.full(len(first), -1.0), (first, second)), shape=(n - 1, n - 1))
    degree = np.bincount(np.r_[first, second], minlength=n - 1)
    matrix = (joined + joined.T + diags_array(degree + 1.0)).tocsc()
    symmetric = {"SymmetricMode": True}
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric)
    filled = tril(factors.L, -1, format="csc")
    filled.sort_indices()
    column = np.insert(factors.perm_c.astype(np.int64) + 1, 0, 0)
    start, rows = np.insert(filled.indptr, 0, 0).astype(np.int64), filled.indices.astype(np.int64)
    values, pivots = np.zeros(9 * len(rows)), np.zeros((n, 9))
    head, link = np.full(n, -1), np.full(2 * len(ends), -1)
    link_slots(head, link, ends)
    length = np.diff(start)
    return Factor(column, np.argsort(column), head, link, start, length, rows + 1, values, pivots)
