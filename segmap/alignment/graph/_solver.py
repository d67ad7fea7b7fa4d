"""Sparse least squares over poses, with Cauchy weights, that keeps what it has computed.

Gauss-Newton (Grisetti et al. 2010) on a block Cholesky factor in an order of minimum degree. Edges
may be added: then only the columns that they change are computed again, as in iSAM2 (Kaess et al.
2012), but with the exact gradient at each step, so that the minimum is that of all edges together.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ._solver_kernels import (
    Edge,
    Edges,
    Factor,
    Indices,
    advance,
    factorise,
    find_structure,
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
#: Equations that are kept until they change by so many metres, radians, parts. At 0.01 what was
#: solved lazily lay so far from the minimum that Intel without odometry slid along a corridor.
STALE_CHANGE = 0.003
#: A loss that rises by no more than this part, and by this much an edge, is rounding.
LOSS_ROUNDING = 1e-9
#: New poses are eliminated last. The order is made anew after so many times the cube root of all:
#: an order costs their number, and what is added to late ones the square of how many these are.
LATE_POSES_FACTOR = 7.0


class Solution(NamedTuple):
    """Poses that fit best, and whether the solver got there."""

    poses: Array  # (n, 3), metres and radians
    converged: bool  # else the rounds were used up, and the poses are still on the way
    rounds: int


#: Every equation is stale, even one that has not changed.
ALL = -1.0


class Step(NamedTuple):
    """How the next step is made."""

    stale: float  # equations are kept until they change by so much
    curved: bool = False  # whether the bend of the loss is used
    # The bend is used where the last step was smaller than this, metres and radians.
    near: float = NEAR_MINIMUM
    size: float = np.inf  # of the last step


class Solver:
    """Solves for poses `(n, 3)` again and again as edges come in; the first pose stays.

    Edges left open by `scale` standard deviations have half the weight, but for those that are
    forced; `inf`: all the same.
    """

    def __init__(self, scale: float = SCALE) -> None:
        self.scale, self.columns = scale, 0  # columns of the factor that were computed so far
        self._count, self._used, self._ordered = 0, 0, 0
        self._edges = Edges(
            np.empty((0, 2), np.int64),
            *(np.empty((0, *shape)) for shape in ((3,), (3, 3), (), (3, 9), (4,))),
        )
        self._factor: Factor | None = None
        self._changed = np.empty(0, np.bool_)  # poses whose equations the factor does not hold yet

    def __len__(self) -> int:
        """Number of edges."""
        return self._count

    def add(self, more: Edge) -> None:
        """Add m edges; the poses that they name are given to the next `solve`."""
        old, new = self._count, self._count + len(more.first)
        if new > len(self._edges.ends):
            longer: Any = (_enlarge(field, max(new, 2 * old)) for field in self._edges)
            self._edges = Edges(*longer)
        e = self._edges
        e.ends[old:new] = np.stack([more.first, more.second], -1)
        e.relative[old:new] = more.relative
        e.information[old:new] = (more.information + more.information.swapaxes(1, 2)) / 2
        e.scale[old:new] = np.where(more.forced, np.inf, self.scale)
        e.made[old:new] = np.inf
        self._count = new

    def solve(
        self, poses: Array, *, rounds: int = MOST_SOLVER_ROUNDS, lazily: bool = False
    ) -> Solution:
        """Poses that fit all edges best, from some to begin with; the first stays where it is.

        Minimises the sum of Cauchy losses of the residuals by at most so many rounds; every pose
        must be tied to the first through edges. `lazily` keeps equations that have changed by less
        than `STALE_CHANGE`: the minimum is the same, the way to it may take a round more, and costs
        only what the new edges change. The newest pose is fixed then: stale equations would turn
        the map to and fro about the first. Where rounding leaves no factor, the bend of the loss is
        left out; raises LinAlgError where the information leaves a pose free even so.
        """
        poses = before = poses.copy()
        n, edges = len(poses), self._all_edges()
        factor = self._prepare(n, n - 1 if lazily else 0)
        keep = STALE_CHANGE if lazily else ALL
        step, loss = Step(keep), np.inf
        for count in range(1, rounds + 1):
            # 1. Half the loss and its gradient; equations that are stale are made anew
            gradient, bent = np.zeros((n, 3)), MOST_BENT_SHARE if step.curved else 0.0
            room = np.empty((6, 3))
            now = linearise(poses, edges, bent, step.stale, gradient, self._changed, room)
            gradient[factor.pose[0]] = 0.0
            if step.curved and now > loss * (1 + LOSS_ROUNDING) + LOSS_ROUNDING * len(self):
                poses, step = before, Step(ALL, near=step.size / 4)
                continue
            # 2. The columns of the factor that these change; kept equations may hold a bend too
            try:
                self._factorise(factor, edges)
            except np.linalg.LinAlgError:
                if step.stale == ALL and not step.curved:
                    raise
                step = Step(ALL, near=0.0)
                continue
            # 3. The step
            move = -gradient[factor.pose]
            substitute(factor, move)
            before, loss, poses = poses, now, np.empty_like(poses)
            size = advance(before, move, factor.column, poses)
            if size < SOLVER_CONVERGED:
                return Solution(poses, True, count)
            step = Step(keep, size < step.near, step.near, size)
        return Solution(poses, False, rounds)

    def moves(self, poses: Array, pulls: Array) -> Array:
        """How far each pose moves, `(d, n, 3)`, by pulls `(d, n, 3)` at them: all is linear there.

        The edges have the weights that the poses give them.
        """
        factor, edges, moves = self._prepare(len(poses), 0), self._all_edges(), np.empty_like(pulls)
        gradient, room = np.zeros(poses.shape), np.empty((6, 3))
        linearise(poses, edges, 0.0, ALL, gradient, self._changed, room)
        self._factorise(factor, edges)
        for pull, move in zip(pulls.take(factor.pose, 1), moves, strict=True):
            pull[0] = 0.0  # the pose that is fixed
            substitute(factor, pull)
            move[:] = pull[factor.column]
        return moves

    def _all_edges(self) -> Edges:
        """The edges, without the room for more."""
        parts: Any = (field[: self._count] for field in self._edges)
        return Edges(*parts)

    def _factorise(self, factor: Factor, edges: Edges) -> None:
        """Compute the columns of the factor that poses have changed."""
        marked, n = self._changed[factor.pose], len(factor.pose)
        free = factorise(factor, edges, marked, np.zeros((n, 9)), np.empty((4, n), np.int64))
        if free >= 0:
            raise np.linalg.LinAlgError(f"the information leaves pose {free} free")
        self.columns += int(marked.sum())
        self._changed[:] = False

    def _prepare(self, n: int, fixed: int) -> Factor:
        """The factor with n columns, and the rows that all edges need."""
        f, ends = self._factor, self._edges.ends[: self._count]
        if f is not None and len(f.pose) == n and len(f.link) == 2 * len(ends):
            return f
        if f is None or n - self._ordered > LATE_POSES_FACTOR * n ** (1 / 3):
            f, used, changed = _minimum_degree_factor(n, ends, fixed), 0, np.ones(n, np.bool_)
            self._ordered = n
        else:
            changed = np.arange(n) >= len(f.pose)
            changed[: len(f.pose)] |= self._changed[: len(f.pose)]
            changed[ends[len(f.link) // 2 :].ravel()] = True
            f, used = _widen(f, n, ends), self._used
        marked, lists = changed[f.pose], np.empty((4, n), np.int64)
        while (end := find_structure(f, ends, marked, used, lists)) < 0:
            room, used = 2 * len(f.rows), -1 - end
            f = f._replace(rows=_enlarge(f.rows, room), values=_enlarge(f.values, 9 * room))
        self._changed, self._used = changed, end
        self._factor = f  # last: until then an interrupt leaves the one before in use
        return f


def solve(
    poses: Array, edges: Edge, *, rounds: int = MOST_SOLVER_ROUNDS, scale: float = SCALE
) -> Solution:
    """Poses `(n, 3)` that fit m edges best, and `converged`, as `Solver.solve` has them."""
    solver = Solver(scale)
    solver.add(edges)
    return solver.solve(poses, rounds=rounds)


def _enlarge(array: Any, count: int) -> Any:
    """A copy with room for so many rows."""
    longer = np.zeros((count, *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return longer


def _minimum_degree_factor(n: int, ends: Indices, fixed: int) -> Factor:
    """An empty factor of n poses, in an order of minimum degree; the fixed pose comes first."""
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import splu

    joins = (ends != fixed).all(1) & (ends[:, 0] != ends[:, 1])  # two poses that are free
    first, second = ends[joins].T
    first, second = first - (first > fixed), second - (second > fixed)
    joined = coo_array((np.full(len(first), -1.0), (first, second)), shape=(n - 1, n - 1))
    degree = np.bincount(np.r_[first, second], minlength=n - 1)
    matrix = (joined + joined.T + diags_array(degree + 1.0)).tocsc()
    symmetric = {"SymmetricMode": True}
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric)
    column = np.insert(factors.perm_c.astype(np.int64) + 1, fixed, 0)
    start, length, rows = (np.zeros(m, np.int64) for m in (n, n, 8 * n))
    values, pivots = np.zeros(72 * n), np.zeros((n, 9))
    head, link = np.full(n, -1), np.full(2 * len(ends), -1)
    link_slots(head, link, ends, 0, fixed)
    return Factor(column, np.argsort(column), head, link, start, length, rows, values, pivots)


def _widen(f: Factor, n: int, ends: Indices) -> Factor:
    """The factor with columns for new poses at its end, and slots for new edges."""
    late, edge_count = np.arange(len(f.pose), n), len(f.link) // 2
    head, link = np.r_[f.head, np.full(len(late), -1)], _enlarge(f.link, 2 * len(ends))
    link[2 * edge_count :] = -1
    link_slots(head, link, ends, edge_count, int(f.pose[0]))
    return f._replace(
        column=np.r_[f.column, late],
        pose=np.r_[f.pose, late],
        head=head,
        link=link,
        start=_enlarge(f.start, n),
        length=_enlarge(f.length, n),
        pivots=_enlarge(f.pivots, n),
    )
