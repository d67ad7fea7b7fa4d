"""Kernels of the pose-graph solver: the equations of all edges (Grisetti et al. 2010)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]


class Edge(NamedTuple):
    """A measured motion between two poses; or m of them, each field with a leading axis m."""

    first: Any  # index of a pose: int, or (m,) int array
    second: Any
    relative: Array  # (3,): pose of the second in the frame of the first, metres and radians
    information: Array  # (3, 3): inverse covariance of that motion
    loop: Any = False  # whether it closes a loop; else it joins neighbours in time
    forced: Any = False  # whether it keeps its weight, however far the others leave it open


def stacked(edges: Sequence[Edge]) -> Edge:
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
