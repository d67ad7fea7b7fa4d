"""Kernels of the pose-graph solver: the equations of all edges, and their factor.

The equations are those of Grisetti et al. (2010). Their matrix has a block of 3 x 3 for each pair
of poses that an edge joins, and is factorised by Cholesky, column by column. What changes in one
column changes only its ancestors in the elimination tree (Davis 2006, "Direct Methods for Sparse
Linear Systems"), so that only those are computed again.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: A pivot that is left with less than this part of its entry is rounding: the pose is free.
PIVOT_ROUNDING = 1e-15


class Edge(NamedTuple):
    """A measured motion between two poses; or m of them, each field with a leading axis m."""

    first: Any  # index of a pose: int, or (m,) int array
    second: Any
    relative: Array  # (3,): pose of the second in the frame of the first, metres and radians
    information: Array  # (3, 3): inverse covariance of that motion
    loop: Any = False  # whether it closes a loop; else it joins neighbours in time
    forced: Any = False  # whether it keeps its weight, however far the others leave it open


def stack(edges: Sequence[Edge]) -> Edge:
    """Several edges as one whose fields have a leading axis m."""
    return Edge(*(np.array(field) for field in zip(*edges, strict=True)))


class Edges(NamedTuple):
    """m edges, and the equations that were made of them last."""

    ends: Indices  # (m, 2)
    relative: Array
    information: Array
    scale: Array  # (m,): left open by so many standard deviations it has half the weight
    blocks: Array  # (m, 3, 9): first and first, second and second, first and second
    made: Array  # (m, 4), from what: motion, metres, heading of the first, radians, and weight


@compiled
def linearise(
    poses: Array,
    edges: Edges,
    bent: float,
    stale: float,
    gradient: Array,
    changed: Flags,
    room: Array,
) -> float:
    """Half the loss at some poses; adds up its gradient (n, 3), and makes stale blocks anew.

    Stale is an edge whose motion, heading or weight has changed by more than so many metres,
    radians, parts; its poses are marked as changed. `bent` is the part of a weight that the bend of
    the loss takes at most: 0 for plain weights. `room` is a (6, 3) array for the work.
    """
    loss = 0.0
    for e in range(len(edges.ends)):
        a, b = edges.ends[e, 0], edges.ends[e, 1]
        c, s = np.cos(poses[a, 2]), np.sin(poses[a, 2])
        dx, dy = poses[b, 0] - poses[a, 0], poses[b, 1] - poses[a, 1]
        x, y = c * dx + s * dy, c * dy - s * dx
        room[0, 0], room[0, 1] = x - edges.relative[e, 0], y - edges.relative[e, 1]
        turn = poses[b, 2] - poses[a, 2] - edges.relative[e, 2]
        room[0, 2] = (turn + np.pi) % (2 * np.pi) - np.pi
        square = 0.0
        for p in range(3):
            room[1, p] = 0.0
            for q in range(3):
                room[1, p] += edges.information[e, p, q] * room[0, q]
            square += room[1, p] * room[0, p]
        scale = edges.scale[e]
        part = max(square, 0.0) / (scale * scale)
        weight = 1.0 / (1.0 + part)
        loss += 0.5 * (square if scale == np.inf else scale * scale * np.log1p(part))
        # Derivatives of the residual: by the second pose a turn, by the first its negative, and:
        u, v = weight * room[1, 0], weight * room[1, 1]
        u, v, w = c * u - s * v, s * u + c * v, weight * room[1, 2]
        gradient[a, 0] -= u
        gradient[a, 1] -= v
        gradient[a, 2] -= w + weight * (x * room[1, 1] - y * room[1, 0])
        gradient[b, 0] += u
        gradient[b, 1] += v
        gradient[b, 2] += w
        off = max(abs(x - edges.made[e, 0]), abs(y - edges.made[e, 1]))
        off = max(off, abs(poses[a, 2] - edges.made[e, 2]), abs(weight / edges.made[e, 3] - 1.0))
        if off > stale:
            edges.made[e, 0], edges.made[e, 1] = x, y
            edges.made[e, 2], edges.made[e, 3] = poses[a, 2], weight
            bend = min(2.0 * weight * part, bent) * weight / square if square > 0.0 else 0.0
            for p in range(3):
                for q in range(3):
                    room[3 + p, q] = weight * edges.information[e, p, q]
                    room[3 + p, q] -= bend * room[1, p] * room[1, q]
            _make(edges.blocks, e, c, s, x, y, room)
            changed[a] = changed[b] = True
    return loss


@compiled
def _make(blocks: Array, e: int, c: float, s: float, x: float, y: float, room: Array) -> None:
    """The blocks of edge e, from its weight, the last three rows of the room.

    The derivative D by the second pose turns by the heading of the first; that by the first is
    -D T, where T adds to a shift what a turn of the first does: the columns p and q of T below.
    """
    for k in range(3):  # the weight times D
        u, v = room[3 + k, 0], room[3 + k, 1]
        room[3 + k, 0], room[3 + k, 1] = c * u - s * v, s * u + c * v
    for k in range(3):  # the transpose of D times that
        u, v = room[3, k], room[4, k]
        room[3, k], room[4, k] = c * u - s * v, s * u + c * v
    p, q = -(s * x + c * y), c * x - s * y
    for k in range(3):
        for m in range(3):
            blocks[e, 1, 3 * k + m] = room[3 + k, m]
            blocks[e, 2, 3 * k + m] = -room[3 + k, m]
            blocks[e, 0, 3 * k + m] = room[3 + k, m]
    for m in range(3):
        more = p * room[3, m] + q * room[4, m]
        blocks[e, 2, 6 + m] -= more
        blocks[e, 0, 6 + m] += more
    for k in range(3):
        blocks[e, 0, 3 * k + 2] += p * blocks[e, 0, 3 * k] + q * blocks[e, 0, 3 * k + 1]


@compiled
def advance(poses: Array, move: Array, column: Indices, ahead: Array) -> float:
    """Write the poses ahead, moved by the steps (n, 3) in their columns; how far the farthest goes.

    All are carried along, rigidly, so that the first stays where it is.
    """
    first, farthest = column[0], 0.0
    turn, x0, y0 = move[first, 2], poses[0, 0], poses[0, 1]
    c, s = np.cos(turn), np.sin(turn)
    for k in range(len(poses)):
        x = poses[k, 0] - x0 + move[column[k], 0] - move[first, 0]
        y = poses[k, 1] - y0 + move[column[k], 1] - move[first, 1]
        ahead[k, 0], ahead[k, 1] = x0 + c * x + s * y, y0 + c * y - s * x
        ahead[k, 2] = (poses[k, 2] + move[column[k], 2] - turn + np.pi) % (2 * np.pi) - np.pi
        farthest = max(farthest, abs(move[column[k], 2] - turn))
        farthest = max(farthest, abs(ahead[k, 0] - poses[k, 0]), abs(ahead[k, 1] - poses[k, 1]))
    return farthest


class Factor(NamedTuple):
    """The factor of the matrix: `length[j]` blocks from `start[j]` on are column j."""

    column: Indices  # column of each pose; the fixed one has column 0
    pose: Indices  # pose of each column
    head: Indices  # first slot of each pose, -1: none; slots 2 e and 2 e + 1 are the ends of edge e
    link: Indices  # (2 m,): next slot of the same pose, -1: none
    start: Indices
    length: Indices
    rows: Indices  # rows of the blocks, ascending in each column; the first is the column's parent
    values: Array  # (9 c,): three columns of numbers in each column, from its first row down
    pivots: Array  # (n, 9): inverse of the lower triangle on the diagonal


@compiled
def link_slots(head: Indices, link: Indices, ends: Indices, begin: int, fixed: int) -> None:
    """Give each pose the slots of the edges from `begin` on, see `Factor`; the last comes first.

    An edge from a pose to itself says nothing and has no slot, nor has the fixed pose.
    """
    for s in range(2 * begin, 2 * len(ends)):
        owner = ends[s // 2, s % 2]
        if owner != fixed and owner != ends[s // 2, 1 - s % 2]:
            link[s], head[owner] = head[owner], s


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

    Each column gathers what the columns before it take from it. Those that follow each other with
    the same rows below them are one supernode (Ng and Peyton 1993), which waits as one and is a
    dense product. For the work: (n, 9) zeros, and lists (4, n), the first column of each supernode,
    the rows it has left, the last column of the first that waits for each row, and of the next.
    """
    sums = np.empty((3, 3 * len(f.pose)))
    for j in range(len(f.pose)):
        lists[0, j], lists[2, j] = j, -1
        if j > 0 and f.length[j - 1] == f.length[j] + 1 and f.rows[f.start[j - 1]] == j:
            lists[0, j] = lists[0, j - 1]
        if marked[j] and f.length[j] > 0:
            marked[f.rows[f.start[j]]] = True
    for j in range(len(f.pose)):
        rest = f.length[j]
        if marked[j]:
            _assemble_column(f, edges, j, work)
            if lists[0, j] < j:
                _subtract(f, lists[0, j], j - 1, rest + 1, work, sums)
            k = lists[2, j]
            while k >= 0:
                following = lists[3, k]
                _subtract(f, lists[0, k], k, lists[1, k], work, sums)
                _wait(f, k, lists[1, k] - 1, lists)
                k = following
            if not _divide(f, j, work):
                return int(f.pose[j])
        else:
            rest = 0
            while rest < f.length[j] and marked[f.rows[f.start[j] + f.length[j] - rest - 1]]:
                rest += 1
        if j + 1 == len(f.pose) or lists[0, j + 1] > j:
            _wait(f, j, rest, lists)
    return -1


@compiled
def _wait(f: Factor, k: int, rest: int, lists: Indices) -> None:
    """Let the supernode that ends with column k wait for the first of its rows that are left."""
    if rest > 0:
        row = f.rows[f.start[k] + f.length[k] - rest]
        lists[1, k], lists[3, k], lists[2, row] = rest, lists[2, row], k


@compiled
def _assemble_column(f: Factor, edges: Edges, j: int, work: Array) -> None:
    """Sum the blocks of all edges in column j of the matrix, by row; 1 for a pose without edges."""
    s = f.head[f.pose[j]]
    if s < 0:
        work[j, 0] = work[j, 4] = work[j, 8] = 1.0
    while s >= 0:
        e, side = s // 2, s % 2
        row = f.column[edges.ends[e, 1 - side]]
        for k in range(9):
            turned = 3 * (k % 3) + k // 3
            work[j, k] += edges.blocks[e, side, k]
            if row > j:
                work[row, k] += edges.blocks[e, 2, turned if side else k]
        s = f.link[s]
    for k in range(3):
        f.pivots[j, k] = PIVOT_ROUNDING * work[j, 4 * k]


@compiled
def _subtract(f: Factor, begin: int, last: int, rest: int, work: Array, sums: Array) -> None:
    """Take from a column what a supernode before it eliminates, by the rows that it has left."""
    many = 3 * rest
    s, t, u = sums[0, :many], sums[1, :many], sums[2, :many]
    for r in range(many):
        s[r] = t[r] = u[r] = 0.0
    for k in range(begin, last + 1):
        size, end = 3 * f.length[k], 9 * f.start[k] + 3 * f.length[k]
        x = f.values[end - many : end]
        y = f.values[end + size - many : end + size]
        z = f.values[end + 2 * size - many : end + 2 * size]
        a, b, c = x[0], x[1], x[2]
        d, e, g = y[0], y[1], y[2]
        h, i, m = z[0], z[1], z[2]
        for r in range(many):
            s[r] += x[r] * a + y[r] * d + z[r] * h
            t[r] += x[r] * b + y[r] * e + z[r] * i
            u[r] += x[r] * c + y[r] * g + z[r] * m
    below = f.start[last] + f.length[last] - rest
    for q in range(rest):
        row = f.rows[below + q]
        for k in range(3):
            work[row, k] -= s[3 * q + k]
            work[row, 3 + k] -= t[3 * q + k]
            work[row, 6 + k] -= u[3 * q + k]


@compiled
def _divide(f: Factor, j: int, work: Array) -> bool:
    """Finish column j, and clear its work; False where a pivot is not positive."""
    m = f.pivots
    least, lesser, last = m[j, 0], m[j, 1], m[j, 2]
    first, a, b = work[j, 0], work[j, 1], work[j, 2]
    if not first > least:
        return False
    m[j, 0] = 1.0 / np.sqrt(first)
    a, b = a * m[j, 0], b * m[j, 0]
    second = work[j, 4] - a * a
    if not second > lesser:
        return False
    m[j, 4] = 1.0 / np.sqrt(second)
    c = (work[j, 5] - a * b) * m[j, 4]
    third = work[j, 8] - b * b - c * c
    if not third > last:
        return False
    m[j, 8] = 1.0 / np.sqrt(third)
    m[j, 3] = -a * m[j, 0] * m[j, 4]
    m[j, 7] = -c * m[j, 4] * m[j, 8]
    m[j, 6] = -(b * m[j, 0] + c * m[j, 3]) * m[j, 8]
    for k in range(9):
        work[j, k] = 0.0
    size = 3 * f.length[j]
    for q in range(f.length[j]):
        row, at = f.rows[f.start[j] + q], 9 * f.start[j] + 3 * q
        for k in range(3):
            x, y, z = work[row, k], work[row, 3 + k], work[row, 6 + k]
            f.values[at + k] = x * m[j, 0]
            f.values[at + size + k] = x * m[j, 3] + y * m[j, 4]
            f.values[at + 2 * size + k] = x * m[j, 6] + y * m[j, 7] + z * m[j, 8]
            work[row, k] = work[row, 3 + k] = work[row, 6 + k] = 0.0
    return True


@compiled
def substitute(f: Factor, move: Array) -> None:
    """Solve for the step (n, 3), by columns, in the place of the right side: forwards, and back."""
    m = f.pivots
    for j in range(len(f.pose)):
        at, size, x, y, z = 9 * f.start[j], 3 * f.length[j], move[j, 0], move[j, 1], move[j, 2]
        z = m[j, 6] * x + m[j, 7] * y + m[j, 8] * z
        y = m[j, 3] * x + m[j, 4] * y
        x = m[j, 0] * x
        move[j, 0], move[j, 1], move[j, 2] = x, y, z
        u, v, w = f.values[at : at + size], f.values[at + size :], f.values[at + 2 * size :]
        for q in range(f.length[j]):
            row = f.rows[f.start[j] + q]
            for k in range(3):
                move[row, k] -= u[3 * q + k] * x + v[3 * q + k] * y + w[3 * q + k] * z
    for j in range(len(f.pose) - 1, -1, -1):
        at, size, x, y, z = 9 * f.start[j], 3 * f.length[j], move[j, 0], move[j, 1], move[j, 2]
        u, v, w = f.values[at : at + size], f.values[at + size :], f.values[at + 2 * size :]
        for q in range(f.length[j]):
            row = f.rows[f.start[j] + q]
            for k in range(3):
                x -= u[3 * q + k] * move[row, k]
                y -= v[3 * q + k] * move[row, k]
                z -= w[3 * q + k] * move[row, k]
        move[j, 0] = m[j, 0] * x + m[j, 3] * y + m[j, 6] * z
        move[j, 1] = m[j, 4] * y + m[j, 7] * z
        move[j, 2] = m[j, 8] * z
