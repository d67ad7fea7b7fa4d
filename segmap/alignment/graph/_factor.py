"""Kernels of the pose-graph solver: a sparse block Cholesky factor that is computed again in parts.

The matrix has a block of 3 x 3 for each pair of poses that an edge joins. Its factor is kept by
columns. What changes in one column changes only its ancestors in the elimination tree (Davis 2006,
"Direct Methods for Sparse Linear Systems"), so that only those are computed again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from ._equations import Edges, Flags, Indices

#: A pivot that is left with less than this part of its entry is rounding: the pose is free.
ROUNDING = 1e-15


class Factor(NamedTuple):
    """The factor of the matrix: `length[j]` blocks from `start[j]` on are column j."""

    column: Indices  # of each pose; the pose that is held, 0, has column 0
    pose: Indices  # of each column
    head: Indices  # first slot of each pose, -1: none; slots 2 e and 2 e + 1 are the ends of edge e
    link: Indices  # (2 m,): next slot of the same pose
    start: Indices
    length: Indices
    rows: Indices  # of blocks, ascending in each column; the first is the column's parent
    blocks: Array  # (c, 9)
    pivots: Array  # (n, 9): inverse of the lower triangle on the diagonal


@compiled
def find_structure(f: Factor, ends: Indices, marked: Flags, used: int, lists: Indices) -> int:
    """Rows of the marked columns and of their ancestors, which get marked.

    Returns how many rows are used, or, where there is no room for more, -1 - used. The four lists
    (4, n) are for the work: first child, next child of the same, what was seen by which, and rows.
    """
    for j in range(len(f.pose)):
        lists[0, j] = lists[2, j] = -1
    for j in range(len(f.pose)):
        if marked[j]:
            k, c, s = 0, lists[0, j], f.head[f.pose[j]]
            while c >= 0:
                for q in range(f.start[c], f.start[c] + f.length[c]):
                    k = _insert(lists, k, f.rows[q], j)
                c = lists[1, c]
            while s >= 0:
                k = _insert(lists, k, f.column[ends[s // 2, 1 - s % 2]], j)
                s = f.link[s]
            if k > f.length[j]:
                if used + k > len(f.rows):
                    return -1 - used
                f.start[j] = used
                used += k
            f.length[j] = k
            for q in range(k):
                f.rows[f.start[j] + q] = lists[3, q]
        if f.length[j] > 0:
            parent = f.rows[f.start[j]]
            lists[1, j], lists[0, parent] = lists[0, parent], j
            marked[parent] |= marked[j]
    return used


@compiled
def _insert(lists: Indices, k: int, row: int, j: int) -> int:
    """Put a row of column j into the k ascending ones, unless it is there; how many there are."""
    if row <= j or lists[2, row] == j:
        return k
    lists[2, row] = j
    place = k
    while place > 0 and lists[3, place - 1] > row:
        lists[3, place] = lists[3, place - 1]
        place -= 1
    lists[3, place] = row
    return k + 1


@compiled
def factorise(f: Factor, edges: Edges, marked: Flags, work: Array, lists: Indices) -> int:
    """Compute the marked columns and their ancestors anew; -1, or a pose that is left free.

    Each column gathers what the columns before it take from it. For the work: (n, 9) zeros, and
    lists (3, n), the block at which each column waits, the first that waits for each row, the next.
    """
    for j in range(len(f.pose)):
        lists[1, j] = -1
        if marked[j] and f.length[j] > 0:
            marked[f.rows[f.start[j]]] = True
    for j in range(len(f.pose)):
        p = f.start[j]
        if marked[j]:
            _gather(f, edges, j, work)
            k = lists[1, j]
            while k >= 0:
                following, at = lists[2, k], lists[0, k]
                _subtract(f.rows, f.blocks, at, f.start[k] + f.length[k], work)
                _wait(f, k, at + 1, lists)
                k = following
            if not _divide(f, j, work):
                return int(f.pose[j])
        else:
            p += f.length[j]
            while p > f.start[j] and marked[f.rows[p - 1]]:
                p -= 1
        _wait(f, j, p, lists)
    return -1


@compiled
def _wait(f: Factor, k: int, p: int, lists: Indices) -> None:
    """Let column k wait for the row of its block p."""
    if p < f.start[k] + f.length[k]:
        row = f.rows[p]
        lists[0, k], lists[2, k], lists[1, row] = p, lists[1, row], k


@compiled
def _gather(f: Factor, edges: Edges, j: int, work: Array) -> None:
    """Sum the blocks of all edges in column j of the matrix, by row; 1 for a pose without edges."""
    s = f.head[f.pose[j]]
    if s < 0:
        work[j, 0] = work[j, 4] = work[j, 8] = 1.0
    while s >= 0:
        e, side = s // 2, s % 2
        row = f.column[edges.ends[e, 1 - side]]
        for k in range(9):
            work[j, k] += edges.blocks[e, side, k]
            if row > j:
                turned = k if side else 3 * (k % 3) + k // 3
                work[row, k] += edges.blocks[e, 2, turned]
        s = f.link[s]
    for k in range(3):
        f.pivots[j, k] = ROUNDING * work[j, 4 * k]


@compiled
def _subtract(rows: Indices, blocks: Array, p: int, end: int, work: Array) -> None:
    """Take from a column what one before it eliminates: blocks times the transpose of block p."""
    a, b, c = blocks[p, 0], blocks[p, 1], blocks[p, 2]
    d, e, f = blocks[p, 3], blocks[p, 4], blocks[p, 5]
    g, h, i = blocks[p, 6], blocks[p, 7], blocks[p, 8]
    for q in range(p, end):
        for k in range(0, 9, 3):
            x, y, z = blocks[q, k], blocks[q, k + 1], blocks[q, k + 2]
            work[rows[q], k] -= x * a + y * b + z * c
            work[rows[q], k + 1] -= x * d + y * e + z * f
            work[rows[q], k + 2] -= x * g + y * h + z * i


@compiled
def _divide(f: Factor, j: int, work: Array) -> bool:
    """Finish column j, and clear its work; False where a pivot is not positive."""
    m = f.pivots
    least, lesser, last = m[j, 0], m[j, 1], m[j, 2]
    first, a, b = work[j, 0], work[j, 3], work[j, 6]
    if not first > least:
        return False
    m[j, 0] = 1.0 / np.sqrt(first)
    a, b = a * m[j, 0], b * m[j, 0]
    second = work[j, 4] - a * a
    if not second > lesser:
        return False
    m[j, 4] = 1.0 / np.sqrt(second)
    c = (work[j, 7] - a * b) * m[j, 4]
    third = work[j, 8] - b * b - c * c
    if not third > last:
        return False
    m[j, 8] = 1.0 / np.sqrt(third)
    m[j, 3] = -a * m[j, 0] * m[j, 4]
    m[j, 7] = -c * m[j, 4] * m[j, 8]
    m[j, 6] = -(b * m[j, 0] + c * m[j, 3]) * m[j, 8]
    for k in range(9):
        work[j, k] = 0.0
    for q in range(f.start[j], f.start[j] + f.length[j]):
        row = f.rows[q]
        for k in range(0, 9, 3):
            x, y, z = work[row, k], work[row, k + 1], work[row, k + 2]
            f.blocks[q, k] = x * m[j, 0]
            f.blocks[q, k + 1] = x * m[j, 3] + y * m[j, 4]
            f.blocks[q, k + 2] = x * m[j, 6] + y * m[j, 7] + z * m[j, 8]
            work[row, k] = work[row, k + 1] = work[row, k + 2] = 0.0
    return True


@compiled
def substitute(f: Factor, gradient: Array, move: Array) -> None:
    """The step (n, 3) against the gradient (n, 3): forwards through the factor, and back."""
    m, blocks = f.pivots, f.blocks
    for j in range(len(f.pose)):
        for k in range(3):
            move[j, k] = -gradient[j, k]
    for j in range(len(f.pose)):
        i = f.pose[j]
        x, y, z = move[i, 0], move[i, 1], move[i, 2]
        z = m[j, 6] * x + m[j, 7] * y + m[j, 8] * z
        y = m[j, 3] * x + m[j, 4] * y
        x = m[j, 0] * x
        move[i, 0], move[i, 1], move[i, 2] = x, y, z
        for q in range(f.start[j], f.start[j] + f.length[j]):
            row = f.pose[f.rows[q]]
            for k in range(3):
                move[row, k] -= (
                    blocks[q, 3 * k] * x + blocks[q, 3 * k + 1] * y + blocks[q, 3 * k + 2] * z
                )
    for j in range(len(f.pose) - 1, -1, -1):
        i = f.pose[j]
        for q in range(f.start[j], f.start[j] + f.length[j]):
            row = f.pose[f.rows[q]]
            x, y, z = move[row, 0], move[row, 1], move[row, 2]
            for k in range(3):
                move[i, k] -= blocks[q, k] * x + blocks[q, k + 3] * y + blocks[q, k + 6] * z
        x, y, z = move[i, 0], move[i, 1], move[i, 2]
        move[i, 0] = m[j, 0] * x + m[j, 3] * y + m[j, 6] * z
        move[i, 1] = m[j, 4] * y + m[j, 7] * z
        move[i, 2] = m[j, 8] * z
