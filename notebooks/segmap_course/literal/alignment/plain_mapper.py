"""A mapper of six functions, which a student may write: chapter 30.

Each takes arrays: poses are `(3,)`, metres and radians, points `(n, 2)`. Wheels and scans make a
chain of poses, key frames that meet again make loops, and relaxation makes both agree.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy

from segmap.arrays import Array
from segmap.poses import transform

Function = Callable[..., Any]
#: Points on walls and the unit normals of these walls, each (n, 2).
Walls = tuple[Array, Array]
#: A key frame, a later one, and the pose of that seen from the first.
Edge = tuple[int, int, Array]
#: Poses by the numbers of their scans.
Poses = Sequence[Array] | Mapping[int, Array] | Array
#: No step at all.
STILL = np.zeros(3)


class Functions(NamedTuple):
    """The six functions, by the names of their exercises."""

    compose: Function
    segments_all_round: Function
    move_onto_walls: Function
    edge_error: Function
    least_translation: Function
    cell_of: Function


def thinned(points: Array, cell_of: Function, side: float = 0.05) -> Array:
    """One point of each square cell that holds some."""
    cells = {(cell_of(x, 0.0, side), cell_of(y, 0.0, side)): k for k, (x, y) in enumerate(points)}
    return points[list(cells.values())]


def on_walls(points: Array) -> Walls:
    """Those points whose neighbours lie on a line, and the unit normal of that line."""
    around = points[np.asarray(scipy.spatial.cKDTree(points).query(points, 7)[1])]
    around -= around.mean(axis=1, keepdims=True)
    spread, axes = np.linalg.eigh(around.swapaxes(1, 2) @ around)
    flat = spread[:, 0] < 0.1 * spread[:, 1]
    return points[flat], axes[flat, :, 0]


def laid_on(
    walls: Sequence[Walls],
    poses: Poses,
    chosen: Sequence[int],
    scan: Array,
    pose: Array,
    mine: Functions,
) -> tuple[Array, float]:
    """Where a scan comes to rest on walls at their poses; the share of it that is near them."""
    points = np.concatenate([transform(poses[k], walls[k][0]) for k in chosen])
    normals = np.concatenate([transform((0, 0, poses[k][2]), walls[k][1]) for k in chosen])
    tree: Any = scipy.spatial.cKDTree(points)
    for reach in np.geomspace(0.6, 0.1, 10):
        turned = transform((0, 0, pose[2]), scan)
        far, k = tree.query(turned + pose[:2])
        near, feet = far < reach, points[k] - pose[:2]
        pose = pose + mine.move_onto_walls(turned[near], feet[near], normals[k[near]])
    return pose, float(np.mean(far < 0.1))


def follow(
    scans: Sequence[Array], walls: Sequence[Walls], wheels: Array, mine: Functions
) -> tuple[Array, list[int]]:
    """Poses of all scans, each laid on the last five key frames; and which are key frames."""
    poses, keys = [wheels[0]], [0]
    for k in range(1, len(scans)):
        start = mine.compose(poses[-1], mine.edge_error(wheels[k - 1], wheels[k], STILL))
        poses.append(laid_on(walls, poses, keys[-5:], scans[k], start, mine)[0])
        x, y, turn = mine.edge_error(poses[keys[-1]], poses[k], STILL)
        if max(np.hypot(x, y), abs(turn)) > 0.5:
            keys.append(k)
    return np.array(poses), keys


def graph_edges(
    scans: Sequence[Array], walls: Sequence[Walls], poses: Array, keys: list[int], mine: Functions
) -> list[Edge]:
    """To each key frame from the one before, and from the nearest much older one that it fits."""
    edges = []
    for b, k in enumerate(keys[1:], 1):
        edges.append((b - 1, b, mine.edge_error(poses[keys[b - 1]], poses[k], STILL)))
        far = np.hypot(*(poses[keys[: max(b - 8, 1)], :2] - poses[k, :2]).T)
        a = int(far.argmin())
        if b > 8 and far[a] < 1:
            around = keys[max(a - 1, 0) : a + 2]
            pose, share = laid_on(walls, poses, around, scans[k], poses[k], mine)
            if share > 0.7:
                edges.append((a, b, mine.edge_error(poses[keys[a]], pose, STILL)))
    return edges


def relaxed(nodes: Array, edges: list[Edge], mine: Functions, sweeps: int = 100) -> Array:
    """Each pose takes in turn the shift and the turn that its edges ask for, times 1.8."""
    nodes, back = nodes.copy(), [(b, a, mine.edge_error(s, STILL, STILL)) for a, b, s in edges]
    beside = [[(i, s) for i, j, s in edges + back if j == k] for k in range(len(nodes))]
    for k in [*range(1, len(nodes))] * sweeps:
        x, y, turn = np.transpose([mine.edge_error(nodes[i], nodes[k], s) for i, s in beside[k]])
        c, s = np.cos(nodes[k, 2] - turn), np.sin(nodes[k, 2] - turn)
        normals = np.column_stack([np.append(c, -s), np.append(s, c)])
        shift = mine.least_translation(normals, np.append(x, y), np.ones(2 * len(x)))
        nodes[k] += 1.8 * np.append(shift, -turn.mean())
    return nodes


def lines(points: Array, fit: Function) -> list[Array]:
    """Segments of a scan, cut at its widest gap, then where a run is farthest from its chord."""
    if len(points) < 5:
        return []
    gaps, (dx, dy) = np.hypot(*np.diff(points, axis=0).T), points[-1] - points[0]
    off = abs((points - points[0]) @ (-dy, dx)) / max(np.hypot(dx, dy), 1e-9)
    if gaps.max() < 0.3 and off.max() < 0.04:
        return [*fit(points, 100.0)]
    k = int(off.argmax() if gaps.max() < 0.3 else gaps.argmax() + 1)
    return lines(points[:k], fit) + lines(points[k:], fit)


def mapped(scans: Sequence[Array], wheels: Array, mine: Functions) -> list[Array]:
    """Poses of all scans by the chain alone, and with its loops."""
    thin = [thinned(scan, mine.cell_of) for scan in scans]
    walls = [on_walls(scan) for scan in thin]
    poses, keys = follow(thin, walls, wheels, mine)
    nodes = relaxed(poses[keys], graph_edges(thin, walls, poses, keys, mine), mine)
    frame = np.searchsorted(keys, np.arange(len(poses)), side="right") - 1
    steps = [mine.edge_error(poses[keys[b]], poses[k], STILL) for k, b in enumerate(frame)]
    return [poses, np.array([mine.compose(nodes[b], steps[k]) for k, b in enumerate(frame)])]
